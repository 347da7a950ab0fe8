"""The walk finds the first root, which a scan in high precision finds too."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import nodes, stepper
from fmu_src.kernels.oscillator.event_function import (
    evaluate_event_function,
    event_rounding,
    write_event_values,
)
from fmu_src.kernels.oscillator.roots import (
    cross_clear_intervals,
    value_on_decided_side,
    walk_to_event,
)
from tests import exact_motion as truth

from .kernel import (
    DEFAULTS,
    examples,
    flight,
    resonances,
    rest_together,
    started,
    structures,
    unstarted,
)
from .test_event_function import STATES, flight_and_gap


def first_end(m, horizon):
    """Age at which the present state ends by an event; None if it does not before the horizon."""
    walk_to(m, horizon)
    return m[at.END] if m[at.END_KIND] == at.END_EVENT and m[at.END] <= horizon else None


def walk_to(m, age, limit=1e5):
    """The memory, walked to an age by a number of evaluations at most."""
    m[at.WORK], m[at.WORK_LIMIT] = 0.0, limit
    walk_to_event(m, age)
    assert limit < 1e5 or m[at.WORK] < limit
    return m


def agree(found, expected, signal, horizon):
    """Whether both are the same root, up to the rounding of the event function's terms."""
    if expected is None:
        return found is None or found > horizon * (1 - 1e-9)
    terms = sum(abs(complex(c)) for c, _ in signal.terms) + sum(
        abs(float(p)) * horizon**k for k, p in enumerate(signal.polynomial)
    )
    if found is None:
        return False
    off = truth.ROUNDING * terms / abs(float(signal.derivative()(expected)))
    return abs(found - float(expected)) <= 1e-15 * (1.0 + found) + off


@examples(100)
@given(structures(clearance=True) | resonances(), STATES)
@example(
    {"m2": 1.274, "k2": 0.448, "d1": 0.0, "d2": 27.1, "box_frequency": 0.117, "phase_start": 0.633},
    (-0.867, 0.783, 0.461, -0.530),
)
def test_first_impact_of_a_flight(values, state):
    m, gap = flight_and_gap(values, state)
    assert agree(first_end(m, 12.0), truth.first_root(gap, 12.0), gap, 12.0)


