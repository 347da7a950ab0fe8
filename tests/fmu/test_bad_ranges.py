"""Ranges of ``modelDescription.xml`` hold in the FMU, and a refused call changes nothing."""

import math

import pytest

from .driver import FMUS, run, run_with_output


def test_every_range_holds(fmu, tmp_path):
    """NaN, infinities and the numbers next to the ends are refused, the ends themselves are not;
    before and after initialisation.
    """
    tried, missed, kept, same = run("bad_ranges.ranges", fmu, cwd=tmp_path)
    assert tried >= 5 * (18 + 6)
    assert missed == []
    assert kept == []
    assert same


def test_a_refused_set_sets_nothing(fmu, tmp_path):
    """One bad value in a list: the good ones before and after it are not taken over either."""
    assert run("bad_ranges.a_refused_set_sets_nothing", fmu, cwd=tmp_path) == [1.0, 1.0, 1.0]


def test_a_refused_step_leaves_the_instance_where_it_was(fmu, tmp_path):
    """After a step that cannot be done the run goes on with the bits it would have had."""
    (refusals, unmoved, spoilt), (_, _, plain) = run(
        "bad_ranges.a_refused_step_leaves_the_instance_where_it_was", fmu, cwd=tmp_path
    )
    assert refusals == 5
    assert unmoved
    assert spoilt == plain


def test_stderr_has_the_message_where_logging_is_off(tmp_path):
    """An importer that has logging off is told nothing by pythonfmu, so the FMU itself tells."""
    logged, done = run_with_output(
        "bad_ranges.stderr_has_the_message_where_logging_is_off", FMUS["fmi2-python"], cwd=tmp_path
    )
    assert [status > 1 for status, _ in logged] == [True, True]
    assert [messages for _, messages in logged] == [[], []]
    first, second = done.stderr.splitlines()
    assert "'quiet': m1 = -2.0 kg: expected 1e-30 <= m1 <= 1e+30" in first
    assert "'quiet': communicationStepSize = -1.0 s: expected" in second


def test_long_step_ends(fmu, tmp_path):
    """A step of some thousand periods is no hang, and zero length is no step back."""
    before, after = run("bad_ranges.long_step_ends", fmu, cwd=tmp_path, timeout=60)
    assert before["impact_count"] > 1e5
    assert after["x_rel_max"] == pytest.approx(before["x_rel"], abs=1e-14)
    assert after == {
        **before,
        "box_impulse": 0.0,
        "box_impulse_moment": 0.0,
        "x_rel_max": after["x_rel_max"],
        "evaluations": 0,
    }
    assert all(math.isfinite(value) for value in before.values())


def test_overdamped_masses_are_supported(fmu, tmp_path):
    """Overdamping is in range, so it has to give right numbers: mass 2 creeps back alone, as its
    closed form says.
    """
    root = math.sqrt(2.5**2 - 1.2)
    for (x2, v2, count), time in zip(
        run("bad_ranges.overdamped_masses_are_supported", fmu, cwd=tmp_path),
        (0.5, 2.0, 6.0),
        strict=True,
    ):
        slow, fast = -2.5 + root, -2.5 - root
        a = -0.5 * fast / (slow - fast)
        b = 0.5 - a
        assert count == 0
        assert x2 == pytest.approx(a * math.exp(slow * time) + b * math.exp(fast * time), rel=1e-12)
        assert v2 == pytest.approx(
            slow * a * math.exp(slow * time) + fast * b * math.exp(fast * time), rel=1e-12
        )
