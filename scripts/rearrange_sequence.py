#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cuts a recorded sequence (TUM layout) and puts its pieces together anew: a camera that is kidnapped.

    scripts/rearrange_sequence.py SEQUENCE OUT PIECE...

A PIECE is FIRST:LAST (frames FIRST to LAST - 1; backwards where LAST is the smaller), FOLDER@FIRST:LAST (of another
sequence with the same camera and the same frame of its ground truth: a second session), or black:N (N frames with the
lens covered: no light, no depth). The frames get new, even timestamps; images are linked, not copied; masks and ground
truth go with their frames.
"""
import argparse
import os
import pathlib
import struct
import sys
import zlib

INTERVAL_S = 1 / 30
LISTS = ("rgb", "depth", "mask", "groundtruth")


def read_list(path):
    """Lines of a list as (timestamp, rest), without comments."""
    entries = []
    for line in path.read_text().splitlines():
        fields = line.split(maxsplit=1)
        if len(fields) == 2 and not line.startswith("#"):
            entries.append((float(fields[0]), fields[1].strip()))
    return entries


def nearest(entries, timestamp, most_s=0.02):
    """What an entry says at a time, or None."""
    if not entries:
        return None
    best = min(entries, key=lambda entry: abs(entry[0] - timestamp))
    return best[1] if abs(best[0] - timestamp) <= most_s else None


def png_size(path):
    """Width and height of a PNG."""
    with path.open("rb") as file:
        header = file.read(24)
    if header[:8] != b"\x89PNG\r\n\x1a\n":
        sys.exit(f"{path}: not a PNG")
    return struct.unpack(">II", header[16:24])


def write_black(path, width, height, bits):
    """A gray PNG, all 0."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = (b"\0" + bytes(width * bits // 8)) * height
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


class Sequence:
    """A folder's lists; `place` is where its images are linked below OUT."""

    def __init__(self, folder, place):
        self.folder = folder
        self.place = place
        self.lists = {name: read_list(folder / f"{name}.txt") if (folder / f"{name}.txt").exists() else []
                      for name in LISTS}
        if not self.lists["rgb"] or not self.lists["depth"]:
            sys.exit(f"{folder}: no rgb.txt and depth.txt")


def pieces_to_frames(pieces, sequence):
    """(sequence, index) of each frame, None for a black one; and all sequences."""
    sequences = {sequence.folder: sequence}
    frames = []
    for piece in pieces:
        folder, _, span = piece.rpartition("@")
        first, _, last = span.partition(":")
        try:
            if span == piece and first == "black":
                frames += [None] * int(last)
                continue
            a, b = int(first), int(last)
        except ValueError:
            sys.exit(f"{piece}: expected FIRST:LAST, FOLDER@FIRST:LAST or black:N")
        folder = pathlib.Path(folder) if folder else sequence.folder
        if folder not in sequences:
            sequences[folder] = Sequence(folder, f"session{len(sequences)}")
        count = len(sequences[folder].lists["rgb"])
        if not (0 <= a <= count and 0 <= b <= count):
            sys.exit(f"{piece}: the sequence has {count} frames")
        frames += [(sequences[folder], i) for i in (range(a, b) if a <= b else range(a - 1, b - 1, -1))]
    return frames, list(sequences.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("pieces", nargs="+", metavar="PIECE")
    arguments = parser.parse_args()
    frames, sequences = pieces_to_frames(arguments.pieces, Sequence(arguments.sequence, ""))
    arguments.out.mkdir(parents=True, exist_ok=True)
    width, height = png_size(arguments.sequence / sequences[0].lists["depth"][0][1])
    write_black(arguments.out / "black8.png", width, height, 8)
    write_black(arguments.out / "black16.png", width, height, 16)
    lines = {name: [] for name in LISTS}
    for i, frame in enumerate(frames):
        stamp = f"{1000 + i * INTERVAL_S:.6f}"
        if frame is None:
            for name, black in (("rgb", "black8.png"), ("depth", "black16.png"), ("mask", "black8.png")):
                lines[name].append(f"{stamp} {black}")
            continue
        sequence, index = frame
        timestamp, image = sequence.lists["rgb"][index]
        for name in ("rgb", "depth", "mask"):
            file = image if name == "rgb" else nearest(sequence.lists[name], timestamp)
            if file is not None:
                place = pathlib.Path(sequence.place) / file
                link = arguments.out / place
                if not link.exists():
                    link.parent.mkdir(parents=True, exist_ok=True)
                    link.symlink_to(pathlib.Path(os.path.relpath(sequence.folder.resolve() / file, link.parent.resolve())))
                lines[name].append(f"{stamp} {place.as_posix()}")
        pose = nearest(sequence.lists["groundtruth"], timestamp)
        if pose is not None:
            lines["groundtruth"].append(f"{stamp} {pose}")
    for name, content in lines.items():
        if content and (name != "mask" or any(sequence.lists["mask"] for sequence in sequences)):
            (arguments.out / f"{name}.txt").write_text("\n".join(content) + "\n")
    (arguments.out / "pieces.txt").write_text(" ".join(arguments.pieces) + "\n")
    print(f"{arguments.out}: {len(frames)} frames of {' and '.join(str(sequence.folder) for sequence in sequences)}")


if __name__ == "__main__":
    main()
