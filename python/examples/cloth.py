"""A cloth that hangs from two corners in the wind: a mesh of arrays, steps, and what is read of them.

    python3 cloth.py

Prints a line a second; exit status 0 if all is as it should be, 1 if not.
"""
import sys

import numpy as np

import wisp

SIDE = 33  # vertices

points, triangles = wisp.grid(SIDE, SIDE, 1 / (SIDE - 1))
scene = wisp.Scene.from_dict(
    {
        "substeps": 10,
        "surfaces": [
            {
                "name": "cloth",
                "points": points,
                "triangles": triangles,
                "pins": [0, SIDE - 1],
                "damping": 0.5,
                "cloth": {"wind": [0, 0, 2], "drag_coefficient": 1, "coarse_substeps": 1},
                "compute": ["points", "motion_stats"],
            }
        ],
    }
)
with scene.create_world() as world:
    for second in range(1, 6):
        world.run(60)
        stats = world.motion_stats("cloth")
        print(f"{second} s: the centre is at {stats.centre[1]:.3f} m, the largest strain {stats.strain_max:.4f}, {stats.kinetic_energy:.4f} J")
    corners = world.points("cloth")[[0, SIDE - 1]]
    hangs = np.array_equal(corners, points[[0, SIDE - 1]]) and stats.centre[1] < -0.3 and stats.strain_max < 0.2
    sys.exit(0 if hangs and "halted entities" not in world.counters() else 1)
