"""Momentum, restitution and energy of an impact; sticking has no scale of its own."""

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator.impact import (
    chattering_ends,
    common_velocity,
    record_impact,
    restitution_coefficient,
    velocities_after_impact,
)

from .kernel import advanced, examples, least_work, rounded, sizes, started, unstarted

SPEEDS = rounded(-10.0, 10.0)


def structure(mu, e, m1=1.3, e_slope=0.0):
    """A memory that knows masses and restitution."""
    m = unstarted(m1=m1, m2=mu * m1, e=e, e_slope=e_slope)
    m[at.MU], m[at.OMEGA] = m[at.M2] / m[at.M1], 1.7
    m[at.SHARE] = 1.0 / (1.0 + m[at.MU])
    m[at.REDUCED_MASS] = m[at.M2] * m[at.SHARE]
    return m


def kinetic(m, v1, v2):
    return 0.5 * m[at.OMEGA] ** 2 * (m[at.M1] * v1 * v1 + m[at.M2] * v2 * v2)


@examples(200)
@given(*(sizes(1e-3, 1e3), st.floats(0.0, 1.0), st.just(0.0) | sizes(1e-6, 1e6), SPEEDS, SPEEDS))
def test_momentum_restitution_and_energy(mu, e, slope, v1, v2):
    """v' = -e(v) v with e(v) = e/(1 + slope v), v in m/s; nothing is gained, whatever e(v)."""
    assume(v1 > v2)
    m = structure(mu, e, e_slope=slope)
    closing, speed = v1 - v2, abs(v1) + abs(v2)
    now = restitution_coefficient(m, closing)
    assert now == pytest.approx(e / (1.0 + slope * m[at.OMEGA] * closing), rel=1e-15)
    w1, w2 = velocities_after_impact(m, v1, v2, now)
    assert w1 + mu * w2 == pytest.approx(v1 + mu * v2, abs=4e-15 * (1.0 + mu) * speed)
    assert w2 - w1 == pytest.approx(now * closing, abs=4e-15 * speed)
    record_impact(m, 0.0, closing, now, False)
    lost = kinetic(m, v1, v2) - kinetic(m, w1, w2)
    assert m[at.IMPACT_ENERGY] == pytest.approx(lost, abs=1e-13 * kinetic(m, speed, speed))
    assert lost >= -1e-13 * kinetic(m, speed, speed)


@examples(200)
@given(st.floats(0.0, 1.0), sizes(1e-6, 1e6), sizes(1e-12, 1e12), sizes(1e-12, 1e12))
def test_a_faster_impact_parts_faster_by_a_smaller_coefficient(e, slope, one, two):
    """And towards no speed the coefficient is e: chattering ends as with e."""
    m = structure(1.0, e, e_slope=slope)
    slow, fast = sorted((one, two))
    parting = [restitution_coefficient(m, v) * v for v in (slow, fast)]
    assert parting[0] <= parting[1] * (1.0 + 1e-15)
    assert e >= restitution_coefficient(m, slow) >= restitution_coefficient(m, fast) >= 0.0
    assert restitution_coefficient(m, 1e-17 / slope) == e


@examples(200)
@given(sizes(1e-3, 1e3), SPEEDS, SPEEDS)
def test_sticking_keeps_momentum_and_loses_the_closing_energy(mu, v1, v2):
    m = structure(mu, 0.7)
    common = common_velocity(m, v1, v2)
    record_impact(m, 0.0, v1 - v2, 0.7, True)
    assert m[at.STICKING_ENERGY] == pytest.approx(0.49 * m[at.IMPACT_ENERGY], rel=1e-14)
    speed = abs(v1) + abs(v2)
    assert (1.0 + mu) * common == pytest.approx(v1 + mu * v2, abs=4e-15 * (1.0 + mu) * speed)
    lost = kinetic(m, v1, v2) - kinetic(m, common, common)
    assert m[at.IMPACT_ENERGY] == pytest.approx(lost, abs=1e-13 * kinetic(m, speed, speed))


def test_masses_that_are_pulled_apart_do_not_stick():
    m = started(gamma=1.0, e=0.5, k2=4.0)  # the flights left last 2 v/(1 - e), the limit is 1/2
    assert not chattering_ends(m, 0.0, 0.0)
    assert not chattering_ends(m, 1e-12, 1.0)
    assert not chattering_ends(m, 0.0, 1.0)
    assert chattering_ends(m, 0.0, -1e-12)
    assert not chattering_ends(m, 0.126, -1.0)
    assert chattering_ends(m, 0.124, -1.0)


def test_at_e_1_nothing_sticks():
    assert not chattering_ends(started(gamma=1.0, e=1.0), 1e-300, -1e300)
    assert chattering_ends(started(gamma=1.0, e=0.0), 0.0, -1e-300)


# f = -0.2, closing with 1 mm/s
PRESSED = {"x1_start": 1.0, "x2_start": 1.0, "v1_start": 5e-4, "v2_start": -5e-4}


@pytest.mark.parametrize(
    ("e", "e_slope"), [(0.0, 0.0), (0.3, 0.0), (0.7, 0.0), (0.95, 0.0), (0.7, 500.0), (0.95, 2e3)]
)
@pytest.mark.parametrize("gamma", [1e-9, 1e-8, 1e-7, 1e-6, 1e-4])
@least_work
def test_a_bouncing_mass_comes_to_rest_after_as_many_impacts_as_a_ball(gamma, e, e_slope):
    m = advanced(started(**PRESSED, box_amplitude=0.0, gamma=gamma, e=e, e_slope=e_slope), 0.3)

    def parting(closing):
        return e * closing / (1 + e_slope * closing)

    impacts, closing, flown = 1, 1e-3, 0.0
    while 2 * parting(closing) >= gamma * (1 - e) / 1.2**0.5 * 0.2:
        flown += 2 * parting(closing) / 0.2
        impacts, closing = impacts + 1, parting(closing)
    assert m[at.IN_CONTACT] == 1.0
    # f varies by some per cent meanwhile
    assert m[at.IMPACT_COUNT] == pytest.approx(impacts, abs=1 + 0.02 * impacts)
    assert m[at.IMPACT_TIME] == pytest.approx(flown, rel=0.1, abs=1e-12)
    # almost all of the closing energy
    assert m[at.IMPACT_ENERGY] == pytest.approx(0.25e-6, rel=0.01)
