"""The closed-form oscillator in high precision, undamped to overdamped, and its envelope."""

import math

import mpmath as mp
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fmu_src.kernels.numerics.elementary import TWO_PI, sincos_turns
from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator.excitation import set_cubic_response, set_forced_amplitudes
from fmu_src.kernels.oscillator.nodes import free_part_after
from fmu_src.kernels.oscillator.parameters import set_oscillator_constants
from fmu_src.kernels.oscillator.response import (
    displacement_and_velocity,
    fundamental_solutions,
    set_free_part,
)
from tests import exact_motion as truth

from .kernel import examples, sizes

BRANCH, HARMONIC, FREE, CUBIC = at.OSCILLATOR_1, at.HARMONIC_1, at.FREE_A, at.CUBIC_A
# over omega_i; 1 is critical
NEAR = (1.0 - 1e-6, 1.0 - 1e-13, 1.0, 1.0 + 1e-13, 1.0 + 1e-6)
DAMPINGS = [0.0, 0.005, 0.3, 0.97, *NEAR, 1.03, 1.5, 40.0]
FORCING = {"box_amplitude": 0.7, "box_frequency": 0.9, "box_acceleration": 0.3, "box_jerk": -0.2}
FORCING |= {"box_snap": 0.1, "box_crackle": 0.05}


def oscillator(damping, omega_squared, x, v, phase):
    """A memory whose first branch is one oscillator with omega = 1, from initial conditions."""
    m = [0.0] * at.SIZE
    set_oscillator_constants(m, BRANCH, damping, omega_squared)
    m[at.ETA], m[at.TURN] = FORCING["box_frequency"], phase / TWO_PI
    m[BRANCH + at.DRIVE + 1] = FORCING["box_amplitude"] * FORCING["box_frequency"] ** 2
    for i, name in enumerate(("acceleration", "jerk", "snap", "crackle")):
        m[at.CUBIC + i] = -FORCING[f"box_{name}"]
    assert not set_forced_amplitudes(m, BRANCH, HARMONIC)
    m[at.CUBIC_PRESENT] = 1.0
    m[BRANCH + at.SHARES] = 1.0
    set_cubic_response(m, BRANCH, CUBIC)
    set_free_part(m, HARMONIC, FREE, CUBIC, x, v, *sincos_turns(m[at.TURN]))
    return m


def state(m, tau):
    x, v = free_part_after(m, BRANCH, m[FREE], m[FREE + 1], tau)
    sine, cosine = sincos_turns(m[at.TURN] + m[at.ETA] / TWO_PI * tau)
    return displacement_and_velocity(m, HARMONIC, CUBIC, tau, x, v, sine, cosine)


@examples(150)
@given(
    *(st.sampled_from(DAMPINGS) | sizes(1e-3, 1e3), sizes(0.05, 20.0), st.floats(-1, 1)),
    *(st.floats(-1, 1), st.floats(0, 6.2), st.floats(0, 50)),
)
def test_in_high_precision(ratio, omega_squared, x, v, phase, tau):
    damping = ratio * math.sqrt(omega_squared)
    if damping == 0.0 and abs(omega_squared - FORCING["box_frequency"] ** 2) < 1e-3:
        damping = 0.01
    m = oscillator(damping, omega_squared, x, v, phase)
    with mp.workdps(60):
        box = truth.box_acceleration(FORCING, mp.mpf(phase))
        own = (1, 2 * mp.mpf(damping), omega_squared)
        exact = truth.oscillator_motion(*own, mp.mpf(x), mp.mpf(v), box)
        values = [float(exact(tau)), float(exact.derivative()(tau))]
    rate = max(1.0, math.sqrt(omega_squared))
    terms = sum(abs(m[i]) for i in (HARMONIC, HARMONIC + 1, FREE))
    terms += sum(abs(m[CUBIC + i]) * max(1.0, tau) ** i for i in range(4))
    terms += abs(m[FREE + 1]) * m[BRANCH + at.ENVELOPE_SINE]
    # an angle's or exponent's own rounding
    angle = 1.0 + (rate + damping * math.exp(-min(tau, 1.0))) * tau
    for found, value, unit in zip(state(m, tau), values, (1.0, rate + 2 * damping), strict=True):
        assert abs(found - value) <= 4e-15 * terms * angle * unit


@examples(400)
@given(
    st.sampled_from(DAMPINGS) | sizes(1e-4, 1e4) | st.floats(0.9, 1.1),
    *(sizes(1e-3, 1e3), sizes(1e-3, 1e4)),
)
@example(1.03, 1.0, 3.7)
@example(1.0328, 1.0, 8.0)
def test_envelope_bounds_the_basis(ratio, omega_squared, age):
    m = [0.0] * at.SIZE
    set_oscillator_constants(m, BRANCH, ratio * math.sqrt(omega_squared), omega_squared)
    tau = age / math.sqrt(omega_squared)
    C, S, decay = fundamental_solutions(m, BRANCH, tau)
    room = 1.0 + 1e-12
    assert abs(C) <= decay * room
    assert abs(S) <= m[BRANCH + at.ENVELOPE_SINE] * decay * room
    if m[BRANCH + at.ENVELOPE_RATE] * tau < 700.0:
        assert decay == pytest.approx(math.exp(-m[BRANCH + at.ENVELOPE_RATE] * tau), rel=1e-12)
