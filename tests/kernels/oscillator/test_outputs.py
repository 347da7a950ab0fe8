"""Energy, impulse and its moment against quadrature over the states passed through: nothing is lost
between, at or after impacts.
"""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator.motion import state_at
from tests import exact_motion as truth

from .kernel import (
    CHAOTIC,
    DEFAULTS,
    advanced,
    examples,
    pieces,
    set_inputs,
    sizes,
    started,
    structures,
)

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
CUBIC = {"box_acceleration": 0.3, "box_jerk": -0.2, "box_snap": 0.15, "box_crackle": -0.1}
RUNS = [
    CHAOTIC,
    {"e": 0.2},
    {"box_frequency": 0.9, "e": 1.0, "box_acceleration": 0.5},
    {
        "m1": 0.6,
        "m2": 2.1,
        "k1": 1.9,
        "k2": 1.3,
        "d1": 0.3,
        "d2": 0.02,
        "box_frequency": 1.1,
        "phase_start": 2.0,
    },
    {
        "m1": 3.0,
        "m2": 0.4,
        "k1": 0.5,
        "k2": 0.9,
        "d1": 0.0,
        "d2": 1.5,
        "box_frequency": 0.35,
        "e": 0.5,
    },
]
STATES = st.tuples(
    st.floats(-1.0, 0.0), st.floats(-1.0, 0.0), st.floats(0.01, 1.0), st.floats(0.0, 1.0)
)


def integrals(passed, functions):
    """Integrals over time (s) of functions of (m, t, x1, v1, x2, v2), and of their magnitudes."""
    total, absolute = [0.0] * len(functions), [0.0] * len(functions)
    for m, entry, end in passed:
        omega = m[at.OMEGA]
        count = max(
            1,
            math.ceil(
                (end - entry)
                * max(m[at.FASTEST], m[at.ETA], m[at.OSCILLATOR_1], m[at.OSCILLATOR_2])
                / 0.7
            ),
        )
        edges = np.linspace(entry, end, count + 1)
        for low, high in zip(edges, edges[1:], strict=False):
            for node, weight in zip(NODES, WEIGHTS, strict=True):
                age = float(0.5 * (low + high + node * (high - low)))
                x1, v1, x2, v2 = state_at(m, age)
                time = m[at.START_TIME] + (m[at.ORIGIN] + m[at.ORIGIN_LOW] + age) / omega
                for i, function in enumerate(functions):
                    part = (
                        0.5
                        * (high - low)
                        / omega
                        * weight
                        * function(m, time, x1, omega * v1, x2, omega * v2)
                    )
                    total[i] += part
                    absolute[i] += abs(part)
    return total, absolute


def box_force(m, time, x1, v1, x2, v2):
    return m[at.K1] * x1 + m[at.D1] * v1 + m[at.K2] * x2 + m[at.D2] * v2


def energy(m):
    kinetic = m[at.M1] * m[at.V1] ** 2 + m[at.M2] * m[at.V2] ** 2
    return 0.5 * (kinetic + m[at.K1] * m[at.X1] ** 2 + m[at.K2] * m[at.X2] ** 2)


@examples(30)
@given(structures(damping=40.0), STATES, sizes(1e-8, 20.0))
def test_energy_to_the_rounding_of_what_the_motion_is_made_of(values, state, stop):
    """What a flight gains and loses is that of exact motion, to 1e-14 of the energy of forced
    response and free parts: near rest under a drive these cancel.
    """
    values = {**DEFAULTS, **values, **dict.fromkeys(CUBIC, 0.0)}
    names = ("x1_start", "v1_start", "x2_start", "v2_start")
    m = advanced(started(**values, **dict(zip(names, state, strict=True))), stop)
    assume(not m[at.IMPACT_COUNT])
    exact = terms = mp.mpf(0)
    for i, motion in enumerate(truth.free_motion(values, state, mp.mpf(values["phase_start"])), 1):
        mass, stiffness, speed = values[f"m{i}"], values[f"k{i}"], motion.derivative()
        exact += (mass * speed(stop) ** 2 + stiffness * motion(stop) ** 2) / 2
        size, fastest = (sum(abs(c) for c, _ in one.terms) for one in (motion, speed))
        terms += (mass * fastest**2 + stiffness * size**2) / 2
    assert abs(energy(m) - exact) <= 1e-14 * terms


@examples(25)
@given(
    st.sampled_from(RUNS),
    st.lists(st.floats(1e-3, 4.0), min_size=1, max_size=12),
    st.tuples(*[st.floats(-0.5, 0.5)] * 4),
)
def test_impulses_of_steps_with_changing_inputs(values, steps, cubic):
    m = started(time=2.0, **values, x1_start=-0.4, x2_start=0.3, v1_start=0.5)
    time = 2.0
    for i, step in enumerate(steps):
        if i % 3 == 1:
            set_inputs(m, **dict(zip(CUBIC, cubic, strict=True)), box_frequency=1.2)
        begun, time = time, time + step
        passed = pieces(m, time)

        def moment(*state, begun=begun):
            return (state[1] - begun) * box_force(*state)

        found, size = integrals(passed, [box_force, moment])
        assert m[at.BOX_IMPULSE] == pytest.approx(found[0], abs=1e-11 * (1.0 + size[0]))
        assert m[at.BOX_IMPULSE_MOMENT] == pytest.approx(found[1], abs=1e-11 * (1.0 + size[1]))


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
