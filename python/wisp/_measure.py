"""What accuracy costs: time and error of a scene against its converged run, and the search for the cheapest parameters."""
from __future__ import annotations

import statistics
from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from ._bodies import Body
from ._errors import BadInput, Conflict, check
from ._library import Callbacks, Floats, raise_kept, whole
from ._native import ffi, lib
from ._scene import Scene
from ._world import World

_SAMPLES = 12
_SECONDS = 2.0


class Measured(NamedTuple):
    """A run against its reference."""

    ms: float
    """median time of a step"""
    error: float
    """m, root mean square distance from the reference, over all points and samples"""
    largest: float
    """m, largest distance"""


class Reference:
    """The converged run of a scene, to measure others against.

    It has the finest parameters with `factor` times their substeps. Compared are the points of surfaces and of strands with dynamics,
    at 12 times that are spread evenly, as tune() does. `wisp tune` and `wisp accuracy` have a reference of their own.

    seconds: of simulated time; 0: the scene, at most 2
    """

    def __init__(self, scene: Scene, *, seconds: float = 0.0, factor: int = 16, workers: int = 0) -> None:
        self.steps = _steps(scene, seconds)
        self.scene = scene
        with scene.create_world(reference=True, factor=factor, workers=workers) as world:
            self._samples: List[Floats] = []
            self.ms = self._run(world, self._samples.append)

    def measure(self, scene: Scene, *, workers: int = 0, isa: Optional[str] = None) -> Measured:
        """Run a scene of the same bodies, such as one with other parameters. Times need an idle machine.

        Raises Conflict if it has other points, or a body was halted.
        """
        if abs(scene.dt - self.scene.dt) > 1e-9 * self.scene.dt:
            raise Conflict(f"{scene.name}: got steps of {scene.dt:g} s, expected those of the reference, {self.scene.dt:g} s")
        squares, largest, number = 0.0, 0.0, 0

        def compare(points: Floats) -> None:
            nonlocal squares, largest, number
            reference = self._samples[number]
            if points.shape != reference.shape:
                raise Conflict(f"{scene.name}: got {len(points)} points, expected {len(reference)} as the reference has")
            distance = np.sum((points.astype(np.float64) - reference) ** 2, axis=1)
            squares += float(distance.sum())
            largest = max(largest, float(distance.max()))
            number += 1

        with scene.create_world(workers=workers, isa=isa) as world:
            ms = self._run(world, compare)
        return Measured(ms, float(np.sqrt(squares / (number * len(self._samples[0])))), float(np.sqrt(largest)))

    def _run(self, world: World, observe: Callable[[Floats], None]) -> float:
        bodies = [body for body in world.bodies if "speed" in body.has]
        for body in bodies:
            world.request(body, "points")
        samples = min(_SAMPLES, self.steps)
        times = []
        for step in range(self.steps):
            world.step()
            times.append(world.step_seconds)
            if (step + 1) * samples // self.steps > step * samples // self.steps:
                observe(np.concatenate([world.points(body) for body in bodies]))
        _check_halted(world, bodies)
        return 1e3 * statistics.median(times)


def _check_halted(world: World, bodies: List[Body]) -> None:
    for body in bodies:
        if world.is_halted(body):
            raise Conflict(f"{world.scene.name}: '{body.name}' was halted, and has no error to speak of")


def _steps(scene: Scene, seconds: float) -> int:
    if not seconds >= 0.0:
        raise BadInput(f"seconds: got {seconds}, expected at least 0")
    if not scene.parameters:
        raise BadInput(f"{scene.name}: nothing of the scene moves in time")
    asked = seconds or min(scene.steps * scene.dt, _SECONDS) or _SECONDS
    return max(1, round(asked / scene.dt))


class Trial(NamedTuple):
    """Parameters that a search has run."""

    parameters: Dict[str, float]
    ms: float
    """median time of a step"""
    error: float
    """m"""
    halted: bool
    is_pareto: bool
    """No other one is better in time or error and as good in the other."""


class Tuned(NamedTuple):
    """The result of a search."""

    meets_target: bool
    """False: no parameters meet the target, and these are the closest."""
    parameters: Dict[str, float]
    ms: float
    error: float
    """m"""
    runs: int
    stopped_early: bool
    """A limit ended the search: better parameters may exist."""
    trials: Tuple[Trial, ...]
    """In the order of their first run."""


def tune(
    scene: Scene,
    *,
    error: Optional[float] = None,
    budget_ms: Optional[float] = None,
    seconds: float = 0.0,
    limit: float = 60.0,
    workers: int = 0,
    isa: Optional[str] = None,
    progress: Optional[Callable[[int, int], Optional[bool]]] = None,
) -> Tuned:
    """Find the cheapest parameters within an error, or the most accurate ones within a time, by running the scene many times.

    error: m, root mean square distance from a converged run; or
    budget_ms: ms per step
    seconds: of simulated time in each run; 0: the scene, at most 2
    limit: s of wall time after which no run starts
    progress: called after every run with the number of runs and their maximum; False ends the search, an exception is passed on
    """
    if (error is None) == (budget_ms is None):
        raise BadInput("tune: expected one of error and budget_ms")
    target = error if error is not None else budget_ms
    if target is None or not 0.0 < target < np.inf or not limit > 0.0 or not seconds >= 0.0:
        raise BadInput(f"tune: got a target of {target}, {seconds} s and a limit of {limit} s, expected numbers above 0")
    callbacks = Callbacks(progress)
    options = ffi.new("binding_tune_def*")
    options.error, options.budget_ms, options.seconds, options.limit = error or 0.0, budget_ms or 0.0, seconds, limit
    options.workers = whole(workers, "workers", 0, 64)
    name = ffi.new("char[]", isa.encode()) if isa is not None else ffi.NULL
    options.isa = name
    options.progress, options.go_on, options.log = lib.wisp_python_progress, lib.wisp_python_go_on, lib.wisp_python_log
    options.user = callbacks.handle
    out, failure = ffi.new("wisp_tune_result*"), ffi.new("wisp_error*")
    status = lib.binding_tune(scene._handle, options, out, failure)
    try:
        raise_kept()
        check(status, failure)
        return _result(scene, out)
    finally:
        lib.wisp_tune_release(out)


def _result(scene: Scene, out: object) -> Tuned:
    found = ffi.cast("wisp_tune_result*", out)
    parameters = scene.parameters

    def values(configuration: List[int]) -> Dict[str, float]:
        return {parameter.name: parameter.values[configuration[k]] for k, parameter in enumerate(parameters)}

    trials = []
    for k in range(found.trial_count):
        trial = found.trials[k]
        sample = trial.sample
        trials.append(Trial(values(trial.configuration), sample.ms, sample.error, sample.is_halted, trial.is_pareto))
    return Tuned(
        found.meets_target, values(found.configuration), found.achieved.ms, found.achieved.error, found.run_count,
        found.stopped_early, tuple(trials),
    )
