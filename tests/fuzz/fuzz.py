#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Feeds broken input of every kind to the readers and to the whole program.

    fuzz.py DRIVER RDS [--inputs N] [--seed S] [--keep FOLDER] [--jobs J]

DRIVER is the program fuzz_driver, RDS the program rds, best both built with AddressSanitizer and
UndefinedBehaviorSanitizer. Each input is made from a good one by mutations that follow from seed and number alone, so
any can be made again. What must hold: no signal, no sanitizer's report, no hang; the program ends with 0, 1 or 3, and
with 1 says why in one line; and an image that is read is the image that Pillow reads. Prints a table and exits with 1
if anything did not hold; inputs that did not are kept.
"""
import argparse
import collections
import concurrent.futures
import io
import os
import pathlib
import random
import re
import select
import shutil
import struct
import subprocess
import sys
import tarfile
import tempfile
import threading
import time
import zipfile
import zlib

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "build" / "venv" / "bin" / "python"
try:
    import numpy
    import PIL.Image
except ImportError:
    if TOOLS.exists() and pathlib.Path(sys.executable) != TOOLS:
        os.execv(TOOLS, [TOOLS, *sys.argv])
    print("[  SKIPPED ] Pillow and NumPy, the judge of images, are not there (scripts/install_dependencies.sh --tests)")
    sys.exit(77)

TIMEOUT_S = 120
WIDTH, HEIGHT = 48, 36

# ---- good inputs ----


def picture():
    y, x = numpy.mgrid[0:HEIGHT, 0:WIDTH]
    return numpy.dstack([5 * x, 6 * y, (x * y) % 256]).astype(numpy.uint8)


def depth_picture():
    y, x = numpy.mgrid[0:HEIGHT, 0:WIDTH]
    return (5000 + 100 * x + 37 * y).astype(numpy.uint16)


def encoded(image, form, **options):
    out = io.BytesIO()
    image.save(out, form, **options)
    return out.getvalue()


def images():
    color = PIL.Image.fromarray(picture())
    mask = PIL.Image.fromarray(((picture()[:, :, 0] > 100) * 255).astype(numpy.uint8))
    depth = PIL.Image.fromarray(depth_picture())
    meters = PIL.Image.fromarray((depth_picture() / 5000).astype(numpy.float32))
    npy = io.BytesIO()
    numpy.save(npy, (depth_picture() / 5000).astype(numpy.float32))
    pgm16 = b"P5\n%d %d\n65535\n" % (WIDTH, HEIGHT) + depth_picture().astype(">u2").tobytes()
    return {
        "color": [encoded(color, "PNG"), encoded(color, "JPEG", quality=90),
                  encoded(color, "JPEG", quality=80, progressive=True), encoded(color, "BMP"), encoded(color, "PPM"),
                  encoded(color, "TIFF"), encoded(color, "TIFF", compression="tiff_lzw"),
                  encoded(color, "WEBP", lossless=True), encoded(color.convert("P"), "PNG"),
                  encoded(color.convert("L"), "JPEG"), encoded(color.convert("RGBA"), "PNG")],
        "mask": [encoded(mask, "PNG"), encoded(mask.convert("1"), "PNG"), encoded(color, "PNG")],
        "depth": [encoded(depth, "PNG"), encoded(depth, "TIFF"), encoded(depth, "TIFF", compression="tiff_adobe_deflate"),
                  encoded(meters, "TIFF"), npy.getvalue(), pgm16],
    }


CAMERA = b"""width: 48
height: 36
fx: 44
fy: 44
cx: 24
cy: 18
distortion: [0.26, -0.95, -0.005, 0.002, 1.16]
depth_scale: 5000  # units in a meter
baseline_m: 0.08
"""
CAMERAS = [CAMERA, CAMERA.replace(b"distortion: [0.26, -0.95, -0.005, 0.002, 1.16]",
                                  b"distortion_model: fisheye\ndistortion: [-0.01, 0.05, -0.04, 0.008]"),
           b"%YAML:1.0\n\nCamera.fx: 44.0\nCamera.fy: 44.0\nCamera.cx: 24.0\nCamera.cy: 18.0\nCamera.k1: 0.1\n"
           b"Camera.bf: 4.0\nCamera.width: 48\nCamera.height: 36\nDepthMapFactor: 5000.0\n",
           b"image_width: 48\nimage_height: 36\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
           b"  data: [44.0, 0.0, 24.0, 0.0, 44.0, 18.0, 0.0, 0.0, 1.0]\ndistortion_model: plumb_bob\n"
           b"distortion_coefficients:\n  data: [0.1, 0.0, 0.0, 0.0, 0.0]\ndepth_scale: 1000\n"]
OPTIONS = [b"orb:\n  features: 900\n  levels: 6\ntracking:\n  unknown: gated\n  tau: 20\nsemantic: {per_round: 2}\n"]
MODELS = [b"input: {layout: NCHW, size: [24, 32], color: RGB, mean: [0, 0, 0], scale: [1, 1, 1]}\n"
          b"output:\n  tensor: scores\n  kind: logits\n  stride: [8, 8]\n  labels: [15]\n  threshold: 0.4\n",
          b"output:\n  kind: instances\n  labels: [1]\ninstances:\n  boxes: b\n  order: yxyx\n  relative: true\n  score: 0.7\n"]


def message(json_text, binary=b""):
    return b"%08d" % len(json_text) + json_text + binary


MESSAGES = [message(b'{"inputs":[{"name":"image","datatype":"UINT8","shape":[1,2,2,3],"parameters":{"binary_data_size":12}}]}',
                    bytes(range(12))),
            message(b'{"inputs":[{"name":"image","datatype":"BYTES","shape":[2],"parameters":{"binary_data_size":11}}]}',
                    b"\2\0\0\0ab\1\0\0\0c"),
            message(b'{"id":"1","inputs":[{"name":"x","datatype":"FP32","shape":[2,2],"data":[[1,2],[3,4.5]]},'
                    b'{"name":"y","datatype":"BYTES","shape":[1],"data":["w"]}]}')]


def archives():
    """A .tgz and a .zip of two small files, and a .tar, whose names a mutation reaches."""
    packed = []
    for mode in ("w:gz", "w"):
        file = io.BytesIO()
        with tarfile.open(fileobj=file, mode=mode) as archive:
            for name in ("sequence/rgb.txt", "sequence/rgb/1.png"):
                entry = tarfile.TarInfo(name)
                entry.size = 5
                archive.addfile(entry, io.BytesIO(b"12345"))
        packed.append(file.getvalue())
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("sequence/rgb.txt", b"12345")
        archive.writestr("sequence/rgb/1.png", b"12345")
    return packed + [file.getvalue()]


ARCHIVES = archives()
TRUTH = "".join(f"{i / 10:.3f} {i / 50:.4f} {(i % 7) / 30:.4f} {(i % 5) / 40:.4f} 0 0 0 1\n" for i in range(40)).encode()
TRAJECTORIES = [b"# timestamp tx ty tz qx qy qz qw\n" + TRUTH,
                b"#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []\n" +
                b"".join(b"%d,%d,1,2,1,0,0,0\n" % (i * 100000000, i) for i in range(30))]

# ---- mutations ----

WORDS = [b"nan", b"-nan", b"inf", b"1e308", b"-1", b"0", b"1e-320", b"99999999999999999999", b"0x10", b"1,5", b"", b"\0",
         b"\xff\xfe", b"\xef\xbb\xbf", b"*a", b"&a [*a]", b"---\n", b"{}", b"[]", b"[" * 40, b"a: " * 30, b"'", b'"', b"#",
         b"\r", b"\n\n", b"\t", b"../../etc/passwd", b"/dev/zero", b"%s%n", b"true", b"null", b"~", b"!!binary x",
         b"1700000000000000000", b"2147483648", b"4294967295", b"18446744073709551616"]
NUMBERS = [0, 1, 2, 3, 7, 8, 16, 127, 128, 255, 256, 32767, 32768, 65535, 65536, 2**31 - 1, 2**31, 2**32 - 1]


def mutate_bytes(random_, data):
    data = bytearray(data)
    for _ in range(random_.choice([1, 1, 1, 2, 3, 8])):
        if not data:
            break
        # Where decoders decide: headers more often than pixels.
        at = random_.randrange(min(len(data), random_.choice([16, 64, 200, len(data)])))
        how = random_.randrange(9)
        if how <= 2:
            data[at] ^= 1 << random_.randrange(8)
        elif how == 3:
            data[at] = random_.randrange(256)
        elif how == 4:
            size = random_.choice([1, 2, 4])
            value = random_.choice(NUMBERS) & (2**(8 * size) - 1)
            data[at:at + size] = value.to_bytes(size, random_.choice(["little", "big"]))
        elif how == 5:
            del data[at:at + random_.choice([1, 2, 4, 30, 300])]
        elif how == 6:
            data[at:at] = random_.choice(WORDS) + bytes(random_.choice([0, 1, 4]))
        elif how == 7:
            data = data[:random_.randrange(len(data))]
        else:
            other = random_.randrange(len(data))
            data[at:at + 8] = data[other:other + 8]
    return bytes(data)


def mend_png(data):
    """Checksums as they should be, so that what is behind them is reached."""
    if not data.startswith(b"\x89PNG\r\n\x1a\n"):
        return data
    out, at = bytearray(data[:8]), 8
    while at + 12 <= len(data):
        length = struct.unpack(">I", data[at:at + 4])[0]
        body = data[at + 4:at + 8 + length]
        if len(body) < 4 + length:
            return data
        out += data[at:at + 4] + body + struct.pack(">I", zlib.crc32(body))
        at += 12 + length
    return bytes(out)


def mutate_text(random_, text):
    lines = text.split(b"\n")
    for _ in range(random_.choice([1, 1, 2, 4])):
        at = random_.randrange(len(lines))
        how = random_.randrange(9)
        if how <= 2:
            words = re.split(rb"([ ,:\[\]])", lines[at])
            words[random_.randrange(len(words))] = random_.choice(WORDS)
            lines[at] = b"".join(words)
        elif how == 3:
            lines.insert(at, random_.choice(lines))
        elif how == 4:
            del lines[at]
            lines = lines or [b""]
        elif how == 5:
            random_.shuffle(lines)
        elif how == 6:
            lines[at] = mutate_bytes(random_, lines[at])
        elif how == 7:
            lines[at] = re.sub(rb"[0-9]+", lambda found: str(random_.choice(NUMBERS)).encode(), lines[at], count=1)
        else:
            return random_.choice([b"\r", b"\r\n", b"\0", b" "]).join(lines)
    return b"\n".join(lines)


# ---- the judge of images ----

PIL.Image.MAX_IMAGE_PIXELS = None


def judged(kind, data, width, height, pixels):
    """What is wrong with the pixels that were read, or None."""
    if kind == "depth" and data.startswith(b"\x93NUMPY"):
        try:
            stored = numpy.load(io.BytesIO(data))
        except Exception as error:  # pylint: disable=broad-except
            return f"NumPy refuses it: {error}"
        with numpy.errstate(all="ignore"):
            units = stored if stored.dtype.kind == "u" else numpy.round(stored.astype(numpy.float64) * 5000)
        expected = numpy.where(numpy.isfinite(units) & (units > 0) & (units < 65535), units, 0).astype(numpy.uint16)
        got = numpy.frombuffer(pixels, numpy.uint16).reshape(height, width)
        return None if numpy.abs(got.astype(int) - expected).max(initial=0) <= 1 else "other numbers than NumPy's"
    try:
        image = PIL.Image.open(io.BytesIO(data))
        image.load()
    except Exception as error:  # pylint: disable=broad-except
        return f"Pillow refuses it: {error}"
    if image.size != (width, height):
        return f"{width} x {height} instead of {image.size}"
    if kind == "depth":
        got = numpy.frombuffer(pixels, numpy.uint16).reshape(height, width).astype(int)
        stored = numpy.asarray(image)
        if image.mode == "F":
            with numpy.errstate(all="ignore"):
                units = numpy.round(stored.astype(numpy.float64) * 5000)
            stored = numpy.where(numpy.isfinite(units) & (units > 0) & (units < 65535), units, 0)
        if data.startswith(b"P5") and image.mode == "I":
            return None  # Pillow stretches what is not of 65535; the header test covers it
        return None if numpy.abs(got - stored.astype(int)).max(initial=0) <= 1 else "other depth than Pillow's"
    expected = numpy.asarray(image.convert("RGB")).astype(int)
    if kind == "mask":
        got = numpy.frombuffer(pixels, numpy.uint8).reshape(height, width) != 0
        share = (got != (expected.max(axis=2) != 0)).mean()
        return None if share < 0.01 else f"{100 * share:.0f} % of the mask differ from Pillow's"
    got = numpy.frombuffer(pixels, numpy.uint8).reshape(height, width, 3)[:, :, ::-1].astype(int)
    difference = numpy.abs(got - expected).mean()
    return None if difference < 4 else f"colors differ from Pillow's by {difference:.1f} on average"


# ---- running ----


class Driver:
    """One fuzz_driver, started anew when it ends."""

    def __init__(self, program, environment):
        self.program, self.environment, self.process = program, environment, None

    def ask(self, kind, path):
        """Its answer; raises RuntimeError with what happened where there is none."""
        if self.process is None:
            self.log = tempfile.TemporaryFile()
            self.process = subprocess.Popen([self.program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log,
                                            env=self.environment)
        self.process.stdin.write(f"{kind} {path}\n".encode())
        self.process.stdin.flush()
        ready, _, _ = select.select([self.process.stdout], [], [], TIMEOUT_S)
        answer = self.process.stdout.readline().decode(errors="replace") if ready else ""
        if answer.startswith(("ok", "error")):
            return answer
        try:
            status = self.process.wait(timeout=10 if ready else 0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            status = self.process.wait()
        self.log.seek(0)
        said = self.log.read().decode(errors="replace")
        self.process = None
        raise RuntimeError("hang" if not ready else f"answered {answer!r}, ended with {status}: {said[-3000:]}")

    def close(self):
        if self.process is not None:
            self.process.stdin.close()
            self.process.wait()


class Fuzzer:
    def __init__(self, arguments, work):
        self.arguments, self.work = arguments, work
        self.images = images()
        self.local = threading.local()
        self.drivers = []
        self.counts = collections.Counter()
        self.failures = []
        self.lock = threading.Lock()
        self.environment = {**os.environ, "RDS_CACHE": str(work / "cache"), "RDS_WEIGHTS": "",
                            "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":exitcode=99:allocator_may_return_null=0",
                            "UBSAN_OPTIONS": os.environ.get("UBSAN_OPTIONS", "") + ":exitcode=99"}

    def driver(self):
        if not hasattr(self.local, "driver"):
            self.local.driver = Driver(self.arguments.driver, self.environment)
            with self.lock:
                self.drivers.append(self.local.driver)
        return self.local.driver

    # Each returns a problem or None, and counts how it ended.

    def image(self, random_, folder, kind):
        data = mutate_bytes(random_, random_.choice(self.images[kind]))
        if random_.random() < 0.7:
            data = mend_png(data)
        path = folder / "input"
        path.write_bytes(data)
        answer = self.driver().ask(kind, path).split()
        if answer[0] == "error":
            return "refused", None
        pixels = pathlib.Path(f"{path}.pixels").read_bytes()
        return "read", judged(kind, data, int(answer[1]), int(answer[2]), pixels)

    def text(self, random_, folder, kind, goods, name="input"):
        (folder / name).write_bytes(mutate_text(random_, random_.choice(goods)))
        answer = self.driver().ask(kind, folder / name)
        return ("read" if answer.startswith("ok") else "refused"), None

    def model(self, random_, folder):
        (folder / "net.onnx").write_bytes(b"weights")
        return self.text(random_, folder, "model", MODELS, "net.onnx.yaml")

    def bytes_of(self, random_, folder, kind, goods):
        (folder / "input").write_bytes(mutate_bytes(random_, random_.choice(goods)))
        answer = self.driver().ask(kind, folder / "input")
        return ("read" if answer.startswith("ok") else "refused"), None

    def inference(self, random_, folder):
        return self.bytes_of(random_, folder, "inference", MESSAGES)

    def archive(self, random_, folder):
        outcome, problem = self.bytes_of(random_, folder, "archive", ARCHIVES)
        strangers = [path.name for path in folder.iterdir() if path.name not in ("input", "input.folder")]
        return outcome, f"unpacked outside its folder: {strangers}" if strangers else problem

    def trajectory(self, random_, folder):
        (folder / "truth.txt").write_bytes(TRUTH)
        return self.text(random_, folder, "trajectory", TRAJECTORIES)

    def make_sequence(self):
        """A good sequence of a few small pictures, in which people walk."""
        folder = self.work / "good"
        subprocess.run([self.arguments.rds, "synth", "--out", folder, "--frames", "6", "--width", "200"],
                       capture_output=True, check=True, env=self.environment)
        self.good = {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}

    def sequence_folder(self, random_, folder, mutations):
        """A copy of the good sequence in which some files are broken."""
        files = dict(self.good)
        if random_.random() < 0.6:
            del files["associations.txt"]
        for _ in range(mutations):
            name = random_.choice(sorted(files) if random_.random() < 0.5 else
                                  sorted(name for name in files if name.endswith((".txt", ".yaml"))))
            mutate = mutate_text if name.endswith((".txt", ".yaml")) else mutate_bytes
            files[name] = mutate(random_, files[name])
        for name, data in files.items():
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_bytes(data)
        if mutations and random_.random() < 0.2:
            victim = folder / random_.choice(sorted(files))
            victim.unlink()
            random_.choice([lambda: None, lambda: victim.mkdir(), lambda: os.mkfifo(victim),
                            lambda: victim.symlink_to("/dev/zero")])()

    def sequence(self, random_, folder):
        self.sequence_folder(random_, folder, random_.choice([1, 2, 3]))
        answer = self.driver().ask("sequence", folder)
        return ("read" if answer.startswith("ok") else "refused"), None

    def program(self, words, folder):
        """The whole program; a problem if it does not end as it should."""
        try:
            result = subprocess.run([self.arguments.rds, *map(str, words)], capture_output=True, timeout=TIMEOUT_S,
                                    check=False, env=self.environment, cwd=folder, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            return "hang", f"hang: {words}"
        said = result.stderr.decode(errors="replace")
        errors = [line for line in said.splitlines() if line.startswith("rds: error: ")]
        if result.returncode not in (0, 1, 3) or "rds: bug" in said:
            return "broken", f"{words}: ended with {result.returncode}: {said[-3000:]}"
        if (len(errors) == 1) != (result.returncode == 1):
            return "broken", f"{words}: {len(errors)} errors, but ended with {result.returncode}: {said[-3000:]}"
        return f"exit {result.returncode}", None

    def run(self, random_, folder):
        sequence = folder / "sequence"
        sequence.mkdir()
        self.sequence_folder(random_, sequence, random_.choice([0, 1, 2, 3]))
        words = ["run", sequence, "--out", folder / "out", "--segmenter", random_.choice(["none", "stored"]),
                 "--set", "semantic.stored.delay_ms=0", "--set", "orb.features=100", "--set", "tracking.min_start_points=10"]
        words += random_.choice([["--lockstep"], ["--rate", "0"]]) + random_.choice([[], ["--strict"]])
        return self.program(words, folder)

    def arguments_of_commands(self, random_, folder):
        sequence = folder / "sequence"
        sequence.mkdir()
        self.sequence_folder(random_, sequence, 0)
        for name, data in (("o.yaml", OPTIONS[0]), ("c.yaml", CAMERA), ("t.txt", TRUTH)):
            (folder / name).write_bytes(data)
        values = ["", "-1", "0", "1e400", "nan", "9" * 30, "\udcff", "a=b", "orb.features=10000", "orb.moving_ratio=10", "1:3",
                  "3:1", ":", "o.yaml", "c.yaml", "t.txt", "sequence", "/dev/full", "/dev/null", ".", "none", "stored",
                  "tum_fr1", "x" * 5000, "--", "-h", "*", "orb.levels=8", "--out", "semantic.backlog=1"]
        options = ["--set", "--config", "--camera", "--frames", "--rate", "--segmenter", "--model", "--video", "--still",
                   "--still-frame", "--lockstep", "--strict", "--json", "--plot", "--scale", "--delta", "--delta-frames",
                   "--max-difference", "--only", "--markdown", "--seed", "--width", "--height", "--movers", "--noise"]
        command = random_.choice([["run", "sequence", "--out", "out", "--rate", "0", "--segmenter", "none"],
                                  ["eval", "t.txt", "t.txt"], ["bench", "sequence", "--rate", "0"],
                                  ["ablate", "sequence", "--only", "no semantics"], ["config"],
                                  ["synth", "--out", "made", "--frames", "1", "--width", "64"], ["fetch", "weights"], []])
        words = list(command)
        for _ in range(random_.choice([1, 1, 2, 3])):
            words += random_.choice([[random_.choice(options), random_.choice(values)], [random_.choice(options)],
                                     [random_.choice(values)]])
        if command[:1] == ["fetch"]:
            words += ["--url-base", "file:///nowhere"]
        words = [word.replace("\udcff", "\N{REPLACEMENT CHARACTER}") for word in words]
        outcome, problem = self.program(words, folder)
        if problem and "--width" in words:
            return outcome, None if "out of memory" in problem else problem
        return outcome, problem

    KINDS = {"color": 26, "depth": 14, "mask": 6, "camera": 10, "options": 6, "model": 6, "trajectory": 10, "sequence": 8,
             "run": 7, "arguments": 7, "inference": 8, "archive": 4}

    def one(self, number):
        random_ = random.Random(f"{self.arguments.seed} {number}")
        kind = random_.choices(list(self.KINDS), list(self.KINDS.values()))[0]
        folder = self.work / str(number)
        folder.mkdir()
        begin = time.monotonic()
        try:
            if kind in self.images:
                outcome, problem = self.image(random_, folder, kind)
            elif kind in ("camera", "options"):
                outcome, problem = self.text(random_, folder, kind, CAMERAS if kind == "camera" else OPTIONS)
            else:
                outcome, problem = {"model": self.model, "inference": self.inference, "archive": self.archive,
                                    "trajectory": self.trajectory, "sequence": self.sequence,
                                    "run": self.run, "arguments": self.arguments_of_commands}[kind](random_, folder)
        except RuntimeError as error:
            outcome, problem = "broken", str(error)
        with self.lock:
            self.counts[kind, "silently wrong" if problem and outcome == "read" else outcome] += 1
            self.counts["slowest", ""] = max(self.counts["slowest", ""], int(1000 * (time.monotonic() - begin)))
            if problem:
                self.failures.append((number, kind, problem))
        if problem and self.arguments.keep:
            shutil.copytree(folder, pathlib.Path(self.arguments.keep) / f"{self.arguments.seed}_{number}", symlinks=True,
                            dirs_exist_ok=True, ignore_dangling_symlinks=True,
                            ignore=lambda where, names: [n for n in names if not os.path.isfile(os.path.join(where, n))
                                                         and not os.path.isdir(os.path.join(where, n))])
        shutil.rmtree(folder, ignore_errors=True)

    def everything(self):
        numbers = [self.arguments.only] if self.arguments.only is not None else range(self.arguments.inputs)
        with concurrent.futures.ThreadPoolExecutor(self.arguments.jobs) as pool:
            for done, _ in enumerate(pool.map(self.one, numbers), 1):
                if done % 1000 == 0:
                    print(f"{done} inputs, {len(self.failures)} failures", file=sys.stderr, flush=True)
        for driver in self.drivers:
            driver.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("driver")
    parser.add_argument("rds")
    parser.add_argument("--inputs", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="the input of this number alone")
    parser.add_argument("--keep", help="folder for inputs that fail")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    arguments.driver, arguments.rds = (str(pathlib.Path(p).resolve()) for p in (arguments.driver, arguments.rds))
    begin = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="rds_fuzz_") as work:
        fuzzer = Fuzzer(arguments, pathlib.Path(work))
        fuzzer.make_sequence()
        fuzzer.everything()
    slowest = fuzzer.counts.pop(("slowest", ""), 0)
    for kind in Fuzzer.KINDS:
        outcomes = {outcome: count for (k, outcome), count in sorted(fuzzer.counts.items()) if k == kind}
        print(f"{kind:12}", ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items()))
    for number, kind, problem in sorted(fuzzer.failures)[:20]:
        print(f"\nFAILED {kind}, --seed {arguments.seed} --only {number}: {problem}")
    print(f"\n{sum(fuzzer.counts.values())} inputs, {len(fuzzer.failures)} failures; slowest {slowest} ms; "
          f"{time.monotonic() - begin:.0f} s")
    sys.exit(1 if fuzzer.failures else 0)


if __name__ == "__main__":
    main()
