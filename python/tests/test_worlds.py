"""Worlds: steps, input, snapshots, costs, messages."""
import copy
import logging
import pickle

import numpy as np
import pytest

import wisp
from conftest import HAIR, SHEET


def test_bodies_are_described_in_the_order_of_the_scene(sheet, hair):
    with sheet.create_world() as world:
        names = [(body.name, body.kind, body.moves) for body in world.bodies]
        assert names == [("sheet", "cloth", True), ("ball", "collider", False), ("floor", "plane", False)]
        body = world.body("sheet")
        assert (body.vertex_count, body.triangle_count, body.strand_count) == (81, 128, 0)
        assert body.computes == {"points", "normals", "strain", "speed", "motion_stats"} and body.has == body.computes
        assert world.body(body) is body
    with hair.create_world() as world:
        assert (world.bodies[0].kind, world.bodies[0].strand_count, world.bodies[0].is_frozen_hair) == ("strands", 20, False)


def test_run_makes_the_steps_of_the_scene_that_are_left(sheet):
    with sheet.create_world() as world:
        world.step()
        assert world.run() == 39 and world.step_count == 40 and world.run() == 0
        assert world.time == pytest.approx(40 / 60)
        assert world.run(2) == 2 and world.step_count == 42


def test_a_callback_sees_each_step_and_may_end_the_run(sheet):
    seen = []

    def watch(world):
        seen.append(world.step_count)
        return world.step_count < 7

    with sheet.create_world() as world:
        assert world.run(callback=watch) == 7
        assert seen == [1, 2, 3, 4, 5, 6, 7]


def test_an_exception_of_a_callback_passes_through(sheet):
    class Own(Exception):
        pass

    def fail(world):
        if world.step_count == 3:
            raise Own("here")

    with sheet.create_world() as world:
        with pytest.raises(Own, match="here"):
            world.run(callback=fail)
        assert world.step_count == 3
        world.step()  # goes on


def test_advance_makes_whole_steps_and_shows_points_between_them(sheet):
    with sheet.create_world() as world, sheet.create_world() as other:
        assert world.advance(2.5 / 60) == 2 and world.step_count == 2
        other.run(1)
        first = other.points("sheet").copy()
        other.run(1)
        second = other.points("sheet")
        between = world.points("sheet")
        assert np.allclose(between, 0.5 * (first + second), atol=1e-6) and not np.array_equal(between, second)
        assert world.hash() == other.hash()
        assert world.advance(0.0) == 0
        assert world.advance(0.5 / 60) == 1 and world.step_count == 3
        other.step()
        assert world.hash() == other.hash()
        world.step()
        other.step()
        assert np.array_equal(world.points("sheet"), other.points("sheet"))


def test_advance_plays_the_events_of_the_scene(scenes):
    scene = wisp.Scene.from_file(scenes / "moving_floor_cloth.yaml")
    with scene.create_world() as world, scene.create_world() as other:
        for _ in range(10):
            world.advance(3 * scene.dt)
        other.run(world.step_count)
        assert world.step_count == 30 and world.hash() == other.hash()


def test_advance_refuses_wrong_times_and_scenes_with_uneven_steps(sheet):
    with sheet.create_world() as world:
        with pytest.raises(wisp.BadInput, match="advance: got -1 s"):
            world.advance(-1.0)
    with wisp.Scene.from_dict({**SHEET, "dt_factors": [1, 2]}).create_world() as world:
        with pytest.raises(wisp.Conflict, match="dt_factors"):
            world.advance(0.1)


def test_values_have_the_shapes_and_meanings_that_are_documented(sheet):
    with sheet.create_world() as world:
        world.run()
        points, normals = world.points("sheet"), world.normals("sheet")
        assert points.shape == normals.shape == (81, 3) and points.dtype == np.float32
        assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
        speed, strain = world.speed("sheet"), world.strain("sheet")
        assert speed.shape == strain.shape == (81,)
        stats = world.motion_stats("sheet")
        assert stats.speed_max == pytest.approx(speed.max(), rel=1e-6)
        assert stats.strain_max == pytest.approx(strain.max(), rel=1e-5)
        assert stats.mass == pytest.approx(0.16 * 0.15, rel=0.05)  # 0.4 m x 0.4 m of 0.15 kg/m^2, without the pinned corners
        assert world.points("floor").shape == (4, 3)


def test_values_of_strands_and_their_offsets(hair):
    with hair.create_world() as world:
        world.run(5)
        offsets = world.offsets("hair")
        assert offsets.tolist() == list(range(0, 161, 8))
        assert world.points("hair").shape == (160, 3) and world.speed("hair")[offsets[:-1]].max() == 0  # roots rest


