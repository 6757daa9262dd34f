"""What scenes and worlds are described by: bodies, parameters, statistics."""
from __future__ import annotations

from dataclasses import dataclass
from typing import FrozenSet, NamedTuple, Tuple

KINDS = ("strands", "cloth", "balloon", "collider", "plane")
VALUES = {"points": 0, "strain": 1, "speed": 2, "width": 3, "colour": 4, "motion_stats": 5, "normals": 6}

Vector = Tuple[float, float, float]


@dataclass(frozen=True)
class Body:
    """A body of a world or of a recording."""

    index: int
    name: str
    kind: str
    """strands, cloth, balloon, collider or plane; of a recording strands or cloth"""
    vertex_count: int
    triangle_count: int
    """0 for strands"""
    strand_count: int
    moves: bool
    """False for colliders, which move only as told. A plane is shown as a square of 2 m."""
    hidden: bool = False
    """Strands that others follow: they are not shown, and have no points to read unless the scene or request() asks for them."""
    is_frozen_hair: bool = False
    has: FrozenSet[str] = frozenset({"points"})
    """Values that can be requested."""
    computes: FrozenSet[str] = frozenset()
    """Values that the scene computes itself: requesting them changes nothing, other values become part of the hash."""


class MotionStats(NamedTuple):
    """Motion of a surface, or of strands that move, at the end of the last step."""

    mass: float
    """kg, of the vertices that are not pinned"""
    centre: Vector
    """m, of that mass"""
    momentum: Vector
    """kg m/s"""
    angular_momentum: Vector
    """kg m^2/s about the centre"""
    kinetic_energy: float
    """J"""
    potential_energy: float
    """J; 0 at the origin"""
    volume: float
    """m^3, signed; of strands 0"""
    strain_max: float
    """largest |l/l0 - 1|"""
    strain_mean: float
    speed_max: float
    """m/s"""


class FrozenHair(NamedTuple):
    """Parameters of frozen hair."""

    intensity: float
    """x: 1 turns whole strands, 0 their tips alone"""
    reach: float
    """m, of the cursor"""
    stretch_stiffness: float
    bend_stiffness: float
    clump_radius: float
    """m"""
    freezes: bool
    aligns: bool
    clumps: bool
    temperature: float
    """degrees Celsius, of the scene's climate or the default one"""
    wetness: float
    """0 to 1"""


class PassTime(NamedTuple):
    """A pass of the last step."""

    name: str
    """module.verb"""
    seconds: float


class MemoryPart(NamedTuple):
    """A part of a world's memory."""

    name: str
    kind: str
    """engine, module, component; outside: not in World.memory_bytes except for fabrics"""
    bytes: int
    """in use"""
    capacity: int
    """allocated"""
