"""Energy, impulse, its moment and the largest gap to the last digits, where terms cancel."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from tests import exact_motion as truth

from .kernel import DEFAULTS, advanced, examples, flight, sizes, started, structures

STATES = st.tuples(
    st.floats(-1.0, 0.0), st.floats(-1.0, 0.0), st.floats(0.01, 1.0), st.floats(0.0, 1.0)
)


def energy(m):
    kinetic = m[at.M1] * m[at.V1] ** 2 + m[at.M2] * m[at.V2] ** 2
    return 0.5 * (kinetic + m[at.K1] * m[at.X1] ** 2 + m[at.K2] * m[at.X2] ** 2)


@examples(30)
@given(structures(damping=40.0), STATES, sizes(1e-8, 20.0))
def test_energy_to_the_rounding_of_what_the_motion_is_made_of(values, state, stop):
    """To 1e-14 of the energy of forced response and free parts: near rest these cancel."""
    names = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
    values = {**DEFAULTS, **values, **dict.fromkeys(names, 0.0)}
    m = advanced(flight(*state, **values), stop)
    assume(not m[at.IMPACT_COUNT])
    exact = terms = mp.mpf(0)
    for i, motion in enumerate(truth.free_motion(values, state, mp.mpf(values["phase_start"])), 1):
        mass, stiffness, speed = values[f"m{i}"], values[f"k{i}"], motion.derivative()
        exact += (mass * speed(stop) ** 2 + stiffness * motion(stop) ** 2) / 2
        size, fastest = (sum(abs(c) for c, _ in one.terms) for one in (motion, speed))
        terms += (mass * fastest**2 + stiffness * size**2) / 2
    assert abs(energy(m) - exact) <= 1e-14 * terms


@pytest.mark.parametrize("step", [1e-10, 1e-8, 1e-6, 1e-4, 3e-3])
@pytest.mark.parametrize("push", [0.0, 0.3])
def test_impulses_of_short_steps(step, push):
    """Of heavy masses, whose momenta at both ends of a step differ in their last digits."""
    values = {
        **{"m1": 40.0, "m2": 60.0, "k1": 30.0, "k2": 70.0, "d1": 9.0, "d2": 0.4},
        **{"box_amplitude": 0.3, "box_frequency": 1.7, "box_acceleration": push},
    }
    start = {"x1_start": -0.2, "v1_start": 3.0, "x2_start": 0.1, "v2_start": 5.0}
    m = advanced(started(**values, **start, phase_start=0.5), step)
    first, second = truth.free_motion({**DEFAULTS, **values}, start.values(), mp.mpf(0.5))
    force = 30 * first + 9 * first.derivative() + 70 * second + mp.mpf(0.4) * second.derivative()
    impulse = mp.quad(force, [0, mp.mpf(step)])
    moment = mp.quad(lambda t: t * force(t), [0, mp.mpf(step)])
    assert m[at.BOX_IMPULSE] == pytest.approx(float(impulse), rel=2e-14, abs=0.0)
    assert m[at.BOX_IMPULSE_MOMENT] == pytest.approx(float(moment), rel=2e-14, abs=0.0)


@pytest.mark.parametrize("amplitude", [5e-324, 1e-310, 1e-201])
def test_a_drive_next_to_nothing_leaves_the_numbers_finite(amplitude):
    """Displacements over such an amplitude have no finite value; there is no drive to speak of."""
    m = advanced(started(x2_start=1.0, v1_start=-1e90, box_amplitude=amplitude), 0.1, 5.0)
    assert (m[at.XI1], m[at.XI2], m[at.XI_REL]) == (0.0, 0.0, 0.0)


@examples(60)
@given(
    sizes(0.03, 30.0),
    *[st.tuples(sizes(1e-6, 10.0), st.sampled_from([-1.0, 1.0]), sizes(1e-6, 10.0))] * 2,
    *[sizes(1e-3, 100.0)] * 2,
    sizes(0.01, 100.0),
    sizes(1e-8, 10.0),
)
def test_to_the_rounding_of_its_terms(m2, one, other, d1, d2, amplitude, length):
    """Sizes apart, dampers far beyond critical: no further off than the displacements are."""
    values = {**DEFAULTS, "m2": m2, "d1": d1, "d2": d2, "box_amplitude": amplitude}
    state = (-one[0], one[1] * one[2], other[0], other[1] * other[2])
    m = advanced(flight(*state, **values), length)
    assume(not m[at.IMPACT_COUNT])
    first, second = truth.free_motion(values, state, mp.mpf(0))
    gap = second - first
    t = np.concatenate([np.linspace(0.0, length, 200), length * np.geomspace(1e-7, 1.0, 100)])
    t.sort()
    slope = gap.derivative()
    signs = np.sign(slope.sample(t))
    expected = max(gap(0), gap(length))
    for i in np.flatnonzero((signs[:-1] > 0) & (signs[1:] < 0)):
        expected = max(expected, gap(mp.findroot(slope, (t[i], t[i + 1]), solver="anderson")))
    size = sum(abs(complex(c)) for c, _ in gap.terms)
    assert m[at.X_REL_MAX] == pytest.approx(float(expected), rel=0.0, abs=4e-15 * size)