def test_width_and_colour_of_strands(scenes):
    with wisp.Scene.from_file(scenes / "environment_and_appearance.yaml").create_world() as world:
        world.run(2)
        body = next(body for body in world.bodies if "colour" in body.has)
        assert world.colour(body).shape == (body.vertex_count, 3) and world.width(body).min() >= 0


def test_a_value_that_is_not_computed_can_be_requested(scenes):
    with wisp.Scene.from_file(scenes / "hanging_cloth.yaml").create_world() as world:
        body = next(body for body in world.bodies if "normals" in body.has and "normals" not in body.computes)
        world.step()
        with pytest.raises(wisp.Conflict, match="normals"):
            world.normals(body)
        world.request(body, "normals")
        world.step()
        assert np.allclose(np.linalg.norm(world.normals(body), axis=1), 1, atol=1e-5)


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda w: w.points("shirt"), "got body 'shirt', expected one of sheet, ball, floor"),
        (lambda w: w.points(0), "got body 0"),
        (lambda w: w.width("sheet"), "'sheet' has no value 'width'"),
        (lambda w: w.speed("ball"), "'ball' has no value 'speed'"),
        (lambda w: w.request("sheet", "beauty"), "got value 'beauty'"),
        (lambda w: w.request("ball", "points"), "'ball' has no value 'points'"),
        (lambda w: w.offsets("sheet"), "'sheet' has no strands"),
        (lambda w: w.run(-1), "steps: got -1"),
        (lambda w: w.pin("sheet", [0, 81]), "81"),
        (lambda w: w.pin("sheet", [[0]]), "vertices: got shape (1, 1)"),
        (lambda w: w.pin("sheet", [0.5]), "vertices: got float64"),
        (lambda w: w.pin("sheet", [2**35]), "32 bits"),
        (lambda w: w.move_pins("sheet", [1], [[0, 0, 0]]), "1"),
        (lambda w: w.move_pins("sheet", [0, 8], [[0, 0, 0]]), "targets: got 1 for 2 vertices"),
        (lambda w: w.move_pins("sheet", [0], [[0, np.nan, 0]]), "0"),
        (lambda w: w.grab("sheet", 81), "got vertex 81"),
        (lambda w: w.grab("sheet", -1), "vertex: got -1"),
        (lambda w: w.set_gravity([0, 1]), "gravity: got"),
        (lambda w: w.restore(b"nonsense"), "no snapshot of this world"),
        (lambda w: w.restore(w.snapshot()[:-1]), "snapshot"),
        (lambda w: w.record("a.mp4"), "mp4"),
        (lambda w: w.record("a.wisp", every=0), "every: got 0"),
    ],
)
def test_wrong_arguments_are_refused_and_change_nothing(sheet, call, message):
    with sheet.create_world() as world:
        world.run(3)
        before = world.hash()
        with pytest.raises(wisp.BadInput) as caught:
            call(world)
        assert message in str(caught.value)
        assert world.hash() == before
        world.step()


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda w: w.drag("sheet", 4, [0, 0, 0]), "vertex 4 of body 0 is not held"),
        (lambda w: w.let_go("sheet", 4), "is not held"),
        (lambda w: w.grab("ball", 0), "got body 1"),
        (lambda w: w.pin("ball", [0]), "'ball' is no surface"),
        (lambda w: w.move_collider("sheet", [0, 0, 0]), "'sheet' is no collider"),
        (lambda w: w.collider_place("sheet"), "body 0 is no collider"),
        (lambda w: w.frozen_hair("sheet"), "body 0 has no frozen hair"),
        (lambda w: w.set_frozen_hair("sheet", reach=1), "body 0 has no frozen hair"),
        (lambda w: w.command_frozen_hair("sheet", [0, 0, 0]), "body 0 has no frozen hair"),
        (lambda w: w.begin_stroke("sheet"), "body 0 has no frozen hair"),
        (lambda w: w.climate_stiffness("sheet", 20, 0), "body 0 has no frozen hair"),
        (lambda w: w.resume("ball"), "does not move by itself"),
        (lambda w: w.motion_stats("sheet"), "motion"),
    ],
)
def test_calls_that_do_not_fit_the_state_are_refused(sheet, call, message):
    with sheet.create_world() as world:
        with pytest.raises((wisp.Conflict, wisp.BadInput)) as caught:
            call(world)
        assert message in str(caught.value)


def test_a_closed_world_refuses_every_call(sheet):
    world = sheet.create_world()
    world.close()
    world.close()
    assert world.closed and "closed" in repr(world)
    for call in (world.step, world.hash, world.snapshot, world.profile, world.memory, lambda: world.points("sheet"), lambda: world.time):
        with pytest.raises(wisp.Conflict, match="the world is closed"):
            call()


def test_a_world_cannot_be_copied_or_pickled(sheet):
    with sheet.create_world() as world:
        for use in (copy.copy, copy.deepcopy, pickle.dumps):
            with pytest.raises(TypeError, match="cannot be copied or pickled"):
                use(world)


