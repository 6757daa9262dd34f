"""Arrays of the engine's memory: what they show, and how long they live."""
import gc
import weakref

import numpy as np
import pytest

import wisp
from conftest import SHEET


def address(array):
    return array.__array_interface__["data"][0]


def test_an_array_is_a_read_only_view_that_steps_refresh(sheet):
    with sheet.create_world() as world:
        world.step()
        views = {name: getattr(world, name)("sheet") for name in ("points", "normals", "strain", "speed")}
        for name, array in views.items():
            assert not array.flags.owndata and not array.flags.writeable and array.flags.c_contiguous, name
            with pytest.raises(ValueError):
                array[0] = 1
            with pytest.raises(ValueError):
                array.flags.writeable = True
        before = {name: array.copy() for name, array in views.items()}
        world.step()
        for name, array in views.items():
            assert np.shares_memory(array, getattr(world, name)("sheet")), name
            assert np.array_equal(array, getattr(world, name)("sheet")) and not np.array_equal(array, before[name]), name


def test_no_call_moves_the_memory_of_a_view(sheet, tmp_path):
    """A view that moved would show old values for ever. Every call that changes a world is made here."""
    with sheet.create_world() as world:
        world.step()
        points = world.points("sheet")
        start = address(points)
        world.pin("sheet", [40])
        world.move_pins("sheet", [40], [[0, 1, 0]])
        world.step()
        world.unpin("sheet", [40])
        world.grab("sheet", 30)
        world.drag("sheet", 30, [0, 1, 0])
        world.step()
        world.let_go("sheet", 30)
        world.move_collider("ball", [0, 0.4, 0])
        world.set_wind([3, 0, 0])  # gives the cloth drag, a new pass
        world.step()
        world.set_wind([0, 0, 0])
        world.set_gravity([0, 0, 0])
        world.step()
        world.set_gravity([0, -1, 0])
        world.advance(3.3 / 60)
        world.request("sheet", "normals")
        with world.record(tmp_path / "a.wisp"):
            world.step()
        snapshot, before = world.snapshot(), points.copy()
        world.run(3)
        world.restore(snapshot)
        assert address(world.points("sheet")) == start and np.array_equal(points, before)
        world.step()
        assert address(world.points("sheet")) == start and not np.array_equal(points, before)


def test_a_new_request_keeps_views_of_other_values(scenes):
    with wisp.Scene.from_file(scenes / "balloons.yaml").create_world() as world:
        world.step()
        bodies = [body for body in world.bodies if body.moves]
        points = {body.name: world.points(body) for body in bodies}
        for body in bodies:
            for value in sorted(body.has):
                world.request(body, value)
                world.step()
        for name, array in points.items():
            assert np.shares_memory(array, world.points(name)) and np.array_equal(array, world.points(name))


def test_before_the_first_step_arrays_are_copies_of_the_start(sheet):
    with sheet.create_world() as world:
        points = world.points("sheet")
        assert points.flags.owndata and not points.flags.writeable
        assert points[:, 1] == pytest.approx(0.5) and not world.normals("sheet").any() and not world.speed("sheet").any()
        before = points.copy()
        world.step()
        assert np.array_equal(points, before) and not np.array_equal(world.points("sheet"), before)


def test_points_of_colliders_are_copies(sheet):
    with sheet.create_world() as world:
        world.step()
        ball = world.points("ball")
        assert ball.flags.owndata and not ball.flags.writeable and ball.shape == (world.body("ball").vertex_count, 3)


@pytest.mark.parametrize("end", ["close", "delete", "with", "cycle"])
def test_a_view_outlives_its_world(sheet, end):
    world = sheet.create_world()
    world.run(5)
    points, triangles, normals = world.points("sheet"), world.triangles("sheet"), world.normals("sheet")
    part = points[40:50, 1:]
    expected = points.copy(), triangles.copy(), normals.copy()
    if end == "close":
        world.close()
    elif end == "with":
        with world:
            pass
    elif end == "cycle":
        world.itself = world
    del world
    gc.collect()
    # Others take and return memory, which would show in memory that was freed.
    for _ in range(20):
        with sheet.create_world() as other:
            other.step()
    assert np.array_equal(points, expected[0]) and np.array_equal(triangles, expected[1]) and np.array_equal(normals, expected[2])
    del points
    gc.collect()
    assert np.array_equal(part, expected[0][40:50, 1:])


def test_views_of_strands_outlive_their_world(hair):
    world = hair.create_world()
    world.run(3)
    offsets, points = world.offsets("hair"), world.points("hair")
    assert not offsets.flags.owndata and not offsets.flags.writeable
    expected = offsets.copy(), points.copy()
    world.close()
    del world
    gc.collect()
    assert np.array_equal(offsets, expected[0]) and np.array_equal(points, expected[1])


def test_a_world_without_views_is_freed_at_once(sheet):
    world = sheet.create_world()
    world.step()
    handle = weakref.ref(world._handle)
    world.close()
    assert handle() is None
    world = sheet.create_world()
    gone = weakref.ref(world)
    del world
    assert gone() is None  # no cycle waits for the collector


def test_a_view_holds_the_memory_and_not_the_world(sheet):
    world = sheet.create_world()
    world.step()
    points, gone, handle = world.points("sheet"), weakref.ref(world), weakref.ref(world._handle)
    del world
    assert gone() is None and handle() is not None
    del points
    assert handle() is None


def test_views_of_a_recording_are_refreshed_by_seek_and_outlive_it(sheet, tmp_path):
    path = tmp_path / "sheet.wisp"
    frames = []
    with sheet.create_world() as world, world.record(path):
        for _ in range(3):
            frames.append(world.points("sheet").copy())
            world.step()
    recording = wisp.Recording(path)
    points = recording.points("sheet")
    for number, frame in enumerate(frames):
        recording.seek(number)
        assert np.array_equal(points, frame)
    recording.close()
    del recording
    gc.collect()
    assert np.array_equal(points, frames[-1])


def test_arrays_given_to_a_scene_may_die_first():
    points, triangles = wisp.grid(20, 20, 0.05)
    scene = wisp.Scene.from_dict({"steps": 3, "surfaces": [{**{k: v for k, v in SHEET["surfaces"][0].items() if k != "generate"}, "points": points, "triangles": triangles}]})
    del points, triangles
    gc.collect()
    scratch = [np.full((400, 3), np.nan, dtype=np.float32) for _ in range(50)]
    with scene.create_world() as world:
        del scene, scratch
        gc.collect()
        world.run()
        assert np.isfinite(world.points("sheet")).all()
