"""What accuracy costs: time and error of a scene against its converged run, and the search for the cheapest parameters."""
from __future__ import annotations

from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from ._errors import BadInput, check
from ._library import Callbacks, raise_kept, whole
from ._native import ffi, lib
from ._scene import Scene


class Measured(NamedTuple):
    """A run against its reference."""

    ms: float
    """median time of a step"""
    error: float
    """m, root mean square distance from the reference, over all vertices and compared times"""
    largest: float
    """m, largest distance"""


class Reference:
    """The converged run of a scene, to measure others against: that of `wisp accuracy` and `wisp tune`, whose errors are the same.

    It is kept in `$WISP_CACHE`, else `$XDG_CACHE_HOME/wisp`, else `~/.cache/wisp`, and read there the next time.

    length: s of motion that is compared; 0: the scene, at most 1
    """

    doubt: float
    """m, how far a coarser converged run is from it"""
    until: float
    """s, how long motion is compared"""
    parts: bool
    """Motion is compared no longer because two converged runs part: places are chance after that."""

    def __init__(self, scene: Scene, *, length: float = 0.0) -> None:
        if not 0.0 <= length < np.inf:
            raise BadInput(f"length: got {length}, expected at least 0")
        self.scene = scene
        out, info, error = ffi.new("binding_reference**"), ffi.new("binding_reference_info*"), ffi.new("wisp_error*")
        status = lib.binding_reference_open(scene._handle, length, lib.wisp_python_go_on, lib.wisp_python_log, out, info, error)
        self._handle: Any = ffi.gc(out[0], lib.binding_reference_close)
        raise_kept()
        check(status, error)
        self.doubt, self.until, self.parts = info.doubt, info.until, info.parts

    def measure(self, scene: Scene, *, workers: int = 0, isa: Optional[str] = None) -> Measured:
        """Run a scene of the same bodies, such as one with other parameters. Times need an idle machine.

        Raises BadInput if it has other bodies, and Conflict if one was halted.
        """
        out, error = ffi.new("tune_sample*"), ffi.new("wisp_error*")
        name = ffi.new("char[]", isa.encode()) if isa is not None else ffi.NULL
        threads = whole(workers, "workers", 0, 64)
        status = lib.binding_reference_measure(self._handle, scene._handle, threads, name, out, error)
        raise_kept()
        check(status, error)
        return Measured(out.ms, out.error, out.largest)


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
    length: float = 0.0,
    limit: float = 60.0,
    workers: int = 0,
    isa: Optional[str] = None,
    progress: Optional[Callable[[int, int], Optional[bool]]] = None,
) -> Tuned:
    """Find the cheapest parameters within an error, or the most accurate ones within a time, by running the scene many times.

    error: m, that of Reference; or
    budget_ms: ms per step
    length: s of motion that is compared; 0: the scene, at most 1
    limit: s of wall time after which no run starts
    progress: called after every run with the number of runs and their maximum; False ends the search, an exception is passed on
    """
    if (error is None) == (budget_ms is None):
        raise BadInput("tune: expected one of error and budget_ms")
    target = error if error is not None else budget_ms
    if target is None or not 0.0 < target < np.inf or not limit > 0.0 or not length >= 0.0:
        raise BadInput(f"tune: got a target of {target}, {length} s and a limit of {limit} s, expected numbers above 0")
    callbacks = Callbacks(progress)
    options = ffi.new("binding_tune_def*")
    options.error, options.budget_ms, options.limit = error or 0.0, budget_ms or 0.0, limit
    options.workers = whole(workers, "workers", 0, 64)
    name = ffi.new("char[]", isa.encode()) if isa is not None else ffi.NULL
    options.isa = name
    options.progress, options.user = lib.wisp_python_progress, callbacks.handle
    reference = Reference(scene, length=length)
    out, failure = ffi.new("tune_result*"), ffi.new("wisp_error*")
    status = lib.binding_tune(reference._handle, options, out, failure)
    try:
        raise_kept()
        check(status, failure)
        return _result(scene, out)
    finally:
        lib.tune_release(out)


def _result(scene: Scene, out: object) -> Tuned:
    found = ffi.cast("tune_result*", out)
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
