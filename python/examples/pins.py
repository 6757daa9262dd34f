"""Pins moved by hand: two corners of a cloth go round while it hangs; a snapshot, and the same motion again with the same bits.

    python3 pins.py
"""
import sys

import numpy as np

import wisp

points, triangles = wisp.grid(25, 25, 0.02)
pins = np.array([0, 24])
scene = wisp.Scene.from_dict(
    {"substeps": 5, "surfaces": [{"name": "cloth", "points": points, "triangles": triangles, "pins": pins, "damping": 0.5, "cloth": {}}]}
)


def swing(world, steps):
    for _ in range(steps):
        angle = 2 * np.pi * world.time
        world.move_pins("cloth", pins, points[pins] + 0.1 * np.array([1 - np.cos(angle), 0, np.sin(angle)]))
        world.step()


with scene.create_world() as world:
    swing(world, 30)
    snapshot = world.snapshot()
    swing(world, 60)
    first, shape = world.hash(), world.points("cloth").copy()
    world.restore(snapshot)
    swing(world, 60)
    print(f"after {world.time:.1f} s: {first}, again {world.hash()}")
    sys.exit(0 if world.hash() == first and np.array_equal(world.points("cloth"), shape) and shape[:, 1].min() < -0.2 else 1)
