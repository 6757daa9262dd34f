"""The parameters that a hanging cloth needs for a given error on this machine.

    python3 tune.py
"""
import sys

import wisp

ERROR = 0.03  # m

points, triangles = wisp.grid(13, 13, 1 / 12)
scene = wisp.Scene.from_dict(
    {"steps": 60, "surfaces": [{"name": "cloth", "points": points, "triangles": triangles, "pins": [0, 12], "damping": 1, "cloth": {}}]}
)
found = wisp.tune(scene, error=ERROR, limit=300)
for trial in sorted(found.trials, key=lambda trial: trial.ms):
    if trial.is_pareto:
        values = ", ".join(f"{name} {value:g}" for name, value in trial.parameters.items())
        print(f"{trial.ms:.3f} ms, {1e3 * trial.error:.1f} mm: {values}")
measured = wisp.Reference(scene).measure(scene.with_parameters(found.parameters))
print(f"found {found.parameters} in {found.runs} runs; measured again: {1e3 * measured.error:.1f} mm")
sys.exit(0 if found.meets_target and measured.error <= ERROR else 1)
