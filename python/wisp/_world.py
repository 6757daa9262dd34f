"""Worlds: steps, values as arrays, input, costs, snapshots, recorders."""
from __future__ import annotations

import threading
import weakref
from types import TracebackType
from typing import TYPE_CHECKING, Any, Callable, Dict, List, NoReturn, Optional, Tuple, Type, Union

import numpy.typing as npt

from ._bodies import KINDS, VALUES, Body, FrozenHair, MemoryPart, MotionStats, PassTime, Vector
from ._errors import BadInput, Conflict, check, text
from ._library import Floats, Integers, Path, float_rows, integers, path_bytes, raise_kept, vector, view, whole
from ._native import ffi, lib

if TYPE_CHECKING:
    from ._scene import Scene

import numpy as np

_MEMORY_KINDS = {
    lib.WISP_MEMORY_ENGINE: "engine",
    lib.WISP_MEMORY_MODULE: "module",
    lib.WISP_MEMORY_COMPONENT: "component",
    lib.WISP_MEMORY_OUTSIDE: "outside",
}

BodyOrName = Union[Body, str]


class World:
    """A world of a scene. Scene.create_world() makes one; `with` closes it.

    Arrays of values are read-only views of the engine's memory, in the order of the scene's vertices. Each step refreshes them.
    They keep the memory, also after close() and when the world is gone: an array never shows memory that was freed. Where the
    engine has no memory of a value the array is a copy, which nothing refreshes: before the first step, of colliders, and of points
    that advance() has interpolated.

    One thread at a time may use a world; a second one gets Conflict. Steps run without the GIL.
    """

    def __init__(self, *arguments: Any, **named: Any) -> None:
        raise TypeError("make worlds with Scene.create_world()")

    _handle: Any
    _owner: Dict[str, int]  # the thread that uses the world; empty: none
    _in_call: bool
    _recorders: List[Recorder]
    _by_name: Dict[str, Body]

    scene: Scene
    """What the world was made of."""
    bodies: Tuple[Body, ...]
    """Strands, then surfaces, then colliders, each in the order of the scene."""

    @classmethod
    def _open(cls, scene: Scene, handle: Any, options: Any) -> World:
        out, error = ffi.new("binding_world**"), ffi.new("wisp_error*")
        status = lib.binding_world_open(handle, options, out, error)
        self = object.__new__(cls)
        self._handle = ffi.gc(out[0], lib.binding_world_close) if out[0] else None
        raise_kept()
        check(status, error)
        self._owner = {}
        self._in_call = False
        self._recorders = []
        self.scene = scene
        self.bodies = tuple(_describe(self._handle, index) for index in range(lib.binding_body_count(self._handle)))
        self._by_name = {body.name: body for body in self.bodies}
        return self

    # ---- life ----

    def close(self) -> None:
        """Finish its recorders and free it. Arrays that are still there keep what they show, and the memory. Again: nothing."""
        if self._handle is None:
            return
        self._enter()
        try:
            failure: Optional[BaseException] = None
            for recorder in list(self._recorders):
                try:
                    recorder._finish()
                except Exception as error:  # the others are finished all the same
                    failure = failure or error
            self._handle = None
        finally:
            self._in_call = False
            self._leave()
        if failure is not None:
            raise failure

    @property
    def closed(self) -> bool:
        return self._handle is None

    def __enter__(self) -> World:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        raise TypeError("a world cannot be copied or pickled: its state is in the engine. Use snapshot() and restore(), or pickle its scene")

    def __repr__(self) -> str:
        state = "closed" if self._handle is None else f"step {lib.binding_world_step_count(self._handle)}"
        return f"<wisp.World of {self.scene.name!r}, {state}>"

    # ---- calls ----

    # An interrupt from the keyboard may come at any call of Python, and at no assignment. After one the world may be left to this thread,
    # which may go on; a lock would be left taken for ever. So _in_call is false before anything else is called.
    def _enter(self) -> Any:
        """Take the world for a call, which the caller ends with _leave()."""
        thread = threading.get_ident()
        if self._owner.setdefault("thread", thread) != thread or self._in_call:
            raise Conflict("the world is in use: another thread, or a message that a call has logged, called it")
        handle = self._handle
        if handle is None:
            self._leave()
            raise Conflict("the world is closed")
        self._in_call = True
        return handle

    def _leave(self) -> None:
        self._owner.clear()

    def _call(self, function: Any, *arguments: Any) -> None:
        """Call what returns a status."""
        error = ffi.new("wisp_error*")
        handle = self._enter()
        try:
            status = function(handle, *arguments, error)
        finally:
            self._in_call = False
            self._leave()
        raise_kept()
        check(status, error)

    def _get(self, function: Any, *arguments: Any) -> Any:
        """Call what cannot fail."""
        handle = self._enter()
        try:
            return function(handle, *arguments)
        finally:
            self._in_call = False
            self._leave()

    def body(self, name: BodyOrName) -> Body:
        """The body of a name."""
        key = name.name if isinstance(name, Body) else name
        own = self._by_name.get(key) if isinstance(key, str) else None
        if own is None or (isinstance(name, Body) and own.index != name.index):
            raise BadInput(f"{self.scene.name}: got body {key!r}, expected one of {', '.join(self._by_name) or 'none'}")
        return own

    # ---- steps ----

    def step(self) -> None:
        """Make a step of the scene, with its events, and a frame of each recorder."""
        error = ffi.new("wisp_error*")
        handle = self._enter()
        try:
            status = lib.binding_world_step(handle, error)
            for recorder in self._recorders:
                if status == lib.WISP_OK:
                    status = recorder._frame(error)
        finally:
            self._in_call = False
            self._leave()
        raise_kept()
        check(status, error)

    def run(self, steps: Optional[int] = None, callback: Optional[Callable[[World], Optional[bool]]] = None) -> int:
        """Make steps; by default those of the scene that are still to come.

        callback: called after each step with the world. False ends the run; an exception ends it and is passed on, as is an interrupt
        from the keyboard. The steps before it were made.
        Returns the number of steps that were made.
        """
        left = max(self.scene.steps - self.step_count, 0) if steps is None else whole(steps, "steps", 0, 2**31 - 1)
        for made in range(left):
            self.step()
            if callback is not None and callback(self) is False:
                return made + 1
        return left

    def advance(self, seconds: float) -> int:
        """Advance by the time of a frame, in steps of the scene. Time that is no whole step is kept for the next call.

        Afterwards points() are copies, interpolated between the last two steps: smooth, and one step late. Other values are of the
        last step. At most eight steps are made, and the rest is dropped. Returns the number of steps.
        """
        if self._recorders:
            raise Conflict("advance: a recorder is open, and records whole steps")
        before = self.step_count
        self._call(lib.binding_world_advance, seconds)
        return self.step_count - before

    @property
    def step_count(self) -> int:
        return int(self._get(lib.binding_world_step_count))

    @property
    def time(self) -> float:
        """s, of all steps so far"""
        return float(self._get(lib.binding_world_time))

    def hash(self) -> str:
        """64 bits of the whole state in hexadecimal, as `wisp run` prints them."""
        return f"{self._get(lib.binding_world_hash):016x}"

    @property
    def workers(self) -> int:
        return int(self._get(lib.binding_world_workers))

    @property
    def isa(self) -> str:
        """baseline, avx2 or avx512"""
        return text(self._get(lib.binding_world_isa))

    def write_outputs(self) -> None:
        """Write the files of the scene's `output`, as `wisp run` does after the last step."""
        self._call(lib.binding_world_write_outputs)

    # ---- values ----

    def request(self, body: BodyOrName, value: str) -> None:
        """Compute a value from the next step on: points, normals, strain, speed, width, colour or motion_stats.

        Points of shown bodies always are. What the scene does not compute changes the hash.
        """
        own = self._with_value(body, value)
        self._call(lib.binding_request, own.index, VALUES[value])

    def _with_value(self, body: BodyOrName, value: str) -> Body:
        own = self.body(body)
        if value not in VALUES:
            raise BadInput(f"got value {value!r}, expected one of {', '.join(VALUES)}")
        if value not in own.has:
            raise BadInput(f"{self.scene.name}: '{own.name}' has no value '{value}'")
        return own

    def _values(self, body: BodyOrName, name: str) -> Floats:
        own = self.body(body) if name == "points" else self._with_value(body, name)
        value = VALUES[name]
        width = lib.binding_value_width(value)
        shape = (own.vertex_count, width) if width > 1 else (own.vertex_count,)
        error = ffi.new("wisp_error*")
        handle = self._enter()
        try:
            if lib.binding_value_is_live(handle, own.index, value):
                out = ffi.new("float**")
                status = lib.binding_value_view(handle, own.index, value, out, error)
                array: Any = view(handle, out[0], shape, "<f4") if status == lib.WISP_OK else None
            else:
                array = np.empty(shape, dtype=np.float32)
                status = lib.binding_value_copy(handle, own.index, value, ffi.from_buffer("float[]", array), error)
                array.flags.writeable = False
        finally:
            self._in_call = False
            self._leave()
        check(status, error)
        result: Floats = array
        return result

    def points(self, body: BodyOrName) -> Floats:
        """m, (vertices, 3). Before the first step a copy of the start; of colliders a copy of where they are."""
        return self._values(body, "points")

    def normals(self, body: BodyOrName) -> Floats:
        """Unit vectors, (vertices, 3), of surfaces."""
        return self._values(body, "normals")

    def colour(self, body: BodyOrName) -> Floats:
        """Linear red, green and blue, (vertices, 3), of strands with an appearance."""
        return self._values(body, "colour")

    def strain(self, body: BodyOrName) -> Floats:
        """Largest |l/l0 - 1| at a vertex, (vertices,)."""
        return self._values(body, "strain")

    def speed(self, body: BodyOrName) -> Floats:
        """m/s, (vertices,)"""
        return self._values(body, "speed")

    def width(self, body: BodyOrName) -> Floats:
        """m, diameter of a strand, (vertices,)"""
        return self._values(body, "width")

    def triangles(self, body: BodyOrName) -> Integers:
        """(triangles, 3) vertices, counter-clockwise seen from outside, of surfaces and colliders."""
        own = self.body(body)
        if own.kind == "strands":
            raise BadInput(f"{self.scene.name}: '{own.name}' has no triangles")
        return self._topology(lib.binding_body_triangles, own, (own.triangle_count, 3))

    def offsets(self, body: BodyOrName) -> Integers:
        """(strands + 1,) first vertex of each strand, root first: strand s has the vertices offsets[s] to offsets[s + 1] - 1."""
        own = self.body(body)
        if own.kind != "strands":
            raise BadInput(f"{self.scene.name}: '{own.name}' has no strands")
        return self._topology(lib.binding_body_offsets, own, (own.strand_count + 1,))

    def _topology(self, function: Any, body: Body, shape: Tuple[int, ...]) -> Integers:
        handle = self._enter()
        try:
            array: Integers = view(handle, function(handle, body.index), shape, "<i4")
            return array
        finally:
            self._in_call = False
            self._leave()

    def motion_stats(self, body: BodyOrName) -> MotionStats:
        """Raises Conflict unless they are computed and a step was made."""
        own = self._with_value(body, "motion_stats")
        if self.step_count == 0:
            raise Conflict(f"{self.scene.name}: '{own.name}': motion stats exist after the first step")
        m = ffi.new("wisp_motion_stats*")
        self._call(lib.binding_motion_stats, own.index, m)
        return MotionStats(
            m.mass, _three(m.centre), _three(m.momentum), _three(m.angular_momentum), m.kinetic_energy, m.potential_energy, m.volume,
            m.strain_max, m.strain_mean, m.speed_max,
        )

    def is_halted(self, body: BodyOrName) -> bool:
        """Whether its state was not finite or left its bounds: steps leave the body out since then."""
        return bool(self._get(lib.binding_body_is_halted, self.body(body).index))

    def resume(self, body: BodyOrName) -> None:
        """Let steps move a halted body again, from its last valid state."""
        self._call(lib.binding_body_resume, self.body(body).index)

    # ---- costs ----

    @property
    def step_seconds(self) -> float:
        """s of wall time, of the last step"""
        return float(self._get(lib.binding_step_seconds))

    def profile(self) -> List[PassTime]:
        """Passes of the last step and their times, in the order of the plan."""
        handle = self._enter()
        try:
            return [
                PassTime(text(lib.binding_profile_pass(handle, line)), lib.binding_profile_seconds(handle, line))
                for line in range(lib.binding_profile_count(handle))
            ]
        finally:
            self._in_call = False
            self._leave()

    def counters(self) -> Dict[str, int]:
        """Numerical failures, limits reached and work done, without those that are 0."""
        handle = self._enter()
        try:
            counts = {text(lib.binding_counter_name(k)): lib.binding_counter(handle, k) for k in range(lib.binding_counter_count())}
        finally:
            self._in_call = False
            self._leave()
        return {name: count for name, count in counts.items() if count > 0}

    @property
    def memory_bytes(self) -> int:
        """Of the world and of the fabrics of its surfaces."""
        return int(self._get(lib.binding_memory_bytes))

    def memory(self) -> List[MemoryPart]:
        """Where the memory of the world goes."""
        handle = self._enter()
        try:
            count = lib.binding_memory_parts(handle, ffi.NULL, 0)
            parts = ffi.new("wisp_memory_part[]", count)
            lib.binding_memory_parts(handle, parts, count)
            return [MemoryPart(text(p.name), _MEMORY_KINDS.get(p.kind, "other"), p.bytes, p.capacity) for p in parts]
        finally:
            self._in_call = False
            self._leave()

    # ---- input, from the next step on ----

    def pin(self, body: BodyOrName, vertices: npt.ArrayLike) -> None:
        """Pin vertices of a surface where they are."""
        rows = _vertices(vertices)
        self._call(lib.binding_pin, self.body(body).index, ffi.from_buffer("int32_t[]", rows), len(rows))

    def unpin(self, body: BodyOrName, vertices: npt.ArrayLike) -> None:
        """Release pinned vertices of a surface."""
        rows = _vertices(vertices)
        self._call(lib.binding_unpin, self.body(body).index, ffi.from_buffer("int32_t[]", rows), len(rows))

    def move_pins(self, body: BodyOrName, vertices: npt.ArrayLike, targets: npt.ArrayLike) -> None:
        """Have pinned vertices reach their targets, (count, 3) m, at the end of the next step.

        Raises Conflict if the scene's keyframes move them, BadInput if a vertex is not pinned.
        """
        rows, places = _vertices(vertices), float_rows(targets, "targets")
        if len(rows) != len(places):
            raise BadInput(f"targets: got {len(places)} for {len(rows)} vertices")
        self._call(
            lib.binding_move_pins, self.body(body).index, ffi.from_buffer("int32_t[]", rows), ffi.from_buffer("float[]", places), len(rows)
        )

    def grab(self, body: BodyOrName, vertex: int) -> None:
        """Take hold of a vertex: of a surface it is pinned, of strands their head comes along. Raises Conflict if it cannot be dragged."""
        self._call(lib.binding_grab, self.body(body).index, whole(vertex, "vertex", 0, 2**31 - 1))

    def drag(self, body: BodyOrName, vertex: int, target: npt.ArrayLike) -> None:
        """Where a held vertex is at the end of the next step, m."""
        self._call(lib.binding_drag, self.body(body).index, whole(vertex, "vertex", 0, 2**31 - 1), *vector(target, "target"))

    def let_go(self, body: BodyOrName, vertex: int) -> None:
        """Free a held vertex, unless the scene pins it. A head stays where it is."""
        self._call(lib.binding_let_go, self.body(body).index, whole(vertex, "vertex", 0, 2**31 - 1))

    def collider_place(self, body: BodyOrName) -> Vector:
        """m, where a collider's own origin is"""
        out = ffi.new("float[3]")
        self._call(lib.binding_collider_place, self.body(body).index, out)
        return out[0], out[1], out[2]

    def move_collider(self, body: BodyOrName, place: npt.ArrayLike) -> None:
        """Where a collider is at the end of the next step, m. Raises Conflict if keyframes move it."""
        self._call(lib.binding_move_collider, self.body(body).index, *vector(place, "place"))

    def set_gravity(self, gravity: npt.ArrayLike) -> None:
        """Of all that moves, m/s^2."""
        self._call(lib.binding_set_gravity, *vector(gravity, "gravity"))

    def set_wind(self, wind: npt.ArrayLike) -> bool:
        """Of cloth and strands that move, m/s; those without drag get it. Returns whether anything feels it."""
        felt = ffi.new("int*")
        self._call(lib.binding_set_wind, *vector(wind, "wind"), felt)
        return bool(felt[0] > 0)

    # ---- frozen hair ----

    def frozen_hair(self, body: BodyOrName) -> FrozenHair:
        """Parameters of frozen hair (`is_frozen_hair`)."""
        out = ffi.new("binding_hair*")
        self._call(lib.binding_hair_read, self.body(body).index, out)
        return FrozenHair(
            out.intensity, out.reach, out.stretch_stiffness, out.bend_stiffness, out.clump_radius, out.freezes, out.aligns, out.clumps,
            out.temperature_celsius, out.wetness,
        )

    def set_frozen_hair(self, body: BodyOrName, *, intensity: Optional[float] = None, reach: Optional[float] = None,
                        stretch_stiffness: Optional[float] = None, bend_stiffness: Optional[float] = None,
                        clump_radius: Optional[float] = None) -> None:
        """Other parameters from the next step on. One number replaces a value for each strand."""
        now = self.frozen_hair(body)
        hair = ffi.new("binding_hair*")
        hair.intensity = now.intensity if intensity is None else intensity
        hair.reach = now.reach if reach is None else reach
        hair.stretch_stiffness = now.stretch_stiffness if stretch_stiffness is None else stretch_stiffness
        hair.bend_stiffness = now.bend_stiffness if bend_stiffness is None else bend_stiffness
        hair.clump_radius = now.clump_radius if clump_radius is None else clump_radius
        self._call(lib.binding_hair_set, self.body(body).index, hair)

    def command_frozen_hair(self, body: BodyOrName, cursor: npt.ArrayLike) -> None:
        """The next step updates the strands, those within reach towards a point, m. The scene's own hair events are over then."""
        self._call(lib.binding_hair_command, self.body(body).index, *vector(cursor, "cursor"))

    def begin_stroke(self, body: BodyOrName) -> None:
        """Forget what commands have done, where strokes add up (`base: stroke`)."""
        self._call(lib.binding_hair_begin_stroke, self.body(body).index)

    def climate_stiffness(self, body: BodyOrName, temperature: float, wetness: float) -> float:
        """Stiffness that a climate gives strands, by the scene's curve or the default one.

        temperature: degrees Celsius
        wetness: 0 to 1
        """
        out = ffi.new("double*")
        self._call(lib.binding_hair_climate_stiffness, self.body(body).index, temperature, wetness, out)
        return float(out[0])

    # ---- snapshots ----

    def snapshot(self) -> bytes:
        """State and step count, for restore() of a world of the same scene. Gravity, wind and dragged heads are not part of it.

        It fits worlds with the same components. The first move_pins(), drag() or move_collider(), wind on cloth without air, and gravity
        that becomes zero add or remove one: make those calls before.
        """
        error = ffi.new("wisp_error*")
        handle = self._enter()
        try:
            size = ffi.new("size_t*")
            status = lib.binding_snapshot_prepare(handle, size, error)
            buffer = bytearray(size[0])
            if status == lib.WISP_OK:
                status = lib.binding_snapshot(handle, ffi.from_buffer(buffer), len(buffer), error)
        finally:
            self._in_call = False
            self._leave()
        check(status, error)
        return bytes(buffer)

    def restore(self, snapshot: Union[bytes, bytearray, memoryview]) -> None:
        """Raises BadInput if the bytes are no snapshot of this world; nothing has changed then. A recorder must not be open."""
        if self._recorders:
            raise Conflict("restore: a recorder is open, and its time cannot go back")
        content = ffi.from_buffer(snapshot)
        self._call(lib.binding_restore, content, len(content))

    # ---- recorders ----

    def record(self, path: Path, *, every: int = 1) -> Recorder:
        """Record all bodies but planes: a frame now, and one after every `every`-th step, until the recorder or the world is closed.

        The extension selects the format: .wisp, .pc2, .pvd (with .vtp files), .obj, .usda or .glb (docs/outputs.md).
        Points that the scene does not compute change the hash.
        """
        return Recorder._open(self, path, whole(every, "every", 1, 2**31 - 1))


