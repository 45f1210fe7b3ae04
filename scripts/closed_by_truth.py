#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a true loop edge would make of a trajectory that was estimated without loops.

    scripts/closed_by_truth.py GROUNDTRUTH TRAJECTORY FRAMES

Bends TRAJECTORY (TUM format) as a pose graph whose only loop edge is the true relative pose between the first pose and
that FRAMES later. Prints the ATE (root mean square after rigid alignment, meters) of the trajectory and of the bent
one. What remains is not the loop's to mend: noise between its ends. Wants scipy.
"""
import sys

import numpy as np
from scipy.optimize import least_squares
from scipy.sparse import lil_matrix
from scipy.spatial.transform import Rotation

EVERY = 25  # poses, of which one is a node
SIGMA = np.array([np.radians(0.05)] * 3 + [0.004] * 3)  # rotation, position from node to node; their ratio matters only
LOOP_WEIGHT = 10


class Poses:
    """World from camera: rotations and positions."""

    def __init__(self, rotations, positions):
        self.rotations = rotations
        self.positions = positions

    def __getitem__(self, index):
        return Poses(self.rotations[index], self.positions[index])

    def between(self, other):
        """From each of the other to each of these."""
        inverse = self.rotations.inv()
        return Poses(inverse * other.rotations, inverse.apply(other.positions - self.positions))


def read(path):
    rows = np.loadtxt(path, comments="#", ndmin=2)
    return rows[:, 0], Poses(Rotation.from_quat(rows[:, 4:8]), rows[:, 1:4])


def ate(positions, truth):
    own, other = positions - positions.mean(0), truth - truth.mean(0)
    u, _, v = np.linalg.svd(other.T @ own)
    rotation = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return float(np.sqrt(((own @ rotation.T - other) ** 2).sum(1).mean()))


def closed_by_truth(groundtruth, trajectory, frames):
    """ATE of the trajectory and of the one that is closed, meters."""
    times, estimated = read(trajectory)
    true_times, truth = read(groundtruth)
    nearest = np.abs(true_times[None, :] - times[::EVERY, None]).argmin(1)
    estimated, truth = estimated[::EVERY], truth[nearest]
    nodes, again = len(estimated.positions), frames // EVERY
    if again >= nodes:
        raise ValueError(f"{trajectory}: no pose {frames} frames after the first")
    steps = estimated[:-1].between(estimated[1:])
    loop = truth[[0]].between(truth[[again]])

    def error(measured, seen, sigma):
        return (np.hstack([(measured.rotations.inv() * seen.rotations).as_rotvec(),
                           seen.positions - measured.positions]) / sigma).ravel()

    def errors(x):
        x = x.reshape(nodes, 6)
        bent = Poses(Rotation.from_rotvec(x[:, :3]) * estimated.rotations, estimated.positions + x[:, 3:])
        return np.concatenate([error(steps, bent[:-1].between(bent[1:]), SIGMA),
                               error(loop, bent[[0]].between(bent[[again]]), SIGMA / LOOP_WEIGHT), x[0] * 1e3])

    pattern = lil_matrix((6 * (nodes + 1), 6 * nodes), dtype=int)
    for row, both in enumerate([(i, i + 1) for i in range(nodes - 1)] + [(0, again), (0, 0)]):
        for node in both:
            pattern[6 * row:6 * row + 6, 6 * node:6 * node + 6] = 1
    solution = least_squares(errors, np.zeros(6 * nodes), jac_sparsity=pattern, x_scale="jac")
    return ate(estimated.positions, truth.positions), ate(estimated.positions + solution.x.reshape(nodes, 6)[:, 3:],
                                                          truth.positions)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    before, after = closed_by_truth(sys.argv[1], sys.argv[2], int(sys.argv[3]))
    print(f"{before:.4f} {after:.4f} {after / before:.2f}")
