#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures what is made of places that are seen again: kidnapped cameras, loops, second sessions.

    scripts/measure_places.py --out DIR [--kitchen FOLDER] [--seeds N] [STUDY...]

Makes sequences below DIR (`rds synth --scenario building`, scripts/rearrange_sequence.py), runs `rds run` on each, in
lockstep unless --threaded says how many runs there are of each, and writes DIR/runs.csv and DIR/summary.md. What is there
already is not run again. Beside what loops make of a trajectory stands what a true loop edge would
(scripts/closed_by_truth.py), and after cuts it is told since when the kitchen shows what was seen before
(scripts/known_places.py): both with numpy, scipy and Pillow only. Sequences (0.5 GB each of the building) are removed
once all studies of their seed have run, unless --keep. A run is wrong if a pose of its largest world is off by more than 0.35 m.

Studies of the kitchen (--kitchen: folder with kitchen_static, kitchen_walking, kitchen_crowd):
  kidnap_nobody, kidnap_walking, kidnap_crowd      frames 0 to 400, the lens covered for two seconds, 700 to 1000, 0 to 200
  pieces_nobody, pieces_walking, pieces_crowd      five pieces in random order; the seed is that of the order
of the building, whose rooms, pictures and noise are the seed's:
  ring          once round and on where it began; with and without loops
  ring_walking  the same with four people, exact masks 200 ms late
  drift_005, drift_02   the same with depth off by 0.5 and 2 % (standard deviation) from frame to frame
  alike         all rooms and doors look the same
  back          a second session the other way round
  redecorated   a second session with other pictures and furniture
  covered       the lens is covered for one and a half and for four seconds
"""
import argparse
import concurrent.futures
import csv
import json
import pathlib
import random
import shutil
import statistics
import subprocess
import sys

try:
    from closed_by_truth import closed_by_truth
    from known_places import KnownPlaces
except ImportError:
    closed_by_truth = KnownPlaces = None

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROUND = 2322  # frames once round the building
OVERLAP = 380  # and on
WRONG_M = 0.35
MASKS = ["--segmenter", "stored", "--set", "semantic.stored.delay_ms=200"]
KITCHEN = {"nobody": "kitchen_static", "walking": "kitchen_walking", "crowd": "kitchen_crowd"}
STUDIES = [f"{kind}_{who}" for kind in ("kidnap", "pieces") for who in KITCHEN] + [
    "ring", "ring_walking", "drift_005", "drift_02", "alike", "back", "redecorated", "covered"]
ALONE = {"ring": [], "ring_walking": [], "drift_005": ["--depth-error", "0.005"], "drift_02": ["--depth-error", "0.02"],
         "alike": ["--alike"]}  # with the options of `rds synth`
SECOND_SESSIONS = {"back": ["--path", "ring_back"], "redecorated": ["--decor", "1"]}
COMPARED = {"ring", "ring_walking", "drift_005", "drift_02"}  # with runs without loops


class Sequences:
    """Those of a seed, each made where it is asked for first."""

    def __init__(self, arguments, seed):
        self.arguments = arguments
        self.seed = seed
        self.folder = arguments.out / "sequences" / str(seed)

    def building(self, name, *options, people=False):
        folder = self.folder / name
        if not (folder / "groundtruth.txt").exists():
            run([self.arguments.rds, "synth", "--out", folder, "--scenario", "building", "--width",
                 str(self.arguments.width), "--seed", str(self.seed), "--movers", "4" if people else "0",
                 "--frames", str(ROUND + OVERLAP), *options])
        return folder

    def rearranged(self, name, source, pieces):
        folder = self.folder / name
        if not (folder / "pieces.txt").exists():
            run([sys.executable, ROOT / "scripts" / "rearrange_sequence.py", source, folder, *pieces])
            camera = source / "camera.yaml"
            if camera.exists():
                (folder / "camera.yaml").write_text(camera.read_text())
        return folder

    def pieces(self, study):
        """Those that a study's sequence is put together from; none if it is used as it was made."""
        kind = study.partition("_")[0]
        if kind == "kidnap":
            return ["0:400", "black:60", "700:1000", "0:200"]
        if kind == "pieces":
            order = list(range(5))
            random.Random(self.seed).shuffle(order)
            return [f"{200 * i}:{200 * i + 200}" for i in order]
        if kind == "covered":
            return ["0:500", "black:45", "530:1300", "black:120", f"1400:{ROUND + OVERLAP}"]
        if kind in SECOND_SESSIONS:
            return [f"0:{ROUND}", "black:15", f"{self.folder / kind}@0:{ROUND}"]
        return []

    def make(self, study):
        """The folder of a study's sequence."""
        kind, _, who = study.partition("_")
        if kind in ("kidnap", "pieces"):
            if self.arguments.kitchen is None:
                sys.exit(f"{study}: wants --kitchen FOLDER")
            return self.rearranged(study, self.arguments.kitchen / KITCHEN[who], self.pieces(study))
        if study in ALONE:
            return self.building(study, *ALONE[study], people=study == "ring_walking")
        if study in SECOND_SESSIONS:
            self.building(study, *SECOND_SESSIONS[study])
        return self.rearranged(f"{study}_joined", self.building("ring"), self.pieces(study))

    def remove(self):
        shutil.rmtree(self.folder, ignore_errors=True)