class Recorder:
    """A recording that is being written. World.record() makes one; `with` closes it, which finishes the files."""

    def __init__(self, *arguments: Any, **named: Any) -> None:
        raise TypeError("make recorders with World.record()")

    _handle: Any
    _world: weakref.ReferenceType[World]
    _count: int
    path: Path

    @classmethod
    def _open(cls, world: World, path: Path, every: int) -> Recorder:
        self = object.__new__(cls)
        self.path = path
        out, error = ffi.new("binding_recorder**"), ffi.new("wisp_error*")
        name = path_bytes(path)
        handle = world._enter()
        try:
            status = lib.binding_recorder_open(handle, name, every, out, error)
            if status == lib.WISP_OK:
                # The world's memory must outlive the recorder, whichever Python frees first.
                self._handle = ffi.gc(out[0], lambda pointer, world=handle: lib.binding_recorder_close(pointer, ffi.NULL))
                self._world = weakref.ref(world)
                self._count = 0
                world._recorders.append(self)
                status = self._frame(error)
                if status != lib.WISP_OK:
                    world._recorders.remove(self)
        finally:
            world._in_call = False
            world._leave()
        check(status, error)
        return self

    def _frame(self, error: Any) -> int:
        return int(lib.binding_recorder_step(self._handle, error))

    def _finish(self) -> None:
        """The caller has entered the world."""
        world = self._world()
        handle, self._handle = self._handle, None
        if world is not None:
            world._recorders.remove(self)
        self._count = lib.binding_recorder_frames(handle)
        error = ffi.new("wisp_error*")
        ffi.gc(handle, None)
        status = lib.binding_recorder_close(handle, error)
        check(status, error)

    @property
    def frames(self) -> int:
        """Frames that were written."""
        return int(self._count if self._handle is None else lib.binding_recorder_frames(self._handle))

    def close(self) -> None:
        """Finish the files. Raises IoError if one could not be written: the old file, if there was one, is unchanged. Again: nothing."""
        world = self._world()
        if self._handle is None:
            return
        if world is None:
            self._finish()
            return
        world._enter()
        try:
            self._finish()
        finally:
            world._in_call = False
            world._leave()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        raise TypeError("a recorder cannot be copied or pickled")


def _three(values: Any) -> Vector:
    return values[0], values[1], values[2]


def _vertices(vertices: npt.ArrayLike) -> Integers:
    rows = integers(vertices, "vertices")
    if rows.ndim != 1:
        raise BadInput(f"vertices: got shape {rows.shape}, expected (count,)")
    return rows


def _describe(handle: Any, index: int) -> Body:
    kind = KINDS[lib.binding_body_kind(handle, index)]
    return Body(
        index=index,
        name=text(lib.binding_body_name(handle, index)),
        kind=kind,
        vertex_count=lib.binding_body_vertices(handle, index),
        triangle_count=lib.binding_body_triangle_count(handle, index),
        strand_count=lib.binding_body_strands(handle, index),
        moves=kind not in ("collider", "plane"),
        hidden=not lib.binding_body_is_shown(handle, index),
        is_frozen_hair=lib.binding_hair_is_frozen(handle, index),
        has=frozenset(name for name, value in VALUES.items() if lib.binding_body_has(handle, index, value)),
        computes=frozenset(name for name, value in VALUES.items() if lib.binding_body_computes(handle, index, value)),
    )
