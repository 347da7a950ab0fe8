"""No impact is missed, whatever the step: against small steps, at a graze, and against an
independent event-driven solution.
"""

import mpmath
import numpy as np
import pytest

from .driver import run


def test_giant_steps_count_what_small_steps_count(fmu, tmp_path):
    """From periodic to chaotic motion, with sticking: as many impacts and contacts in one step as
    in thousands.
    """
    for eta, giant, small in run(
        "no_impact_missed.giant_steps_count_what_small_steps_count", fmu, cwd=tmp_path
    ):
        assert giant[0] > 20, eta
        assert giant == small, eta


def test_small_steps_show_every_impact_one_by_one(fmu, tmp_path):
    """Steps so small that hardly two impacts share one: each impact is seen with its own time
    inside its step.
    """
    rows = run("no_impact_missed.small_steps_show_every_impact_one_by_one", fmu, cwd=tmp_path)
    assert len(rows) > 10
    for new, before, instant, after, closing in rows:
        assert new == 1
        assert before < instant <= after
        assert closing > 0.0


@pytest.mark.parametrize(("excess", "touches"), [(1e-9, True), (-1e-9, False)])
def test_graze_of_one_part_in_a_billion(fmu, tmp_path, excess, touches):
    """Mass 1 rests; undamped mass 2 swings down to the touching point and a billionth of its
    amplitude beyond, or short of it.

    With a constant acceleration g the rest positions are -g/k1 and -g/k2, so the gap is 1/k1 - 1/k2
    + A cos(omega_2 t) for g = 1.
    """
    middle = 1.0 - 1.0 / 1.2
    values = {"x1_start": -1.0, "x2_start": -1.0 / 1.2 + middle * (1.0 + excess)}
    count, largest = run(
        "no_impact_missed.graze_of_one_part_in_a_billion", fmu, values, cwd=tmp_path
    )
    assert (count > 0) == touches
    if not touches:
        assert largest == pytest.approx(2.0 * middle, rel=1e-8)


@pytest.mark.parametrize("eta", [0.9960688001316983, 1.0839052450562332, 1.0861113018963422])
def test_no_impact_is_made_out_of_rounding(fmu, tmp_path, eta):
    """Drawn apart from rest (phase pi), the gap grows for a second at least: there is nothing to
    count.
    """
    count, gap = run("no_impact_missed.no_impact_is_made_out_of_rounding", fmu, eta, cwd=tmp_path)
    assert gap > 1e-3
    assert count == 0


class Oscillator:
    """x'' + d/m x' + k/m x = a Omega^2 sin(Omega t), in closed form from (t0, x0, v0)."""

    def __init__(self, m, k, d, amplitude, frequency):
        self.decay, self.frequency = d / (2 * m), frequency
        self.natural = mpmath.sqrt(k / m - self.decay**2)
        detuning, twice = k / m - frequency**2, 2 * self.decay * frequency
        size = amplitude * frequency**2 / (detuning**2 + twice**2)
        self.sine, self.cosine = size * detuning, -size * twice

    def begin(self, t, x, v):
        s, c = mpmath.sin(self.frequency * t), mpmath.cos(self.frequency * t)
        self.t0 = t
        self.a = x - self.sine * s - self.cosine * c
        self.b = (
            v - self.frequency * (self.sine * c - self.cosine * s) + self.decay * self.a
        ) / self.natural

    def position(self, t, lib=mpmath):
        number = float if lib is np else mpmath.mpf
        tau = t - number(self.t0)
        free = lib.exp(-number(self.decay) * tau) * (
            number(self.a) * lib.cos(number(self.natural) * tau)
            + number(self.b) * lib.sin(number(self.natural) * tau)
        )
        angle = number(self.frequency) * t
        return free + number(self.sine) * lib.sin(angle) + number(self.cosine) * lib.cos(angle)

    def velocity(self, t):
        return mpmath.diff(self.position, t)


@mpmath.workdps(30)
def event_driven(p, end):
    """Impacts up to ``end`` as (time, closing speed) with 30 digits: dense scanning, then a
    bracketed root.
    """
    q = {name: mpmath.mpf(value) for name, value in p.items()}
    one = Oscillator(q["m1"], q["k1"], q["d1"], q["box_amplitude"], q["box_frequency"])
    two = Oscillator(q["m2"], q["k2"], q["d2"], q["box_amplitude"], q["box_frequency"])
    one.begin(mpmath.mpf(0), q["x1_start"], q["v1_start"])
    two.begin(mpmath.mpf(0), q["x2_start"], q["v2_start"])
    t, impacts, first = mpmath.mpf(0), [], 1e-7
    while True:
        grid = float(t) + np.concatenate(([first], np.linspace(2.0**-12, 30.0, 120000)))
        gap = two.position(grid, np) - one.position(grid, np)
        below = np.flatnonzero(gap < 0.0)
        if below.size == 0 or below[0] == 0 or grid[below[0] - 1] > end:
            assert below.size and below[0], "no impact, or one right after another"
            return impacts
        bracket = (mpmath.mpf(grid[below[0] - 1]), mpmath.mpf(grid[below[0]]))
        t = mpmath.findroot(
            lambda s: two.position(s) - one.position(s),
            bracket,
            solver="anderson",
            tol=1e-28,
            verify=False,
        )
        if t > end:
            return impacts
        u1, u2, x = one.velocity(t), two.velocity(t), one.position(t)
        impacts.append((float(t), float(u1 - u2)))
        common = (q["m1"] * u1 + q["m2"] * u2) / (q["m1"] + q["m2"])
        part = q["e"] * (u1 - u2) / (q["m1"] + q["m2"])
        one.begin(t, x, common - q["m2"] * part)
        two.begin(t, x, common + q["m1"] * part)


@pytest.mark.parametrize(
    "more",
    [
        {"box_frequency": 1.13, "box_amplitude": 1.0 / 1.13**2},
        {"box_frequency": 1.13, "m2": 1.75, "d2": 0.04, "e": 0.8, "box_amplitude": 0.5},
    ],
    ids=["equal masses", "unequal masses"],
)
def test_impacts_against_an_independent_solution(fmu, tmp_path, more):
    """Number, times and speeds of the impacts of a chaotic stretch; the rounding it amplifies
    bounds the difference.
    """
    values = {"m1": 1.0, "m2": 1.0, "k1": 1.0, "k2": 1.2, "d1": 0.01, "d2": 0.01, "e": 0.7}
    values |= {"x1_start": -0.25, "x2_start": 0.5, "v1_start": 0.125, "v2_start": -0.375, **more}
    expected = event_driven(values, 80.0)
    rows, (count, contacts) = run(
        "no_impact_missed.impacts_against_an_independent_solution", fmu, values, cwd=tmp_path
    )
    assert contacts == 0  # the reference knows none
    assert count == len(expected) == len(rows)
    assert count > 15
    times = np.array([instant for _, instant, _ in rows])
    assert times == pytest.approx([instant for instant, _ in expected], abs=1e-10)
    assert [closing for *_, closing in rows] == pytest.approx(
        [closing for _, closing in expected], abs=1e-10
    )
