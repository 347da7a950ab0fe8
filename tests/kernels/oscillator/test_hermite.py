"""The quintic between two nodes and its Bernstein coefficients, against its own polynomial."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from fmu_src.kernels.numerics.elementary import sincos_turns
from fmu_src.kernels.oscillator import hermite, nodes
from fmu_src.kernels.oscillator import memory as at

from .kernel import examples, flight, structures

H = 0.3
S = np.linspace(0.0, 1.0, 2001)
TRIANGLE = np.array([[math.comb(k, i) / math.comb(5, i) for i in range(6)] for k in range(6)])
POWERS = np.linalg.inv(TRIANGLE)  # of s, from Bernstein coefficients


def interval(quintic, remainder=0.0):
    """A memory with a quintic's values and derivatives at both ends of an interval from 2 on."""
    m = [0.0] * at.SIZE
    m[at.SPACING], m[at.LEFT_AGE], m[at.RIGHT_AGE] = H, 2.0, 2.0 + H
    m[at.HERMITE], m[at.HERMITE + 1], m[at.HERMITE + 2] = H / 5.0, H * H / 20.0, H**6 / 28800.0
    for slot, s in ((at.LEFT_VALUES, 0.0), (at.RIGHT_VALUES, 1.0)):
        for k in range(3):
            m[slot + k] = float(quintic.deriv(k)(s)) / H**k if k else float(quintic(s))
    m[at.REMAINDER] = remainder
    return m


def quintics(seed, count, spread=1.0):
    """Of s in [0, 1], by their Bernstein coefficients; with these."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        b = spread * rng.normal(size=6) + rng.choice([0.0, 1.0, 3.0])
        yield rng, of_bernstein(b), b


def of_bernstein(b):
    return Polynomial(POWERS @ b)


def test_coefficients_of_values_and_derivatives():
    for _, quintic, b in quintics(1, 200):
        m = interval(quintic, 0.125)
        assert hermite.interval_coefficients(m, 0.0) == pytest.approx(b, abs=1e-12)
        lowered = b - np.array([0.0, 0.0, 0.25, 0.25, 0.0, 0.0])
        assert hermite.interval_coefficients(m, 0.25) == pytest.approx(lowered, abs=1e-12)
        left, right = m[at.LEFT_VALUES :][:3], m[at.RIGHT_VALUES :][:3]
        after, before = (
            hermite.lowest_left_coefficient(m, *left, 0.25),
            hermite.lowest_right_coefficient(m, *right, 0.25),
        )
        assert after == pytest.approx(lowered[:3].min(), abs=1e-12)
        assert before == pytest.approx(lowered[3:5].min(), abs=1e-12)
        raised = b + np.array([0.0, 0.0, 0.125, 0.125, 0.0, 0.0])
        assert hermite.is_interval_below(m, raised.max() + 1e-9)
        assert not hermite.is_interval_below(m, raised.max() - 1e-9)


def test_each_coefficient_counts_for_having_no_root():
    for k in range(6):
        b = [1.0] * 6
        b[k] = 0.0
        assert hermite.excludes_root(*b) == (k < 5)
        b[k] = -1e-9
        assert not hermite.excludes_root(*b)


def test_a_part_is_clear_where_its_coefficients_are():
    clear = 0
    for rng, quintic, b in quintics(2, 1000):
        s = float(rng.uniform(0.05, 1.0))
        lowest = (TRIANGLE @ (quintic.coef * s ** np.arange(6))).min()  # of the part up to s
        if abs(lowest) > 1e-12:
            assert hermite.is_part_clear(*b, s) == (lowest >= 0.0)
            clear += lowest >= 0.0
    assert 100 < clear < 900


def test_the_clear_part_ends_closely_before_the_last_root():
    """Of a quintic that falls throughout, if Newton's method gets there; any has no root in it."""
    short, tried = [], 0
    for rng, quintic, b in quintics(3, 500):
        part = hermite.clear_part(*b)
        assert not part or quintic(part * S[1:]).min() > 0.0
        falling = np.sort(rng.normal(size=6))[::-1]
        if falling[0] > 0.0 > falling[-1]:
            root = S[np.argmax(of_bernstein(falling)(S) <= 0.0)]
            part, crossing = hermite.clear_part(*falling), hermite.point_before_last_root(*falling)
            assert part < root and part in (0.0, crossing)
            tried += 1
            short += [root - part] if part else []
    short = np.array(short)
    assert len(short) > 0.5 * tried
    assert (short < 1e-3).mean() > 0.99 and (short > 2e-4).mean() > 0.5


