"""Sequences of states against independent references, and how each state begins."""

import math
from fractions import Fraction
from unittest.mock import patch

import mpmath as mp
import pytest

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import motion, stepper
from fmu_src.kernels.oscillator.event_function import evaluate_event_function, event_rounding
from tests import exact_motion as truth
from tests.fmu.event_driven import CONTACT, Motion
from tests.fmu.test_forces import KINDS, drawn

from .kernel import DEFAULTS, advanced, flight, pieces, set_inputs, started

STATE = (-0.3, 0.2, 0.4, -0.5)  # x1, v1, x2, v2
STARTS = dict(zip(("x1_start", "v1_start", "x2_start", "v2_start"), STATE, strict=True))


@pytest.mark.parametrize("kind", KINDS)
def test_gaps_walls_plays_and_forces_at_points_of_their_motion(kind):
    """Against an event-driven solver: in flights and contacts at either end, from either origin."""
    for seed in range(4):
        values, changes, stop = drawn(kind, seed, 3)
        motion, m, now = Motion(values), started(**values), 0.0
        motion.longest *= 0.5  # no graze is stepped over
        for time, inputs in [*changes, (stop, {})]:
            for part in (0.25, 0.5, 0.75, 1.0):
                motion.run(now + part * (time - now))
                advanced(m, motion.time)
                expected = *motion.state, motion.gap(0.0, motion.state)
                found = [m[i] for i in (at.X1, at.V1, at.X2, at.V2, at.X_REL)]
                assert found == pytest.approx(expected, abs=1e-10 * motion.size), (seed, part)
                side = (1 if motion.side > 0 else 2) if motion.impacts else 0
                assert (m[at.IN_CONTACT], m[at.IMPACT_SIDE]) == (motion.mode == CONTACT, side)
                counts = len(motion.impacts), sum(motion.sticks)
                assert (m[at.IMPACT_COUNT], m[at.CONTACT_COUNT]) == counts
                last = motion.impacts[-1] if motion.impacts else 0.0
                assert m[at.IMPACT_TIME] == pytest.approx(last, abs=1e-7)
            motion.set(**inputs)
            set_inputs(m, **inputs)
            now = time


@pytest.mark.parametrize("m2", [1.0, 4.0])
@pytest.mark.parametrize("push", [0.0, -0.3])
def test_equal_oscillators_always_move_together(m2, push):
    alike = {"m2": m2, "k2": m2, "d1": 0.25, "d2": 0.25 * m2, "box_frequency": 1.3}
    values = {**alike, "phase_start": math.pi, "box_acceleration": push}
    m = flight(0.2, -0.4, 0.2, -0.4, **values)
    slots = (at.X_REL, at.V_REL, at.X_REL_MAX, at.CONTACT_FORCE, at.IMPACT_COUNT)
    for i in range(1, 200):
        advanced(m, 0.5 * i)
        assert [m[slot] for slot in (*slots, at.IN_CONTACT)] == [0, 0, 0, 0, 0, 1]
    common, _ = truth.contact_motion({**DEFAULTS, **values}, 0.2, -0.4, mp.mpf(math.pi))
    assert m[at.X1] == pytest.approx(float(common(99.5)), abs=1e-12)


STEEP = {"m2": 1.3, "k2": 9.3, "d1": 0.0, "d2": 79.0, "e": 0.2, "gamma": 1e-6}


@pytest.mark.parametrize(("clearance", "impacts"), [(0.0, 1000), (0.3, 0)])
def test_a_motion_that_decays_for_ever_comes_to_rest(clearance, impacts):
    """Impacts take some of it in each period; nothing drives it, and its digits end."""
    start = {"x1_start": -0.3, "v1_start": -0.3} if impacts else {"x2_start": 0.1}
    m = started(**STEEP, box_amplitude=0.0, clearance=clearance, **start)
    with patch.multiple(stepper, WORK_BASE=1e5, WORK_RATE=0.0):
        advanced(m, 20_000.0)
    assert [m[slot] for slot in (at.X1, at.V1, at.X2, at.V2)] == [0.0] * 4
    assert m[at.X_REL] == clearance and m[at.IMPACT_COUNT] >= impacts


@pytest.mark.parametrize("push", ["box_amplitude", "box_acceleration"])
def test_a_motion_next_to_nothing_that_is_driven_goes_on(push):
    """2 to the -985 of another, to within what rounding takes there."""
    found = [
        advanced(started(**{"box_amplitude": 0.0, push: size}, d1=0.2), 5.0)[at.X1] / size
        for size in (-1.0, -(2.0**-985))
    ]
    assert found[1] == pytest.approx(found[0], rel=0.02)


