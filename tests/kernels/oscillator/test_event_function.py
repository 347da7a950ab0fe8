"""The event function is the gap or minus the contact force; its derivatives are theirs, its bounds
hold for all later times.
"""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fmu_src.kernels.numerics.first_root import INFINITE
from fmu_src.kernels.oscillator import event_function
from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator.contact import first_nonzero_derivative
from fmu_src.kernels.oscillator.motion import begin_common
from fmu_src.kernels.oscillator.nodes import LONGEST
from tests import exact_motion as truth

from .kernel import DEFAULTS, examples, flight, rest_together, sizes, started, structures, unloaded

AGES = st.floats(0.0, 40.0)
STATES = st.tuples(
    st.floats(-1.0, 0.0), st.floats(-1.0, 1.0), st.floats(0.01, 1.0), st.floats(-1.0, 1.0)
)


def flight_and_gap(values, state):
    """A flight's memory and its gap by Newton's law, omega = 1."""
    m = flight(*state, **values)
    full, start = {**DEFAULTS, **values}, unloaded(values, state)
    first, second = truth.free_motion(full, start, mp.mpf(values["phase_start"]))
    return m, truth.gap_signal(full, first, second)


def contact_and_pull(values, state):
    """A contact's memory and minus the force f (18) by Newton's law; pressed together or not."""
    x, v = state[0], state[1]
    m = started(**values)
    m[at.TURN], m[at.CUBIC_AGE] = values["phase_start"] / 6.283185307179586 % 1.0, 0.0
    begin_common(m, at.CONTACT, x, v)
    full = {**DEFAULTS, **values}
    place = x + rest_together(values)[0]
    _, push = truth.contact_motion(full, place, v, mp.mpf(values["phase_start"]))
    return m, (1 / mp.mpf(full["m1"]) + 1 / mp.mpf(full["m2"])) * push


MAKERS = pytest.mark.parametrize("make", [flight_and_gap, contact_and_pull])


def size(signal):
    """Sum of all amplitudes: what rounding is relative to."""
    return sum(abs(complex(c)) for c, _ in signal.terms) + float(sum(map(abs, signal.polynomial)))


@MAKERS
@examples(60)
@given(structures(clearance=True), STATES, AGES)
# critical damping
@example(
    {"d1": 2.0, "d2": 2.0 + 1e-9, "k2": 1.0, "box_frequency": 0.4, "phase_start": 1.0},
    (-0.3, 0.2, 0.5, -0.4),
    1.5,
)
def test_value_and_derivatives(make, values, state, age):
    m, signal = make(values, state)
    found = event_function.evaluate(m, age)[:5]
    fastest = max(1.0, signal.fastest_rate())
    growth = (1.0 + age) ** 3  # of the cubic
    for order, value in enumerate(found):
        scale = (size(signal) + 1.0) * fastest**order * growth
        assert abs(value - float(signal(age))) <= 2e-13 * scale
        signal = signal.derivative()


@MAKERS
@examples(60)
@given(structures(clearance=True), STATES, AGES)
def test_bounds_hold_for_all_later_times(make, values, state, age):
    m, signal = make(values, state)
    found = event_function.evaluate(m, age)
    later = age + np.concatenate([np.linspace(0.0, 3.0, 300), np.geomspace(3.0, 300.0, 300)])
    rounding = 1e-12 * (size(signal) + 1.0) * max(1.0, signal.fastest_rate()) ** 5
    fifth = signal.derivative().derivative().derivative().derivative().derivative()
    assert np.abs(fifth.sample(later)).max() <= found[5] * (1 + 1e-9) + rounding


@examples(30)
@given(structures(), STATES, sizes(1e-16, 2e-5), sizes(1e-12, 0.1), AGES)
@example(
    {"m2": 1.0, "d1": 5.0, "box_frequency": 0.4, "phase_start": 0.0},
    (-0.3, 0.2, 0.5, -9.0),
    1e-9,
    0.1,
    0.0,
)
def test_bounds_of_nearly_equal_oscillators_hold_as_long_as_they_are_used(
    values, state, near, gap, age
):
    equal = {"k2": values["m2"] * (1.0 + near), "d2": values["d1"] * values["m2"] * (1.0 - near)}
    x1, v1, rise, speed = state
    m, signal = flight_and_gap({**values, **equal}, (x1, v1, x1 + gap * rise, v1 + gap * speed))
    assert event_function.are_nearly_equal(m)
    spacing = m[at.SPACING]
    found = event_function.evaluate(m, age)[5]
    for _ in range(5):
        signal = signal.derivative()
    assert all(abs(signal(age + part * spacing)) <= found for part in np.linspace(0.0, 1.0, 8))
    sixth, found = signal.derivative(), m[at.REMAINDER] / m[at.HERMITE + 2]
    later = spacing * np.concatenate([np.linspace(0.0, 8.0, 20), np.linspace(8.0, LONGEST, 20)])
    assert all(abs(sixth(t)) <= found for t in later)


@examples(60)
@given(structures(clearance=True), STATES, st.integers(5, 8))
def test_bounds_of_higher_derivatives(values, state, order):
    m, signal = flight_and_gap(values, state)
    rounding = 1e-12 * (size(signal) + 1.0) * max(1.0, signal.fastest_rate()) ** order
    for _ in range(order):
        signal = signal.derivative()
    highest = np.abs(signal.sample(np.linspace(0.0, 60.0, 3000))).max()
    assert highest <= sum(event_function.derivative_bounds(m, order)) * (1 + 1e-9) + rounding


@examples(60)
@given(structures(clearance=True), STATES, st.integers(0, 3))
def test_the_derivative_that_decides_on_the_boundary_is_newtons(values, state, lowest):
    """Dampers, box and all, in each order: what comes after a release hangs on them."""
    m, signal = contact_and_pull(values, state)
    order, value = first_nonzero_derivative(m, state[0], state[1], lowest)
    assume(order >= 0)
    rate = max(1.0, signal.fastest_rate())
    scale = (size(signal) + 1.0) * rate ** (order + 2)
    for _ in range(order):
        signal = signal.derivative()
    assert abs(value + float(signal(0))) <= 1e-12 * scale


APART = {"clearance": 0.5, "box_amplitude": 0.0}


@pytest.mark.parametrize("moves", ["x1_start", "x2_start", "v1_start", "v2_start", "force1", ""])
def test_nothing_ends_a_state_in_which_nothing_moves(moves):
    still = started(**APART)
    assert still[at.MODE] == at.FLIGHT and still[at.CLEAR] == INFINITE
    assert started(clearance=-0.5, box_amplitude=0.0)[at.CLEAR] == INFINITE
    if moves:
        m = started(**APART, **{moves: 0.1 if "1" not in moves or moves == "v1_start" else -0.1})
    else:  # at a resonance, next to a wall: from rest on
        m = started(clearance=0.5, wall=1.0, d1=0.0, box_frequency=1.0)
        assert m[at.SECULAR] != 0.0
    assert m[at.MODE] == at.FLIGHT and m[at.CLEAR] < INFINITE