def run(command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode not in (0, 3):  # 3: nothing was tracked
        sys.exit(f"{' '.join(str(word) for word in command)}: exit code {done.returncode}\n{done.stderr[-2000:]}")


def cuts(pieces):
    """First frames that show something after a jump."""
    found, at, before = [], 0, None
    for piece in pieces:
        folder, _, span = piece.rpartition("@")
        first, _, last = span.partition(":")
        if first == "black":
            at += int(last)
            before = None
            continue
        if at > 0 and (folder, first) != before:
            found.append(at)
        at += abs(int(last) - int(first))
        before = folder, last
    return found


def lost_after(folder, jumps):
    """Frames on end without a pose from each jump on."""
    with (folder / "frames.csv").open() as file:
        states = [row["state"] for row in csv.DictReader(file)]
    counts = []
    for jump in jumps:
        count = 0
        while jump + count < len(states) and states[jump + count] != "tracked":
            count += 1
        counts.append(count)
    return counts


def lost_though_known(sequence, jumps, lost):
    """Of these the frames from the first that shows a known place, where more than three were lost; - where none did."""
    places, counts = KnownPlaces(sequence), []
    for jump, count in zip(jumps, lost):
        since = places.since(jump, jump + count) if count > 3 else jump
        counts.append("-" if since is None else str(jump + count - since))
    return " ".join(counts)


def kept(path, compute):
    """What is computed once."""
    if not path.exists():
        path.write_text(f"{compute()}\n")
    return path.read_text().strip()


def measure(arguments, sequences, study, repetition, loops):
    seed = sequences.seed
    name = f"{seed}" + ("" if loops else "-noloops") + (f"-{repetition}" if arguments.threaded else "")
    folder = arguments.out / "runs" / study / name
    if not (folder / "report.json").exists():
        sequence = sequences.make(study)
        camera = sequence / "camera.yaml"
        people = study.endswith(("walking", "crowd"))
        command = [arguments.rds, "run", sequence, "--out", folder, "--camera", camera if camera.exists() else "redkitchen"]
        command += (arguments.options.split() or MASKS) if people else ["--segmenter", "none"]
        command += [] if arguments.threaded else ["--lockstep"]
        command += [] if loops else ["--set", "loop.enabled=false"]
        run(command)
    report = json.loads((folder / "report.json").read_text())
    accuracy = report["ate_m"] or {}
    jumps = cuts(sequences.pieces(study))
    lost = lost_after(folder, jumps)
    row = {"study": study, "seed": seed, "run": repetition, "loop lane": int(loops), "frames": report["frames"],
           "tracked": report["tracked"], "found": report["found"], "coverage": round(report["coverage"], 4),
           "worlds": len(report["worlds"]), "loops": report["loops"], "relocalizations": report["relocalizations"],
           "merges": report["merges"], "ate_m": accuracy.get("rmse"), "max_m": accuracy.get("max"),
           "lost_after_cuts": " ".join(str(count) for count in lost), "closed_by_truth_m": None, "lost_though_known": ""}
    if closed_by_truth is not None and not loops:
        row["closed_by_truth_m"] = float(kept(folder / "closed_by_truth.txt", lambda: closed_by_truth(
            sequences.make(study) / "groundtruth.txt", folder / "trajectory.txt", ROUND)[1]))
    if KnownPlaces is not None and study.startswith(("kidnap", "pieces")):
        row["lost_though_known"] = kept(folder / "lost_though_known.txt", lambda: lost_though_known(
            sequences.make(study), jumps, lost))
    return row


def spread(values, form="{:.4f}"):
    values = [value for value in values if value is not None]
    if not values:
        return "-"
    return f"{form} ({form} to {form})".format(statistics.median(values), min(values), max(values))


def summarize(rows):
    lines = ["| study | runs | worlds 1 | coverage | lost after cuts: to 3 frames, more | once a known "
             "place is seen: to 3 frames, more | loops, merges, relocalizations | "
             "ATE, m | without loops | closed by truth | with over without, closed by truth over without | "
             "largest error, m | wrong |", "|---" * 13 + "|"]
    for study in dict.fromkeys(row["study"] for row in rows):
        mine = [row for row in rows if row["study"] == study and row["loop lane"]]
        other = [row for row in rows if row["study"] == study and not row["loop lane"]]
        without = {(row["seed"], row["run"]): row["ate_m"] for row in other}
        ratios = [row["ate_m"] / without[row["seed"], row["run"]] for row in mine if (row["seed"], row["run"]) in without]
        bounds = [row["closed_by_truth_m"] / row["ate_m"] for row in other if row["closed_by_truth_m"]]
        lost = [int(count) for row in mine for count in row["lost_after_cuts"].split()]
        known = [int(count) for row in mine for count in row["lost_though_known"].split() if count != "-"]
        events = ", ".join(str(sum(row[kind] for row in mine)) for kind in ("loops", "merges", "relocalizations"))
        lines.append(f"| {study} | {len(mine)} | {sum(row['worlds'] == 1 for row in mine)} | "
                     f"{spread([row['coverage'] for row in mine], '{:.3f}')} | "
                     f"{sum(count <= 3 for count in lost)}, {sum(count > 3 for count in lost)} | "
                     f"{sum(count <= 3 for count in known)}, {sum(count > 3 for count in known)} | {events} | "
                     f"{spread([row['ate_m'] for row in mine])} | "
                     f"{spread([row['ate_m'] for row in other])} | {spread([row['closed_by_truth_m'] for row in other])} | "
                     f"{spread(ratios, '{:.2f}')}, {spread(bounds, '{:.2f}')} | "
                     f"{spread([row['max_m'] for row in mine], '{:.3f}')} | "
                     f"{sum((row['max_m'] or 0) > WRONG_M for row in mine)} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("studies", nargs="*", metavar="STUDY", help=f"default: all; {', '.join(STUDIES)}")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--kitchen", type=pathlib.Path)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--rds", type=pathlib.Path, default=ROOT / "build" / "release" / "rds")
    parser.add_argument("--threaded", type=int, default=0, metavar="RUNS", help="at the recorded rate, so many of each")
    parser.add_argument("--options", default="", help=f"of `rds run` where there are people; default: {' '.join(MASKS)}")
    parser.add_argument("--width", type=int, default=320, help="of the building's images")
    parser.add_argument("--keep", action="store_true", help="the sequences")
    parser.add_argument("--jobs", type=int, default=1, help="runs at once, in lockstep only")
    arguments = parser.parse_args()
    studies = arguments.studies or [study for study in STUDIES if arguments.kitchen or study.partition("_")[0] not in
                                    ("kidnap", "pieces")]
    if unknown := set(studies) - set(STUDIES):
        sys.exit(f"unknown: {', '.join(sorted(unknown))}; there are {', '.join(STUDIES)}")
    rows = []

    def of_seed(seed):  # studies share sequences
        sequences = Sequences(arguments, seed)
        for study in studies:
            if study.startswith("kidnap") and seed > 1:
                continue
            for loops in (True, False) if study in COMPARED else (True,):
                for repetition in range(1, max(1, arguments.threaded) + 1):
                    rows.append(measure(arguments, sequences, study, repetition, loops))
                    print(f"\r{len(rows)} runs: {study}, {seed}    ", end="", file=sys.stderr, flush=True)
        if not arguments.keep:
            sequences.remove()

    with concurrent.futures.ThreadPoolExecutor(1 if arguments.threaded else arguments.jobs) as executor:
        list(executor.map(of_seed, range(1, arguments.seeds + 1)))
    print(file=sys.stderr)
    rows.sort(key=lambda row: (studies.index(row["study"]), row["seed"], -row["loop lane"], row["run"]))
    with (arguments.out / "runs.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    (arguments.out / "summary.md").write_text(summarize(rows))
    print(summarize(rows), end="")


if __name__ == "__main__":
    main()