@pytest.mark.parametrize(
    "values",
    [
        *({"phase_start": phase, "box_acceleration": 0.1} for phase in (0.3, 2.0)),
        {"phase_start": 0.3, "box_acceleration": 0.1, "d1": 0.6, "start": (0.25, -0.5)},
        {"d1": 1.0},  # from its jerk on,
        {"box_amplitude": 0.0, "box_jerk": 0.0},  # from its snap on: the next term is a millionth
    ],
)
def test_a_brief_contact_ends_where_newton_has_it(values):
    """From rest its way is below the rounding of the closed form."""
    error = 1e-14 if "box_acceleration" in values else 1e-8
    own = {"m2": 1.3, "d1": 0.02, "box_jerk": 0.05, "box_snap": 0.3, "box_frequency": 4.0}
    values = {**DEFAULTS, **own, "phase_start": 0.0, **values}
    x, v = values.pop("start", (0.0, 0.0))
    m = started(**values)
    m[at.MODE] = at.CONTACT
    motion.begin_contact_or_glued(m, at.CONTACT, x, v)
    exact, _ = truth.contact_motion(values, x, v, mp.mpf(values["phase_start"]))
    speed = exact.derivative()
    for age in (0.95e-6, 1e-8):
        m[at.END] = age / m[at.RATE]
        with mp.workdps(60):
            expected = float(exact(mp.mpf(m[at.END]))), float(speed(mp.mpf(m[at.END])))
        assert motion.state_at_end(m)[:2] == pytest.approx(expected, rel=error, abs=0.0)


def test_the_origin_of_time_keeps_its_low_part():
    """Over 200,000 states: both parts together are the sum to 1e-25 of it."""
    m = started()
    m[at.ORIGIN] = 1e6
    for _ in range(200_000):
        motion.advance_origin(m, 0.1)
    total = Fraction(10**6) + 200_000 * Fraction(0.1)
    assert abs(Fraction(m[at.ORIGIN]) + Fraction(m[at.ORIGIN_LOW]) - total) < 1e-19
    assert m[at.ORIGIN] == float(total)


def test_a_contact_that_is_written_anew_while_it_is_pressed_goes_on():
    """Whichever way its force changes there: only where it ends has the force vanished."""
    m = started(clearance=-1.0, box_amplitude=0.2, box_frequency=1.3)
    for _ in range(8):
        m[at.END], m[at.END_KIND], work = 0.7, at.END_RENEWAL, m[at.WORK]
        motion.end_state(m)
        assert (m[at.MODE], m[at.WORK]) == (at.CONTACT, work + 1.0)


@pytest.mark.parametrize("values", [{"box_frequency": 0.7, "d1": 0.2}, {"box_frequency": 1.9}])
def test_a_phase_that_is_rotated_is_computed_anew_before_it_is_off(values):
    """By 32 roundings at most; without that it was off by 5e-14 after 200 impacts."""
    states = pieces(started(**values), 600.0)
    assert len(states) > 100
    for m, _, _ in states:
        angle = 2.0 * math.pi * m[at.TURN]
        expected = math.cos(angle), math.sin(angle)
        assert (m[at.COSINE], m[at.SINE]) == pytest.approx(expected, abs=6e-15)


@pytest.mark.parametrize(
    ("duration", "limit", "is_short"), [(1.0, 1.01, True), (1.0, 0.99, False), (0.0, 1.0, False)]
)
def test_a_short_flight_is_certain_and_stays_inside_the_stroke(
    monkeypatch, duration, limit, is_short
):
    m = started(**STARTS)
    monkeypatch.setattr(motion, "required_series_order", lambda *given: 8)
    monkeypatch.setattr(motion, "short_flight_duration", lambda *given: duration)
    m[at.LIMIT] = limit * 0.25  # of a gap velocity of 0.25
    motion.begin_after_impact(m, 0.1, -0.1, 0.15)
    assert (m[at.SERIES] != 0.0, m[at.END] == duration) == (is_short, is_short)


@pytest.mark.parametrize("order", [3, 4, 5])
def test_a_start_at_rest_leaves_the_boundary_by_half_of_what_its_bound_allows(order):
    """There its first derivative that does not vanish makes twice as much as the bound takes."""
    m = started(**STARTS)
    bound = motion.event_derivative_bound(m, order + 1)
    value = 1e-3 * bound * m[at.RIGHT_AGE]
    motion.leave_boundary(m, order, value)
    step = m[at.CLEAR]
    grown, taken = (s / math.factorial(k) for k, s in power_terms(step, order, value, bound))
    assert 0.0 < step < m[at.RIGHT_AGE] and taken == pytest.approx(0.5 * grown, abs=0.0)
    assert motion.bound_after_step(step, order, value) == pytest.approx(grown + taken, abs=0.0)
    m[at.LIMIT] = 0.5 * (grown + taken)
    motion.leave_boundary(m, order, value)
    assert m[at.CLEAR] == 0.5 * step  # within the stroke
    motion.leave_boundary(m, order, 1e9 * bound)
    assert m[at.CLEAR] <= m[at.RIGHT_AGE]


