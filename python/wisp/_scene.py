"""Scenes: from a file, from YAML text, or from a dict with arrays in it."""
from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple

import numpy as np
import numpy.typing as npt

from ._errors import BadInput, check, text
from ._library import Floats, Integers, Path, float_rows, integers, path_bytes, whole
from ._native import ffi, lib
from ._world import World

_MAX_VALUES = 16


@dataclass(frozen=True)
class Parameter:
    """A parameter that determines the accuracy of a scene, not its material."""

    name: str
    values: Tuple[float, ...]
    """From cheap and coarse to expensive and fine, unless unordered."""
    value: float
    """That of the scene."""
    unordered: bool
    """The last value, 0, turns the approximation off."""


class _Arrays(NamedTuple):
    """A mesh or strands in memory, and the name that the text has for them."""

    file: str
    points: Floats
    triangles: Optional[Integers]
    offsets: Optional[Integers]


class Scene:
    """A scene that was read and checked. Make one with from_file(), from_text() or from_dict(); it does not change.

    Scenes can be pickled and used by several threads.
    """

    def __init__(self, *arguments: Any, **named: Any) -> None:
        raise TypeError("make scenes with Scene.from_file(), Scene.from_text() or Scene.from_dict()")

    _handle: Any
    _content: bytes
    _arrays: Tuple[_Arrays, ...]

    name: str
    """What messages call it: the path of its file."""

    @classmethod
    def from_file(cls, path: Path) -> Scene:
        """Read a scene (YAML or JSON) from a file. Files that it names are relative to its folder, and read by create_world().

        Raises IoError, or BadInput whose message names file, line and column.
        """
        name = path_bytes(path)
        out, error = ffi.new("binding_scene**"), ffi.new("wisp_error*")
        check(lib.binding_scene_read(name, out, error), error)
        size = ffi.new("size_t*")
        content = lib.binding_scene_text(out[0], size)
        return cls._wrap(out[0], os.fsdecode(name), bytes(ffi.buffer(content, size[0])), ())

    @classmethod
    def from_text(cls, text: str, *, name: Path = "scene.yaml") -> Scene:
        """Read a scene from YAML or JSON.

        name: what messages call it; files that it names are relative to the folder of this path.
        """
        return cls._parse(text.encode("utf-8", "surrogateescape"), os.fsdecode(path_bytes(name)), ())

    @classmethod
    def from_dict(cls, scene: Mapping[str, Any], *, folder: Path = "") -> Scene:
        """Read a scene from a dict with the keys of docs/scenes.md. `wisp: 1` may be left out.

        Entries may have arrays in place of `file`:

        - surfaces and mesh colliders: `points` (vertices, 3) in m and `triangles` (count, 3), counter-clockwise seen from outside;
        - strands: `points` (strands, vertices, 3), or `points` (vertices, 3) and `offsets` (strands + 1), root first.

        They are copied. NumPy arrays and numbers may stand for any list and number.
        folder: what files that it names are relative to.
        """
        if not isinstance(scene, Mapping):
            raise BadInput(f"scene: got {type(scene).__name__}, expected a mapping")
        arrays: List[_Arrays] = []
        tree: Dict[Any, Any] = {"wisp": 1}
        tree.update(scene)
        for key in ("strands", "surfaces", "colliders"):
            if isinstance(tree.get(key), (list, tuple)):
                tree[key] = [_take_arrays(key, number, entry, arrays) for number, entry in enumerate(tree[key])]
        content = json.dumps(_plain(tree, "scene"), indent=1)
        return cls._parse(content.encode(), os.path.join(os.fsdecode(path_bytes(folder)), "scene"), tuple(arrays))

    @classmethod
    def _parse(cls, content: bytes, name: str, arrays: Tuple[_Arrays, ...]) -> Scene:
        out, error = ffi.new("binding_scene**"), ffi.new("wisp_error*")
        rows, kept = _c_arrays(arrays)
        status = lib.binding_scene_parse(content, len(content), os.fsencode(name), rows, len(arrays), out, error)
        del kept
        check(status, error)
        return cls._wrap(out[0], name, content, arrays)

    @classmethod
    def _wrap(cls, handle: Any, name: str, content: bytes, arrays: Tuple[_Arrays, ...]) -> Scene:
        self = object.__new__(cls)
        self._handle = ffi.gc(handle, lib.binding_scene_close)
        self._content = content
        self._arrays = arrays
        self.name = name
        return self

    def __reduce__(self) -> Tuple[Any, ...]:
        return (_scene_again, (self._content, self.name, self._arrays))

    def __repr__(self) -> str:
        return f"<wisp.Scene {self.name!r}>"

    @property
    def text(self) -> str:
        """The scene as text: that of the file, or the JSON of the dict, where arrays have names in quotes."""
        return self._content.decode("utf-8", "surrogateescape")

    @property
    def dt(self) -> float:
        """s, of a step"""
        return float(lib.binding_scene_dt(self._handle))

    @property
    def steps(self) -> int:
        """of the scene's own run"""
        return int(lib.binding_scene_steps(self._handle))

    @property
    def gravity(self) -> Tuple[float, float, float]:
        """m/s^2"""
        out = ffi.new("float[3]")
        lib.binding_scene_gravity(self._handle, out)
        return out[0], out[1], out[2]

    @property
    def parameters(self) -> Tuple[Parameter, ...]:
        """Parameters of accuracy, which are those of `wisp tune`. Empty where nothing moves in time."""
        return tuple(self._parameter(k) for k in range(lib.binding_parameter_count(self._handle)))

    def _parameter(self, k: int) -> Parameter:
        out = ffi.new("double[]", _MAX_VALUES)
        count = lib.binding_parameter_values(self._handle, k, out)
        return Parameter(
            text(lib.binding_parameter_name(self._handle, k)),
            tuple(out[0:count]),
            lib.binding_parameter_value(self._handle, k),
            lib.binding_parameter_is_unordered(self._handle, k),
        )

    def with_parameters(self, changes: Optional[Mapping[str, Any]] = None, /, **more: Any) -> Scene:
        """The same scene with other values: `scene.with_parameters({"surfaces[sheet].cloth.bending": "dihedral"}, substeps=5)`.

        A name of `parameters` means all bodies that have it; comments and order of the text stay.
        Any other name is a path to a field, as suites have it. An entry of a list is meant by its number, by its name, or all are by `*`.
        A path writes the text anew, without comments. None removes a field.
        Raises BadInput for a path that names nothing, and for what the scene's reader refuses.
        """
        wanted = {**(changes or {}), **more}
        values = []
        for parameter in self.parameters:
            is_number = isinstance(wanted.get(parameter.name), (int, float, np.number))
            values.append(float(wanted.pop(parameter.name)) if is_number else parameter.value)
        fields = json.dumps(_plain(wanted, self.name)).encode() if wanted else ffi.NULL
        out, size, error = ffi.new("char**"), ffi.new("size_t*"), ffi.new("wisp_error*")
        check(lib.binding_scene_edit(self._handle, values, fields, out, size, error), error)
        content = bytes(ffi.buffer(out[0], size[0]))
        lib.binding_free(out[0])
        return self._parse(content, self.name, self._arrays)

    def with_text(self, text: str) -> Scene:
        """Another text in place of this one, with the same name and arrays."""
        return self._parse(text.encode("utf-8", "surrogateescape"), self.name, self._arrays)

    def create_world(self, *, reference: bool = False, factor: int = 4, workers: int = 0, isa: Optional[str] = None) -> World:
        """Make a world of the scene, with the points of all shown bodies requested.

        reference: a finer twin, with the finest parameters and `factor` times their substeps; errors are told by Reference
        workers: 1 to 64 threads; 0: those of the scene, or one per core
        isa: "baseline", "avx2" or "avx512" limits the instruction set; the bits are the same
        """
        options = ffi.new("binding_options*")
        options.workers = whole(workers, "workers", 0, 64)
        options.reference_factor = whole(factor, "factor", 1, 64) if reference else 0
        name = ffi.new("char[]", isa.encode()) if isa is not None else ffi.NULL
        options.isa = name
        options.log = lib.wisp_python_log
        return World._open(self, self._handle, options)


