#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""No program or library of ours looks for libraries where anybody may lay one.

    run_path_test.py FILE_OR_FOLDER...

Each element of a run path must be absolute or begin with $ORIGIN, must not be writable for everybody, and is never
empty (which means the current folder). Then a program is started in a folder full of false libraries.
"""
import os
import pathlib
import re
import stat
import subprocess
import sys
import tempfile
import unittest

FILES = []


def is_elf(path):
    if path.is_symlink() or not path.is_file():
        return False
    with open(path, "rb") as file:
        return file.read(4) == b"\x7fELF"


def dynamic(path):
    result = subprocess.run(["readelf", "-d", path], capture_output=True, text=True, check=False)
    return result.stdout


def problem(element, origin):
    """What is wrong with an element of a run path, or None."""
    if element == "":
        return "an empty element: the current folder"
    place = element.replace("$ORIGIN", str(origin)).replace("${ORIGIN}", str(origin))
    if not place.startswith("/"):
        return f"'{element}' is relative"
    folder = pathlib.Path(place)
    while not folder.exists():
        folder = folder.parent
    if folder.stat().st_mode & stat.S_IWOTH:
        return f"'{element}': {folder} is writable for everybody"
    return None


class RunPathTest(unittest.TestCase):
    def test_elements(self):
        checked = 0
        for path in FILES:
            for line in re.findall(r"\((?:RUNPATH|RPATH)\).*\[(.*)\]", dynamic(path)):
                checked += 1
                for element in line.split(":"):
                    self.assertIsNone(problem(element, path.parent), f"{path}: {line}")
        print(f"{len(FILES)} files, {checked} run paths")
        self.assertGreater(len(FILES), 0)

    def test_finds_what_is_wrong(self):
        self.assertIsNotNone(problem("", "/usr/bin"))
        self.assertIsNotNone(problem("lib", "/usr/bin"))
        self.assertIsNotNone(problem("/tmp/nowhere", "/usr/bin"))
        self.assertIsNone(problem("$ORIGIN/../lib", "/usr/bin"))

    def test_false_libraries_in_the_current_folder(self):
        program = next((path for path in FILES if path.name == "rds"), None)
        if program is None:
            self.skipTest("no program among the files")
        needed = re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic(program))
        self.assertGreater(len(needed), 5)
        with tempfile.TemporaryDirectory() as folder:
            for library in [*needed, "libcurl.so.4", "libssl.so.3", "libz.so.1"]:
                pathlib.Path(folder, library).write_bytes(b"\x7fELF of somebody else")
            environment = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
            result = subprocess.run([program, "--version"], cwd=folder, capture_output=True, text=True, check=False,
                                    env=environment)
            self.assertEqual(result.returncode, 0, result.stderr)
            trace = subprocess.run([program, "--version"], cwd=folder, capture_output=True, text=True, check=False,
                                   env={**environment, "LD_DEBUG": "libs"}).stderr
            self.assertEqual(re.findall(r"trying file=((?!/)\S+)", trace), [])


def main():
    for argument in sys.argv[1:]:
        path = pathlib.Path(argument).resolve()
        FILES.extend(filter(is_elf, sorted(path.iterdir()) if path.is_dir() else [path]))
    result = unittest.TextTestRunner(verbosity=2).run(unittest.defaultTestLoader.loadTestsFromTestCase(RunPathTest))
    sys.exit(0 if result.wasSuccessful() else 1)


if __name__ == "__main__":
    main()
