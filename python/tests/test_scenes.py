"""Scenes from files, texts and dicts."""
import copy
import json
import pickle
import re

import numpy as np
import pytest
import yaml

import wisp
from conftest import SHEET


class Loader(yaml.SafeLoader):
    """PyYAML follows YAML 1.1, where 1e-6 without a point is a text."""


Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"^[-+]?[0-9.]+[eE][-+]?[0-9]+$"), list("-+0123456789."))


def run_hash(scene, steps=None):
    with scene.create_world() as world:
        world.run(steps)
        return world.hash()


@pytest.mark.parametrize("name", ["flag", "hanging_cloth", "swinging_guides", "frozen_and_thawed", "balloons", "moving_floor_cloth"])
def test_file_text_and_dict_give_the_hash_of_the_program(scenes, program_hash, name):
    path = scenes / f"{name}.yaml"
    expected = program_hash(path, "--steps", "20")
    text = path.read_text()
    assert run_hash(wisp.Scene.from_file(path), 20) == expected
    assert run_hash(wisp.Scene.from_text(text, name=path), 20) == expected
    assert run_hash(wisp.Scene.from_dict(yaml.load(text, Loader), folder=scenes), 20) == expected


def test_every_scene_of_the_tree_has_the_hash_of_the_program(scenes, program_hash):
    for path in sorted(scenes.glob("*.yaml")):
        # It computes nothing, on purpose; a world here always computes points, which become part of the hash.
        if path.name != "empty.yaml":
            assert run_hash(wisp.Scene.from_file(path), 3) == program_hash(path, "--steps", "3"), path.name


def test_a_scene_says_what_it_is(sheet):
    assert sheet.steps == 40
    assert sheet.dt == pytest.approx(1 / 60)
    assert sheet.gravity == pytest.approx((0, -9.81, 0))
    substeps = sheet.parameters[0]
    assert (substeps.name, substeps.value, substeps.unordered) == ("substeps", 4, False)
    assert substeps.values == (1, 2, 4, 8, 16)
    assert json.loads(sheet.text)["surfaces"][0]["name"] == "sheet"


def test_arrays_give_the_bits_of_a_generated_mesh(sheet):
    points, triangles = wisp.grid(9, 9, 0.05)
    entry = {**SHEET["surfaces"][0], "points": points, "triangles": triangles}
    del entry["generate"]
    with sheet.create_world() as world:
        assert np.array_equal(world.triangles("sheet"), triangles)
    assert run_hash(wisp.Scene.from_dict({**SHEET, "surfaces": [entry]})) == run_hash(sheet)


def test_strands_of_arrays_move_as_those_of_a_file(hair, tmp_path):
    with hair.create_world() as world:
        points, offsets = world.points("hair").copy(), world.offsets("hair").copy()
    entry = {"name": "hair", "dynamics": {}}
    flat = wisp.Scene.from_dict({"steps": 5, "strands": [{**entry, "points": points, "offsets": offsets}]})
    cube = wisp.Scene.from_dict({"steps": 5, "strands": [{**entry, "points": points.reshape(20, 8, 3)}]})
    written = {**entry, "output": None}
    del written["output"]
    with wisp.Scene.from_dict({"steps": 0, "strands": [{**entry, "points": points, "offsets": offsets}],
                               "output": [{"strands": "hair", "file": str(tmp_path / "hair.hair")}]}).create_world() as world:
        world.write_outputs()
    of_file = wisp.Scene.from_dict({"steps": 5, "strands": [{**written, "file": "hair.hair"}]}, folder=tmp_path)
    assert run_hash(flat) == run_hash(cube) == run_hash(of_file)


