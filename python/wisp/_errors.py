"""Failures of the engine as exceptions."""
from __future__ import annotations

from typing import Any

from ._native import ffi, lib


class Error(Exception):
    """A failure of the engine. The message names file and line, or element."""


class BadInput(Error, ValueError):
    """A value, file or scene is wrong. Nothing has changed."""


class Conflict(Error):
    """The call does not fit the state: a value that is not computed, a world that is closed or in use by another thread."""


class StaleId(Error, LookupError):
    """An entity was removed, or never existed."""


class IoError(Error, OSError):
    """The operating system refused to open, read or write a file."""


class NoMemory(Error, MemoryError):
    """There is no memory for it. Nothing has changed."""


CLASSES = {
    lib.WISP_NO_MEMORY: NoMemory,
    lib.WISP_BAD_INPUT: BadInput,
    lib.WISP_STALE_ID: StaleId,
    lib.WISP_CONFLICT: Conflict,
    lib.WISP_IO_ERROR: IoError,
}


def text(pointer: Any) -> str:
    """A text of the engine. File names in it may be any bytes."""
    return str(ffi.string(pointer).decode("utf-8", "surrogateescape"))


def check(status: int, error: Any) -> None:
    """Raise what a status stands for."""
    if status != lib.WISP_OK:
        raise CLASSES.get(status, Error)(text(error.message))
