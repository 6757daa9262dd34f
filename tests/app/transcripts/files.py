"""What transcripts write and read: recordings of one mesh, and pictures of eight bits per channel."""
import array
import os
import re
import struct
import subprocess
import sys
import zlib

sys.path.insert(0, os.environ["SOURCE"] + "/tests/outputs")
import wisp_recording
from wisp_recording import checksum


def seal(data, seed=0):
    """Return the bytes with their checksum behind them."""
    return data + struct.pack("<Q", checksum(data, seed))


def record(path, frames, triangles, dt):
    """Write a .wisp recording of a mesh: x, y, z of its vertices in each frame."""
    count, corners = len(frames[0]) // 3, len(triangles)
    body = struct.pack("<4I8s", 0, 5, count, corners // 3, b"sheet") + array.array("i", triangles).tobytes()
    frame_bytes = 40 + 12 * count + 8
    header = seal(struct.pack("<8s2I2Qd", b"WISP\r\n\x1a\n", 1, 1, 40 + len(body) + 8, frame_bytes, dt) + body)
    seed = struct.unpack("<Q", header[-8:])[0]
    with open(path, "wb") as file:
        file.write(header)
        for i, points in enumerate(frames):
            head = struct.pack("<8s2QdQ", b"WISPFRAM", frame_bytes, i, i * dt, 0)
            file.write(seal(head + array.array("f", points).tobytes(), seed))
        file.write(seal(struct.pack("<8sQ", b"WISPEND\n", len(frames)), seed))


def write_hair(path, sizes, points, thickness=(), transparency=(), colours=()):
    """Write strands of so many vertices each: their x, y, z, and what there is of the other arrays."""
    arrays = [array.array("f", numbers).tobytes() for numbers in (points, thickness, transparency, colours)]
    flags = 1 + sum(2 << i for i, data in enumerate(arrays) if data)
    with open(path, "wb") as file:
        file.write(struct.pack("<4s3I", b"HAIR", len(sizes), len(points) // 3, flags) + bytes(112))
        file.write(struct.pack(f"<{len(sizes)}H", *[size - 1 for size in sizes]) + b"".join(arrays))


def change_frame(path, frame, change):
    """Change the bytes of a frame, of which `change` gets those before the checksum, and seal it."""
    data = bytearray(open(path, "rb").read())
    header, size = struct.unpack_from("<2Q", data, 16)
    at, seed = header + frame * size, struct.unpack_from("<Q", data, header - 8)[0]
    data[at:at + size] = seal(bytes(change(data[at:at + size - 8])), seed)
    open(path, "wb").write(data)


def hashes(path):
    """Return the hash of the world in each frame of a recording."""
    data = open(path, "rb").read()
    header, size = struct.unpack_from("<2Q", data, 16)
    return [struct.unpack_from("<Q", data, at + 32)[0] for at in range(header, len(data) - size + 1, size)]


class Picture:
    """A PNG file without interlacing."""

    def __init__(self, path):
        data = open(path, "rb").read()
        assert data[:8] == b"\x89PNG\r\n\x1a\n"
        at, packed = 8, b""
        while at < len(data):
            length, kind = struct.unpack_from(">I4s", data, at)
            chunk = data[at + 8:at + 8 + length]
            assert zlib.crc32(kind + chunk) == struct.unpack_from(">I", data, at + 8 + length)[0]
            if kind == b"IHDR":
                self.width, self.height, depth, colour, _, _, interlaced = struct.unpack(">2I5B", chunk)
                assert depth == 8 and colour in (2, 6) and interlaced == 0
                step = 3 if colour == 2 else 4
            packed += chunk if kind == b"IDAT" else b""
            at += 12 + length
        raw, row, self.rows = zlib.decompress(packed), bytes(step * self.width), []
        for y in range(self.height):
            start = y * (step * self.width + 1)
            row = unfilter(raw[start], raw[start + 1:start + 1 + step * self.width], row, step)
            self.rows.append([tuple(row[i:i + 3]) for i in range(0, len(row), step)])

    def pixels(self):
        return [pixel for row in self.rows for pixel in row]

    def body(self):
        """Return where the picture is unlike its corner: the background."""
        return [(x, y) for y in range(self.height) for x in range(self.width) if self.rows[y][x] != self.rows[0][0]]

    def is_edge_empty(self):
        return all(0 < x < self.width - 1 and 0 < y < self.height - 1 for x, y in self.body())


def unfilter(kind, line, above, step):
    out = bytearray(line)
    for i, value in enumerate(line):
        left, up, corner = out[i - step] if i >= step else 0, above[i], above[i - step] if i >= step else 0
        nearest = min((left, up, corner), key=lambda v: abs(left + up - corner - v))
        out[i] = value + (0, left, up, (left + up) // 2, nearest)[kind] & 255
    return out


def same(a, b):
    return Picture(a).rows == Picture(b).rows


def differing(a, b):
    return sum(p != q for p, q in zip(Picture(a).pixels(), Picture(b).pixels(), strict=True))


# ---- runs ----


class Body:
    """A body of a recording: `frames` has x, y, z of each vertex in each frame, `numbers` corners or offsets, `corners` those of each frame."""

    def __init__(self, body):
        self.numbers, self.corners = body.numbers, body.triangles
        self.frames = [list(zip(*[iter(frame)] * 3)) for frame in body.frames]

    def still(self):
        """Return the vertices that stay in the first step."""
        return [v for v, (a, b) in enumerate(zip(*self.frames[:2])) if a == b]


def run(text, *options):
    """Run a scene. Return its bodies by name, and what the program said."""
    open("scene.yaml", "w").write("wisp: 1\n" + text)
    done = subprocess.run([os.environ["WISP"], "run", "scene.yaml", "--record", "scene.wisp", *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return {body.name: Body(body) for body in wisp_recording.read("scene.wisp")[0]}, done.stdout + done.stderr


def hash_of(text):
    return re.search(r"\nhash +(\S+)", run(text)[1])[1]


def refused(text):
    """Return the message that refuses a scene, behind warnings and the name of the program."""
    open("scene.yaml", "w").write("wisp: 1\n" + text)
    done = subprocess.run([os.environ["WISP"], "run", "scene.yaml"], capture_output=True, text=True)
    assert done.returncode == 2 and done.stdout == "", (done.returncode, done.stderr)
    return done.stderr.splitlines()[-1].removeprefix("wisp: ")


def near(found, expected, tolerance):
    return all(abs(a - b) <= tolerance for a, b in zip(found, expected, strict=True))
