#!/usr/bin/env python3
"""Write the files of groom/ and recording/ that must be refused, by the rows of groom.txt and recording.txt. The good files that they are made
of, and checksums, are built from the descriptions of the formats.

usage: make_bad_files.py [check]
    check: say which files differ, and write none
"""
import array
import os
import struct
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../outputs"))
import wisp_recording


def packed(data, seed=0):
    return struct.pack("<Q", wisp_recording.checksum(bytes(data), seed))


def seal(data):
    """Make every checksum right, as far as the header says where they are."""
    header, frame = struct.unpack_from("<2Q", data, 16)
    if not 48 <= header <= len(data) or frame < 16:
        return
    data[header - 8:header] = packed(data[:header - 8])
    seed, at = struct.unpack_from("<Q", data, header - 8)[0], header
    while frame <= len(data) - at:
        data[at + frame - 8:at + frame] = packed(data[at:at + frame - 8], seed)
        at += frame
    if len(data) - at == 24:
        data[at + 16:] = packed(data[at:at + 16], seed)


def ones(count):
    return array.array("f", [1] * count).tobytes()


def good_hair():
    """Strands of 2 and 1 segments, all five arrays."""
    return struct.pack("<4s3I112x2H", b"HAIR", 2, 5, 31, 2, 1) + ones(40)


def good_recording():
    """A triangle "cloth", two strands "hairs" of two vertices, two frames, the mark of the end."""
    data = struct.pack("<8s2I2Qd", b"WISP\r\n\x1a\n", 1, 2, 120, 132, 1)
    data += struct.pack("<4I8s3i", 0, 5, 3, 1, b"cloth", 0, 1, 2) + struct.pack("<4I8s3i", 1, 5, 4, 2, b"hairs", 0, 2, 4) + bytes(8)
    for frame in 0, 1:
        data += struct.pack("<8s2QdQ", b"WISPFRAM", 132, frame, frame, 7) + ones(21) + bytes(8)
    data = bytearray(data + struct.pack("<8s2Q", b"WISPEND\n", 2, 0))
    seal(data)
    return data


def good_cache():
    """Two points, two samples."""
    return struct.pack("<12s2i2fi", b"POINTCACHE2", 1, 2, 0, 1, 2) + ones(12)


GOOD = {"wisp": good_recording(), "pc2": good_cache()}


def make(name, recipe):
    size, *patches = recipe.split()
    data = bytearray(GOOD.get(name.rsplit(".")[-1], good_hair()) + bytes(int(size)))[:int(size)]
    for place, value in (patch.split("=") for patch in patches if "=" in patch):
        at, width = map(int, place.split("/"))
        data[at:at + width] = int(value, 16).to_bytes(width, "little")
    if patches[-1:] == ["sealed"]:
        seal(data)
    return data


wrong = 0
for folder in "groom", "recording":
    for line in open(os.path.join(HERE, folder + ".txt"), encoding="utf-8"):
        if not line.startswith("#"):
            path, data = os.path.join(HERE, folder, line.split(": ")[0]), make(line.split(": ")[0], line.split("\t")[1])
            if sys.argv[1:] != ["check"]:
                open(path, "wb").write(data)
            elif open(path, "rb").read() != data:
                print(f"{path}: the file is not what make_bad_files.py writes")
                wrong = 1
sys.exit(wrong)
