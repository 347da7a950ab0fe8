"""The event function is the gap or minus the contact force, with its derivatives and bounds."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fmu_src.kernels.numerics.first_root import EPS, INFINITE
from fmu_src.kernels.oscillator import event_function, maximum, nodes, secular
from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator.contact import first_nonzero_force_derivative
from fmu_src.kernels.oscillator.motion import begin_contact_or_glued
from fmu_src.kernels.oscillator.nodes import LONGEST
from tests import exact_motion as truth

from .kernel import (
    DEFAULTS,
    advanced,
    examples,
    flight,
    resonances,
    rest_together,
    sizes,
    started,
    structures,
    unloaded,
)

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
    begin_contact_or_glued(m, at.CONTACT, x, v)
    full = {**DEFAULTS, **values}
    place = x + rest_together(values)[0]
    _, push = truth.contact_motion(full, place, v, mp.mpf(values["phase_start"]))
    return m, (1 / mp.mpf(full["m1"]) + 1 / mp.mpf(full["m2"])) * push


MAKERS = pytest.mark.parametrize("make", [flight_and_gap, contact_and_pull])


def size(signal):
    """Sum of all amplitudes: what rounding is relative to."""
    return sum(abs(complex(c)) for c, _ in signal.terms) + float(sum(map(abs, signal.polynomial)))


def scales(m, values, signal, age):
    """What rounding is relative to: the size of the signal, and the rate that a derivative adds."""
    if m[at.SECULAR] == 0.0:
        return 2.0 * (size(signal) + 1.0), max(1.0, signal.fastest_rate())
    rate = max(1.0, math.sqrt(values["k2"] / values["m2"]), values["box_frequency"])
    # of a resonance terms are large and cancel: what they may have grown to, from about 1
    return (4.0 + values["box_frequency"] * (1.0 + age)) * rate**2, rate


# critically damped
CRITICAL = {"d1": 2.0, "d2": 2.0 + 1e-9, "k2": 1.0, "box_frequency": 0.4, "phase_start": 1.0}
DRAWN = structures(clearance=True) | resonances()


@MAKERS
@examples(100)
@given(DRAWN, STATES, AGES)
@example(CRITICAL, (-0.3, 0.2, 0.5, -0.4), 1.5)
def test_value_and_derivatives(make, values, state, age):
    m, signal = make(values, state)
    node, at_node = m[at.RIGHT_AGE], m[at.RIGHT_VALUES : at.RIGHT_VALUES + 3]
    work, found = m[at.WORK], event_function.evaluate_event_function(m, age)[:5]
    assert m[at.WORK] == work + 1.0
    whole, rate = scales(m, values, signal, age)
    for order, value in enumerate(found):
        allowed = 1e-13 * whole * rate**order * (1.0 + age) ** 3  # growth of the cubic
        assert abs(value - float(signal(age))) <= allowed, order
        assert order > 2 or abs(at_node[order] - float(signal(node))) <= allowed
        signal = signal.derivative()


def derivative(signal, order):
    for _ in range(order):
        signal = signal.derivative()
    return signal


@MAKERS
@examples(100)
@given(DRAWN, STATES, AGES)
def test_bounds_hold_as_long_as_they_are_used(make, values, state, age):
    """For ever; of growing amplitudes some spacings, or until the state is written anew."""
    m, signal = make(values, state)
    limits = {k: sum(event_function.event_derivative_bounds(m, k)) for k in (5, 6, 7, 8)}
    fifth = event_function.evaluate_event_function(m, age)[5]
    sixth = m[at.REMAINDER] / m[at.HERMITE + 2]
    later = np.concatenate([np.linspace(0.0, 3.0, 300), np.geomspace(3.0, 300.0, 300)])
    ahead = age + later
    if m[at.SECULAR] != 0.0:
        later = m[at.SPACING] * np.linspace(0.0, secular.LONGEST_DRIVEN, 24)
        ahead = age + m[at.SPACING] * np.linspace(0.0, event_function.AHEAD, 8)
    whole, rate = scales(m, values, signal, age)
    signal = derivative(signal, 4)
    for order, limit in limits.items():
        signal, rounding = signal.derivative(), 1e-12 * whole * rate**order
        highest = np.abs(signal.sample(later)).max()
        assert highest <= limit * (1 + 1e-9) + rounding
        if order == 5:
            soon = np.abs(signal.sample(ahead)).max()
            assert soon <= fifth * (1 + 1e-9) + rounding
        assert order != 6 or highest <= sixth * (1 + 1e-9) + rounding


SLOW = {"m2": 1.0, "d1": 5.0, "box_frequency": 0.4, "phase_start": 0.0}


@st.composite
def alike(draw):
    """Structures to be made of two halves that are nearly equal; some are driven at a resonance."""
    resonance = {"m2": 1.0, "box_frequency": 1.0, "phase_start": 0.0}
    damping = st.sampled_from((0.0, 1e-9, 1e-5))
    return draw(structures() | damping.map(lambda d1: {**resonance, "d1": d1}))


@examples(60)
@given(alike(), STATES, sizes(1e-16, 2e-5), sizes(1e-12, 0.1), AGES)
@example(SLOW, (-0.3, 0.2, 0.5, -9.0), 1e-9, 0.1, 0.0)
# apart by the slow of two decays alone, by 0.2 in a time of 1
@example(SLOW, (-0.3, 0.03, 1.0, math.sqrt(5.25) - 2.5), 1e-12, 0.1, 0.0)
def test_a_gap_of_nearly_equal_oscillators_is_bounded_by_its_own(values, state, near, gap, age):
    """Without what rounding takes from the displacements, and far below the sum of both."""
    equal = {"k2": values["m2"] * (1.0 + near), "d2": values["d1"] * values["m2"] * (1.0 - near)}
    x1, v1, rise, speed = state
    m, signal = flight_and_gap({**values, **equal}, (x1, v1, x1 + gap * rise, v1 + gap * speed))
    assert event_function.are_halves_nearly_equal(m)
    grows, spacing = m[at.SECULAR] != 0.0, m[at.SPACING]
    ahead, longest = (event_function.AHEAD, secular.LONGEST_DRIVEN) if grows else (1.0, LONGEST)
    found = event_function.evaluate_event_function(m, age)[5]
    signal = derivative(signal, 5)
    assert all(abs(signal(age + part * spacing)) <= found for part in np.linspace(0.0, ahead, 8))
    sixth, found = signal.derivative(), m[at.REMAINDER] / m[at.HERMITE + 2]
    later = spacing * np.concatenate([np.linspace(0.0, 8.0, 20), np.linspace(8.0, longest, 20)])
    assert all(abs(sixth(t)) <= found for t in later)
    assert not grows or found <= 1e3 * (gap + near * spacing * longest + 1e-13)


@examples(60)
@given(structures(clearance=True), STATES, st.integers(0, 3))
def test_the_derivative_that_decides_on_the_boundary_is_newtons(values, state, lowest):
    """Dampers, box and all, in each order: what comes after a release hangs on them."""
    m, signal = contact_and_pull(values, state)
    order, value = first_nonzero_force_derivative(m, state[0], state[1], lowest)
    assume(order >= 0)
    rate = max(1.0, signal.fastest_rate())
    scale = (size(signal) + 1.0) * rate ** (order + 2)
    assert abs(value + float(derivative(signal, order)(0))) <= 1e-12 * scale


APART = {"clearance": 0.5, "box_amplitude": 0.0}


@pytest.mark.parametrize("moves", ["x1_start", "x2_start", "v1_start", "v2_start", "force1", ""])
def test_nothing_ends_a_state_in_which_nothing_moves(moves):
    still = started(**APART)
    assert still[at.MODE] == at.FLIGHT and still[at.CLEAR] == INFINITE
    assert started(clearance=-0.5, box_amplitude=0.0)[at.CLEAR] == INFINITE
    still[at.EVENT_HARMONIC] = still[at.EVENT_HARMONIC + 1] = 0.1
    assert not event_function.is_event_function_constant(still)
    if moves:
        m = started(**APART, **{moves: 0.1 if "1" not in moves or moves == "v1_start" else -0.1})
    else:  # at a resonance, next to a wall: from rest on
        m = started(clearance=0.5, wall=1.0, d1=0.0, box_frequency=1.0)
        assert m[at.SECULAR] != 0.0
    assert m[at.MODE] == at.FLIGHT and m[at.CLEAR] < INFINITE


def test_a_cubic_that_is_gone_is_not_read():
    m = flight(-0.5, 0.2, 0.5, -0.1, clearance=0.3)
    other = list(m)
    other[at.EVENT_CUBIC : at.EVENT_CUBIC + 4] = [1e3] * 4
    event_function.write_event_values(other, at.RIGHT_VALUES, at.RIGHT, m[at.RIGHT_AGE])
    values = slice(at.RIGHT_VALUES, at.RIGHT_VALUES + 3)
    assert other[values] == m[values]
    assert event_function.evaluate_event_function(
        other, 0.3
    ) == event_function.evaluate_event_function(m, 0.3)


@pytest.mark.parametrize("drive", [{"box_crackle": 1e-3}, {"d1": 0.0, "box_frequency": 1.0}])
def test_rounding_grows_with_what_it_is_of(drive):
    m = flight(-0.5, 0.2, 0.5, -0.1, **drive)
    assert event_function.event_rounding(m, 1e3) > 5.0 * event_function.event_rounding(m, 0.0)


@pytest.mark.parametrize(
    ("slot", "places"), [("HARMONIC", 2), ("OFFSET", 1), ("FREE_A", 1), ("FREE_B", 1), ("CUBIC", 4)]
)
def test_rounding_is_that_of_each_part(slot, places):
    m = flight(-0.5, 0.2, 0.5, -0.1, box_jerk=0.1)
    for place in range(places):
        other = list(m)
        other[getattr(at, f"EVENT_{slot}") + place] = -1e3
        assert 3.9e-12 < event_function.event_rounding(other, 1.0) < 4.2e-12  # once


@examples(60)
@given(structures(), STATES)
def test_both_ways_to_a_bound_of_the_sixth_derivative_agree(values, state):
    m, _ = flight_and_gap(values, state)
    both = (at.OSCILLATOR_1, at.EVENT_FREE_A), (at.OSCILLATOR_2, at.EVENT_FREE_B)
    for oscillator, free in both:
        expected = event_function.free_part_bound(m, oscillator, free, 6)
        found = event_function.sixth_derivative_bound(m, oscillator, m[free], m[free + 1])
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_free_parts_of_one_size_are_not_nothing():
    assert started(**APART, x1_start=-0.1, x2_start=0.1)[at.CLEAR] < INFINITE


@examples(60)
@given(*[st.just(0.0) | sizes(1e-16, 9e-5)] * 2, st.floats(0.0, 6.28), sizes(0.1, 1e6))
def test_a_growing_motion_is_the_closed_form(damping, detuning, phase, time):
    """In high precision: the growing part, and what it is of any age."""
    values = {"d1": damping, "box_frequency": 1.0 + detuning, "m2": 1e-9, "k2": 1e-9, "d2": 0.0}
    m = started(bonded=1.0, phase_start=phase, **values)
    assert m[at.SECULAR] == 1.0
    advanced(m, time)
    both = truth.contact_motion({**DEFAULTS, **values}, 0.0, 0.0, mp.mpf(m[at.PHASE_START]))[0]
    grown = min(time, 1.0 / max(detuning, damping, 1e-300))
    assert abs(m[at.X1] - both(time)) <= 5e-15 * (2.0 + grown) * (1.0 + 0.1 * time)


ALIKE = {"m2": 1.0, "k2": 1.0, "d1": 0.0, "d2": 0.0, "box_frequency": 1.0, "phase_start": 1.0}


DRIVEN = [
    *({**ALIKE, "m2": eta**-2, "d1": 0.01, "box_frequency": eta} for eta in (0.4, 0.5, 2.0, 3.0)),
    {**ALIKE, "force1_amplitude": 0.3},
    {**ALIKE, "force2_amplitude": 0.3, "k2": 1.0 + 1e-9},
]


@pytest.mark.parametrize("values", DRIVEN)
def test_what_a_quintic_may_miss_of_a_growing_amplitude(values):
    """Mass 2 is driven on its natural frequency; or both are alike, and a force drives one."""
    m, signal = flight_and_gap(values, (-1e-3, 0.0, 1e-3, 0.0))
    assert m[at.SECULAR] != 0.0
    signal = derivative(signal, 5)
    fifth, ahead = event_function.evaluate_event_function(m, 0.0)[5], 5.0 * m[at.SPACING]
    assert 0.14 * fifth < np.abs(signal.sample(np.linspace(0.0, ahead, 50))).max() <= fifth
    signal = signal.derivative()
    found = m[at.REMAINDER] / m[at.HERMITE + 2]
    ages = np.linspace(0.0, secular.LONGEST_DRIVEN * m[at.SPACING], 200)
    largest = np.abs(signal.sample(ages)).max()
    assert 0.3 * found < largest <= found


def test_the_rounding_of_a_gap_is_that_of_its_terms():
    """Each half's displacement with its own velocity, which counts where it is strongly damped."""
    m = flight(-0.9, 3.0, 0.0, -4.0, d1=1.5, d2=0.2, box_amplitude=0.0, clearance=9.0)
    event_function.evaluate_event_function(m, 0.7)
    x_a, v_a, x_b, v_b, _, _ = nodes.phasors_at(m, 0.7)
    free = ((at.OSCILLATOR_1, x_a, v_a), (at.OSCILLATOR_2, x_b, v_b))
    size = 9.0 + sum(event_function.envelope_bound(m, *part) for part in free)
    assert maximum.gap_rounding(m, 0.7) / (2.0 * EPS) == pytest.approx(size, rel=1e-12)
