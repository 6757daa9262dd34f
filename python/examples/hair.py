"""Hair on a head that is shaken: guides that move, ghosts that follow them, and what is read of both.

    python3 hair.py

Prints a line a second; exit status 0 if all is as it should be, 1 if not.
"""
import sys

import numpy as np

import wisp

GUIDES, GHOSTS, VERTICES, LENGTH = 16, 8, 20, 0.2


def strands(around):
    """(strands, vertices, 3): they hang from a circle of 8 cm; several about the same place lie 2 mm apart."""
    number = np.arange(GUIDES * around)
    angle, aside = 2 * np.pi * (number // around) / GUIDES, 0.002 * (number % around)
    roots = np.stack([(0.08 + aside) * np.cos(angle), np.zeros(len(number)), (0.08 + aside) * np.sin(angle)], axis=1)
    down = np.linspace(0, LENGTH, VERTICES)[:, None] * np.array([0, -1, 0])
    return roots[:, None] + down


shake = [{"time": 0.25 * k, "position": [0.05 * (k % 2), 0, 0]} for k in range(13)]
scene = wisp.Scene.from_dict(
    {
        "substeps": 10,
        "strands": [
            {"name": "guides", "points": strands(1), "dynamics": {}, "head": {"keyframes": shake}, "compute": ["points", "strain", "speed"]},
            {"name": "hair", "points": strands(GHOSTS), "ghosts": {"targets": "guides"}},
        ],
    }
)
with scene.create_world() as world:
    stretch = speed = 0.0
    for second in range(1, 4):
        world.run(60)
        stretch = max(stretch, float(world.strain("guides").max()))
        speed = max(speed, float(world.speed("guides").max()))
        print(f"{second} s: stretch {world.strain('guides').max():.4f}, speed {world.speed('guides').max():.3f} m/s")
    offsets, ghosts = world.offsets("hair"), world.points("hair")
    roots, tips = ghosts[offsets[:-1]], ghosts[offsets[1:] - 1]
    hangs = np.linalg.norm(tips - roots, axis=1).max() < 1.1 * LENGTH and tips[:, 1].max() < 0
    sys.exit(0 if hangs and stretch < 0.05 and 0.01 < speed < 5 else 1)
