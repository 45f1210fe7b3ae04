#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Metrics of the evo package (https://pypi.org/project/evo, tested with 1.31.1 and 1.38.1) that `rds eval` must equal.

    evo_reference.py available              exit code 0 if evo can be imported
    evo_reference.py generate FOLDER SEED   write three pairs of trajectories: NAME_estimate.txt, NAME_truth.txt
    evo_reference.py figures FOLDER         print evo's figures of all pairs in FOLDER as JSON

src/eval/testdata holds the pairs of seed 1 and their figures (golden.json); src/eval/evo_test.cc compares. Only evo's
programming interface is used, and only as its documentation describes it.
"""
import argparse
import copy
import json
import math
import os
import pathlib
import random
import sys
import tempfile

MAX_DIFFERENCE_S = 0.01


# --- Trajectories: plain Python, so that the same seed gives the same bytes everywhere. ---

def multiply(a, b):
    """Product of quaternions (w, x, y, z)."""
    return (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])


def from_rotation_vector(v):
    angle = math.sqrt(sum(x * x for x in v))
    factor = math.sin(angle / 2) / angle if angle > 0 else 0.5
    return (math.cos(angle / 2), *(factor * x for x in v))


def rotate(q, v):
    return multiply(multiply(q, (0.0, *v)), (q[0], -q[1], -q[2], -q[3]))[1:]


def true_pose(t, reach_m):
    """A smooth path that turns all the way round."""
    position = (reach_m * math.sin(0.7 * t), reach_m * math.cos(0.45 * t) + 0.1 * t, 0.4 * math.sin(1.3 * t))
    rotation = multiply(from_rotation_vector((0, 0, 0.9 * t)), from_rotation_vector((0.6 * math.sin(t), 0.3 * t, 0)))
    return position, rotation


def estimated_pose(position, rotation, noise, scale, rng):
    """The true pose in another world frame, shrunk and noisy."""
    world = from_rotation_vector((0.4, -1.1, 0.8))
    offset = (3.0, -2.0, 0.5)
    moved = rotate(world, position)
    return (tuple(scale * m + o + rng.gauss(0, noise) for m, o in zip(moved, offset)),
            multiply(multiply(world, rotation), from_rotation_vector([rng.gauss(0, noise) for _ in range(3)])))


def row(t, position, rotation):
    w, x, y, z = rotation
    return "%.6f " % t + " ".join("%.9g" % value for value in (*position, x, y, z, w)) + "\n"


def generate(folder, seed):
    """Same times; dense truth, jitter and a gap; estimate denser than the truth, with drift in scale."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = random.Random(seed)
    begin = 1305031102.175304
    cases = {
        "same_times": ([i / 30 for i in range(240)], None, 0.01, 1.0),
        "gap": ([i / 30 + rng.uniform(-0.004, 0.004) for i in range(300) if not 120 <= i < 170],
                [i / 100 for i in range(-20, 1050)], 0.03, 1.0),
        "dense_estimate": ([i / 30 for i in range(300)], [i / 12 + 0.003 for i in range(110)], 0.005, 0.83),
    }
    for name, (estimate_times, truth_times, noise, scale) in cases.items():
        truth = [(begin + t, *true_pose(t, 1.5)) for t in (truth_times or estimate_times)]
        estimate = [(begin + t, *estimated_pose(*true_pose(t, 1.5), noise, scale, rng)) for t in estimate_times]
        for kind, poses in (("truth", truth), ("estimate", estimate)):
            text = "# timestamp tx ty tz qx qy qz qw\n" + "".join(row(*pose) for pose in poses)
            (folder / f"{name}_{kind}.txt").write_text(text, encoding="utf-8")


# --- Metrics, by evo. ---

def quiet_import():
    """Imports evo with its settings in a folder of no consequence."""
    with tempfile.TemporaryDirectory() as home:
        before = os.environ.get("HOME")
        os.environ["HOME"] = home
        os.environ.setdefault("MPLBACKEND", "agg")
        try:
            import evo.core.metrics  # noqa: F401
            import evo.core.sync  # noqa: F401
            import evo.tools.file_interface  # noqa: F401
        finally:
            if before is None:
                del os.environ["HOME"]
            else:
                os.environ["HOME"] = before