def test_masses_that_touch_at_a_start_are_where_they_are_put():
    """The centre of two equal numbers is off by their rounding for some masses."""
    for m2 in (0.7, 1.0, 1.3, 1.9, 3.1, 4.7):
        m = started(m2=m2, x1_start=0.2, x2_start=0.2, box_acceleration=-1.0)
        assert (m[at.X1], m[at.X2]) == (0.2, 0.2)


@pytest.mark.parametrize(("part", "narrow"), [(0.95, 1.0), (1.05, 0.0)])
def test_a_stroke_of_a_million_roundings_of_the_gap_is_wide_enough(part, narrow):
    m = started(**STARTS, stroke=2.0)
    m[at.LIMIT] = 1e6 * event_rounding(m, 0.0) * part
    motion.set_flight(m, *STATE, 0.7)
    assert m[at.NARROW] == narrow


@pytest.mark.parametrize("clearance", [0.0, 0.3])
def test_a_flight_begins_with_the_second_derivative_of_its_gap(monkeypatch, clearance):
    """Its first certified step hangs on it: as the closed form has it."""
    told = []
    monkeypatch.setattr(motion, "skip_clear_start", lambda m, *slopes: told.append(slopes) or True)
    monkeypatch.setattr(motion, "required_series_order", lambda *given: 0)
    m = started(**STARTS, clearance=clearance, d1=0.3, d2=0.7)
    motion.begin_flight(m, *STATE, 0.7 + clearance)
    assert m[at.LEFT_VALUES + 2] == pytest.approx(evaluate_event_function(m, 0.0)[2], rel=1e-12)
    motion.begin_after_impact(m, 0.1, -0.1, 0.4)
    assert told == [pytest.approx(evaluate_event_function(m, 0.0)[1:3], rel=1e-12)]
    angle = 2.0 * math.pi * (m[at.TURN] + m[at.ETA_TURNS] * 0.3)
    for m[at.SERIES] in (0.0, 8.0):  # of a short flight the phase is its own too
        found = motion.state_and_phase_at(m, 0.3)
        expected = *motion.state_at(m, 0.3), math.cos(angle), math.sin(angle)
        assert found == pytest.approx(expected, abs=1e-12)


def test_which_derivative_leaves_the_boundary(monkeypatch):
    """Of the gap it is the one two orders higher; the first two begin a certified step."""
    told, slopes, m = [], [], started(**STARTS)
    monkeypatch.setattr(motion, "leave_boundary", lambda m, *given: told.append(given))
    for value in (0.5, -0.5):
        monkeypatch.setattr(motion, "first_nonzero_force_derivative", lambda *_, v=value: (1, v))
        motion.begin_touching_state(m, 0.1, 0.2, 0.2, 0)
    assert told == [(3, 0.5), (1, 0.5)]
    monkeypatch.undo()
    monkeypatch.setattr(motion, "skip_clear_start", lambda m, *given: slopes.append(given) or True)
    m = started(**STARTS)
    for order in (1, 2):
        motion.leave_boundary(m, order, 0.25)
    assert slopes == [(0.25, evaluate_event_function(m, 0.0)[2]), (0.0, 0.25)]


@pytest.mark.parametrize(
    ("values", "size", "dead"),
    [
        *(({}, 1.9e-292, True), ({}, 2.1e-292, False), ({at.SHAKEN: 1.0}, 0.0, False)),
        *(({at.CUBIC_PRESENT: 1.0}, 0.0, False), ({at.MODE: at.CONTACT}, 0.0, True)),
        *(({at.GAP_OFFSET: 0.3}, 0.0, True), ({at.GAP_OFFSET: -0.3}, 0.0, True)),
        ({at.GAP_OFFSET: 0.3, at.MODE: at.CONTACT}, 0.0, False),  # together, not at rest
    ],
)
def test_what_is_too_small_for_its_digits_and_not_driven_has_died_away(values, size, dead):
    m = started(**STARTS, box_amplitude=0.0)
    for slot, value in values.items():
        m[slot] = value
    for place in range(4):
        state = [0.0] * 4
        state[place] = -size
        assert motion.has_died_away(m, *state) == dead


def power_terms(step, order, value, bound):
    """Exponents and sizes of the leading term and of the one that the bound allows."""
    return (order, value * step**order), (order + 1, bound * step ** (order + 1))
