"""A coefficient of restitution that decreases with the closing speed, e(v) = e/(1 + e_slope v):
against an independent event-driven solution, by what was measured at each impact, and as the limit
that a constant coefficient is.
"""

import pytest

from .driver import FMUS, run
from .test_clearance import NAMES, check, structure


def decreasing(seed):
    """A structure whose restitution halves at a speed about that of its impacts."""
    values = structure(seed)
    values["clearance"] *= 0.1
    return values | {"e": (0.5, 0.7, 0.9)[seed % 3], "e_slope": (0.1, 0.5, 2.0, 1.0)[seed % 4]}


def test_random_structures_move_as_an_independent_solver_says(fmu, tmp_path):
    regular, impacts = check(fmu, [decreasing(seed) for seed in range(4)], tmp_path)
    assert regular >= 3
    assert impacts > 50


@pytest.mark.slow
def test_sixty_structures_move_as_an_independent_solver_says(tmp_path):
    regular, impacts = check(FMUS["fmi3"], [decreasing(seed) for seed in range(60)], tmp_path)
    print(f"{regular} of 60 motions are regular, {impacts} impacts")
    assert regular > 30


def test_without_a_slope_nothing_changes_and_a_small_one_changes_little(fmu, tmp_path):
    values = structure(1) | {"clearance": 0.0}
    runs = [values, values | {"e_slope": 0.0}, values | {"e_slope": 1e-9}]
    plain, zero, small = run("clearance.ends", fmu, runs, [8.0] * 3, NAMES, cwd=tmp_path)
    assert zero == plain != small
    assert small == pytest.approx(plain, abs=1e-7)


@pytest.mark.parametrize("value", ["-1e-300", "nan", "1e101"])
def test_a_slope_out_of_range_is_refused_with_its_range(fmu, tmp_path, value):
    message = run("clearance.refusal", fmu, {"e_slope": float(value)}, cwd=tmp_path)
    assert "e_slope = " in message and "0.0 <= e_slope <= 1e+100" in message
