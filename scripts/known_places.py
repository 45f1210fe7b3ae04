# SPDX-License-Identifier: Apache-2.0
"""When a sequence shows again what it has shown before, by its ground truth, depth images and masks. Wants numpy and
Pillow."""
import numpy as np
from PIL import Image
from rearrange_sequence import read_list

FOCAL, CENTER, DEPTH_UNITS = 585.0, (320.0, 240.0), 1000.0  # pixels; in a meter
STEP = 20  # pixels from sample to sample
FAR_M = 5.0
LEAST_SAMPLES = 60
EVERY = 5  # frames shown before, of which one is held against
AGREE_M, AGREE_SHARE = 0.05, 0.03  # of depth
KNOWN_SHARE = 0.7


class KnownPlaces:
    """Of a sequence of the kitchen (640 x 480) that scripts/rearrange_sequence.py made: its lists have the same times."""

    def __init__(self, sequence):
        self.sequence = sequence
        self.depth, self.poses = (dict(read_list(sequence / f"{name}.txt")) for name in ("depth", "groundtruth"))
        self.masks = dict(read_list(sequence / "mask.txt")) if (sequence / "mask.txt").exists() else {}
        self.stamps = [stamp for stamp, _ in read_list(sequence / "rgb.txt")]
        self.rows, self.columns = np.mgrid[STEP // 2:480:STEP, STEP // 2:640:STEP]
        self.rays = np.stack([(self.columns - CENTER[0]) / FOCAL, (self.rows - CENTER[1]) / FOCAL,
                              np.ones(self.rows.shape)], -1)
        self.views = {}

    def view(self, index):
        """Depth of the static samples (0: none), rotation and position (world from camera); None of a black frame."""
        if index not in self.views:
            stamp = self.stamps[index]
            self.views[index] = None
            if stamp in self.poses:
                depth = self.samples(self.depth[stamp]) / DEPTH_UNITS
                if stamp in self.masks:
                    depth[self.samples(self.masks[stamp]) > 0] = 0
                depth[depth > FAR_M] = 0
                *position, x, y, z, w = map(float, self.poses[stamp].split())
                rotation = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
                self.views[index] = depth, rotation, np.array(position)
        return self.views[index]

    def samples(self, file):
        return np.asarray(Image.open(self.sequence / file))[self.rows, self.columns].astype(float)

    def share(self, index, other):
        """Of the static samples of a frame: the share of those that another has seen where they are."""
        if self.view(index) is None or self.view(other) is None:
            return 0.0
        (depth, rotation, position), (seen, other_rotation, other_position) = self.view(index), self.view(other)
        valid = depth > 0
        if valid.sum() < LEAST_SAMPLES:
            return 0.0
        world = (self.rays * depth[..., None])[valid] @ rotation.T + position
        there = (world - other_position) @ other_rotation
        z = np.maximum(there[:, 2], 1e-3)
        column = np.floor((FOCAL * there[:, 0] / z + CENTER[0]) / STEP).astype(int)
        row = np.floor((FOCAL * there[:, 1] / z + CENTER[1]) / STEP).astype(int)
        inside = (there[:, 2] > 0.2) & (column >= 0) & (column < seen.shape[1]) & (row >= 0) & (row < seen.shape[0])
        depth_there = np.zeros(len(z))
        depth_there[inside] = seen[row[inside], column[inside]]
        agrees = (depth_there > 0) & (np.abs(depth_there - z) < AGREE_M + AGREE_SHARE * z)
        return agrees.sum() / valid.sum()

    def since(self, jump, last):
        """The first frame from `jump` on and before `last` of which one frame shown before `jump` has seen the static
        part, but for a third; None if there is none."""
        for index in range(jump, last):
            if any(self.share(index, other) >= KNOWN_SHARE for other in range(0, jump, EVERY)):
                return index
        return None
