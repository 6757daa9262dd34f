"""Recordings, and files that cannot be written."""
import numpy as np
import pytest

import wisp


def test_a_recording_is_that_of_the_program(scenes, program, tmp_path):
    path = scenes / "flag.yaml"
    program("run", path, "--steps", 6, "--every", 2, "--record", tmp_path / "program.wisp")
    with wisp.Scene.from_file(path).create_world() as world:
        with world.record(tmp_path / "python.wisp", every=2) as recorder:
            world.run(6)
            assert recorder.frames == 4
        assert recorder.frames == 4
    assert (tmp_path / "python.wisp").read_bytes() == (tmp_path / "program.wisp").read_bytes()
    program("run", path, "--steps", 6, "--verify", tmp_path / "python.wisp")


@pytest.mark.parametrize("name, files", [("a.wisp", ["a.wisp"]), ("a.pvd", ["a.pvd"]), ("a.usda", ["a.usda"]), ("a.glb", ["a.glb"]), ("a.pc2", ["a_ball.pc2", "a_sheet.pc2"]),
                                         ("a.obj", ["a_0001.obj", "a_0002.obj", "a_0003.obj"])])
def test_every_format_is_written(sheet, tmp_path, name, files):
    with sheet.create_world() as world, world.record(tmp_path / name):
        world.run(2)
    written = sorted(path.name for path in tmp_path.iterdir() if path.is_file())
    assert written == files
    if name == "a.pvd":
        # three frames of the cloth; the ball and the floor never move
        assert len(list(tmp_path.glob("a/sheet_*.vtp"))) == 3 and len(list(tmp_path.glob("a/ball_*.vtp"))) == 1


def test_closing_the_world_finishes_its_recordings(sheet, tmp_path):
    with sheet.create_world() as world:
        recorders = [world.record(tmp_path / "a.wisp"), world.record(tmp_path / "b.usda", every=3)]
        world.run(6)
    assert wisp.Recording(tmp_path / "a.wisp").is_complete and (tmp_path / "b.usda").exists()
    assert [recorder.frames for recorder in recorders] == [7, 3]
    for recorder in recorders:
        recorder.close()


@pytest.mark.parametrize("first", ["world", "recorder"])
def test_a_recorder_that_is_dropped_finishes_its_file(sheet, tmp_path, first):
    world = sheet.create_world()
    recorder = world.record(tmp_path / "a.wisp")
    world.run(3)
    if first == "world":
        del world, recorder
    else:
        del recorder
        world.step()
        del world
    recording = wisp.Recording(tmp_path / "a.wisp")
    assert recording.is_complete and recording.frame_count == (4 if first == "world" else 5)


def test_a_recording_is_read_frame_by_frame(sheet, tmp_path):
    hashes = []
    with sheet.create_world() as world, world.record(tmp_path / "a.wisp"):
        world.run(4, callback=lambda world: hashes.append(world.hash()))
        last = world.points("sheet").copy()
        triangles = world.triangles("sheet").copy()
    with wisp.Recording(tmp_path / "a.wisp") as recording:
        assert (recording.frame_count, recording.frame, recording.time) == (5, 0, 0)
        assert [body.name for body in recording.bodies] == ["sheet", "ball"] and recording.dt == pytest.approx(1 / 60)
        recording.seek(4)
        assert recording.hash() == hashes[-1] and recording.time == pytest.approx(4 / 60)
        assert np.array_equal(recording.points("sheet"), last) and np.array_equal(recording.triangles("sheet"), triangles)
        for frame in (-1, 5, 1.5):
            with pytest.raises(wisp.BadInput, match="frame: got"):
                recording.seek(frame)
        with pytest.raises(wisp.BadInput, match="got body 'floor', expected one of sheet, ball"):
            recording.points("floor")
        with pytest.raises(wisp.BadInput, match="'sheet' has no strands"):
            recording.offsets("sheet")
    with pytest.raises(wisp.Conflict, match="the recording is closed"):
        recording.seek(0)


def test_strands_of_a_recording(hair, tmp_path):
    with hair.create_world() as world, world.record(tmp_path / "a.wisp"):
        world.step()
    with wisp.Recording(tmp_path / "a.wisp") as recording:
        assert recording.bodies[0].kind == "strands" and recording.offsets("hair").tolist() == list(range(0, 161, 8))


def test_damaged_and_missing_recordings_are_refused(sheet, tmp_path):
    with sheet.create_world() as world, world.record(tmp_path / "a.wisp"):
        world.run(2)
    content = bytearray((tmp_path / "a.wisp").read_bytes())
    (tmp_path / "cut.wisp").write_bytes(content[:-600])
    cut = wisp.Recording(tmp_path / "cut.wisp")
    assert not cut.is_complete and cut.frame_count == 2
    content[-200] ^= 1
    (tmp_path / "bad.wisp").write_bytes(content)
    bad = wisp.Recording(tmp_path / "bad.wisp")
    with pytest.raises(wisp.BadInput, match="frame 2"):
        bad.seek(2)
    (tmp_path / "none.wisp").write_bytes(b"nothing")
    with pytest.raises(wisp.BadInput, match="none.wisp"):
        wisp.Recording(tmp_path / "none.wisp")
    with pytest.raises(wisp.IoError, match="gone.wisp"):
        wisp.Recording(tmp_path / "gone.wisp")


def test_a_file_that_cannot_be_written_is_an_error_of_the_system(sheet, tmp_path):
    (tmp_path / "full.wisp").symlink_to("/dev/full")
    with sheet.create_world() as world:
        with pytest.raises(wisp.IoError, match="none"):
            world.record(tmp_path / "none" / "a.wisp")
        world.step()  # no recorder is left
        with pytest.raises(wisp.IoError, match="full.wisp: cannot write"):
            world.record(tmp_path / "full.wisp")
        world.run(2)
    scene = sheet.with_text(sheet.text.replace('"steps": 40', '"output": [{"surface": "sheet", "file": "%s"}], "steps": 40' % (tmp_path / "none" / "a.obj")))
    with scene.create_world() as world:
        with pytest.raises(wisp.IoError, match="a.obj"):
            world.write_outputs()


def test_a_recorder_needs_steps_that_go_on(sheet, tmp_path):
    with sheet.create_world() as world:
        snapshot = world.snapshot()
        with world.record(tmp_path / "a.wisp"):
            with pytest.raises(wisp.Conflict, match="a recorder is open"):
                world.advance(0.1)
            with pytest.raises(wisp.Conflict, match="a recorder is open"):
                world.restore(snapshot)
        world.advance(0.1)
        world.restore(snapshot)
