"""What the tests share. `./dev python` sets WISP_PROGRAM and runs them with an installed package."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

import wisp

TREE = pathlib.Path(__file__).resolve().parents[2]
SCENES = TREE / "data" / "scenes"


@pytest.fixture(autouse=True, scope="session")
def cache(tmp_path_factory):
    """References are not those that other runs have kept."""
    os.environ["WISP_CACHE"] = str(tmp_path_factory.mktemp("references"))


@pytest.fixture
def scenes():
    return SCENES


@pytest.fixture
def program(tmp_path):
    """Run the program wisp in an empty folder."""
    path = os.environ.get("WISP_PROGRAM")
    if path is None:
        pytest.skip("WISP_PROGRAM is not set")

    def run(*arguments):
        environment = {key: value for key, value in os.environ.items() if key not in ("LD_PRELOAD", "ASAN_OPTIONS")}
        return subprocess.run([path, *map(str, arguments)], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300, check=True).stdout

    return run


@pytest.fixture
def program_hash(program):
    def run(*arguments):
        return re.search(r"(?m)^hash\s+(\w{16})", program("run", *arguments)).group(1)

    return run


@pytest.fixture
def python(tmp_path):
    """Run Python code in a process of its own, in an empty folder. Returns the finished process."""

    def run(code, **options):
        return subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=300, **options)

    return run


@pytest.fixture
def sheet():
    """A cloth of 9 x 9 vertices that hangs from two corners above the floor."""
    return wisp.Scene.from_dict(SHEET)


SHEET = {
    "steps": 40,
    "substeps": 4,
    "surfaces": [
        {
            "name": "sheet",
            "generate": {"shape": "plane", "columns": 9, "rows": 9, "spacing": 0.05},
            "transform": {"translate": [0, 0.5, 0]},
            "pins": [0, 8],
            "cloth": {},
            "collision": {},
            "compute": ["points", "normals", "strain", "speed", "motion_stats"],
        }
    ],
    "colliders": [{"name": "ball", "shape": "sphere", "radius": 0.1, "position": [0, 0.3, 0]}, {"name": "floor", "shape": "plane"}],
}

HAIR = {
    "steps": 40,
    "strands": [
        {
            "name": "hair",
            "generate": {"shape": "straight", "dimension": 3, "strands": 20, "vertices": 8},
            "dynamics": {},
            "compute": ["points", "strain", "speed", "motion_stats"],
        }
    ],
}


@pytest.fixture
def hair():
    return wisp.Scene.from_dict(HAIR)
