"""A .wisp recording, read from the description of the format in app/io/record_wisp.c."""
import array
import struct
import sys


def checksum(data, seed=0):
    """Return the checksum of app/io/record_wisp.c."""
    mask = 2**64 - 1
    value = seed ^ (len(data) * 0x9E3779B97F4A7C15 & mask)
    for word, in struct.iter_unpack("<Q", data + bytes(-len(data) % 8)):
        value = (value ^ word) * 0xFF51AFD7ED558CCD & mask
        value ^= value >> 32
    return value


class Body:
    def __init__(self, kind, name, vertices, numbers):
        self.is_strands = kind == 1
        self.name = name
        self.vertices = vertices
        self.numbers = numbers  # corners of triangles, or offsets of strands
        self.triangles = [] if kind == 2 else None  # corners in each frame, where they change
        self.frames = []  # an array of 3 * vertices floats each


def read(path):
    """Return the bodies and the times of a recording."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"WISP\r\n\x1a\n" and sys.byteorder == "little"
    version, body_count, header_bytes, frame_bytes = struct.unpack_from("<2I2Q", data, 8)
    bodies, at = [], 40 if version == 1 else 64  # behind an origin, to which points are relative
    for _ in range(body_count):
        kind, letters, vertices, elements = struct.unpack_from("<4I", data, at)
        name = data[at + 16:at + 16 + letters].decode()
        at += 16 + (letters + 3) // 4 * 4
        count = elements + 1 if kind == 1 else 3 * elements
        bodies.append(Body(kind, name, vertices, struct.unpack_from(f"<{count}i", data, at)))
        at += 4 * count
    times = []
    for start in range(header_bytes, len(data) - frame_bytes + 1, frame_bytes):
        assert data[start:start + 8] == b"WISPFRAM"
        times.append(struct.unpack_from("<d", data, start + 24)[0])
        at = start + 40
        for body in bodies:
            size = 12 * body.vertices
            body.frames.append(array.array("f", data[at:at + size]))
            at += size
            if body.triangles is not None:
                body.triangles.append(struct.unpack_from(f"<{len(body.numbers)}i", data, at))
                at += 4 * len(body.numbers)
    return bodies, times
