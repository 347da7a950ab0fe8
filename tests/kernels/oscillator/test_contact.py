"""On which side of the boundary a state begins, and when contact ends."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fmu_src.kernels.numerics.elementary import sincos_turns
from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator.contact import first_nonzero_force_derivative, gap_acceleration
from fmu_src.kernels.oscillator.motion import state_at
from tests import exact_motion as truth

from .kernel import DEFAULTS, examples, rounded, started, structures
from .test_event_function import STATES, contact_and_pull, size

# of the force at rest the fifth derivative is the first that does not vanish
FIFTH = {"m2": 1.0, "k2": 1.2, "d1": 0.01, "d2": 0.01, "box_amplitude": 0.0, "box_crackle": 0.1}
HALF_TURN = math.pi  # its sine is 1.2e-16 as a float, and nothing as an angle


@examples(150)
@given(structures(), st.sampled_from([0.0, HALF_TURN]) | rounded(0.0, 6.28))
@example({"k2": 1.0, "m2": 1.0, "d1": 0.01, "d2": 0.02, "box_frequency": 0.4}, HALF_TURN)
@example(FIFTH, 0.0)
@example({**FIFTH, "box_crackle": -0.1}, 0.0)
def test_from_rest_newton_decides(values, phase):
    values = {**values, "phase_start": phase}
    unlike = abs(values["k2"] / values["m2"] - 1.0), abs(values["d2"] / values["m2"] - values["d1"])
    assume(all(difference == 0.0 or difference > 1e-6 for difference in unlike))
    with mp.workdps(250):
        exact = mp.pi if phase == HALF_TURN else mp.mpf(phase)  # Newton's law from a common start
        first, second = truth.free_motion({**DEFAULTS, **values}, (0, 0, 0, 0), exact)
        gap = (second - first)(mp.mpf("1e-15"))
        pressed = gap < mp.mpf("1e-150")  # alike, they stay together
    assert started(**values)[at.IN_CONTACT] == float(pressed)


@examples(60)
@given(structures(clearance=True), STATES, st.floats(0.0, 3.0))
def test_the_gaps_acceleration_is_newtons(values, state, age):
    """Of faces together, pressed by a preload or held over a clearance, at any age."""
    m, pull = contact_and_pull(values, state)
    sine, cosine = sincos_turns(m[at.TURN] + m[at.ETA_TURNS] * age)
    x1, v1, *_ = state_at(m, age)
    found = gap_acceleration(m, x1, v1, cosine, sine, age)
    assert abs(found + pull(age)) <= 1e-12 * (1.0 + size(pull)) * (1.0 + age) ** 3


@pytest.mark.parametrize("force", [0.0, 0.3])
def test_a_force_of_rounding_alone_decides_nothing(force):
    """Damper and spring balance, with what drives the masses, but for a last digit."""
    m = started(d1=0.3, d2=0.05, k2=1.3, force1_amplitude=force, phase_start=1.0)
    pull = gap_acceleration(m, 0.0, 0.0, m[at.COSINE], m[at.SINE], 0.0)
    rng, left = np.random.default_rng(1), 0
    for v in rng.uniform(-1.0, 1.0, 300).tolist():
        x = -(m[at.FORCE_V] * v + pull) / m[at.FORCE_X]
        left += gap_acceleration(m, x, v, m[at.COSINE], m[at.SINE], 0.0) != 0.0
        assert first_nonzero_force_derivative(m, x, v, 0)[0] == 1
    assert left > 10


def test_drives_that_cancel_but_for_rounding_decide_nothing():
    """A harmonic at its zero or against a constant; a slope in which damper and spring cancel."""
    unlike, still = {"d1": 0.3, "d2": 0.05, "k2": 1.3}, {"box_amplitude": 0.0}
    m = started(**unlike, **still, force1_amplitude=0.3, phase_start=HALF_TURN)
    assert first_nonzero_force_derivative(m, 0.0, 0.0, 0)[0] == 1
    for phase in np.linspace(1.4, 1.7, 100).tolist():
        sine = math.sin(phase)
        on_mass = {**still, "force1_amplitude": 0.3, "force1": -0.3 * sine}
        for drive, order in ((on_mass, 1), ({"box_acceleration": 0.16 * sine}, 2)):
            m = started(phase_start=phase, **unlike, **drive)
            assert first_nonzero_force_derivative(m, 0.0, 0.0, 0)[0] == order
    for d1, k2 in ((2e-6, 1.2), (1.1, 0.8)):  # next to no damping; more than the spring
        m = started(d1=d1, d2=0.0, k2=k2, **still)
        damping = 2.0 * m[at.OSCILLATOR_3 + at.DAMPING]
        part = (m[at.FORCE_X] - m[at.FORCE_V] * damping) / m[at.FORCE_V]
        for v in np.linspace(0.1, 1.0, 100).tolist():
            x = part * v / m[at.OSCILLATOR_3 + at.OMEGA_SQUARED]
            assert first_nonzero_force_derivative(m, x, v, 1)[0] == 2
