#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks how the folders of src/ depend on each other, and what may be used where (see ARCHITECTURE.md).

Run it as it is; it names each file and line that breaks a rule. It also checks itself on sources that break each rule.
"""
import pathlib
import re
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent / "src"

# Lowest first: a folder includes only itself and those before it.
ORDER = ["base", "geometry", "optim", "feature", "segmentation", "map", "semantic", "propagation", "place", "tracking", "mapping",
         "loop", "runtime", "system", "io", "eval", "synth", "cli", "testing"]
ONLY = {"runtime": {"base", "runtime"}, "segmentation": {"base", "segmentation"}}  # what a folder may include, where that is less than the order allows
STRANGERS = {"tracking", "mapping", "loop"}  # never include each other
MAX_LINES = 400

# (start of an include, folders whose files may have it (.cc files only, but in cli/), where it belongs)
CONFINED = [
    (r"<opencv2/", {"feature", "place", "segmentation", "io", "synth", "cli", "testing"},
     "OpenCV: .cc files of feature/, place/ (P3P), segmentation/, io/, synth/"),
    (r"<openvino/", {"segmentation"}, "OpenVINO: its back end in segmentation/"),
    (r"<curl/", {"io", "segmentation"}, "libcurl: .cc files of io/ and segmentation/"),
    (r"<boost/", {"io"}, "Boost: .cc files of io/"),
    (r"<openssl/", {"base"}, "OpenSSL: .cc files of base/ (digests)"),
    (r"<CLI/", {"cli"}, "CLI11: cli/"),
    (r"<yaml-cpp/", {"base", "io", "segmentation", "cli"},
     "yaml-cpp: .cc files of base/ (the strict reader), io/, segmentation/, cli/"),
]
THREADS = re.compile(r"std::(?:recursive_|shared_|timed_)?mutex\b|std::j?thread\b|std::condition_variable|std::async\b|"
                     r"std::(?:lock_guard|unique_lock|scoped_lock|shared_lock)\b|sleep_for\b|sleep_until\b")
# Files outside runtime/ that may hold a thread, mutex or sleep, with the reason.
THREADS_ALLOWED = {
    "segmentation/stored_segmenter.cc": "stands in for a slow network: it waits",
    "segmentation/stored_segmenter.h": "stands in for a slow network: it waits",
    "segmentation/openvino_segmenter.cc": "a back end guards its own runtime",
    "segmentation/remote_segmenter.cc": "waits before it asks a server again",
    "synth/synthetic_sequence.cc": "renders frames on all cores",
    "cli/inference_service.cc": "one request at a time is segmented",
    "cli/inference_service.h": "one request at a time is segmented",
    "cli/playback.cc": "plays a recording at its recorded times",
}


def is_test(path):
    return path.name.endswith("_test.cc")


def strip_comment(line):
    return line.split("//", 1)[0]


def check_include(path, folder, target):
    """The rule that an include of src/'s own breaks, or None."""
    other = target.split("/", 1)[0]
    if other not in ORDER:
        return f"includes {target}, which is in no known folder"
    if other == "testing" and folder != "testing" and not is_test(path):
        return f"includes {target}: testing/ is for tests"
    if is_test(path) and other == "testing":
        return None
    if ORDER.index(other) > ORDER.index(folder):
        return f"includes {target}: {other}/ is above {folder}/"
    if folder in STRANGERS and other in STRANGERS and folder != other:
        return f"includes {target}: {folder}/ and {other}/ never include each other"
    if folder in ONLY and other not in ONLY[folder]:
        return f"includes {target}: {folder}/ includes only {', '.join(sorted(ONLY[folder]))}"
    return None