def test_a_positive_end_behind_a_low_middle_leaves_half():
    """Both halves' ends are positive; no crossing is sought."""
    assert hermite.clear_part(1.0, 1.0, -0.2, 0.9, 1.0, 1.0) == 0.5
    assert hermite.clear_part(1.0, -1.0, -1.0, 1.0, 1.0, 1.0) == 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_no_summit_is_overlooked_and_a_clear_slope_is_seen(sign):
    """What the quintic misses is added or taken: the remainder times 20 s^3 (1 - s)^3 / (5/16)."""
    seen = 0
    bump = Polynomial([0.0, 0.0, 0.0, 1.0]) * Polynomial([1.0, -1.0]) ** 3
    for rng, quintic, b in quintics(4, 600, spread=0.1):
        tilted = quintic + Polynomial([0.0, float(rng.normal(scale=3.0))])
        low = float(np.exp(rng.uniform(-6.0, 0.0)))
        m = interval(tilted, low)
        a = float(rng.uniform(0.0, 1.0))
        z = a + (1.0 - a) * float(rng.uniform(0.0, 1.0)) ** 2
        slope = (tilted + sign * 40.0 * low * bump).deriv()(a + (z - a) * S)
        summit = hermite.may_have_summit(m, 2.0 + H * a, 2.0 + H * z)
        assert summit or slope.min() > 0.0 or slope.max() < 0.0
        length, third = z - a, 60.0 * np.abs(np.diff(b, 3)).max() + 240.0 * low
        change = (abs(tilted.deriv(2)(a)) + 15.0 * low + 0.5 * third * length) * length
        if abs(tilted.deriv()(a)) > 1.1 * (change + 2.15 * low):
            seen += 1
            assert not summit
    assert seen > 80


@pytest.mark.parametrize("length", [0.1, 1.0])
def test_a_line_has_no_summit_where_it_is_steeper_than_what_may_be_missed(length):
    """By a sixth derivative of 28,800 remainders: in slope, curvature and third derivative."""
    missed = 28800.0 * (math.sqrt(5.0) / 30000.0 + length / 1920.0 + 0.5 * length**2 / 120.0)
    for part, summit in ((0.99, True), (1.01, False)):
        m = interval(Polynomial([1.0, part * missed]), 1.0)
        assert hermite.may_have_summit(m, 2.0, 2.0 + H * length) == summit


AGES = st.lists(st.floats(0.0, 300.0), min_size=2, max_size=8)
STEEP = {"m2": 0.35, "k2": 0.468, "d1": 0.03, "d2": 0.9765, "box_frequency": 1.111}


def closed_form(m, age):
    sine, cosine = sincos_turns(m[at.TURN] + m[at.ETA_TURNS] * age)
    x_a, v_a = nodes.free_part_after(m, at.OSCILLATOR_1, m[at.FREE_A], m[at.FREE_A + 1], age)
    x_b, v_b = nodes.free_part_after(m, at.OSCILLATOR_2, m[at.FREE_B], m[at.FREE_B + 1], age)
    return x_a, v_a, x_b, v_b, cosine, sine


@examples(60)
@given(structures() | st.just({**STEEP, "phase_start": 0.35}), AGES)
def test_they_are_those_of_the_closed_form(values, ages):
    m = flight(-0.9, 0.95, 0.7, 0.24, **values)
    size = max(1.0, *(abs(m[i]) for i in range(at.FREE_A, at.FREE_A + 4)))
    rate = m[at.RATE]
    for age in (0.45 * m[at.SPACING], 0.55 * m[at.SPACING], 0.999 * m[at.SPACING], *ages):
        found, expected = nodes.phasors_at(m, age), closed_form(m, age)
        for k in range(6):
            error = abs(found[k] - expected[k])
            if k >= 4:
                assert error <= 1e-15 * (8.0 + m[at.ETA] * age), k
            else:
                assert error <= 4e-15 * size * (rate if k % 2 else 1.0) * (8.0 + rate * age), k


@examples(40)
@given(structures())
def test_what_a_quintic_misses_is_bounded_closely(values):
    """A sixth derivative that stays 1 is missed by s^3 (1 - s)^3 h^6/720, against b_2 and b_3."""
    m = flight(-0.9, 0.95, 0.7, 0.24, **values)
    s = np.linspace(0.01, 0.99, 99)
    missed = (s * (1.0 - s)) ** 3 * m[at.SPACING] ** 6 / 720.0
    lowered = 10.0 * s**2 * (1.0 - s) ** 3 + 10.0 * s**3 * (1.0 - s) ** 2
    assert m[at.HERMITE + 2] == pytest.approx((missed / lowered).max(), rel=1e-12, abs=0.0)
