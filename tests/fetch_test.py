#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`rds fetch tum` and `rds fetch bonn` against a local server: whole, interrupted, damaged and malicious archives.

    fetch_test.py RDS
"""
import http.server
import io
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
import threading
import unittest
import zipfile

RDS = ""
TUM = "rgbd_dataset_freiburg3_walking_xyz"
BONN = "rgbd_bonn_balloon"


def rds(*words):
    return subprocess.run([RDS, *map(str, words)], capture_output=True, text=True, timeout=120, check=False)


class Handler(http.server.BaseHTTPRequestHandler):
    """Serves bytes by path, with ranges; the first `cuts` answers end in their middle."""
    files = {}
    cuts = 0
    starts = []

    def log_message(self, *_):
        pass

    def do_HEAD(self):
        self.answer(False)

    def do_GET(self):
        self.answer(True)

    def answer(self, body):
        content = self.files.get(self.path)
        if content is None:
            self.send_error(404)
            return
        start = 0
        if "Range" in self.headers:
            start = int(self.headers["Range"].split("=")[1].rstrip("-"))
            self.send_response(206)
            self.send_header("Content-Range", f"bytes {start}-{len(content) - 1}/{len(content)}")
        else:
            self.send_response(200)
        self.send_header("Content-Length", str(len(content) - start))
        self.end_headers()
        if body:
            type(self).starts.append(start)
            rest = content[start:]
            if type(self).cuts > 0:
                type(self).cuts -= 1
                rest = rest[:len(rest) // 2]
                self.close_connection = True
            self.wfile.write(rest)


class FetchTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory(prefix="rds_fetch_")
        cls.sequence = pathlib.Path(cls.shared.name) / "sequence"
        made = rds("synth", "--out", cls.sequence, "--frames", 3, "--width", 64)
        if made.returncode != 0:
            raise RuntimeError(made.stderr)
        cls.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=cls.server.serve_forever, daemon=True).start()
        cls.url = f"http://127.0.0.1:{cls.server.server_port}"

    @classmethod
    def tearDownClass(cls):
        cls.server.shutdown()
        cls.server.server_close()
        cls.shared.cleanup()

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="rds_fetch_")
        self.out = pathlib.Path(self.temporary.name) / "data"
        Handler.files, Handler.cuts, Handler.starts = {}, 0, []

    def tearDown(self):
        self.temporary.cleanup()

    def tgz(self, name=TUM, more=()):
        packed = io.BytesIO()
        with tarfile.open(fileobj=packed, mode="w:gz") as archive:
            archive.add(self.sequence, name)
            for entry, content in more:
                entry.size = len(content)
                archive.addfile(entry, io.BytesIO(content))
        return packed.getvalue()

    def zip(self, name=BONN, more=()):
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w") as archive:
            for file in sorted(self.sequence.rglob("*")):
                archive.write(file, pathlib.Path(name) / file.relative_to(self.sequence))
            for entry, content in more:
                archive.writestr(entry, content)
        return packed.getvalue()

    def fetch(self, *words, benchmark="tum"):
        return rds("fetch", benchmark, *words, "--url-base", self.url, "--out", self.out)

    def refused(self, content, *fragments):
        Handler.files[f"/freiburg3/{TUM}.tgz"] = content
        ran = self.fetch("walking_xyz")
        self.assertEqual(ran.returncode, 1, ran.stderr)
        for fragment in fragments:
            self.assertIn(fragment, ran.stderr)
        self.assertEqual([path.name for path in self.out.iterdir()], [], "something is left behind")
        self.assertEqual({path.name for path in pathlib.Path(self.temporary.name).iterdir()}, {"data"})

    def test_brings_a_sequence(self):
        Handler.files[f"/freiburg3/{TUM}.tgz"] = self.tgz()
        ran = self.fetch("walking_xyz")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertEqual(ran.stdout.strip(), str(self.out / TUM))
        self.assertEqual((self.out / TUM / "rgb.txt").read_text(), (self.sequence / "rgb.txt").read_text())
        self.assertEqual([path.name for path in self.out.iterdir()], [TUM])
        Handler.files.clear()
        self.assertEqual(self.fetch("fr3/walking_xyz").returncode, 0, "it is there, and needs no server")
        (self.out / TUM / "rgb" / "0.000000.png").unlink()
        broken = self.fetch("walking_xyz")
        self.assertEqual(broken.returncode, 1)
        self.assertIn("no whole sequence", broken.stderr)

    def test_goes_on_where_it_stopped(self):
        content = Handler.files[f"/freiburg3/{TUM}.tgz"] = self.tgz()
        Handler.cuts = 100
        ran = self.fetch("walking_xyz")
        self.assertEqual(ran.returncode, 1)
        part = self.out / f"{TUM}.tgz.part"
        arrived = part.stat().st_size
        self.assertTrue(0 < arrived < len(content))
        Handler.cuts, Handler.starts = 1, []
        ran = self.fetch("walking_xyz")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertEqual(Handler.starts[0], arrived)
        self.assertEqual(len(Handler.starts), 2)
        self.assertFalse(part.exists())

    def test_truth_of_markers_becomes_that_of_the_camera(self):
        Handler.files[f"/{BONN}.zip"] = self.zip()
        ran = self.fetch("balloon", benchmark="bonn")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        folder = self.out / BONN
        self.assertEqual((folder / "groundtruth.markers.txt").read_text(),
                         (self.sequence / "groundtruth.txt").read_text())
        self.assertIn("poses of the camera", (folder / "groundtruth.txt").read_text())
        self.assertNotEqual((folder / "groundtruth.txt").read_text(), (self.sequence / "groundtruth.txt").read_text())

    def test_nothing_leaves_the_folder(self):
        for name in (f"{TUM}/../../evil", "/tmp/rds_evil", "../evil"):
            self.refused(self.tgz(more=[(tarfile.TarInfo(name), b"x")]), "leads out of the folder")
        link = tarfile.TarInfo(f"{TUM}/link")
        link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
        self.refused(self.tgz(more=[(link, b"")]), "neither a file nor a folder")
        hard = tarfile.TarInfo(f"{TUM}/hard")
        hard.type, hard.linkname = tarfile.LNKTYPE, f"{TUM}/rgb.txt"
        self.refused(self.tgz(more=[(hard, b"")]), "neither a file nor a folder")
        Handler.files[f"/{BONN}.zip"] = self.zip(more=[("../evil", "x")])
        self.assertEqual(self.fetch("balloon", benchmark="bonn").returncode, 1)
        self.assertFalse((self.out.parent / "evil").exists())

    def test_what_is_no_sequence_is_refused(self):
        self.refused(self.tgz()[:-200], "cut short")
        self.refused(b"<html>log in first</html>", "not the sequence")
        self.refused(self.tgz("another"), "no such sequence folder")
        incomplete = pathlib.Path(self.temporary.name).parent / "incomplete"
        shutil.rmtree(incomplete, ignore_errors=True)
        shutil.copytree(self.sequence, incomplete)
        (incomplete / "depth" / "0.033333.png").unlink()
        packed = io.BytesIO()
        with tarfile.open(fileobj=packed, mode="w:gz") as archive:
            archive.add(incomplete, TUM)
        shutil.rmtree(incomplete)
        self.refused(packed.getvalue(), "0.033333.png is not there")

    def test_says_what_is_wrong(self):
        ran = self.fetch("walking_xyz")
        self.assertEqual(ran.returncode, 1)
        self.assertIn("404", ran.stderr)
        self.assertIn("ambiguous", self.fetch("xyz").stderr)
        self.assertIn("rds fetch bonn", rds("fetch", "kitti").stderr)


if __name__ == "__main__":
    RDS = sys.argv.pop(1)
    unittest.main(verbosity=2)