def check_line(path, relative, folder, line):
    """The rules that a line of code breaks."""
    own = re.match(r'\s*#\s*include\s*"([^"]+)"', line)
    if own:
        broken = check_include(path, folder, own.group(1))
        if broken:
            yield broken
    foreign = re.match(r"\s*#\s*include\s*(<[^>]+>)", line)
    if foreign:
        for pattern, folders, rule in CONFINED:
            if foreign.group(1).startswith(pattern) and (
                    folder not in folders or (path.suffix != ".cc" and folder != "cli")):
                yield f"includes {foreign.group(1)}. {rule}"
    if folder not in ("runtime", "testing") and not is_test(path) and relative not in THREADS_ALLOWED:
        found = THREADS.search(line)
        if found:
            yield f"uses {found.group(0)}: threads and mutexes live in runtime/"


def violations(source):
    """Every broken rule below the folder `source`, as 'file:line: what'."""
    result = []
    for path in sorted(p for p in source.rglob("*") if p.suffix in (".h", ".cc")):
        relative = path.relative_to(source).as_posix()
        folder = relative.split("/", 1)[0]
        if folder not in ORDER:
            result.append(f"src/{relative}:1: {folder}/ has no place in the order of folders")
            continue
        lines = path.read_text(encoding="utf-8").splitlines()
        if len(lines) > MAX_LINES:
            result.append(f"src/{relative}:{len(lines)}: {len(lines)} lines, at most {MAX_LINES}")
        if path.suffix == ".h" and "#pragma once" not in lines:
            result.append(f"src/{relative}:1: no #pragma once")
        for number, line in enumerate(lines, 1):
            result += [f"src/{relative}:{number}: {broken}"
                       for broken in check_line(path, relative, folder, strip_comment(line))]
    return result


class Repository(unittest.TestCase):
    def test_follows_the_rules(self):
        self.assertTrue(SOURCE.is_dir())
        found = violations(SOURCE)
        if found:
            self.fail("\n" + "\n".join(found))


class Checker(unittest.TestCase):
    def found_in(self, name, text):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True)
            path.write_text(text, encoding="utf-8")
            return violations(pathlib.Path(folder))

    def test_finds_each_violation(self):
        for name, text in [
            ("base/a.cc", '#include "map/map.h"\n'),
            ("tracking/a.cc", '#include "mapping/local_mapper.h"\n'),
            ("mapping/a.cc", '#include "tracking/tracker.h"\n'),
            ("runtime/a.cc", '#include "map/map.h"\n'),
            ("segmentation/a.cc", '#include "feature/orb.h"\n'),
            ("cli/a.cc", '#include "testing/matchers.h"\n'),
            ("system/a.cc", '#include "io/dataset.h"\n'),
            ("system/a.cc", '#include "synth/synthetic_world.h"\n'),
            ("base/a.cc", '#include "elsewhere/a.h"\n'),
            ("elsewhere/a.cc", "\n"),
            ("map/a.cc", "#include <opencv2/core.hpp>\n"),
            ("feature/a.h", "#pragma once\n#include <opencv2/core.hpp>\n"),
            ("tracking/a.cc", "#include <yaml-cpp/yaml.h>\n"),
            ("system/a.cc", "#include <openvino/openvino.hpp>\n"),
            ("map/a.cc", "std::mutex mutex;\n"),
            ("system/a.cc", "std::this_thread::sleep_for(1s);\n"),
            ("base/a.h", "int a;\n"),
            ("base/a.cc", "\n" * (MAX_LINES + 1)),
        ]:
            with self.subTest(name=name, text=text[:60]):
                self.assertEqual(len(self.found_in(name, text)), 1)

    def test_leaves_good_sources_alone(self):
        for name, text in [
            ("system/a.cc", '#include "runtime/worker.h"\n#include "tracking/tracker.h"\n#include "base/ids.h"\n'),
            ("map/map_test.cc", '#include "testing/matchers.h"\nstd::thread thread;\n'),
            ("cli/synth.cc", '#include "synth/synthetic_world.h"\n'),
            ("feature/a.cc", "#include <opencv2/core.hpp>\n"),
            ("runtime/a.h", "#pragma once\nstd::mutex mutex;\n"),
            ("map/a.cc", "// no std::mutex here\n"),
        ]:
            with self.subTest(name=name):
                self.assertEqual(self.found_in(name, text), [])


if __name__ == "__main__":
    unittest.main(verbosity=1)