def summary(errors):
    import numpy
    errors = numpy.asarray(errors)
    return {"count": len(errors), "rmse": math.sqrt(numpy.mean(errors ** 2)), "mean": float(numpy.mean(errors)),
            "median": float(numpy.median(errors)), "std": float(numpy.std(errors)), "min": float(numpy.min(errors)),
            "max": float(numpy.max(errors))}


def ate(truth, estimate):
    from evo.core import metrics
    metric = metrics.APE(metrics.PoseRelation.translation_part)
    metric.process_data((truth, estimate))
    result = {name: float(value) for name, value in metric.get_all_statistics().items() if name != "sse"}
    result["count"] = len(metric.error)
    return result


def rpe_frames(truth, estimate, frames):
    """As `evo_rpe -d FRAMES -u f --all_pairs` has it."""
    from evo.core import metrics
    result = {"delta": frames, "delta_unit": "frames"}
    for key, relation in (("translation_m", metrics.PoseRelation.translation_part),
                          ("rotation_deg", metrics.PoseRelation.rotation_angle_deg)):
        metric = metrics.RPE(relation, delta=frames, delta_unit=metrics.Unit.frames, all_pairs=True)
        metric.process_data((truth, estimate))
        result[key] = {name: float(value) for name, value in metric.get_all_statistics().items() if name != "sse"}
        result[key]["count"] = len(metric.error)
    return result


def rpe_seconds(truth, estimate, delta_s):
    """evo knows no seconds: our pairs (see src/eval/evaluation.h), each pair's error by evo."""
    import numpy
    from evo.core import lie_algebra, metrics
    times = estimate.timestamps
    tolerance_s = 0.75 * numpy.median(numpy.diff(times))
    translation_m, rotation_deg = [], []
    for i in range(len(times)):
        if i + 1 == len(times):
            break
        off = numpy.abs(times[i + 1:] - times[i] - delta_s)
        j = i + 1 + int(numpy.argmin(off))
        if off[j - i - 1] >= tolerance_s:
            continue
        error = metrics.RPE.rpe_base(truth.poses_se3[i], truth.poses_se3[j], estimate.poses_se3[i],
                                     estimate.poses_se3[j])
        translation_m.append(float(numpy.linalg.norm(error[:3, 3])))
        rotation_deg.append(math.degrees(lie_algebra.so3_log_angle(error[:3, :3])))
    return {"delta": delta_s, "delta_unit": "s", "translation_m": summary(translation_m),
            "rotation_deg": summary(rotation_deg)}


def figures(folder):
    from evo.core import sync
    from evo.tools import file_interface
    result = {}
    for path in sorted(folder.glob("*_estimate.txt")):
        name = path.name[:-len("_estimate.txt")]
        truth, estimate = sync.associate_trajectories(
            file_interface.read_tum_trajectory_file(str(folder / f"{name}_truth.txt")),
            file_interface.read_tum_trajectory_file(str(path)), max_diff=MAX_DIFFERENCE_S)
        result[name] = {}
        for kind, with_scale in (("rigid", False), ("similarity", True)):
            aligned = copy.deepcopy(estimate)
            aligned.align(truth, correct_scale=with_scale)
            result[name][kind] = {"ate_m": ate(truth, aligned),
                                  "rpe": [rpe_frames(truth, aligned, 1), rpe_frames(truth, aligned, 30),
                                          rpe_seconds(truth, aligned, 1.0)]}
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("available")
    command = commands.add_parser("generate")
    command.add_argument("folder", type=pathlib.Path)
    command.add_argument("seed", type=int)
    command = commands.add_parser("figures")
    command.add_argument("folder", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.command == "generate":
        generate(arguments.folder, arguments.seed)
        return 0
    try:
        quiet_import()
    except ImportError as error:
        print(f"evo is not there: {error}", file=sys.stderr)
        return 1
    if arguments.command == "figures":
        print(json.dumps(figures(arguments.folder), indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
