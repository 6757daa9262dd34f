"""Strict readers of recordings for other programs, written from the descriptions of the formats."""
import array
import base64
import json
import math
import re
import struct
import xml.etree.ElementTree as xml


def floats(numbers):
    """Return numbers, or bytes, in single precision."""
    return array.array("f", numbers)


def bits(numbers):
    return floats(numbers).tobytes()


def vectors(numbers):
    return [tuple(numbers[i:i + 3]) for i in range(0, len(numbers), 3)]


def bounds(points):
    return [list(map(choose, zip(*vectors(points)))) for choose in (min, max)]


def normals(points, corners):
    """Return unit normals weighted by area, None where the triangles of a vertex cancel."""
    at, sums = vectors(points), [[0.0] * 3 for _ in range(len(points) // 3)]
    for i, j, k in zip(corners[::3], corners[1::3], corners[2::3]):
        p, q = ([b - a for a, b in zip(at[i], at[end])] for end in (j, k))
        for v in i, j, k:
            for c in range(3):
                sums[v][c] += p[c - 2] * q[c - 1] - p[c - 1] * q[c - 2]
    return [[c / math.hypot(*n) for c in n] if any(n) else None for n in sums]


# ---- point caches ----


def read_pc2(path):
    """Return the samples of a point cache."""
    data = open(path, "rb").read()
    magic, version, points, start, rate, samples = struct.unpack_from("<12s2i2fi", data)
    assert (magic, version, start, rate) == (b"POINTCACHE2\0", 1, 0, 1) and len(data) == 32 + 12 * points * samples
    return [floats(data[at:at + 12 * points]) for at in range(32, len(data), 12 * points)]


# ---- ParaView ----

VECTORS = "Normals", "RGB"


def read_array(element, components):
    code = {"Float32": "f", "Int32": "i", "UInt8": "B"}[element.get("type")]
    data = base64.b64decode(element.text, validate=True)
    assert element.get("format") == "binary" and int(element.get("NumberOfComponents", 1)) == components
    assert struct.unpack_from("<Q", data) == (len(data) - 8,)
    return array.array(code, data[8:])


class Vtp:
    """A body in a frame."""

    def __init__(self, path):
        root = xml.parse(path).getroot()
        assert root.attrib == {"type": "PolyData", "version": "1.0", "byte_order": "LittleEndian", "header_type": "UInt64"}
        piece = root.find("PolyData/Piece")
        time = root.find("PolyData/FieldData/DataArray")
        self.time = None if time is None else float(time.text)
        self.roles = piece.find("PointData").attrib
        counts = {key: int(value) for key, value in piece.attrib.items()}
        self.values = {a.get("Name"): read_array(a, 3 if a.get("Name") in VECTORS else 1) for a in piece.find("PointData")}
        self.points = read_array(piece.find("Points/DataArray"), 3)
        kind = "Lines" if counts["NumberOfLines"] else "Polys"
        cells = {a.get("Name"): read_array(a, 1) for a in piece.find(kind)}
        ends = list(cells["offsets"])
        self.cells = [list(cells["connectivity"][a:b]) for a, b in zip([0] + ends, ends)]
        assert sum(map(len, self.cells)) == len(cells["connectivity"]) and 3 * counts["NumberOfPoints"] == len(self.points)
        assert counts == {"NumberOfPoints": len(self.points) // 3, "NumberOfVerts": 0, "NumberOfLines": 0, "NumberOfStrips": 0, "NumberOfPolys": 0,
                          "NumberOf" + kind: len(ends)}
        assert all(len(values) == len(self.points) // (1 if name in VECTORS else 3) for name, values in self.values.items())



def read_pvd(path):
    """Return (time, part, name, file) of each entry."""
    root = xml.parse(path).getroot()
    assert root.attrib == {"type": "Collection", "version": "0.1", "byte_order": "LittleEndian"}
    return [(float(e.get("timestep")), int(e.get("part")), e.get("name"), e.get("file")) for e in root.find("Collection")]


# ---- OBJ ----


def read_obj(path):
    """Return (name, points, elements) of each body; elements are numbers of its vertices from 0."""
    bodies, first, count = [], 1, 1
    for line in open(path).read().split("\n")[:-1]:
        word, *rest = line.split(" ")
        if word == "o":
            first = count
            bodies.append((rest[0], floats([]), []))
        elif word == "v":
            bodies[-1][1].extend(map(float, rest))
            count += 1
        elif word != "#":
            assert word == ("f" if len(rest) == 3 else "l")
            bodies[-1][2].append([int(number) - first for number in rest])
    return bodies


# ---- USD ----

TOKEN = re.compile(r'"[^"]*"|[A-Za-z_][\w:.]*(?:\[\])?|-?[\d.]+(?:e[+-]?\d+)?|[(){}\[\],:=]')


class Usda:
    """Metadata and prims of a text."""

    def __init__(self, path):
        text = open(path).read()
        assert text.startswith("#usda 1.0\n")
        self.tokens = TOKEN.findall(text, 10)
        assert re.sub(TOKEN, "", text[10:]).strip() == ""
        self.tokens.reverse()
        self.metadata = self.parentheses()
        [(self.name, self.type, self.own, self.prims)] = [self.prim()]
        assert self.tokens == []
        self.prims = {name: {"prim": kind, **attributes} for name, kind, attributes, inner in self.prims if inner == []}

    def take(self, *expected):
        token = self.tokens.pop()
        assert not expected or token in expected, (token, expected)
        return token

    def value(self):
        token = self.take()
        if token in "([{":
            values, end = [], ")]}"["([{".index(token)]
            while self.tokens[-1] != end:
                values.append(self.value())
                if token == "{":
                    self.take(":")
                    values[-1] = values[-1], self.value()
                if self.take(",", end) == end:
                    self.tokens.append(end)
            self.take(end)
            return dict(values) if token == "{" else tuple(values) if token == "(" else values
        return token[1:-1] if token[0] == '"' else float(token)

    def parentheses(self):
        found = {}
        self.take("(")
        while self.tokens[-1] != ")":
            name = self.take()
            self.take("=")
            assert name not in found
            found[name] = self.value()
        self.take(")")
        return found

    def prim(self):
        self.take("def")
        kind, name, attributes, inner = self.take(), self.take()[1:-1], {}, []
        self.take("{")
        while self.tokens[-1] != "}":
            if self.tokens[-1] == "def":
                inner.append(self.prim())
                assert inner[-1][0] not in [other[0] for other in inner[:-1]]
                continue
            type_name = [self.take()]
            if type_name == ["uniform"]:
                type_name.append(self.take())
            key = self.take()
            if self.tokens[-1] == "(":
                attributes[key + " as"] = self.parentheses()["interpolation"]
            if self.tokens[-1] == "=":
                self.take()
                assert key not in attributes
                attributes[key] = self.value()
                assert isinstance(attributes[key], (list, dict)) == ("[]" in type_name[-1])
                if self.tokens[-1] == "(":
                    attributes[key + " as"] = self.parentheses()["interpolation"]
        self.take("}")
        return name, kind, attributes, inner


def flat(value):
    """Return the numbers of a list of vectors in single precision."""
    return floats([number for vector in value for number in vector])


# ---- glTF ----


def once(pairs):
    assert len(pairs) == len({key for key, _ in pairs})
    return dict(pairs)


class Glb:
    """Chunks, accessors and bodies. Every accessor is read once, and together they fill the binary part."""

    def __init__(self, path):
        data = open(path, "rb").read()
        magic, version, size, length, kind = struct.unpack_from("<4s3I4s", data)
        assert (magic, version, size, kind, length % 4) == (b"glTF", 2, len(data), b"JSON", 0)
        self.json = json.loads(data[20:20 + length], object_pairs_hook=once, parse_constant=lambda word: 1 / 0)
        at = 20 + length
        length, kind = struct.unpack_from("<I4s", data, at)
        assert (kind, length % 4, at + 8 + length) == (b"BIN\0", 0, len(data))
        self.binary, self.read = data[at + 8:], []
        assert self.json["buffers"] == [{"byteLength": length}]

    def accessor(self, index, kind, code, target):
        a = self.json["accessors"][index]
        view = self.json["bufferViews"][a["bufferView"]]
        at, size = a.get("byteOffset", 0), a["count"] * (12 if kind == "VEC3" else 4)
        assert (a["type"], a["componentType"], at % 4, view["buffer"]) == (kind, {"f": 5126, "I": 5125}[code], 0, 0)
        assert (view.get("target"), view.get("byteStride")) == (target, 12 if target == 34962 else None)
        assert at + size <= view["byteLength"] and view["byteOffset"] + view["byteLength"] <= len(self.binary)
        at += view["byteOffset"]
        self.read.append((at, at + size, index))
        numbers = array.array(code, self.binary[at:at + size])
        if "min" in a:
            exact = bounds(numbers) if kind == "VEC3" else [[min(numbers)], [max(numbers)]]
            assert [floats(a["min"]), floats(a["max"])] == [floats(exact[0]), floats(exact[1])]
        return numbers

    def body(self, number):
        """Return the primitive of a body with its accessors read: attributes, targets, indices."""
        mesh = self.json["meshes"][number]
        assert self.json["nodes"][number]["mesh"] == number and self.json["nodes"][number]["name"] == mesh["name"]
        [p] = mesh["primitives"]
        for table in [p["attributes"], *p.get("targets", [])]:
            assert "min" in self.json["accessors"][table["POSITION"]]
            table.update({key: self.accessor(index, "VEC3", "f", 34962) for key, index in table.items()})
        if "indices" in p:
            p["indices"] = list(self.accessor(p["indices"], "SCALAR", "I", 34963))
        p["names"] = mesh.get("extras", {}).get("targetNames", [])
        return p

    def animation(self):
        """Return the times and the weights of each frame."""
        [animation] = self.json["animations"]
        [sampler] = animation["samplers"]
        assert sampler["interpolation"] == "LINEAR" and "min" in self.json["accessors"][sampler["input"]]
        moved = [number for number, mesh in enumerate(self.json["meshes"]) if "targets" in mesh["primitives"][0]]
        assert animation["channels"] == [{"sampler": 0, "target": {"node": number, "path": "weights"}} for number in moved]
        times = self.accessor(sampler["input"], "SCALAR", "f", None)
        weights = self.accessor(sampler["output"], "SCALAR", "f", None)
        count = len(weights) // len(times)
        return times, [list(weights[i:i + count]) for i in range(0, len(weights), count)]

    def is_filled(self):
        parts = sorted(self.read)
        return (sorted(part[2] for part in parts) == list(range(len(self.json["accessors"]))) and parts[0][0] == 0 and
                parts[-1][1] == len(self.binary) and all(a[1] == b[0] for a, b in zip(parts, parts[1:])))