def test_a_mesh_collider_may_be_arrays():
    tetrahedron = np.array([[0, 0.45, 0], [0.2, 0, 0.2], [-0.2, 0, 0.2], [0, 0, -0.2]])
    faces = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]
    scene = {**SHEET, "colliders": [{"name": "rock", "shape": "mesh", "points": tetrahedron, "triangles": faces}]}
    with wisp.Scene.from_dict(scene).create_world() as world:
        world.run()
        assert np.allclose(world.points("rock"), tetrahedron)
        assert world.points("sheet")[:, 1].min() > 0.0


def test_numpy_numbers_and_lists_stand_for_plain_ones(sheet):
    scene = copy.deepcopy(SHEET)
    scene["steps"] = np.int64(40)
    scene["surfaces"][0]["pins"] = np.array([0, 8])
    scene["surfaces"][0]["transform"]["translate"] = np.array([0, 0.5, 0], dtype=np.float32)
    scene["colliders"][0]["radius"] = np.float32(0.1)
    assert run_hash(wisp.Scene.from_dict(scene)) == run_hash(sheet)


def test_the_dict_and_its_arrays_are_copied_and_unchanged():
    points, triangles = wisp.grid(4, 4, 0.1)
    given = {"steps": 3, "surfaces": [{"name": "sheet", "points": points, "triangles": triangles, "cloth": {}}]}
    before = copy.deepcopy(given)
    scene = wisp.Scene.from_dict(given)
    assert list(given["surfaces"][0]) == list(before["surfaces"][0]) and np.array_equal(points, before["surfaces"][0]["points"])
    expected = run_hash(scene)
    points[:] = np.nan
    assert run_hash(scene) == expected


def test_parameters_change_the_text_and_nothing_else(scenes):
    scene = wisp.Scene.from_file(scenes / "flag.yaml")
    other = scene.with_parameters({"cloth.tethers": 1}, substeps=8)
    assert {p.name: p.value for p in other.parameters}["cloth.tethers"] == 1
    changed = [line for line, was in zip(other.text.split("\n"), scene.text.split("\n")) if line != was]
    assert changed[0] == "substeps: 8"
    assert other.text.startswith("# A flag of 0.9 m") and scene.text == (scenes / "flag.yaml").read_text()


def test_parameters_of_arrays_keep_the_arrays():
    points, triangles = wisp.grid(4, 4, 0.1)
    scene = wisp.Scene.from_dict({"steps": 2, "surfaces": [{"name": "sheet", "points": points, "triangles": triangles, "cloth": {}}]})
    with scene.with_parameters(substeps=2).create_world() as world:
        assert world.body("sheet").vertex_count == 16
    with scene.with_text(scene.text).create_world() as world:
        assert world.body("sheet").vertex_count == 16


def test_a_scene_can_be_pickled_and_copied():
    points, triangles = wisp.grid(4, 4, 0.1)
    scene = wisp.Scene.from_dict({"steps": 2, "surfaces": [{"name": "sheet", "points": points, "triangles": triangles, "cloth": {}}]})
    again = pickle.loads(pickle.dumps(scene))
    assert run_hash(again) == run_hash(copy.copy(scene)) == run_hash(scene)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"surfaces": 3}, "surfaces: got"),
        ({"steps": -1}, "steps: got -1"),
        ({"steps": "many"}, "steps: got the text 'many'"),
        ({"stepps": 3}, "stepps"),
        ({"gravity": [0, float("nan"), 0]}, "gravity"),
        ({"gravity": np.zeros((2, 2))}, "gravity"),
        ({3: 4}, "got the key 3, expected a text"),
        ({"steps": {1, 2}}, "scene.steps: got set"),
        ({"wisp": 2}, "got version 2"),
    ],
)
def test_a_wrong_dict_is_refused_with_the_place(change, message):
    with pytest.raises(wisp.BadInput) as caught:
        wisp.Scene.from_dict({**SHEET, **change})
    assert message in str(caught.value)


GRID = wisp.grid(3, 3, 0.1)


