#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`rds evaluate` from end to end: a suite of short runs, interrupted and taken up again.

    evaluate_test.py RDS
"""
import csv
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

RDS = ""
SUITE = """
title: A room
repetitions: 2
sequences:
  - {name: people, path: sequence}
configurations:
  - {name: exact, segmenter: stored, lockstep: true}
  - {name: threaded, segmenter: stored, set: [semantic.stored.delay_ms=30]}
  - {name: broken, segmenter: stored, set: [orb.features=1]}
pictures: [20]
"""


class EvaluateTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="rds_evaluate_")
        self.root = pathlib.Path(self.folder.name)
        (self.root / "suite.yaml").write_text(SUITE, encoding="utf-8")
        made = self.rds("synth", "--out", self.root / "sequence", "--frames", 45, "--width", 320)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.out = self.root / "out"

    def tearDown(self):
        self.folder.cleanup()

    @staticmethod
    def rds(*words):
        return subprocess.run([RDS, *map(str, words)], capture_output=True, text=True, timeout=200, check=False)

    def evaluate(self, *words):
        return self.rds("evaluate", self.root / "suite.yaml", "--out", self.out, *words)

    def test_from_suite_to_report(self):
        process = subprocess.Popen([RDS, "evaluate", self.root / "suite.yaml", "--out", self.out],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(500):
            if (self.out / "runs" / "people" / "exact" / "1" / "done.txt").exists():
                break
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 128 + signal.SIGINT, said)
        self.assertIn("the same command goes on", said)
        kept = (self.out / "runs" / "people" / "exact" / "1" / "report.json").stat().st_mtime_ns

        ran = self.evaluate()
        self.assertEqual(ran.returncode, 1, "what is broken is said")
        self.assertIn("orb.features", ran.stderr)
        self.assertEqual(kept, (self.out / "runs" / "people" / "exact" / "1" / "report.json").stat().st_mtime_ns)
        with open(self.out / "errors.csv", encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["poses_of"] == "frames"]
        self.assertEqual([(row["method"], row["run"]) for row in rows],
                         [("exact", "1"), ("threaded", "1"), ("threaded", "2")])
        for row in rows:
            self.assertLess(float(row["ate_rmse_m"]), 0.02)
            self.assertEqual(row["poses"], "45")
        html = (self.out / "report.html").read_text(encoding="utf-8")
        self.assertIn("data:image/jpeg;base64,", html)
        self.assertGreaterEqual(html.count("<svg"), 3)  # the delay, two paths
        for title in ("Absolute trajectory error", "translation", "rotation", "Execution time", "Keyframes with a label",
                      "Semantic delay", "Features by state"):
            self.assertIn(title, html)
        self.assertRegex((self.out / "times.csv").read_text(encoding="utf-8"), r"threaded,.*,\d+\.\d,")
        again = self.evaluate()
        self.assertRegex(again.stdout, r"0 runs made, [1-9]\d* were there")
        report = self.evaluate("--report-only")
        self.assertEqual(report.returncode, 0, report.stderr)
        self.assertTrue(re.search(r"report: .*report\.html", report.stdout))


if __name__ == "__main__":
    RDS = sys.argv.pop(1)
    unittest.main(verbosity=2)