def test_pins_are_moved_and_released(sheet):
    with sheet.create_world() as world:
        world.step()
        target = world.points("sheet")[[0, 8]] + np.array([0, 0.1, 0])
        world.move_pins("sheet", [0, 8], target)
        world.step()
        assert np.allclose(world.points("sheet")[[0, 8]], target, atol=1e-6)
        world.pin("sheet", [40])
        place = world.points("sheet")[40].copy()
        world.run(5)
        assert np.allclose(world.points("sheet")[40], place, atol=1e-6)
        world.unpin("sheet", np.array([0, 8, 40]))
        world.run(20)
        assert world.points("sheet")[[0, 8], 1].max() < target[:, 1].min() - 0.05


def test_pins_that_keyframes_move_are_not_moved_by_hand():
    entry = {**SHEET["surfaces"][0], "pin_keyframes": [{"time": 0}, {"time": 1, "translate": [0, 1, 0]}]}
    with wisp.Scene.from_dict({**SHEET, "surfaces": [entry]}).create_world() as world:
        for call in (lambda: world.move_pins("sheet", [0], [[0, 0, 0]]), lambda: world.unpin("sheet", [8]), lambda: world.grab("sheet", 0)):
            with pytest.raises(wisp.Conflict, match="follows the keyframes of its pins"):
                call()


def test_vertices_and_heads_are_held_and_dragged(sheet, hair):
    with sheet.create_world() as world:
        world.step()
        for vertex in range(30, 60):  # more than a page needs
            world.grab("sheet", vertex)
        world.grab("sheet", 40)
        world.drag("sheet", 40, [0.3, 0.6, 0])
        world.step()
        assert np.allclose(world.points("sheet")[40], [0.3, 0.6, 0], atol=1e-6)
        world.let_go("sheet", 40)
        world.run(5)
        assert not np.allclose(world.points("sheet")[40], [0.3, 0.6, 0], atol=1e-3)
    with hair.create_world() as world:
        world.step()
        root = world.points("hair")[0].copy()
        world.grab("hair", 0)
        world.drag("hair", 0, root + [0.05, 0, 0])
        world.step()
        assert np.allclose(world.points("hair")[0], root + [0.05, 0, 0], atol=1e-5)


def test_colliders_gravity_and_wind_change_as_told(sheet):
    with sheet.create_world() as world:
        world.step()
        world.move_collider("ball", [0, 0.8, 0])
        world.step()
        assert world.collider_place("ball") == pytest.approx((0, 0.8, 0))
        assert world.points("ball")[:, 1].mean() == pytest.approx(0.8, abs=1e-3)
        world.set_gravity([0, 5, 0])
        world.unpin("sheet", [0, 8])
        world.run(30)
        assert world.points("sheet")[:, 1].mean() > 0.5
        assert world.set_wind([8, 0, 0]) is True
        before = world.points("sheet")[:, 0].mean()
        world.run(20)
        assert world.points("sheet")[:, 0].mean() > before + 0.05
    with wisp.Scene.from_dict(HAIR).create_world() as world:
        assert world.set_wind([1, 0, 0]) is True  # strands without drag get it


def test_frozen_hair_takes_commands_and_parameters(scenes):
    with wisp.Scene.from_file(scenes / "frozen_stroke.yaml").create_world() as world:
        body = next(body for body in world.bodies if body.is_frozen_hair)
        hair = world.frozen_hair(body)
        world.set_frozen_hair(body, reach=2 * hair.reach)
        assert world.frozen_hair(body) == hair._replace(reach=pytest.approx(2 * hair.reach))
        world.step()
        before = world.points(body).copy()
        world.begin_stroke(body)
        world.command_frozen_hair(body, before.mean(axis=0) + [0.02, 0, 0])
        world.step()
        assert not np.array_equal(world.points(body), before)
        assert world.climate_stiffness(body, 20, 0) >= world.climate_stiffness(body, 20, 1)
        with pytest.raises(wisp.BadInput):
            world.set_frozen_hair(body, reach=-1)


@pytest.mark.parametrize("name", ["flag", "moving_floor_cloth", "frozen_stroke", "swinging_guides", "balloons"])
def test_a_restored_world_repeats_its_steps(scenes, name):
    scene = wisp.Scene.from_file(scenes / f"{name}.yaml")
    with scene.create_world() as world:
        world.run(5)
        snapshot, count, time = world.snapshot(), world.step_count, world.time
        world.run(7)
        expected, points = world.hash(), [world.points(body).copy() for body in world.bodies if not body.hidden]
        world.restore(bytearray(snapshot))
        assert (world.step_count, world.time) == (count, time)
        world.run(7)
        assert world.hash() == expected
        for body, old in zip((body for body in world.bodies if not body.hidden), points):
            assert np.array_equal(world.points(body), old), body.name