@pytest.mark.parametrize(
    "entry, message",
    [
        ({"points": GRID[0]}, "surfaces[0]: got 'points' without 'triangles'"),
        ({"triangles": GRID[1]}, "surfaces[0]: got 'triangles' without 'points'"),
        ({"points": GRID[0], "triangles": GRID[1], "file": "a.obj"}, "got both 'points' and 'file'"),
        ({"points": GRID[0], "triangles": GRID[1], "generate": {}}, "got both 'points' and 'generate'"),
        ({"points": GRID[0][:, :2], "triangles": GRID[1]}, "surfaces[0].points: got float32 of shape (9, 2)"),
        ({"points": "here", "triangles": GRID[1]}, "surfaces[0].points: got"),
        ({"points": [[0, 0, 0], [1]], "triangles": GRID[1]}, "surfaces[0].points"),
        ({"points": GRID[0], "triangles": GRID[1].ravel()}, "surfaces[0].triangles: got shape (24,)"),
        ({"points": GRID[0], "triangles": GRID[1] + 0.5}, "surfaces[0].triangles: got float64"),
        ({"points": GRID[0], "triangles": GRID[1].astype(np.int64) + 2**40}, "expected integers of 32 bits"),
    ],
)
def test_wrong_arrays_are_refused_at_once(entry, message):
    with pytest.raises(wisp.BadInput) as caught:
        wisp.Scene.from_dict({"surfaces": [{"name": "sheet", **entry}]})
    assert message in str(caught.value)


@pytest.mark.parametrize(
    "points, triangles, message",
    [
        (np.full((9, 3), np.inf), GRID[1], "vertex 0: x is"),
        (GRID[0], GRID[1] + 5, "expected 0 .. 8"),
        (GRID[0], -GRID[1], "got vertex -"),
        (np.zeros((0, 3)), np.zeros((0, 3), dtype=int), "the mesh is empty"),
        (GRID[0], np.zeros((0, 3), dtype=int), "the mesh is empty"),
    ],
)
def test_a_wrong_mesh_is_refused_by_the_world_with_the_element(points, triangles, message):
    scene = wisp.Scene.from_dict({"surfaces": [{"name": "sheet", "points": points, "triangles": triangles, "cloth": {}}]})
    with pytest.raises(wisp.BadInput) as caught:
        scene.create_world()
    assert message in str(caught.value) and "surfaces[0].points" in str(caught.value)


@pytest.mark.parametrize(
    "strands, message",
    [
        ({"points": np.zeros((2, 3))}, "expected (strands, vertices, 3), or 'offsets'"),
        ({"points": np.zeros((2, 3)), "offsets": [0]}, "offsets: got shape (1,)"),
        ({"offsets": [0, 2]}, "got 'offsets' without 'points'"),
    ],
)
def test_wrong_strands_are_refused_at_once(strands, message):
    with pytest.raises(wisp.BadInput) as caught:
        wisp.Scene.from_dict({"strands": [{"name": "hair", "dynamics": {}, **strands}]})
    assert message in str(caught.value)


@pytest.mark.parametrize("offsets, message", [([1, 2], "strand 0 starts at vertex 1"), ([0, 5], "strand 0 runs from"), ([0, 2, 1], "strand"), ([0, 1], "the strands end")])
def test_wrong_offsets_are_refused_by_the_world(offsets, message):
    scene = wisp.Scene.from_dict({"strands": [{"name": "hair", "dynamics": {}, "points": np.zeros((2, 3)), "offsets": offsets}]})
    with pytest.raises(wisp.BadInput) as caught:
        scene.create_world()
    assert message in str(caught.value)


