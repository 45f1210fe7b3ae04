#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Sums up the results of test.sh: a line for each suite, what failed, what was skipped and why, and the closing line.

Reads FOLDER/*.xml (JUnit files by ctest) and FOLDER/other.tsv (suite, name, result, reason). Exit code 1 if anything
failed or nothing passed.
"""
import collections
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

Result = collections.namedtuple("Result", "suite name outcome reason seconds")


def skip_reason(output):
    """What GoogleTest or a script printed beside its word that it skips."""
    lines = [line.strip() for line in output.splitlines()]
    for index, line in enumerate(lines):
        if re.search(r": Skipped$", line) and index + 1 < len(lines) and lines[index + 1]:
            return lines[index + 1]
        if line.startswith("[  SKIPPED ]") and not re.search(r"\(\d+ ms\)$|\d+ test", line) and " " in line[13:].strip():
            return line[13:]
    return "no reason given"


def read_junit(path):
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        status, failure, skipped = case.get("status"), case.find("failure"), case.find("skipped")
        if status == "fail" or failure is not None:
            outcome, reason = "failed", failure.get("message", "") if failure is not None else ""
        elif status == "disabled":
            outcome, reason = "skipped", "disabled"
        elif skipped is not None and "SKIP_" in skipped.get("message", ""):
            outcome, reason = "skipped", skip_reason(case.findtext("system-out") or "")
        elif status == "run":
            outcome, reason = "passed", ""
        else:
            outcome, reason = "failed", "could not be run"
        yield Result(path.stem, case.get("name"), outcome, reason, float(case.get("time") or 0))


def read_tsv(path):
    for line in path.read_text(encoding="utf-8").splitlines():
        suite, name, outcome, reason = line.split("\t")
        yield Result(suite, name, outcome, reason, 0)


def main():
    folder = pathlib.Path(sys.argv[1])
    results = [r for path in sorted(folder.glob("*.xml")) for r in read_junit(path)]
    results += read_tsv(folder / "other.tsv")

    print()
    for suite in dict.fromkeys(r.suite for r in results):
        count = collections.Counter(r.outcome for r in results if r.suite == suite)
        print(f"{suite}: " + ", ".join(f"{count[o]} {o}" for o in ("passed", "failed", "skipped") if count[o]))
    skipped = collections.defaultdict(list)
    for r in results:
        if r.outcome == "skipped":
            skipped[r.reason].append(f"{r.suite}: {r.name}")
    for reason, names in skipped.items():
        print(f"skipped, {reason}\n    " + "\n    ".join(names))
    for r in results:
        if r.outcome == "failed":
            print(f"FAILED {r.suite}: {r.name} {r.reason}".rstrip())
    slow = [r for r in sorted(results, key=lambda r: -r.seconds)[:5] if r.seconds >= 1]
    if slow:
        print("slowest: " + ", ".join(f"{r.name} ({r.suite}) {r.seconds:.1f} s" for r in slow))

    total = collections.Counter(r.outcome for r in results)
    print(f"{total['passed']} passed, {total['failed']} failed, {total['skipped']} skipped")
    return 1 if total["failed"] or not total["passed"] else 0


if __name__ == "__main__":
    sys.exit(main())
