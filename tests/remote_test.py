#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Segmentation on a server: `rds serve` and the kserve package give the masks that the network gives in process.

    remote_test.py RDS PYTHON_WITH_KSERVE serve|kserve

With a network that needs no weights, whose classes are colors, on a synthetic sequence; and, where $RDS_SHARED has weights and
photographs of people, with those. Exit code 77 says that it was skipped: without OpenVINO, or without the package.
"""
import os
import pathlib
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

RDS = ""
PYTHON = ""
SHARED = pathlib.Path(os.environ.get("RDS_SHARED", "/nonexistent"))
WEIGHTS = SHARED / "models" / "deeplabv3_mnv2_361x481.onnx"
STILLS = SHARED / "data" / "stills"
# An ONNX file whose network hands its three channels through a ReLU, at any height, width and batch. As scores of three
# classes they say which of the colors is the strongest.
COLORS = bytes.fromhex(
    "080812003A630A150A05696D616765120673636F726573220452656C7512"
    "01675A220A05696D61676512190A17080112130A0312016E0A0208030A03"
    "1201680A0312017762230A0673636F72657312190A17080112130A031201"
    "6E0A0208030A031201680A0312017742040A00100D")
COLORS_YAML = "input: {size: [96, 128], scale: [8, 8, 8]}\noutput: {labels: [2], threshold: 0.9}\n"  # what is very blue


def skip(reason):
    print(f"[  SKIPPED ] {reason}")
    sys.exit(77)


def rds(*words, timeout=300):
    return subprocess.run([RDS, *map(str, words)], capture_output=True, text=True, timeout=timeout, check=False)


class Server:
    """A program that serves until the end of the `with`."""

    def __init__(self, *words):
        self.words = [str(word) for word in words]

    def __enter__(self):
        self.process = subprocess.Popen(self.words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(20)
        self.process.stdout.close()


def address(server):
    """What `rds serve` printed."""
    return re.search(r"http://\S+", server.process.stdout.readline()).group(0)


def size(png):
    return struct.unpack(">II", png.read_bytes()[16:24])


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class RemoteTest(unittest.TestCase):
    published = False  # the network of which there are weights, instead of COLORS

    @classmethod
    def setUpClass(cls):
        if cls.published and not (WEIGHTS.is_file() and STILLS.is_dir()):
            raise unittest.SkipTest("RDS_SHARED does not name a folder with models/ and data/stills/")
        cls.folder = tempfile.TemporaryDirectory(prefix="rds_remote_")
        cls.root = pathlib.Path(cls.folder.name)
        cls.sequence = cls.root / "sequence"
        made = rds("synth", "--out", cls.sequence, "--frames", 60, *(() if cls.published else ("--movers", 0)))
        if made.returncode != 0:
            raise RuntimeError(made.stderr)
        cls.weights = WEIGHTS if cls.published else cls.root / "colors.onnx"
        cls.description = ()
        cls.pictures, cls.count = cls.sequence, 8
        if cls.published:
            cls.take_photographs()
        else:
            cls.weights.write_bytes(COLORS)
            description = cls.root / "colors.onnx.yaml"
            description.write_text(COLORS_YAML)
            cls.description = ("--set", f"semantic.remote.description={description}")
        cls.local = cls.masks("local", "openvino", "--model", cls.weights)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def take_photographs(cls):
        """Photographs of people as a sequence of their own, over synthetic depth."""
        cls.pictures = cls.root / "people"
        shutil.copytree(cls.sequence, cls.pictures)
        stills = sorted(path for path in STILLS.glob("*.png") if size(path) == (640, 480))
        names = sorted((cls.pictures / "rgb").iterdir())
        for still, name in zip(stills, names):
            name.unlink()
            shutil.copy(still, name)  # what a file is, its bytes tell
        cls.count = min(len(stills), len(names))

    @classmethod
    def masks(cls, name, segmenter, *words):
        out = cls.root / name
        ran = rds("segment", cls.pictures, "--camera", cls.pictures / "camera.yaml", "--frames", f":{cls.count}", "--out", out,
                  "--segmenter", segmenter, *words)
        if ran.returncode != 0:
            raise AssertionError(ran.stderr)
        return out

    @classmethod
    def serve(cls):
        return Server(RDS, "serve", "--model", cls.weights, "--port", 0)


class Serve(RemoteTest):
    def test_gives_the_same_masks(self):
        with self.serve() as server:
            remote = self.masks("remote", "remote", "--set", f"semantic.remote.url={address(server)}")
        names = sorted(path.name for path in (self.local / "mask").iterdir())
        self.assertGreater(len(names), 2)
        for name in names:
            self.assertEqual((self.local / "mask" / name).read_bytes(), (remote / "mask" / name).read_bytes(), name)
        self.assertGreater(max((self.local / "mask" / name).stat().st_size for name in names), 500)  # something in it

    def test_runs_are_the_same(self):
        with self.serve() as server:
            url = address(server)
            for name, words in (("in_process", ("openvino", "--model", self.weights)),
                                ("remote", ("remote", "--set", f"semantic.remote.url={url}"))):
                ran = rds("run", self.sequence, "--lockstep", "--out", self.root / name, "--segmenter", *words)
                self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertEqual((self.root / "in_process" / "trajectory.txt").read_bytes(),
                         (self.root / "remote" / "trajectory.txt").read_bytes())

    def test_a_run_outlives_its_server(self):
        with self.serve() as server:
            url = address(server)
            run = subprocess.Popen([RDS, "run", self.sequence, "--out", self.root / "alone", "--segmenter", "remote",
                                    "--set", f"semantic.remote.url={url}"], stderr=subprocess.PIPE, text=True,
                                   stdout=subprocess.DEVNULL)
            time.sleep(0.7)
        _, said = run.communicate(timeout=120)
        self.assertEqual(run.returncode, 0, said)
        self.assertGreater(len((self.root / "alone" / "trajectory.txt").read_text().splitlines()), 50)

    def test_is_ended_by_a_signal(self):
        with self.serve() as server:
            url = address(server)
            with urllib.request.urlopen(url.split("/v2/")[0] + "/v2/health/live") as answer:
                self.assertEqual(answer.status, 200)
            server.process.terminate()
            self.assertEqual(server.process.wait(10), 0)
        taken = rds("serve", "--model", self.weights, "--host", "300.1.1.1")
        self.assertEqual(taken.returncode, 1)
        self.assertIn("cannot be served", taken.stderr)


class ServePublished(Serve):
    published = True


class Kserve(RemoteTest):
    def test_gives_the_same_masks(self):
        import numpy  # pylint: disable=import-outside-toplevel
        from PIL import Image  # pylint: disable=import-outside-toplevel
        name = self.weights.stem
        port = free_port()
        url = f"http://127.0.0.1:{port}/v2/models/{name}"
        script = pathlib.Path(__file__).resolve().parent / "kserve_server.py"
        with Server(PYTHON, script, self.weights, name, port):
            for _ in range(300):
                try:
                    urllib.request.urlopen(url).close()
                    break
                except OSError:
                    time.sleep(0.2)
            remote = self.masks("kserve", "remote", "--set", f"semantic.remote.url={url}", *self.description)
        both = either = 0
        for path in sorted((self.local / "mask").iterdir()):
            ours, theirs = (numpy.asarray(Image.open(folder / "mask" / path.name)) for folder in (self.local, remote))
            both += numpy.count_nonzero((ours == 255) & (theirs == 255))
            either += numpy.count_nonzero((ours == 255) | (theirs == 255))
        self.assertGreater(either, 10000)
        # The runtimes compute in precisions of their own (bf16 here, floats there).
        self.assertGreater(both / either, 0.97)


class KservePublished(Kserve):
    published = True


if __name__ == "__main__":
    RDS, PYTHON, part = sys.argv[1:4]
    if "no OpenVINO runtime" in rds("serve", "--model", "/nonexistent.onnx").stderr:
        skip("this build has no OpenVINO runtime (scripts/install_openvino.sh)")
    if part == "kserve" and not pathlib.Path(PYTHON).is_file():
        skip("the Python package kserve is not there (scripts/install_dependencies.sh --tests)")
    if part == "kserve" and pathlib.Path(sys.executable) != pathlib.Path(PYTHON):
        os.execv(PYTHON, [PYTHON, *sys.argv])  # it has numpy and Pillow
    cases = (Serve, ServePublished) if part == "serve" else (Kserve, KservePublished)
    suite = unittest.TestSuite(map(unittest.defaultTestLoader.loadTestsFromTestCase, cases))
    sys.exit(not unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful())
