"""Errors against converged runs, and the tuner."""
import pytest

import wisp


def test_the_error_is_that_of_the_tuner(sheet):
    found = wisp.tune(sheet, error=0.005, limit=600)
    reference = wisp.Reference(sheet)
    assert reference.steps == 40
    for trial in found.trials[:6]:
        measured = reference.measure(sheet.with_parameters(trial.parameters))
        assert measured.error == pytest.approx(trial.error, rel=1e-6) and measured.largest >= measured.error


def test_more_substeps_are_nearer_to_the_reference(sheet):
    reference = wisp.Reference(sheet, seconds=0.5)
    errors = [reference.measure(sheet.with_parameters({"cloth.tethers": 0, "cloth.coarse_substeps": 0}, substeps=n)).error for n in (1, 4, 16)]
    assert errors[0] > errors[1] > errors[2] > 0
    assert reference.ms > 0


def test_the_tuner_finds_parameters_within_the_error(sheet):
    runs = []
    found = wisp.tune(sheet, error=0.1, seconds=0.3, limit=600, progress=lambda run, most: runs.append((run, most)))
    assert found.meets_target and found.error <= 0.1 and not found.stopped_early
    assert len(runs) == found.runs and runs[-1][0] == found.runs
    assert set(found.parameters) == {parameter.name for parameter in sheet.parameters}
    assert any(trial.is_pareto for trial in found.trials) and not any(trial.halted for trial in found.trials)
    tuned = sheet.with_parameters(found.parameters)
    assert wisp.Reference(sheet, seconds=0.3).measure(tuned).error == pytest.approx(found.error, rel=1e-6)


def test_the_tuner_finds_the_most_accurate_parameters_within_a_time(sheet):
    found = wisp.tune(sheet, budget_ms=1000, seconds=0.1, limit=600)
    assert found.meets_target and found.error == min(trial.error for trial in found.trials)


def test_an_error_that_is_out_of_reach_is_told(sheet):
    found = wisp.tune(sheet, error=1e-12, seconds=0.1, limit=600)
    assert not found.meets_target and found.error > 1e-12


def test_progress_may_end_the_search_and_its_exceptions_pass_through(sheet):
    found = wisp.tune(sheet, error=1e-12, seconds=0.1, progress=lambda run, most: run < 3)
    assert found.stopped_early and found.runs == 3

    def fail(run, most):
        raise LookupError("here")

    with pytest.raises(LookupError, match="here"):
        wisp.tune(sheet, error=0.01, seconds=0.1, progress=fail)
    assert wisp.tune(sheet, error=0.1, seconds=0.1).runs > 0  # nothing is left of it


@pytest.mark.parametrize("options", [{}, {"error": 0.1, "budget_ms": 1}, {"error": 0}, {"error": float("nan")}, {"error": 1, "limit": 0}, {"error": 1, "seconds": -1}])
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
    reference = wisp.Reference(sheet, seconds=0.1)
    with pytest.raises(wisp.Conflict, match="got 160 points, expected 81"):
        reference.measure(hair)
    with pytest.raises(wisp.Conflict, match="got steps of"):
        reference.measure(sheet.with_text(sheet.text.replace('"steps": 40', '"dt": 0.01, "steps": 40')))
    with pytest.raises(wisp.BadInput, match="seconds: got -1"):
        wisp.Reference(sheet, seconds=-1)


def test_the_reference_world_has_the_finest_parameters(sheet):
    with sheet.create_world(reference=True, factor=2) as world, sheet.create_world() as own:
        world.run(3)
        own.run(3)
        assert world.hash() != own.hash()
