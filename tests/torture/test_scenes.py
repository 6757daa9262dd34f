"""Scenes of the search: the reader takes them, they hold every kind of body and effect, and a seed is always the same."""
import json
import pathlib
import subprocess
import sys
import tempfile

import hypothesis
import yaml

from scenes import read_keys, scenes

WISP = sys.argv[1]
KINDS = """surfaces: cloth balloon implicit contact collision sleep boundary pins pin_nearest pin_keyframes strain_limit instance_of
strands: dynamics frozen_hair ghosts curves grid contact collision head on_surface sleep appearance environment
colliders: heights generate keyframes friction
events: wind velocity gust release gas_ratio
: contact seams hair_events dt_factors"""


def draw(count, seed):
    found = []
    phases = [hypothesis.Phase.generate]
    options = {"max_examples": count, "deadline": None, "database": None, "phases": phases, "suppress_health_check": list(hypothesis.HealthCheck)}
    hypothesis.settings(**options)(hypothesis.seed(seed)(hypothesis.given(scenes(BLOCKS))(lambda scene: found.append(scene))))()
    return found


def expect(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")


BLOCKS = read_keys(subprocess.run([WISP, "info", "--keys"], capture_output=True, text=True, check=True).stdout)
KEYS = {(path, field["key"]): field for path, block in BLOCKS.items() for field in block}
expect(len(KEYS) > 400 and KEYS["colliders[]", "radius"] == {"key": "radius", "shapes": ["sphere", "capsule"], "words": [], "kind": "number",
                                                             "range": (1e-6, 1e6), "initial": 1.0, "unit": "m"}, "the keys are read")
drawn = draw(300, 1)
expect(json.dumps(drawn[:20]) == json.dumps(draw(300, 1)[:20]) and json.dumps(drawn[:20]) != json.dumps(draw(300, 2)[:20]), "a seed is always the same")
for line in KINDS.splitlines():
    of, kinds = line.split(":")
    entries = [entry for scene in drawn for entry in (scene.get(of, []) if of else [scene])]
    for kind in kinds.split():
        expect(any(kind in entry for entry in entries), f"{of}: no {kind} in {len(drawn)} scenes")
with tempfile.TemporaryDirectory() as folder:
    for number, scene in enumerate(drawn):
        path = pathlib.Path(folder) / "scene.yaml"
        path.write_text(yaml.safe_dump(scene), encoding="utf-8")
        told = subprocess.run([WISP, "info", path], capture_output=True, text=True)
        expect(told.returncode == 0, f"scene {number}: {told.stderr}{yaml.safe_dump(scene)}")
print(f"{len(drawn)} scenes are read, and every kind is drawn")
