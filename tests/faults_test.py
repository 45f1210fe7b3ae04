#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the program on bad input, in bad places, and ends it by signals: clear errors, and nothing half written.

    faults_test.py RDS input|signals|disk

`disk` mounts small and read-only file systems in a namespace of its own; where that is not allowed it is skipped (exit
code 77).
"""
import functools
import http.server
import json
import os
import pathlib
import resource
import shlex
import shutil
import signal
import ssl
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import zlib

RDS = ""
FRAMES = 45
WIDTH, HEIGHT = 320, 240
DISK = "RDS_FAULTS_INSIDE"  # set in the namespace where mounting is allowed


def png(width, height, bits, channels, value):
    """A PNG of one value everywhere."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    row = b"\0" + value.to_bytes(bits // 8, "big") * channels * width
    header = struct.pack(">IIBBBBB", width, height, bits, 2 if channels == 3 else 0, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(row * height))
            + chunk(b"IEND", b""))


def command(*words):
    return [str(word) for word in (RDS, *words)]


def rds(*words, timeout=120):
    environment = {**os.environ, "RDS_CACHE": "/nowhere", "RDS_WEIGHTS": ""}
    return subprocess.run(command(*words), capture_output=True, text=True, timeout=timeout, check=False,
                          env=environment)


def poses(file):
    """The rows of a trajectory; raises ValueError if one is not whole."""
    rows = [[float(word) for word in line.split()] for line in file.read_text(encoding="utf-8").splitlines()
            if not line.startswith("#")]
    if any(len(row) != 8 for row in rows) or any(a[0] >= b[0] for a, b in zip(rows, rows[1:])):
        raise ValueError(f"{file}: not a trajectory")
    return rows


class FaultsTest(unittest.TestCase):
    """A short sequence, made once, and for each test a folder of its own."""

    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory(prefix="rds_faults_")
        cls.sequence = pathlib.Path(cls.shared.name) / "sequence"
        made = rds("synth", "--out", cls.sequence, "--frames", FRAMES, "--width", WIDTH)
        if made.returncode != 0:
            raise RuntimeError(made.stderr)

    @classmethod
    def tearDownClass(cls):
        cls.shared.cleanup()

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=self.shared.name))
        self.out = self.folder / "out"

    def copy(self):
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.folder)) / "copy"
        shutil.copytree(self.sequence, folder)
        (folder / "associations.txt").unlink()  # so that rgb.txt and depth.txt count
        return folder

    def run_words(self, sequence, *more):
        segmenter = () if "--segmenter" in more else ("--segmenter", "none")
        return ["run", sequence, "--out", self.out, "--rate", "0", *segmenter, *more]

    def refused(self, words, *expected):
        """Runs the program: exit code 1, one line of error with all of `expected`, no result."""
        result = rds(*words)
        self.assertEqual(result.returncode, 1, result.stderr)
        errors = [line for line in result.stderr.splitlines() if line.startswith("rds: error: ")]
        self.assertEqual(len(errors), 1, result.stderr)
        for text in expected:
            self.assertIn(str(text), errors[0])
        self.assertEqual(self.results(), [])
        return errors[0]

    def results(self):
        """All files in the output folder, hidden ones too."""
        return sorted(path.name for path in self.out.iterdir()) if self.out.is_dir() else []