def _scene_again(content: bytes, name: str, arrays: Tuple[_Arrays, ...]) -> Scene:
    return Scene._parse(content, name, arrays)


def _take_arrays(key: str, number: int, entry: Any, arrays: List[_Arrays]) -> Any:
    """Put the name of a mesh or of strands in place of its arrays."""
    at = f"{key}[{number}]"
    partner = "offsets" if key == "strands" else "triangles"
    if not isinstance(entry, Mapping) or not ("points" in entry or partner in entry):
        return entry
    rest = dict(entry)
    if "points" not in rest:
        raise BadInput(f"scene: {at}: got '{partner}' without 'points'")
    points = rest.pop("points")
    if key == "strands":
        rows, offsets = _strands(points, rest.pop("offsets", None), at)
        item = _Arrays(f"{at}.points", rows, None, offsets)
    else:
        if "triangles" not in rest:
            raise BadInput(f"scene: {at}: got 'points' without 'triangles'")
        triangles = integers(rest.pop("triangles"), f"scene: {at}.triangles")
        if triangles.ndim != 2 or triangles.shape[1] != 3:
            raise BadInput(f"scene: {at}.triangles: got shape {triangles.shape}, expected (count, 3)")
        item = _Arrays(f"{at}.points", float_rows(points, f"scene: {at}.points"), triangles, None)
    for other in ("file", "generate"):
        if other in rest:
            raise BadInput(f"scene: {at}: got both 'points' and '{other}', expected one of them")
    arrays.append(item)
    rest["file"] = item.file
    return rest


