"""The longest step is bounded: where ``evaluation_limit`` is reached, a step is discarded."""

import pytest

from .driver import BUILD, FORMS, run

MODELS = ("TwoMassImpactOscillator", "MotorShaker", "ElectrodynamicShaker")
DISCARD = 2
forms = pytest.mark.parametrize("form", FORMS)
models = pytest.mark.parametrize("model", MODELS)


@forms
@models
def test_a_step_that_reaches_its_limit_is_discarded_and_changes_nothing(form, model, tmp_path):
    path = BUILD / form / f"{model}.fmu"
    status, messages, before, after = run(
        "evaluation_limit.a_discarded_step", path, model, 13, cwd=tmp_path
    )
    assert status == DISCARD
    (message,) = messages
    assert "is discarded: evaluation_limit = 13" in message
    assert " evaluations" in message and "reached" in message
    assert "expected a shorter step, or a larger limit" in message
    assert after == before


@forms
@pytest.mark.parametrize("model", ["TwoMassImpactOscillator", "ElectrodynamicShaker"])
def test_a_run_of_divided_steps_comes_to_the_same_bits(form, model, tmp_path):
    """Through chattering, or limits: whatever was discarded has left no trace."""
    path = BUILD / form / f"{model}.fmu"
    limited, discarded, most, free = run(
        "evaluation_limit.divided_steps", path, model, 9, cwd=tmp_path
    )
    assert discarded > 10 and 0 < most < 9
    assert limited == free


@forms
def test_a_shaker_goes_on_by_shorter_steps(form, tmp_path):
    """Its formula has 12 evaluations a sub-step."""
    path = BUILD / form / "MotorShaker.fmu"
    limited, discarded, most, free = run(
        "evaluation_limit.divided_steps", path, "MotorShaker", 40, cwd=tmp_path
    )
    assert discarded > 0 and 12 <= most <= 48
    for name, value in limited.items():
        expected = float.fromhex(free[name])
        assert float.fromhex(value) == pytest.approx(expected, rel=1e-8, abs=1e-12), name


@forms
def test_an_output_counts_the_evaluations_of_a_step(form, tmp_path):
    path = BUILD / form / "TwoMassImpactOscillator.fmu"
    first, *others = run("evaluation_limit.evaluations", path, cwd=tmp_path)
    assert first > 0 and others == [0, 0]


@forms
@pytest.mark.parametrize("value", [0, -1, 10_000_001])
def test_a_limit_out_of_range_is_refused(form, value, tmp_path):
    path = BUILD / form / "TwoMassImpactOscillator.fmu"
    (message,) = run("evaluation_limit.a_limit_out_of_range", path, value, cwd=tmp_path)
    assert f"evaluation_limit = {value}: expected 1 <= evaluation_limit <= 10000000" in message
