#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of scripts/summarize_tests.py on made-up results."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parent.parent / "scripts" / "summarize_tests.py"
PASSED = '<testcase name="a.Passes" time="0.1" status="run"><system-out>fine</system-out></testcase>'
FAILED = '<testcase name="a.Fails" time="0.1" status="fail"><failure message="Failed"/><system-out/></testcase>'
SKIPPED = ('<testcase name="a.Skips" time="0.1" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>'
           "<system-out>[ RUN      ] A.Skips\nsrc/a_test.cc:11: Skipped\nno sequence at /data\n\n"
           "[  SKIPPED ] A.Skips (0 ms)</system-out></testcase>")
NOT_RUN = '<testcase name="a.Missing" time="0" status="notrun"><system-out>Unable to find executable</system-out></testcase>'


class Summary(unittest.TestCase):
    def summarize(self, cases, other=""):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "dev.xml").write_text(f"<testsuite>{''.join(cases)}</testsuite>", encoding="utf-8")
            pathlib.Path(folder, "other.tsv").write_text(other, encoding="utf-8")
            done = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True, check=False)
            return done.returncode, done.stdout

    def test_counts(self):
        status, output = self.summarize([PASSED, PASSED, SKIPPED], "format\tformatting\tpassed\t\n")
        self.assertEqual(status, 0)
        self.assertEqual(output.splitlines()[-1], "3 passed, 0 failed, 1 skipped")

    def test_names_failures(self):
        status, output = self.summarize([PASSED, FAILED])
        self.assertEqual(status, 1)
        self.assertIn("FAILED dev: a.Fails", output)
        self.assertEqual(output.splitlines()[-1], "1 passed, 1 failed, 0 skipped")

    def test_gives_the_reason_of_a_skip(self):
        self.assertIn("no sequence at /data", self.summarize([PASSED, SKIPPED])[1])

    def test_a_test_that_cannot_run_has_failed(self):
        self.assertEqual(self.summarize([PASSED, NOT_RUN])[0], 1)

    def test_a_build_that_fails_counts(self):
        self.assertEqual(self.summarize([PASSED], "tsan\tbuild\tfailed\t\n")[0], 1)

    def test_no_test_at_all_is_a_failure(self):
        self.assertEqual(self.summarize([])[0], 1)


if __name__ == "__main__":
    unittest.main()
