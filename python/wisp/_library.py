"""Calls into the engine: arrays of its memory, its messages, callbacks."""
from __future__ import annotations

import logging
import os
import threading
from typing import Any, Callable, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from ._errors import BadInput
from ._native import ffi, lib

Floats = npt.NDArray[np.float32]
Integers = npt.NDArray[np.int32]
Path = Union[str, "os.PathLike[str]"]

logger = logging.getLogger("wisp")
logger.addHandler(logging.NullHandler())  # a program that wants messages says so
LEVELS = {lib.WISP_LOG_INFO: logging.INFO, lib.WISP_LOG_WARNING: logging.WARNING, lib.WISP_LOG_ERROR: logging.ERROR}

# An exception of a callback waits here until the call that it happened in has returned. One thread, one call.
_raised = threading.local()


def _keep(kind: Any, exception: BaseException, trace: Any) -> None:
    if getattr(_raised, "exception", None) is None:
        _raised.exception = exception


def raise_kept() -> None:
    """Pass on the exception of a callback in the call that has just returned."""
    exception = getattr(_raised, "exception", None)
    if exception is not None:
        _raised.exception = None
        raise exception


@ffi.def_extern(onerror=_keep)  # type: ignore[misc]
def wisp_python_log(user: Any, level: int, message: Any) -> None:
    logger.log(LEVELS.get(level, logging.ERROR), "%s", ffi.string(message).decode("utf-8", "replace"))


class Callbacks:
    """Functions that a search calls. `handle` is what C hands back."""

    def __init__(self, progress: Optional[Callable[[int, int], Optional[bool]]]) -> None:
        self.progress = progress
        self.handle = ffi.new_handle(self)


@ffi.def_extern(onerror=_keep, error=False)  # type: ignore[misc]
def wisp_python_progress(user: Any, run_count: int, max_runs: int) -> bool:
    progress = ffi.from_handle(user).progress
    return progress is None or progress(run_count, max_runs) is not False


@ffi.def_extern(onerror=_keep, error=False)  # type: ignore[misc]
def wisp_python_go_on() -> bool:
    """Let Python handle signals: an interrupt raises here."""
    return True


# ---- arrays ----


class _Memory:
    """Memory of the engine as numpy sees it. Whoever holds the array holds the owner of the memory."""

    __slots__ = ("__array_interface__", "owner")

    def __init__(self, owner: Any, pointer: Any, shape: Tuple[int, ...], kind: str) -> None:
        self.owner = owner
        self.__array_interface__ = {
            "data": (int(ffi.cast("uintptr_t", pointer)), True),
            "shape": shape,
            "typestr": kind,
            "version": 3,
        }


def view(owner: Any, pointer: Any, shape: Tuple[int, ...], kind: str) -> Any:
    """A read-only array of the engine's memory, which stays for as long as the array."""
    return np.asarray(_Memory(owner, pointer, shape, kind))


def float_rows(values: npt.ArrayLike, what: str) -> Floats:
    """[count, 3] floats, C order."""
    array = _as_array(values, what)
    if array.dtype.kind not in "fiu" or array.ndim != 2 or array.shape[1] != 3:
        raise BadInput(f"{what}: got {_kind(array)}, expected numbers of shape (count, 3)")
    return np.ascontiguousarray(array, dtype=np.float32)


def integers(values: npt.ArrayLike, what: str) -> Integers:
    """[count] integers that fit the engine's, C order."""
    array = _as_array(values, what)
    if array.size == 0:
        return np.zeros(array.shape, dtype=np.int32)
    if array.dtype.kind not in "iu":
        raise BadInput(f"{what}: got {_kind(array)}, expected integers")
    if int(array.min()) < -(2**31) or int(array.max()) >= 2**31:
        raise BadInput(f"{what}: got {int(array.min())} to {int(array.max())}, expected integers of 32 bits")
    return np.ascontiguousarray(array, dtype=np.int32)


def vector(values: npt.ArrayLike, what: str) -> Tuple[float, float, float]:
    """Three numbers."""
    array = _as_array(values, what)
    if array.dtype.kind not in "fiu" or array.shape != (3,):
        raise BadInput(f"{what}: got {_kind(array)}, expected 3 numbers")
    return float(array[0]), float(array[1]), float(array[2])


def _as_array(values: npt.ArrayLike, what: str) -> npt.NDArray[Any]:
    try:
        return np.asarray(values)
    except ValueError as error:
        raise BadInput(f"{what}: {error}") from None


def _kind(array: npt.NDArray[Any]) -> str:
    return f"{array.dtype} of shape {array.shape}"


def whole(value: Any, what: str, least: int, most: int) -> int:
    """An integer in a range."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not least <= value <= most:
        raise BadInput(f"{what}: got {value!r}, expected a whole number from {least} to {most}")
    return int(value)


def path_bytes(path: Path) -> bytes:
    name = os.fsencode(path)
    if b"\0" in name:
        raise BadInput(f"{path!r}: got a zero in a file name")
    return name