def _strands(points: Any, offsets: Any, at: str) -> Tuple[Floats, Integers]:
    array = np.asarray(points)
    if offsets is None:
        if array.ndim != 3:
            raise BadInput(f"scene: {at}.points: got shape {array.shape}, expected (strands, vertices, 3), or 'offsets' with it")
        offsets = np.arange(array.shape[0] + 1) * array.shape[1]
        array = array.reshape(-1, array.shape[2])
    ends = integers(offsets, f"scene: {at}.offsets")
    if ends.ndim != 1 or ends.size < 2:
        raise BadInput(f"scene: {at}.offsets: got shape {ends.shape}, expected (strands + 1,)")
    return float_rows(array, f"scene: {at}.points"), ends


def _plain(value: Any, at: str) -> Any:
    """A value of a scene as JSON knows it."""
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise BadInput(f"{at}: got the key {key!r}, expected a text")
        return {key: _plain(item, f"{at}.{key}") for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item, f"{at}[{number}]") for number, item in enumerate(value)]
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if value is None or isinstance(value, (str, int, float)):
        return value
    raise BadInput(f"{at}: got {type(value).__name__}, expected a number, a text, a list or a mapping")


def _c_arrays(arrays: Tuple[_Arrays, ...]) -> Tuple[Any, List[Any]]:
    """The arrays as C sees them, and what must live until C has copied them."""
    rows = ffi.new("wisp_scene_arrays[]", len(arrays))
    kept: List[Any] = []
    for row, item in zip(rows, arrays):
        name = ffi.new("char[]", item.file.encode())
        kept += [name, ffi.from_buffer("wisp_vec3[]", item.points)]
        row.file = name
        row.points = kept[-1]
        row.point_count = len(item.points)
        if item.triangles is not None:
            kept.append(ffi.from_buffer("int32_t[]", item.triangles))
            row.triangles = kept[-1]
            row.triangle_count = len(item.triangles)
        if item.offsets is not None:
            kept.append(ffi.from_buffer("int32_t[]", item.offsets))
            row.offsets = kept[-1]
            row.strand_count = len(item.offsets) - 1
    return rows, kept


def grid(columns: int, rows: int, spacing: float) -> Tuple[Floats, Integers]:
    """Points and triangles of a rectangle in y = 0 about the origin, as `generate: { shape: plane }` makes it.

    Vertex (i, j), the i-th along x and the j-th along z, has the number j * columns + i.
    """
    whole(columns, "columns", 2, 2**24)
    whole(rows, "rows", 2, 2**24 // columns)
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    points = np.zeros((columns * rows, 3), dtype=np.float32)
    edge = float(np.float32(spacing))  # as the reader of scenes takes it
    points[:, 0] = (i.ravel() - 0.5 * (columns - 1)) * edge
    points[:, 2] = (j.ravel() - 0.5 * (rows - 1)) * edge
    corner = (j[:-1, :-1] * columns + i[:-1, :-1]).ravel()
    quads = np.stack([corner, corner + columns, corner + columns + 1, corner, corner + columns + 1, corner + 1], axis=1)
    return points, quads.reshape(-1, 3).astype(np.int32)