def test_a_snapshot_of_one_world_restores_another_of_the_same_scene(scenes):
    scene = wisp.Scene.from_file(scenes / "flag.yaml")
    with scene.create_world() as world, scene.create_world() as other:
        world.run(6)
        other.step()
        other.restore(world.snapshot())
        world.run(3)
        other.run(3)
        assert other.hash() == world.hash()
    with scene.create_world() as world, wisp.Scene.from_dict(SHEET).create_world() as other:
        with pytest.raises(wisp.BadInput, match="snapshot"):
            other.restore(world.snapshot())


def test_a_snapshot_of_the_start_can_be_restored(sheet):
    with sheet.create_world() as world, sheet.create_world() as fresh:
        snapshot = world.snapshot()
        world.run(4)
        expected = world.hash()
        world.restore(snapshot)
        assert world.step_count == 0
        world.run(4)
        assert world.hash() == expected
        fresh.restore(snapshot)
        fresh.run(4)
        assert fresh.hash() == expected


def test_a_snapshot_has_the_places_of_colliders(sheet):
    with sheet.create_world() as world:
        world.move_collider("ball", [0, 0.7, 0])
        world.run(5)
        before, hash_before = world.snapshot(), world.hash()
        world.run(10)
        expected = world.hash()
        world.move_collider("ball", [0.1, 0.9, 0.1])
        world.run(5)
        world.restore(before)
        assert world.hash() == hash_before
        world.run(10)
        assert world.hash() == expected


def test_a_snapshot_before_the_first_move_of_a_pin_does_not_fit_after_it(sheet):
    with sheet.create_world() as world:
        world.step()
        before = world.snapshot()
        world.move_pins("sheet", [0], [[0, 1, 0]])
        world.step()
        with pytest.raises(wisp.BadInput, match="snapshot: got .* bytes of columns"):
            world.restore(before)
        after = world.snapshot()
        world.move_pins("sheet", [0], [[0, 2, 0]])
        world.step()
        world.restore(after)


def test_costs_are_told(sheet):
    with sheet.create_world() as world:
        world.run(3)
        profile = world.profile()
        assert {line.name.split(".")[0] for line in profile} >= {"links", "surface"}
        assert 0 < sum(line.seconds for line in profile) <= 1.5 * world.step_seconds
        assert world.counters()["steps"] == 3 and 0 not in world.counters().values()
        inside = sum(part.capacity for part in world.memory() if part.kind != "outside")
        assert 0 < inside <= world.memory_bytes
        assert world.isa in ("baseline", "avx2", "avx512")


def test_messages_go_to_the_logger_and_nothing_is_printed(sheet, caplog, capfd):
    points, triangles = wisp.grid(3, 3, 0.1)
    points = np.vstack([points, [[5, 5, 5]]])
    twice = np.vstack([triangles, triangles[:1]])
    scene = wisp.Scene.from_dict({"steps": 2, "surfaces": [{"name": "rag", "points": points, "triangles": twice, "repair": ["duplicates"], "cloth": {}}]})
    with caplog.at_level(logging.INFO, logger="wisp"):
        with scene.create_world() as world:
            world.run()
    assert any(record.levelno == logging.WARNING and "1 duplicate triangle was removed" in record.message for record in caplog.records)
    assert {record.name for record in caplog.records} == {"wisp"}
    out = capfd.readouterr()
    assert (out.out, out.err) == ("", "")


def test_a_body_that_is_halted_is_logged_and_can_be_resumed(sheet, caplog):
    with sheet.create_world() as world:
        world.step()
        world.unpin("sheet", [0, 8])
        world.set_gravity([0, 1e6, 0])
        with caplog.at_level(logging.INFO, logger="wisp"):
            world.run(150)
        assert world.is_halted("sheet") and not world.is_halted("ball")
        assert any("halted" in record.message for record in caplog.records)
        assert world.counters()["halted entities"] >= 1
        world.set_gravity([0, -9.8, 0])
        world.resume("sheet")
        world.step()
        assert not world.is_halted("sheet") and np.isfinite(world.points("sheet")).all()


def test_an_exception_of_a_log_handler_passes_through(sheet):
    class Fatal(logging.Handler):
        def handle(self, record):
            raise RuntimeError(f"a warning: {record.getMessage()}")

    handler = Fatal()
    logging.getLogger("wisp").addHandler(handler)
    try:
        with sheet.create_world() as world:
            world.step()
            world.unpin("sheet", [0, 8])
            world.set_gravity([0, 1e6, 0])
            with pytest.raises(RuntimeError, match="a warning"):
                world.run(150)
            count = world.step_count
            world.step()  # goes on
            assert count > 50 and world.step_count == count + 1
    finally:
        logging.getLogger("wisp").removeHandler(handler)
