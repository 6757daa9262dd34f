"""Errors against converged runs, and the tuner."""
import json
import os
import pathlib

import pytest

import wisp


def rows_of(text):
    return [{**row, "error": row["error"] or {}} for row in json.loads(text)["rows"]]


@pytest.mark.parametrize("length, parts", [(0.1, False), (0.6, True)])
def test_accuracy_tune_and_python_tell_the_same_errors(sheet, program, tmp_path, monkeypatch, length, parts):
    (tmp_path / "sheet.yaml").write_text(sheet.text)
    monkeypatch.setenv("WISP_CACHE", str(tmp_path / "of_programs"))
    options = ("sheet.yaml", "--workers", 1, "--format", "json")
    accuracy = rows_of(program("accuracy", *options, "--quick", "--length", length))
    tune = rows_of(program("tune", *options, "--error", 10, "--length", length))

    monkeypatch.setenv("WISP_CACHE", str(tmp_path / "of_python"))
    scene = wisp.Scene.from_file(tmp_path / "sheet.yaml")
    reference = wisp.Reference(scene, length=length)
    # the very same runs: what decides about their motion is in their names
    kept = [sorted(path.name for path in (tmp_path / folder).iterdir()) for folder in ("of_programs", "of_python")]
    assert set(kept[1]) <= set(kept[0]) and len(kept[1]) == 2

    count = 0
    for row in accuracy:
        if row["variant"].startswith("as written"):
            values = row["error"]
            run = reference.measure(scene.with_parameters(substeps=int(row["variant"].split("=")[1])))
            error = [value for key, value in values.items() if key.startswith("RMS_distance")]
            assert error == [pytest.approx(1e3 * run.error, rel=1e-4)]
            assert values["largest_distance_mm"] == pytest.approx(1e3 * run.largest, rel=1e-4)
            assert values["until_s"] == pytest.approx(reference.until)
            assert values["doubt_mm"] == pytest.approx(1e3 * reference.doubt, rel=1e-4)
            count += 1
    assert count >= 2 and reference.parts == parts and reference.until <= length + 1e-6

    found = {tuple(sorted(trial.parameters.items())): trial for trial in wisp.tune(scene, error=10, length=length, workers=1).trials}
    for row in tune:
        parameters = {key: row["size"][key] for key in (parameter.name for parameter in scene.parameters)}
        errors = [reference.measure(scene.with_parameters(parameters)).error]
        key = tuple(sorted(parameters.items()))
        errors += [found[key].error] if key in found else []
        assert errors == [pytest.approx(row["error"]["rms_m"], rel=1e-4)] * len(errors)
    assert len(tune) >= 2


def test_more_substeps_are_nearer_to_the_reference(sheet):
    reference = wisp.Reference(sheet, length=0.5)
    errors = [reference.measure(sheet.with_parameters({"cloth.tethers": 0, "cloth.coarse_substeps": 0}, substeps=n)).error for n in (1, 4, 16)]
    assert errors[0] > errors[1] > errors[2] > 0
    assert reference.doubt < errors[2] and 0 < reference.until <= 0.5


def test_the_tuner_finds_parameters_within_the_error(sheet):
    runs = []
    found = wisp.tune(sheet, error=0.1, length=0.3, limit=600, progress=lambda run, most: runs.append((run, most)))
    assert found.meets_target and found.error <= 0.1 and not found.stopped_early
    assert len(runs) == found.runs and runs[-1][0] == found.runs
    assert set(found.parameters) == {parameter.name for parameter in sheet.parameters}
    assert any(trial.is_pareto for trial in found.trials) and not any(trial.halted for trial in found.trials)
    tuned = sheet.with_parameters(found.parameters)
    assert wisp.Reference(sheet, length=0.3).measure(tuned).error == pytest.approx(found.error, rel=1e-6)


def test_the_tuner_finds_the_most_accurate_parameters_within_a_time(sheet):
    found = wisp.tune(sheet, budget_ms=1000, length=0.1, limit=600)
    assert found.meets_target and found.error == min(trial.error for trial in found.trials)


def test_an_error_that_is_out_of_reach_is_told(sheet):
    found = wisp.tune(sheet, error=1e-12, length=0.1, limit=600)
    assert not found.meets_target and found.error > 1e-12


def test_progress_may_end_the_search_and_its_exceptions_pass_through(sheet):
    found = wisp.tune(sheet, error=1e-12, length=0.1, progress=lambda run, most: run < 3)
    assert found.stopped_early and found.runs == 3

    def fail(run, most):
        raise LookupError("here")

    with pytest.raises(LookupError, match="here"):
        wisp.tune(sheet, error=0.01, length=0.1, progress=fail)
    assert wisp.tune(sheet, error=0.1, length=0.1).runs > 0  # nothing is left of it


@pytest.mark.parametrize("options", [{}, {"error": 0.1, "budget_ms": 1}, {"error": 0}, {"error": float("nan")}, {"error": 1, "limit": 0}, {"error": 1, "length": -1}])
def test_wrong_targets_are_refused(sheet, options):
    with pytest.raises(wisp.BadInput, match="tune"):
        wisp.tune(sheet, **options)


def test_a_scene_in_which_nothing_moves_is_refused(scenes):
    scene = wisp.Scene.from_file(scenes / "empty.yaml")
    assert scene.parameters == ()
    for use in (lambda: wisp.Reference(scene), lambda: wisp.tune(scene, error=1), lambda: scene.create_world(reference=True)):
        with pytest.raises(wisp.BadInput, match="moves"):
            use()


def test_other_scenes_cannot_be_compared(sheet, hair):
    reference = wisp.Reference(sheet, length=0.1)
    with pytest.raises(wisp.BadInput, match="it has no body of the reference"):
        reference.measure(hair)
    with pytest.raises(wisp.BadInput, match="no step ends at"):
        reference.measure(sheet.with_text(sheet.text.replace('"steps": 40', '"dt": 0.01, "steps": 40')))
    with pytest.raises(wisp.BadInput, match="length: got -1"):
        wisp.Reference(sheet, length=-1)


def test_the_reference_world_has_the_finest_parameters(sheet):
    with sheet.create_world(reference=True, factor=2) as world, sheet.create_world() as own:
        world.run(3)
        own.run(3)
        assert world.hash() != own.hash()
