#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cuts a recorded sequence (TUM layout) and puts its pieces together anew: a camera that is kidnapped.

    scripts/rearrange_sequence.py SEQUENCE OUT PIECE...

A PIECE is FIRST:LAST (frames FIRST to LAST - 1; backwards where LAST is the smaller) or black:N (N frames with the lens
covered: no light, no depth). The frames get new, even timestamps; images are linked, not copied; masks and ground truth
go with their frames.
"""
import argparse
import os
import pathlib
import struct
import sys
import zlib

INTERVAL_S = 1 / 30


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


def pieces_to_frames(pieces, count):
    """Indices of frames, None for a black one."""
    frames = []
    for piece in pieces:
        first, _, last = piece.partition(":")
        try:
            if first == "black":
                frames += [None] * int(last)
                continue
            a, b = int(first), int(last)
        except ValueError:
            sys.exit(f"{piece}: expected FIRST:LAST or black:N")
        if not (0 <= a <= count and 0 <= b <= count):
            sys.exit(f"{piece}: the sequence has {count} frames")
        frames += range(a, b) if a <= b else range(a - 1, b - 1, -1)
    return frames


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("pieces", nargs="+", metavar="PIECE")
    arguments = parser.parse_args()
    lists = {name: read_list(arguments.sequence / f"{name}.txt") if (arguments.sequence / f"{name}.txt").exists() else []
             for name in ("rgb", "depth", "mask", "groundtruth")}
    if not lists["rgb"] or not lists["depth"]:
        sys.exit(f"{arguments.sequence}: no rgb.txt and depth.txt")
    frames = pieces_to_frames(arguments.pieces, len(lists["rgb"]))
    arguments.out.mkdir(parents=True, exist_ok=True)
    width, height = png_size(arguments.sequence / lists["depth"][0][1])
    write_black(arguments.out / "black8.png", width, height, 8)
    write_black(arguments.out / "black16.png", width, height, 16)
    lines = {name: [] for name in lists}
    for i, frame in enumerate(frames):
        stamp = f"{1000 + i * INTERVAL_S:.6f}"
        if frame is None:
            for name, black in (("rgb", "black8.png"), ("depth", "black16.png"), ("mask", "black8.png")):
                lines[name].append(f"{stamp} {black}")
            continue
        timestamp, image = lists["rgb"][frame]
        for name in ("rgb", "depth", "mask"):
            file = image if name == "rgb" else nearest(lists[name], timestamp)
            if file is not None:
                link = arguments.out / file
                if not link.exists():
                    link.parent.mkdir(parents=True, exist_ok=True)
                    link.symlink_to(pathlib.Path(os.path.relpath(arguments.sequence.resolve() / file, link.parent.resolve())))
                lines[name].append(f"{stamp} {file}")
        pose = nearest(lists["groundtruth"], timestamp)
        if pose is not None:
            lines["groundtruth"].append(f"{stamp} {pose}")
    for name, content in lines.items():
        if content and (name != "mask" or lists["mask"]):
            (arguments.out / f"{name}.txt").write_text("\n".join(content) + "\n")
    (arguments.out / "pieces.txt").write_text(" ".join(arguments.pieces) + "\n")
    print(f"{arguments.out}: {len(frames)} frames of {arguments.sequence}")


if __name__ == "__main__":
    main()