@examples(80)
@given(structures(damping=0.5, clearance=True), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_release_from_contact(values, x, v):
    names = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
    values = {**values, **dict.fromkeys(names, 0.0)}
    clearance = values["clearance"]
    x2 = x - max(clearance, 0.0)
    m = started(x1_start=x, x2_start=x2, v1_start=v, v2_start=v, **values)
    assume(m[at.MODE] == at.CONTACT)
    place = x + rest_together(values)[0] if clearance < 0.0 else x
    _, push = truth.contact_motion({**DEFAULTS, **values}, place, v, mp.mpf(values["phase_start"]))
    assume(push(0) > 1e-3)
    expected = truth.first_root(push, 12.0)
    assert agree(first_end(m, 12.0), expected, push, 12.0)


@pytest.mark.parametrize("seed", range(30))
def test_a_flight_between_two_stops_ends_at_the_one_that_it_reaches_first(seed):
    """Some intervals after its start: the excitation is faster than the springs."""
    rng = np.random.default_rng(seed)
    names = ("m2", "k2", "d1", "d2", "box_frequency", "box_amplitude", "phase_start")
    low, high = (0.3, 0.3, 0.0, 0.0, 2.0, 0.0, 0.0), (3.0, 3.0, 0.2, 0.2, 4.0, 0.3, 6.0)
    values = dict(zip(names, rng.uniform(low, high).tolist(), strict=True))
    values["force1"] = float(rng.choice([0.0, 0.1]))
    state = rng.uniform((-1.0, -1.0, 0.0, -1.0), (0.0, 1.0, 1.0, 1.0)).tolist()
    first, second = truth.free_motion({**DEFAULTS, **values}, state, mp.mpf(values["phase_start"]))
    gap, start = second - first, state[2] - state[0]
    most = float(gap.sample(np.linspace(0.0, 12.0, 500)).max())
    stroke = max(1.001 * start, start + rng.uniform(0.2, 0.99) * (most - start))
    m = walk_to(flight(*state[:2], *state[2:], stroke=stroke, **values), 12.0)
    rest = truth.Signal([], [mp.mpf(stroke), 0, 0, 0]) - gap
    signals = {at.END_EVENT: gap, at.END_OTHER: rest}
    ends = {kind: truth.first_root(one, 12.0) for kind, one in signals.items()}
    expected = min((kind for kind in ends if ends[kind]), key=ends.get)
    assert m[at.END_KIND] == expected
    assert agree(m[at.END], ends[expected], signals[expected], 12.0)


FREE = [  # flights that nothing ends, of all kinds of loops from node to node
    {"clearance": 50.0},
    {"clearance": 50.0, "box_jerk": 1e-4},
    {"clearance": 50.0, "stroke": 100.0},
    {"clearance": 50.0, "stroke": 100.0, "force1": 0.1, "d2": 0.3},
    {"clearance": 50.0, "d1": 0.0, "d2": 0.0, "box_frequency": 1.0, "box_amplitude": 1e-3},
]


@pytest.mark.parametrize("values", FREE)
def test_the_walk_leaves_what_a_look_up_leaves(values):
    """To the bit, over the renewals of all blocks: an interval hangs on its number alone."""
    m = flight(-0.5, 0.2, 0.5, -0.1, **values)
    reached = 0.0
    for node in (1.5, 29.5, 30.5, 31.5, 66.5, 94.5, 95.5, 96.5, 130.5):
        if node > nodes.max_nodes(m) - 1.0:
            break
        age = node * m[at.SPACING]
        walk_to(m, age)
        assert m[at.LEFT_AGE] <= age < m[at.RIGHT_AGE] == m[at.CLEAR]
        assert m[at.WORK] == m[at.NODE] - reached
        reached, other = m[at.NODE], list(m)
        nodes.start_nodes(other)
        nodes.move_to_interval_at(other, age)
        write_event_values(other, at.LEFT_VALUES, at.LEFT, other[at.LEFT_AGE])
        write_event_values(other, at.RIGHT_VALUES, at.RIGHT, other[at.RIGHT_AGE])
        assert m[at.NODE : at.RIGHT_VALUES + 3] == other[at.NODE : at.RIGHT_VALUES + 3]


@pytest.mark.parametrize("gap", [1e-4, 1e-3])
def test_phasors_are_those_of_an_end_that_is_near_the_start(gap):
    m = walk_to(flight(-0.3, 0.5, gap - 0.3, -0.5), 12.0)
    assert (m[at.END_KIND], m[at.AT_END_NODE]) == (at.END_EVENT, 1.0)
    there = nodes.phasors_at(m, m[at.END])
    assert m[at.AT_END : at.AT_END + 6] == pytest.approx(there, rel=0.0, abs=1e-15)


@pytest.mark.parametrize("slope", [0.1, 1.0, 10.0])
@pytest.mark.parametrize("stroke", [0.0, 0.02, 100.0])
def test_no_more_than_the_first_interval_is_clear_at_a_start_from_the_boundary(slope, stroke):
    m = flight(0.1, 0.0, 0.1, slope, box_frequency=0.4, stroke=stroke)
    assert m[at.SERIES] == 0.0 and 0.0 < m[at.CLEAR] <= m[at.RIGHT_AGE] == m[at.SPACING]
    assert (m[at.CLEAR] == m[at.RIGHT_AGE]) == (stroke != 0.02)


def test_a_state_is_written_anew_after_its_nodes_and_a_step_ends_with_its_work():
    m = walk_to(flight(-0.5, 0.2, 0.5, -0.1, **FREE[0]), 1e6, 5.0)
    assert m[at.NODE] == 5.0 and m[at.END_KIND] == at.END_OPEN
    other = flight(-0.5, 0.2, 0.5, -0.1, **FREE[0])
    other[at.WORK], other[at.WORK_LIMIT] = 3.0, 5.0
    walk_to_event(other, 1e6)
    assert other[at.NODE] == 2.0
    walk_to(m, 1e6)
    assert m[at.END_KIND] == at.END_RENEWAL
    assert m[at.END] == nodes.LONGEST * m[at.SPACING]


@pytest.mark.parametrize("values", FREE[:4])
def test_no_interval_that_rises_above_the_ceiling_is_crossed_unseen(values):
    """The last one of a call may: it is looked at by who set the ceiling."""
    m = flight(-0.5, 0.9, 0.5, -0.1, **values)
    first, second = truth.free_motion({**DEFAULTS, **values}, (-0.5, 0.9, 0.5, -0.1), mp.mpf(0))
    gap = truth.gap_signal({**DEFAULTS, **values}, first, second)
    m[at.WORK], m[at.WORK_LIMIT] = 0.0, 1e5
    calls, ceiling = 0, 50.5
    while m[at.RIGHT_AGE] < 40.0:
        before = m[at.RIGHT_AGE]
        cross_clear_intervals(m, 40.0, ceiling)
        assert m[at.RIGHT_AGE] > before
        crossed = np.linspace(before, m[at.LEFT_AGE], 400 * (m[at.LEFT_AGE] > before))
        assert max(gap.sample(crossed), default=0.0) <= ceiling + 1e-12
        here = gap.sample(np.linspace(m[at.LEFT_AGE], m[at.RIGHT_AGE], 100)).max()
        assert m[at.RIGHT_AGE] >= 40.0 or here > ceiling - 0.02
        ceiling, calls = max(ceiling, here), calls + 1
    assert calls > 2


def test_the_side_at_the_boundary_is_kept_up_to_rounding_and_until_it_crosses():
    m = flight(-0.5, 0.2, 0.5, -0.1)
    floor = event_rounding(m, 0.3)
    assert 1e-15 < floor < 1e-13 and evaluate_event_function(m, 0.3)[0] > floor
    kept, slope = 2.0 * floor, -1e6 * floor
    for h0, h1, value in (
        *((-0.9 * floor, 0.0, kept), (-1.1 * floor, 0.0, -1.1 * floor), (0.0, 1.0, kept)),
        *((0.0, 0.9 * slope, kept), (0.0, 1.1 * slope, 0.0)),
    ):
        assert value_on_decided_side(m, 0.3, h0, h1) == value


@pytest.mark.parametrize(
    ("values", "code"),
    [
        ({"d2": 1e75, "x2_start": 1.0, "v2_start": -1.0}, at.NOT_FINITE),
        ({"d2": 1e48, "x2_start": 1e100}, at.LIMITED),
    ],
)
def test_no_event_is_excluded_by_a_bound_that_overflows(monkeypatch, values, code):
    """The walk looks on, and fails where nothing is certain."""
    monkeypatch.setattr(nodes, "FASTEST_RATE", 1e80)
    m = unstarted(evaluation_limit=1000.0, **values)
    assert (stepper.initialize(m, 0.0), stepper.advance(m, 1.0)) == (at.OK, code)
    assert m[at.WORK] > 0.0 and not m[at.IMPACT_COUNT]
