"""Recordings: frames of .wisp files by number."""
from __future__ import annotations

import os
import threading
from types import TracebackType
from typing import Any, NoReturn, Optional, Tuple, Type, Union

from ._bodies import Body
from ._errors import BadInput, Conflict, check, text
from ._library import Floats, Integers, Path, path_bytes, view, whole
from ._native import ffi, lib


class Recording:
    """A .wisp file, opened at its first frame. `with` closes it.

    Arrays of points are read-only views, which seek() refreshes, and which stay valid after close().
    """

    def __init__(self, path: Path) -> None:
        name = path_bytes(path)
        out, error = ffi.new("binding_recording**"), ffi.new("wisp_error*")
        check(lib.binding_recording_open(name, out, error), error)
        self._handle = ffi.gc(out[0], lib.binding_recording_close)
        self._lock = threading.Lock()
        self.path = os.fsdecode(name)
        self.frame_count = int(lib.binding_recording_frames(self._handle))
        self.dt = float(lib.binding_recording_dt(self._handle))
        """s, between two frames"""
        self.is_complete = bool(lib.binding_recording_is_complete(self._handle))
        """False: the file was cut off."""
        self.bodies = tuple(_describe(self._handle, index) for index in range(lib.binding_recording_bodies(self._handle)))
        self.frame = 0
        self.seek(0)

    def close(self) -> None:
        self._handle = None

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        raise TypeError("a recording cannot be copied or pickled: open its file again")

    def _open(self) -> Any:
        if self._handle is None:
            raise Conflict("the recording is closed")
        return self._handle

    def _index(self, body: Union[Body, str]) -> int:
        name = body.name if isinstance(body, Body) else body
        for own in self.bodies:
            if own.name == name:
                return own.index
        raise BadInput(f"{self.path}: got body {name!r}, expected one of {', '.join(own.name for own in self.bodies)}")

    def seek(self, frame: int) -> None:
        """Read a frame. Raises BadInput if it does not exist or is damaged."""
        number = whole(frame, "frame", 0, self.frame_count - 1)
        error = ffi.new("wisp_error*")
        with self._lock:
            check(lib.binding_recording_seek(self._open(), number, error), error)
            self.frame = number

    @property
    def time(self) -> float:
        """s, of the frame"""
        return float(lib.binding_recording_time(self._open()))

    def hash(self) -> str:
        """That the run had after this frame, 0s if the file has none."""
        return f"{lib.binding_recording_hash(self._open()):016x}"

    def points(self, body: Union[Body, str]) -> Floats:
        """m, (vertices, 3), of the frame"""
        own, handle = self.bodies[self._index(body)], self._open()
        array: Floats = view(handle, lib.binding_recording_points(handle, own.index), (own.vertex_count, 3), "<f4")
        return array

    def triangles(self, body: Union[Body, str]) -> Integers:
        """(triangles, 3) vertices of a surface"""
        own = self.bodies[self._index(body)]
        return self._topology(lib.binding_recording_triangles, own, (own.triangle_count, 3), "triangles")

    def offsets(self, body: Union[Body, str]) -> Integers:
        """(strands + 1,) first vertex of each strand"""
        own = self.bodies[self._index(body)]
        return self._topology(lib.binding_recording_offsets, own, (own.strand_count + 1,), "strands")

    def _topology(self, function: Any, body: Body, shape: Tuple[int, ...], what: str) -> Integers:
        handle = self._open()
        pointer = function(handle, body.index)
        if not pointer:
            raise BadInput(f"{self.path}: '{body.name}' has no {what}")
        array: Integers = view(handle, pointer, shape, "<i4")
        return array


def _describe(handle: Any, index: int) -> Body:
    strand_count = lib.binding_recording_strands(handle, index)
    return Body(
        index=index,
        name=text(lib.binding_recording_name(handle, index)),
        kind="strands" if strand_count > 0 else "cloth",
        vertex_count=lib.binding_recording_vertices(handle, index),
        triangle_count=lib.binding_recording_triangle_count(handle, index),
        strand_count=strand_count,
        moves=True,
    )