class InputTest(FaultsTest):
    def nth(self, sequence, kind, number):
        return sorted((sequence / kind).iterdir())[number]

    def test_sequence_folder(self):
        self.refused(self.run_words("/nowhere"), "/nowhere", "no such sequence folder")
        self.refused(self.run_words(self.sequence / "rgb.txt"), "rgb.txt", "not a sequence folder")
        self.refused(self.run_words(self.folder), self.folder, "no rgb.txt in it")

    def test_lists(self):
        sequence = self.copy()
        lines = (sequence / "rgb.txt").read_text(encoding="utf-8").splitlines()
        for rows, expected in (
                ([], ("rgb.txt", "no images are listed")),
                ([*lines[:5], lines[7], lines[6]], ("rgb.txt:7", "does not come after")),
                ([*lines[:5], lines[5].replace("rgb/", "rbg/")], ("rgb.txt:6", "rbg/", "not there")),
                ([*lines[:5], "noon rgb/a.png"], ("rgb.txt:6", "timestamp is 'noon'"))):
            (sequence / "rgb.txt").write_text("\n".join(rows), encoding="utf-8")
            self.refused(self.run_words(sequence), *expected)

    def test_ground_truth(self):
        sequence = self.copy()
        lines = (sequence / "groundtruth.txt").read_text(encoding="utf-8").splitlines()
        lines[3] = " ".join([*lines[3].split()[:2], "nan", *lines[3].split()[3:]])
        (sequence / "groundtruth.txt").write_text("\n".join(lines), encoding="utf-8")
        result = rds(*self.run_words(sequence))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("groundtruth.txt:4", result.stderr)
        self.assertIn("ATE", result.stdout)
        (sequence / "groundtruth.txt").write_text("a b c\n", encoding="utf-8")
        (sequence / "mask.txt").write_text("0 mask/none.png\n", encoding="utf-8")
        result = rds(*self.run_words(sequence))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, "groundtruth.txt:1: .*going on without ground truth")
        self.assertRegex(result.stderr, "mask.txt:1: .*going on without masks")

    def test_images(self):
        for kind, change, expected in (
                ("rgb", lambda image: image[:len(image) // 2], "truncated"),
                ("depth", lambda image: image[:-20], "truncated"),
                ("rgb", lambda image: b"", "empty"),
                ("depth", lambda image: png(160, 120, 16, 1, 5000), "160 x 120 pixels, its color image"),
                ("depth", lambda image: png(WIDTH, HEIGHT, 8, 1, 100), "a depth image of 8 bits"),
                ("rgb", lambda image: png(WIDTH, HEIGHT, 16, 3, 100), "a color image of 16 bits")):
            sequence = self.copy()
            broken = self.nth(sequence, kind, 20)
            broken.write_bytes(change(broken.read_bytes()))
            self.refused(self.run_words(sequence, "--strict", "--video", self.out / "run.mp4"), f"{kind}/{broken.name}",
                         expected)
            result = rds(*self.run_words(sequence))
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(f"frame 20 is left out: {broken.parent}/{broken.name}", result.stderr)
            self.assertEqual(len(poses(self.out / "trajectory.txt")), FRAMES - 1)
            self.assertEqual(json.loads((self.out / "report.json").read_text(encoding="utf-8"))["left_out"], 1)
            shutil.rmtree(self.out)

    def test_cameras(self):
        camera = self.folder / "camera.yaml"
        for text, expected in (("width: [", "camera.yaml"), ("width: 640\nfx: far\n", "height"),
                               ("wdith: 640\n", "camera.yaml:1: unknown key 'wdith' (did you mean 'width'?)")):
            camera.write_text(text, encoding="utf-8")
            self.refused(self.run_words(self.sequence, "--camera", camera), camera, expected)
        self.refused(self.run_words(self.sequence, "--camera", "/nowhere.yaml"), "/nowhere.yaml", "tum_fr1")
        self.refused(self.run_words(self.sequence, "--camera", self.folder), self.folder, "cannot be read")
        self.refused(self.run_words(self.sequence, "--camera", "tum_fr1"), "640 x 480", "--camera")

    def test_options(self):
        self.refused(self.run_words(self.sequence, "--set", "orb.featurs=900"), "orb.featurs", "'orb.features'")
        self.refused(self.run_words(self.sequence, "--set", "orb.features=-1"), "orb.features", "-1")
        self.refused(self.run_words(self.sequence, "--set", "orb.features=many"), "orb.features", "many")
        options = self.folder / "options.yaml"
        options.write_text("orb:\n  features: 1000\n  levels: 1000\n", encoding="utf-8")
        self.refused(self.run_words(self.sequence, "--config", options), "options.yaml:3", "orb.levels", "1000")
        self.refused(self.run_words(self.sequence, "--vidoe", "a.mp4"), "--vidoe", "did you mean '--video'?",
                     "rds run --help")
        self.refused(["rnu", self.sequence], "rnu", "did you mean 'run'?", "rds --help")
        self.refused(self.run_words(self.sequence, "--frames", "9:5"), "9:5")

    def test_places(self):
        file = self.folder / "file"
        file.write_text("mine", encoding="utf-8")
        for place in (file, file / "below", "/proc", "/proc/nowhere"):
            self.refused(["run", self.sequence, "--out", place, "--segmenter", "none"], place, "output folder cannot")
            self.refused(["synth", "--out", place, "--frames", "3"], place, "output folder cannot")
        self.assertEqual(file.read_text(encoding="utf-8"), "mine")
        self.out.mkdir()
        self.refused(self.run_words(self.sequence, "--video", "/nowhere/run.mp4"), "/nowhere/run.mp4")
        (self.folder / "folder.mp4").mkdir()
        self.refused(self.run_words(self.sequence, "--video", self.folder / "folder.mp4"), "Is a directory")

    def test_segmenters(self):
        words = ["run", self.sequence, "--out", self.out]
        error = self.refused(words, "openvino", "--segmenter none", "stored")
        self.assertTrue("rds fetch weights" in error or "scripts/install_openvino.sh" in error, error)
        self.refused([*words, "--segmenter", "storred"], "storred", "did you mean 'stored'?")
        sequence = self.copy()
        (sequence / "mask.txt").unlink()
        self.refused(["run", sequence, "--out", self.out, "--segmenter", "stored"], "mask.txt")

    def finishes(self, kind, frames, image, *more, code=0):
        """Runs with some images replaced: to its end, with all results. Returns the report and what was said."""
        sequence = self.copy()
        for file in sorted((sequence / kind).iterdir())[frames]:
            file.write_bytes(image)
        result = rds(*self.run_words(sequence, *more))
        self.assertEqual(result.returncode, code, result.stderr)
        poses(self.out / "trajectory.txt")
        return json.loads((self.out / "report.json").read_text(encoding="utf-8")), result.stdout

    def test_a_second_of_black_frames(self):
        report, _ = self.finishes("rgb", slice(10, 40), png(WIDTH, HEIGHT, 8, 3, 0))
        self.assertEqual(report["frames"], FRAMES)
        self.assertGreaterEqual(report["lost"], 30)
        self.assertGreaterEqual(report["tracked"], 10)

    def test_without_depth(self):
        report, said = self.finishes("depth", slice(None), png(WIDTH, HEIGHT, 16, 1, 0), code=3)
        self.assertEqual((report["frames"], report["tracked"]), (FRAMES, 0))
        self.assertIn("never started", said)

    def test_depth_beyond_range(self):
        report, _ = self.finishes("depth", slice(None), png(WIDTH, HEIGHT, 16, 1, 65535), code=3)  # none, for some
        self.assertEqual(report["frames"], FRAMES)
        shutil.rmtree(self.out)
        sequence = self.copy()
        for file in (sequence / "depth").iterdir():
            file.write_bytes(png(WIDTH, HEIGHT, 16, 1, 60000))  # 12 m everywhere
        self.refused(self.run_words(sequence), "beyond 12 m with depth_scale 5000", "unusual: true")

    def test_masks(self):
        """Masks that are of no use are no labels, and do no harm."""
        stored = ("--segmenter", "stored", "--set", "semantic.stored.delay_ms=0")
        for image in (png(WIDTH // 2, HEIGHT // 2, 8, 1, 0), png(WIDTH, HEIGHT, 8, 1, 255), b"rubbish", b""):
            report, said = self.finishes("mask", slice(None), image, *stored)
            self.assertEqual(report["tracked"], FRAMES)
            self.assertEqual(report["semantics"]["keyframes_labeled"], 0)
            self.assertRegex(said, "[1-9][0-9]* failures")

    def test_masks_that_come_too_late(self):
        begin = time.monotonic()
        report, _ = self.finishes("mask", slice(0), b"", "--segmenter", "stored", "--set",
                                  "semantic.stored.delay_ms=10000", "--set", "semantic.finish_timeout_s=0.5")
        self.assertLess(time.monotonic() - begin, 10)
        self.assertEqual(report["tracked"], FRAMES)
        self.assertEqual(report["semantics"]["keyframes_labeled"], 0)

    def test_what_has_no_end(self):
        """Pipes and devices where files should be are refused, and not waited for."""
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        for place in (pipe, "/dev/zero"):
            for words in (["eval", place, self.sequence], self.run_words(self.sequence, "--camera", place),
                          self.run_words(self.sequence, "--config", place)):
                self.refused(words, place)
        sequence = self.copy()
        (sequence / "groundtruth.txt").unlink()
        os.mkfifo(sequence / "groundtruth.txt")  # not needed, and no file
        self.assertEqual(rds(*self.run_words(sequence)).returncode, 0)
        shutil.rmtree(self.out)
        self.refused(["eval", self.sequence / "groundtruth.txt", self.sequence, "--plot", pipe], pipe,
                     "cannot be written")

    def test_absurd_trajectories(self):
        estimate = self.folder / "estimate.txt"
        rows = (self.sequence / "groundtruth.txt").read_text(encoding="utf-8").splitlines()
        for value in ("1e160", "-1e10"):
            words = rows[5].split()
            words[2] = value
            estimate.write_text("\n".join([*rows[:5], " ".join(words), *rows[6:]]), encoding="utf-8")
            for more in ([], ["--plot", self.folder / "plot.svg"]):
                self.refused(["eval", estimate, self.sequence, *more], "estimate.txt:6", "farther away than the moon")
        self.assertFalse((self.folder / "plot.svg").exists())

    def test_closed_streams(self):
        """Nothing that is printed gets into a file of ours; a closed or full standard error ends no work."""
        video = self.out / "run.mp4"
        whole = rds(*self.run_words(self.sequence, "--video", video))
        self.assertEqual(whole.returncode, 0, whole.stderr)
        for redirection in ("2>&-", ">&- 2>&-", "<&- >&- 2>&-", "2>/dev/full"):
            shutil.rmtree(self.out, ignore_errors=True)
            line = shlex.join(command(*self.run_words(self.sequence, "--video", video))) + " " + redirection
            self.assertEqual(subprocess.run(["bash", "-c", line], check=False, timeout=120, capture_output=True).returncode, 0)
            self.assertFalse(b"keyframes  " in video.read_bytes(), "the progress display got into the video")
            self.assertEqual(len(poses(self.out / "trajectory.txt")), FRAMES)
            made = self.folder / "made"
            line = shlex.join(command("synth", "--out", made, "--frames", 3, "--width", 160)) + " " + redirection
            self.assertEqual(subprocess.run(["bash", "-c", line], check=False, timeout=120, capture_output=True).returncode, 0)
            self.assertTrue((made / "rgb.txt").is_file())

    def test_without_threads_or_memory(self):
        """Where the system gives no more, that is an error, not a hang, a crash or a bug."""
        def limited(resource_name, value, user):
            def limit():
                if user:
                    os.setgid(user)
                    os.setuid(user)
                resource.setrlimit(resource_name, (value, value))
            return limit
        user = 54321 if os.geteuid() == 0 else 0  # nobody has its processes, so they can be counted
        place = pathlib.Path(tempfile.mkdtemp(dir="/tmp"))
        self.addCleanup(shutil.rmtree, place, ignore_errors=True)
        shutil.copytree(self.sequence, place / "sequence")
        os.chmod(place, 0o777)
        shutil.copy2(RDS, place / "rds")  # with what it needs, to where that user may read
        libraries = pathlib.Path("lib", "rds", "openvino", "libs")
        if (pathlib.Path(RDS).parent / libraries).is_dir():
            shutil.copytree(pathlib.Path(RDS).parent / libraries, place / libraries)
        seen = set()
        for threads in (range(1, 7) if user else (1,)):
            words = [place / "rds", "run", place / "sequence", "--out", place / f"out{threads}", "--rate", "0",
                     "--segmenter", "stored", "--set", "semantic.stored.delay_ms=0"]
            result = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False, cwd=place,
                                    preexec_fn=limited(resource.RLIMIT_NPROC, threads, user))
            self.assertIn(result.returncode, (0, 1), result.stderr)
            if result.returncode == 1:
                self.assertIn("no thread can be started", result.stderr)
            seen.add(result.returncode)
        self.assertIn(1, seen)
        for megabytes in (400, 500, 600, 700, 800, 1000):
            result = subprocess.run(command(*self.run_words(self.sequence)), capture_output=True, text=True, timeout=120,
                                    check=False, preexec_fn=limited(resource.RLIMIT_AS, megabytes << 20, 0))
            self.assertIn(result.returncode, (0, 1, 127), result.stderr)
            self.assertNotIn("bug", result.stderr)

    def test_links_of_others(self):
        """Results go through no link that another user laid."""
        if os.geteuid() != 0:
            self.skipTest("only root can make a link of another user")
        target = self.folder / "target"
        target.write_text("mine", encoding="utf-8")
        link = self.folder / "link"
        link.symlink_to(target)
        words = ["eval", self.sequence / "groundtruth.txt", self.sequence, "--plot", link]
        os.lchown(link, 54321, 54321)
        self.refused(words, "a link that another user made")
        self.assertEqual(target.read_text(encoding="utf-8"), "mine")
        folder = self.folder / "folder"
        folder.symlink_to(self.folder)
        os.lchown(folder, 54321, 54321)
        self.refused(["run", self.sequence, "--out", folder / "out", "--segmenter", "none"], "another user made")
        os.lchown(link, 0, 0)
        self.assertEqual(rds(*words).returncode, 0)
        self.assertIn("<svg", target.read_text(encoding="utf-8"))

    def test_certificates(self):
        """SSL_CERT_FILE names who is trusted, as for other programs."""
        if shutil.which("openssl") is None:
            self.skipTest("openssl makes the certificate of the test, and is not there")
        certificate, key = self.folder / "certificate.pem", self.folder / "key.pem"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-keyout", key, "-out", certificate,
                        "-days", "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost"], check=True,
                       capture_output=True)
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(certificate, key)
        handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=self.folder)
        with http.server.ThreadingHTTPServer(("localhost", 0), handler) as server:
            server.socket = context.wrap_socket(server.socket, server_side=True)
            threading.Thread(target=server.serve_forever, daemon=True).start()
            words = command("fetch", "weights", "--url-base", f"https://localhost:{server.server_port}")
            environment = {**os.environ, "RDS_CACHE": str(self.folder / "cache")}
            environment.pop("SSL_CERT_FILE", None)
            unknown = subprocess.run(words, capture_output=True, text=True, check=False, env=environment, timeout=60)
            trusted = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60,
                                     env={**environment, "SSL_CERT_FILE": str(certificate)})
            server.shutdown()
        self.assertRegex(unknown.stderr, "(?i)certificate")
        self.assertEqual(trusted.returncode, 1)
        self.assertRegex(trusted.stderr, "404")  # it is asked, and has no weights

    def test_yaml_without_end(self):
        options = self.folder / "options.yaml"
        for text in ("orb: &a {x: *a}\n", "a: &a [1, 1]\nb: &b [*a, *a]\nc: [*b, *b]\n", "nothing: {}\n", "nothing:\n",
                     "orb:\n  features: 900\n---\norb:\n  features: 900\n", "[" * 5000, "orb: {features: {}}\n"):
            options.write_text(text, encoding="utf-8")
            self.refused(self.run_words(self.sequence, "--config", options), "options.yaml")
            self.refused(self.run_words(self.sequence, "--camera", options), "options.yaml")

    def test_standard_output_on_a_full_disk(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            result = subprocess.run(command("config"), stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual(result.returncode, 1)
        self.assertIn("standard output cannot be written", result.stderr)

    def test_a_reader_that_leaves(self):
        """The messages have no reader any more; the results are written all the same."""
        reading, writing = os.pipe()
        os.close(reading)
        subprocess.run(command(*self.run_words(self.sequence)), stdout=writing, stderr=writing, check=False,
                       timeout=120)
        os.close(writing)
        self.assertGreater(len(poses(self.out / "trajectory.txt")), 1)
        self.assertIn("report.json", self.results())


class SignalsTest(FaultsTest):
    def start(self, *more):
        """A run in real time with late masks and a video."""
        return subprocess.Popen(command("run", self.sequence, "--out", self.out, "--segmenter", "stored", "--video",
                                        self.out / "run.mp4", *more), stderr=subprocess.PIPE, text=True)

    def wait_for_video(self, process):
        while process.poll() is None and not list(self.out.glob(".*.mp4")):
            time.sleep(0.005)

    def check_results(self, process, number):
        """Ended by the signal: all results or none, and nothing under way left behind."""
        _, said = process.communicate(timeout=60)
        self.assertIn(process.returncode, (128 + number, 0, -number), said)
        names = self.results()
        self.assertEqual([name for name in names if name.startswith(".")], [])
        if process.returncode == -number:  # before the run began
            self.assertEqual(names, [])
        if "trajectory.txt" in names:
            self.assertLessEqual({"report.json", "keyframes.txt", "frames.csv"}, set(names))
            report = json.loads((self.out / "report.json").read_text(encoding="utf-8"))
            self.assertEqual(len(poses(self.out / "trajectory.txt")), report["tracked"])
        return process.returncode, names

    def test_at_any_moment(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            for delay in (0, 0.05, 0.2, 0.5, 0.9, 1.4, 1.6):
                shutil.rmtree(self.out, ignore_errors=True)
                with self.subTest(signal=number, delay=delay):
                    process = self.start()
                    time.sleep(delay)
                    process.send_signal(number)
                    self.check_results(process, number)

    def test_half_way(self):
        """Ended in the midst of the sequence: what was tracked until then is there."""
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGXCPU, signal.SIGXFSZ):
            shutil.rmtree(self.out, ignore_errors=True)
            process = self.start("--rate", "0.1")  # 15 s, were it not ended
            self.wait_for_video(process)
            time.sleep(1)
            process.send_signal(number)
            code, names = self.check_results(process, number)
            self.assertEqual(code, 128 + number)
            self.assertIn("trajectory.txt", names)

    def test_a_killed_run_leaves_nothing_to_the_next(self):
        process = self.start("--rate", "0.1")
        self.wait_for_video(process)
        process.kill()
        process.communicate(timeout=60)
        self.assertEqual(len(self.results()), 1)  # the hidden video under way
        result = rds(*self.run_words(self.sequence))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([name for name in self.results() if name.startswith(".")], [])

    def test_the_second_one_ends_at_once(self):
        process = self.start("--rate", "0.1")
        self.wait_for_video(process)
        process.send_signal(signal.SIGSTOP)  # so that both arrive together
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGCONT)
        process.communicate(timeout=60)
        self.assertIn(process.returncode, (128 + signal.SIGINT, 128 + signal.SIGTERM))
        self.assertEqual(self.results(), [])


class DiskTest(FaultsTest):
    def mount(self, options):
        self.out.mkdir(exist_ok=True)
        subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", self.out], check=True)
        self.addCleanup(subprocess.run, ["umount", self.out], check=True)

    def test_full(self):
        self.mount("size=8k")
        self.refused(self.run_words(self.sequence), self.out, "No space left on device", "make room")

    def test_full_before(self):
        self.mount("size=16k")
        (self.out / "other").write_bytes(b"x" * 16384)
        result = rds(*self.run_words(self.sequence))
        self.assertEqual(result.returncode, 1)
        self.assertIn("No space left on device", result.stderr)
        self.assertEqual(self.results(), ["other"])

    def test_read_only(self):
        self.mount("ro")
        self.refused(self.run_words(self.sequence), self.out, "Read-only file system")

    def test_synth(self):
        self.mount("size=256k")
        result = rds("synth", "--out", self.out, "--frames", 10, "--width", WIDTH)
        self.assertEqual(result.returncode, 1)
        self.assertIn("No space left on device", result.stderr)
        self.assertNotIn("rgb.txt", self.results())  # no list: seen to be incomplete

    def test_results_come_before_the_video(self):
        """Results and video on one disk that has room for the results alone."""
        self.mount("size=128k")
        result = rds(*self.run_words(self.sequence, "--video", self.out / "run.mp4"))
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("run.mp4: ", result.stderr)
        self.assertIn("No space left on device", result.stderr)
        self.assertGreater(len(poses(self.out / "trajectory.txt")), 1)
        self.assertIn("report.json", self.results())
        self.assertEqual([name for name in self.results() if name.startswith(".") or name == "run.mp4"], [])

    def test_video_alone(self):
        self.mount("size=64k")
        results = self.folder / "results"
        result = rds("run", self.sequence, "--out", results, "--segmenter", "none", "--rate", "0", "--video",
                     self.out / "run.mp4", "--still", self.folder / "still.png")
        self.assertEqual(result.returncode, 1)
        self.assertIn("run.mp4: the video is incomplete", result.stderr)
        self.assertTrue((results / "trajectory.txt").is_file())
        self.assertTrue((self.folder / "still.png").is_file())
        self.assertEqual(self.results(), [])


def may_mount():
    """Whether this is a namespace where mounting is allowed; goes into one if need be and possible."""
    if DISK in os.environ:
        return True
    for how in (["unshare", "--mount"], ["unshare", "--map-root-user", "--mount"]):
        with tempfile.TemporaryDirectory() as folder:
            probe = subprocess.run([*how, "mount", "-t", "tmpfs", "none", folder], capture_output=True, check=False)
        if probe.returncode == 0:
            os.environ[DISK] = "1"
            os.execvp(how[0], [*how, sys.executable, *sys.argv])
    return False


def main():
    global RDS
    RDS = str(pathlib.Path(sys.argv[1]).resolve())
    group = {"input": InputTest, "signals": SignalsTest, "disk": DiskTest}[sys.argv[2]]
    if group is DiskTest and (shutil.which("unshare") is None or not may_mount()):
        print("[  SKIPPED ] no file system can be mounted here (as root, or with user namespaces)")
        sys.exit(77)
    result = unittest.TextTestRunner(verbosity=2).run(unittest.defaultTestLoader.loadTestsFromTestCase(group))
    sys.exit(0 if result.wasSuccessful() else 1)


if __name__ == "__main__":
    main()
