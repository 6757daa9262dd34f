"""Memory: worlds come and go, and failures to get it are exceptions."""
import os
import resource

import pytest

import wisp

# The sanitizer keeps freed memory for a while, so that its size says nothing; its checks count then.
SANITIZED = "ASAN_OPTIONS" in os.environ

SMALL = {"steps": 1, "substeps": 1, "surfaces": [{"name": "sheet", "generate": {"shape": "plane", "columns": 2, "rows": 2, "spacing": 0.1}, "cloth": {}}]}


def resident():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def cycle(scene, count):
    for number in range(count):
        world = scene.create_world(workers=1)
        if number % 4 == 0:
            world.step()
            world.points("sheet")
        if number % 2 == 0:
            world.close()


def test_a_hundred_thousand_worlds_leave_no_memory_behind():
    scene = wisp.Scene.from_dict(SMALL)
    cycle(scene, 100 if SANITIZED else 5000)
    before = resident()
    cycle(scene, 2000 if SANITIZED else 100_000)
    # A leak of 50 bytes a world would be 5 MB.
    assert SANITIZED or resident() - before < 4 << 20


def test_scenes_searches_and_failures_leave_no_memory_behind(tmp_path):
    points, triangles = wisp.grid(8, 8, 0.1)
    given = {"steps": 1, "surfaces": [{"name": "sheet", "points": points, "triangles": triangles, "cloth": {}}]}

    def use(count):
        for number in range(count):
            scene = wisp.Scene.from_dict(given)
            scene.with_parameters(substeps=2)
            with pytest.raises(wisp.BadInput):
                wisp.Scene.from_text("wisp: 1\nsteps: ten\n")
            with pytest.raises(wisp.IoError):
                wisp.Scene.from_file(tmp_path / "none")
            with scene.create_world(workers=1) as world:
                with world.record(tmp_path / "a.wisp"):
                    world.step()
                world.restore(world.snapshot())
                with pytest.raises(wisp.BadInput):
                    world.pin("sheet", [99])
            if number % 50 == 0:
                wisp.tune(scene, error=1, length=0.02, limit=5, workers=1)

    use(20 if SANITIZED else 150)
    before = resident()
    use(50 if SANITIZED else 600)
    assert SANITIZED or resident() - before < 4 << 20


@pytest.mark.skipif(SANITIZED, reason="the sanitizer needs all addresses")
def test_a_lack_of_memory_is_an_exception(python):
    result = python(
        """
import resource, wisp
scene = wisp.Scene.from_dict({"surfaces": [{"name": "sheet", "generate": {"shape": "plane", "columns": 2000, "rows": 2000, "spacing": 0.1}, "cloth": {}}]})
resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
try:
    scene.create_world(workers=1)
except MemoryError as error:
    assert isinstance(error, wisp.NoMemory)
    print(error)
small = wisp.Scene.from_dict({"surfaces": [{"name": "sheet", "generate": {"shape": "plane", "columns": 3, "rows": 3, "spacing": 0.1}, "cloth": {}}]})
with small.create_world(workers=1) as world:
    world.step()
"""
    )
    assert result.returncode == 0, result.stderr
    assert "out of memory" in result.stdout and result.stderr == ""