def test_messages_of_files_and_texts_name_line_and_column(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text("wisp: 1\nsteps: ten\n")
    for make in (lambda: wisp.Scene.from_file(path), lambda: wisp.Scene.from_text("wisp: 1\nsteps: ten\n", name=path)):
        with pytest.raises(ValueError) as caught:
            make()
        assert f"{path}:2:8: steps: got 'ten'" in str(caught.value)


def test_a_missing_scene_or_mesh_is_an_error_of_the_system(tmp_path):
    with pytest.raises(OSError) as caught:
        wisp.Scene.from_file(tmp_path / "none.yaml")
    assert isinstance(caught.value, wisp.IoError) and "none.yaml" in str(caught.value)
    with pytest.raises(wisp.IoError) as caught:
        wisp.Scene.from_dict({"surfaces": [{"name": "sheet", "file": "none.obj", "cloth": {}}]}, folder=tmp_path).create_world()
    assert "none.obj" in str(caught.value)


def test_any_value_of_a_scene_is_a_path_as_suites_have_it(sheet):
    finer = {"surfaces[0].generate.columns": np.int64(17), "surfaces[sheet].cloth": {"bending": "dihedral"}, "surfaces[*].pins": np.array([0, 16]),
             "colliders[ball]": None, "surfaces[0].collision": None, "substeps": 5}
    expected = copy.deepcopy(SHEET)
    expected["surfaces"][0].update(cloth={"bending": "dihedral"}, pins=[0, 16])
    expected["surfaces"][0]["generate"]["columns"] = 17
    expected.update(substeps=5, colliders=expected["colliders"][1:])
    del expected["surfaces"][0]["collision"]
    assert run_hash(sheet.with_parameters(finer)) == run_hash(wisp.Scene.from_dict(expected)) != run_hash(sheet)
    assert sheet.with_parameters(substeps=5).parameters[0].value == 5


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"colour": 3}, "colour"),
        ({"surfaces[1].damping": 1}, "'surfaces[1].damping' names nothing of the scene, such as surfaces[0].cloth.bending"),
        ({"surfaces[0].cloth.bending": "springs"}, "bending: got 'springs', expected"),
        ({"surfaces[0].cloth.wobble": 1}, "wobble"),
        ({"substeps": 0}, "substeps: got 0"),
        ({"substeps": 2.5}, "substeps: got '2.5', expected a whole number"),
        ({"substeps": float("nan")}, "substeps: got"),
        ({"substeps": "many"}, "substeps: got 'many', expected a whole number"),
        ({"dt": {1, 2}}, "dt: got set, expected a number"),
    ],
)
def test_paths_and_values_are_refused_by_the_reader(sheet, changes, message):
    with pytest.raises(wisp.BadInput) as caught:
        sheet.with_parameters(changes)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    "options, message",
    [
        ({"workers": -1}, "workers: got -1"),
        ({"workers": 65}, "workers: got 65"),
        ({"workers": 1.5}, "workers: got 1.5"),
        ({"workers": True}, "workers: got True"),
        ({"reference": True, "factor": 0}, "factor: got 0"),
        ({"isa": "sse9"}, "sse9"),
    ],
)
def test_wrong_options_of_a_world_are_refused(sheet, options, message):
    with pytest.raises(wisp.BadInput) as caught:
        sheet.create_world(**options)
    assert message in str(caught.value)


def test_the_number_of_workers_and_the_instruction_set_change_no_bit(sheet):
    hashes = set()
    for options in ({"workers": 1}, {"workers": 3}, {"workers": 1, "isa": "baseline"}):
        with sheet.create_world(**options) as world:
            assert world.workers == options["workers"]
            world.run()
            hashes.add(world.hash())
    assert len(hashes) == 1


@pytest.mark.parametrize("arguments", [(1, 3, 0.1), (3, 2**24, 0.1), (2.5, 3, 0.1)])
def test_a_grid_has_a_bounded_number_of_vertices(arguments):
    with pytest.raises(wisp.BadInput):
        wisp.grid(*arguments)


def test_names_with_zeros_are_refused():
    with pytest.raises(wisp.BadInput, match="zero in a file name"):
        wisp.Scene.from_file("a\0b")


def test_scenes_and_worlds_are_made_in_one_way():
    for make in (wisp.Scene, wisp.World, wisp.Recorder):
        with pytest.raises(TypeError, match="make"):
            make()
