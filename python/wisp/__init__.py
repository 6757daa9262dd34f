"""Wisp: cloth, balloons and hair on the CPU, with the error of a setting beside its time. Units are SI: metres, seconds, kilograms.

    import wisp

    scene = wisp.Scene.from_file("flag.yaml")
    with scene.create_world() as world:
        world.run()
        points = world.points("flag")   # (vertices, 3) float32, a view of the engine's memory

docs/python.md of the source tree is the guide. Warnings go to the logger "wisp" of the module logging.
"""
from ._bodies import Body, FrozenHair, MemoryPart, MotionStats, PassTime
from ._errors import BadInput, Conflict, Error, IoError, NoMemory, StaleId, text as _text
from ._measure import Measured, Reference, Trial, Tuned, tune
from ._native import lib as _lib
from ._recording import Recording
from ._scene import Parameter, Scene, grid
from ._world import Recorder, World

__version__ = _text(_lib.WISP_VERSION_STRING)

__all__ = [
    "BadInput",
    "Body",
    "Conflict",
    "Error",
    "FrozenHair",
    "IoError",
    "Measured",
    "MemoryPart",
    "MotionStats",
    "NoMemory",
    "Parameter",
    "PassTime",
    "Recorder",
    "Recording",
    "Reference",
    "Scene",
    "StaleId",
    "Trial",
    "Tuned",
    "World",
    "grid",
    "tune",
]

for _name in __all__:  # where users find them, also in tracebacks and pickles
    globals()[_name].__module__ = __name__
