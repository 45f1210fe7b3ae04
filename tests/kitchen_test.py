#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the program on real recordings: the kitchen and desk sequences, static and with people walking through them.

    kitchen_test.py RDS WORK_FOLDER make|static|walking|lockstep|threaded|turning|desk|kidnap

The recordings are not part of the repository: RDS_SHARED names the folder that has bench/make_sequences.py. Without it
every test is skipped (exit code 77). `make` builds the sequences first.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys

SHARED = pathlib.Path(os.environ.get("RDS_SHARED", "RDS_SHARED is not set"))
SEQUENCES = {"kitchen_static": 300, "kitchen_walking": 300, "fr1_rpy": 240, "desk_walking": 500}  # and their frames
FRAMES = 300


def skip(reason):
    print(f"[  SKIPPED ] {reason}")
    sys.exit(77)


def python_with_opencv():
    for python in ("/usr/bin/python3", sys.executable):
        if subprocess.run([python, "-c", "import cv2, numpy"], capture_output=True, check=False).returncode == 0:
            return python
    return skip("no Python with OpenCV, which makes the kitchen sequences (apt-get install python3-opencv)")


def make(work):
    for name, frames in SEQUENCES.items():
        if not (work / name / "groundtruth.txt").is_file():
            staging = work / "unfinished"
            shutil.rmtree(staging, ignore_errors=True)
            subprocess.run([python_with_opencv(), SHARED / "bench" / "make_sequences.py", "--out", staging,
                            "--frames", "0", str(frames), name], check=True)
            (staging / name).rename(work / name)


class Runner:
    def __init__(self, rds, work):
        self.rds = rds
        self.work = work

    def run(self, name, sequence, *options):
        """Runs SLAM; returns the folder of the results and the report."""
        out = self.work / "out" / name
        shutil.rmtree(out, ignore_errors=True)
        camera = ("--camera", "redkitchen") if sequence.startswith("kitchen") else ()  # the others are recognized
        subprocess.run([self.rds, "run", self.work / sequence, *camera, "--out", out, *options], check=True,
                       timeout=300)
        report = json.loads((out / "report.json").read_text(encoding="utf-8"))
        print(f"{name}: tracked {report['tracked']} of {report['frames']}, ATE {report['ate_m']['rmse']:.4f} m")
        return out, report


def expect(condition, what):
    if not condition:
        print(f"FAILED: {what}")
        sys.exit(1)


def test_static(runner):
    _, report = runner.run("static", "kitchen_static", "--lockstep", "--segmenter", "none")
    expect(report["tracked"] == report["frames"] == FRAMES, "every frame is tracked")
    expect(report["ate_m"]["rmse"] <= MAX_ATE_M, f"the error is at most {MAX_ATE_M} m")


def test_walking(runner):
    _, with_semantics = runner.run("walking_stored", "kitchen_walking", "--lockstep", "--segmenter", "stored")
    _, without = runner.run("walking_none", "kitchen_walking", "--lockstep", "--segmenter", "none")
    expect(with_semantics["tracked"] >= 0.99 * FRAMES, "99 % of the frames are tracked")
    expect(with_semantics["ate_m"]["rmse"] <= MAX_ATE_M, f"the error is at most {MAX_ATE_M} m")
    expect(with_semantics["ate_m"]["rmse"] < 0.5 * without["ate_m"]["rmse"], "semantics more than halve the error")


def test_lockstep(runner):
    folders = [runner.run(name, "kitchen_walking", "--lockstep", "--segmenter", "stored", "--frames", "0:150")[0]
               for name in ("lockstep_1", "lockstep_2")]
    for file in ("trajectory.txt", "keyframes.txt"):
        expect((folders[0] / file).read_bytes() == (folders[1] / file).read_bytes(), f"{file} has the same bytes twice")


def test_threaded(runner):
    _, report = runner.run("threaded", "kitchen_walking", "--rate", "1", "--segmenter", "stored",
                           "--set", "semantic.stored.delay_ms=200")
    expect(report["tracked"] >= 0.99 * FRAMES, "99 % of the frames are tracked")
    expect(report["ate_m"]["rmse"] <= 1.5 * MAX_ATE_M, f"the error is at most {1.5 * MAX_ATE_M} m")


def test_turning(runner):
    """Depth that says what it is worth, and the rolling shutter, tell turning from moving (ORB-SLAM3: 0.0255 m)."""
    _, report = runner.run("turning", "fr1_rpy", "--lockstep", "--segmenter", "none")
    expect(report["tracked"] == report["frames"] == SEQUENCES["fr1_rpy"], "every frame is tracked")
    expect(report["ate_m"]["rmse"] <= 0.025, "the error is at most 0.025 m")


def test_desk(runner):
    _, report = runner.run("desk", "desk_walking", "--lockstep", "--segmenter", "stored")
    expect(report["tracked"] == report["frames"] == SEQUENCES["desk_walking"], "every frame is tracked")
    expect(report["ate_m"]["rmse"] <= 0.0115, "the error is at most 0.0115 m")


def test_kidnap(runner):
    """The camera is covered and carried off, to where it was and to where it was not; five pieces end as one world."""
    pieces = ["200:300", "black:30", "0:90", "110:60", "90:200", "299:220"]
    script = pathlib.Path(__file__).resolve().parent.parent / "scripts" / "rearrange_sequence.py"
    shutil.rmtree(runner.work / "kitchen_kidnap", ignore_errors=True)
    subprocess.run([sys.executable, script, runner.work / "kitchen_static", runner.work / "kitchen_kidnap", *pieces],
                   check=True)
    _, report = runner.run("kidnap", "kitchen_kidnap", "--lockstep", "--segmenter", "none")
    expect(len(report["worlds"]) == 1, "all pieces end in one world")
    expect(report["tracked"] >= report["frames"] - 30 - 45, "no more than a second's frames is lost beside the black ones")
    expect(report["ate_m"]["rmse"] <= MAX_ATE_M, f"the error is at most {MAX_ATE_M} m")
    expect(report["ate_m"]["max"] <= 0.35, "no pose is off by more than 0.35 m")


MAX_ATE_M = 0.06


def main():
    rds, work, test = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
    if not (SHARED / "bench" / "make_sequences.py").is_file():
        skip(f"the kitchen recordings are not there: {SHARED} (RDS_SHARED names their folder)")
    work.mkdir(parents=True, exist_ok=True)
    if test == "make":
        make(work)
    else:
        if not all((work / name).is_dir() for name in SEQUENCES):
            skip("the kitchen sequences could not be made")
        globals()[f"test_{test}"](Runner(rds, work))


if __name__ == "__main__":
    main()
