"""Short flights by their series: exact relative to the gap itself, however low it is."""

from unittest.mock import patch

import mpmath as mp
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import series
from fmu_src.kernels.oscillator.event_function import evaluate_event_function
from fmu_src.kernels.oscillator.motion import state_at
from fmu_src.kernels.oscillator.parameters import SAME
from tests import exact_motion as truth

from .kernel import DEFAULTS, examples, flight, rest_together, sizes, structures, unloaded

PLACES = st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)


def leaving(values, x, v, slope):
    """A flight that leaves faces which touch, mass 1's motion and the gap in high precision."""
    apart = max(values.get("clearance", 0.0), 0.0)
    start = x, v, x - apart, v + slope
    full = {**DEFAULTS, **values}
    first, second = truth.free_motion(full, unloaded(values, start), mp.mpf(values["phase_start"]))
    return flight(*start, **values), first, truth.gap_signal(full, first, second)


@st.composite
def pressed_or_open(draw):
    """Structures whose faces rest against each other, with a force or without, or apart."""
    size = draw(sizes(1e-6, 1e3))
    return {**draw(structures()), "clearance": draw(st.sampled_from((0.0, -size, -size, size)))}


@examples(200)
@given(pressed_or_open(), *PLACES, sizes(1e-9, 0.1))
# pressed hard, so that the preload alone brings the faces together again
@example({"clearance": -100.0, "phase_start": 1.0}, 0.3, -0.2, 0.05)
@example({"clearance": -3.0, "phase_start": 0.0, "m2": 0.4, "d2": 0.3}, -0.5, 0.7, 1e-3)
@example({"clearance": -3.0, "phase_start": 0.0, "d2": 0.3, "force1_2": 30.0}, -0.5, 0.7, 1e-3)
# nearly as long as twelve terms allow
@example({"clearance": 0.0, "phase_start": 0.0}, 1.0, 0.0, 0.0172)
@example({"clearance": 0.0, "phase_start": 1.0, "box_frequency": 4.0}, 1.0, 0.0, 0.0047)
@example({"clearance": 0.0, "phase_start": 1.0, "m2": 0.3, "box_crackle": 1.0}, 1.0, 0.0, 0.13)
def test_a_short_flight_is_that_of_the_gap(values, x, v, slope):
    """By Newton's law, to rounding of the gap's own terms, below the bound that makes it sure."""
    m, first, gap = leaving(values, x, v, slope)
    assume(m[at.SERIES] != 0.0)
    with mp.workdps(50):
        end, speed, closing = m[at.END], first.derivative(), gap.derivative()
        curvature = closing.derivative()
        terms = abs(m[at.FORCE_V] * v) + abs(m[at.PRELOAD]) + SAME * (abs(x) + abs(v))
        terms += abs(m[at.FORCE_X]) * (abs(x) + max(values["clearance"], 0.0))
        start = abs(float(gap(mp.mpf(0))))  # faces that touch but for the rounding of the start
        size = 1.0 + abs(values["clearance"])
        assert m[at.END_KIND] == at.END_EVENT and closing(mp.mpf(end)) < 0
        for part in (0.1, 0.5, 0.9, 1.0):
            tau = mp.mpf(part * end)
            bound = 1e-13 * (slope + terms * tau) * tau + 4.0 * start
            h0, h1, h2, *_ = evaluate_event_function(m, float(tau))
            assert abs(h0 - gap(tau)) <= bound
            assert abs(h1 - closing(tau)) <= 1e-12 * (slope + terms)
            assert abs(h2 - curvature(tau)) <= 1e-12 * (slope + abs(curvature(0)) + terms)
            x1, v1, x2, _ = state_at(m, float(tau))
            assert abs(x2 - x1 - max(h0, 0.0)) <= 4e-15 * size
            assert abs(v1 - speed(tau)) <= 1e-14 * size
            assert values["clearance"] or abs(x1 - first(tau)) <= 1e-15  # counted from rest else
        assert abs(gap(mp.mpf(end))) <= 1e-13 * (slope + terms * end) * end + 4.0 * start
        assert all(gap(mp.mpf(end) * i / 16) > -start for i in range(1, 16))
        fifth = curvature.derivative().derivative().derivative()
        reach = 0.3 / m[at.RATE]
        largest = max(abs(fifth(mp.mpf(reach * i / 8))) for i in range(9))
        assert largest <= m[at.SERIES_BOUND]


@examples(200)
@given(pressed_or_open(), *PLACES, sizes(1e-9, 0.1), st.sampled_from((8, 12)))
@example({"clearance": -3.0, "phase_start": 1.0, "m2": 0.4, "force1_3": 3.0}, -0.5, 0.7, 1e-3, 12)
@example({"clearance": 0.0, "phase_start": 1.0, "box_crackle": 3.0, "d2": 0.3}, 0.5, 0.7, 0.1, 12)
def test_all_derivatives_at_the_start_are_newtons(values, x, v, slope, order):
    """And nothing is left of the series before."""
    m, first, gap = leaving(values, x, v, slope)
    size = 10.0 + abs(values["clearance"]) * (1.0 + m[at.RATE] ** 2)
    place = x - (rest_together(values)[0] if values["clearance"] > 0.0 else 0.0)
    for k in range(13):
        m[at.SERIES_GAP + 2 * k] = m[at.SERIES_X + 2 * k] = 1e3
    series.set_series(m, float(place), v, v + slope - v, order)
    for k in range(1, order + 1):
        first, gap, size = first.derivative(), gap.derivative(), size * m[at.RATE]
        assert abs(m[at.SERIES_X + 2 * k] - first(0)) <= 1e-12 * size, k
        assert abs(m[at.SERIES_GAP + 2 * k] - gap(0)) <= 1e-12 * size, k
    assert not any(m[at.SERIES_GAP + 2 * k] for k in range(order + 1, 13))


@pytest.mark.parametrize(
    ("third", "fourth", "fifth"),
    [(0.3, 0.3, 0.4), (0.53, 0.3, 0.17), (0.3, 0.53, 0.17), (-1.0, 0.9, 0.1), (0.7, -1.0, 0.3)],
)
def test_a_gap_that_may_not_be_concave_is_walked(third, fourth, fifth):
    """Where what bends it may turn the curvature within half again of the parabola's time."""
    m = flight(1.0, 0.0, 1.0, 1e-3, box_amplitude=0.0)
    bend = -m[at.SERIES_GAP + 4]
    longest = 1.5 * 2.0 * 1e-3 / bend
    m[at.SERIES_GAP + 6] = third * bend / longest
    m[at.SERIES_GAP + 8] = fourth * 2.0 * bend / longest**2
    for more, walked in ((-0.03, False), (0.03, True)):
        bound = (fifth + more) * 6.0 * bend / longest**3
        with patch.object(series, "fifth_derivative_bound", lambda _, size=bound: size):
            assert (series.short_flight_duration(m, 8) == 0.0) == walked


@pytest.mark.parametrize(
    ("angle", "order"), [(0.0199, 8), (0.0201, 12), (0.199, 12), (0.201, 4), (-0.01, 4)]
)
def test_the_order_of_a_series_goes_by_the_flights_angle(angle, order):
    """Of the fastest change over twice the way to its summit; none if it is not pulled back."""
    m = flight(0.1, 0.0, 0.1, 1.0, box_frequency=1.7)
    assert m[at.RATE] == 1.7
    assert series.required_series_order(m, 0.5, -1.7 / angle) == order
    assert series.required_series_order(m, 0.5, 0.0) == 4


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("force", [0.0, 0.01])
def test_all_that_moves_the_masses_raises_the_bound(sign, force):
    """Whichever way it acts: by 9.8 R^4 times what it makes of V at least, and not much more."""
    m = flight(0.1, 0.2, 0.1, 0.3, k2=3.0, d1=0.3, d2=0.1, box_acceleration=0.1, force1=force)
    rate, drive, apart = m[at.RATE], at.OSCILLATOR_1 + at.DRIVE, at.GAP + at.DRIVE
    driven = 1.35 * (abs(m[at.FORCE_V]) + abs(m[at.FORCE_X]) / rate)  # of a part of Z, over R
    parts = {drive: driven / rate**2, drive + 1: driven / rate**2, at.REST_1: driven / rate**2}
    parts |= {at.SERIES_X: driven, at.SERIES_X + 2: driven / rate, at.SERIES_GAP + 2: 1.0}
    parts |= {at.PRELOAD: 1.35 / rate}
    if force:
        parts |= {apart: 1.35 / rate, apart + 1: 1.35 / rate}
    cubics = (at.CUBIC, at.CUBIC_1, at.CUBIC_2) if force else (at.CUBIC,)
    for number, cubic in enumerate(cubics):  # the gap feels the box as both masses do
        own = abs(m[at.OSCILLATOR_1 + at.SHARES + number]) if force else 1.0
        gap = abs(m[at.GAP + at.SHARES + number]) if force else 0.0
        for k in range(4):
            parts[cubic + k] = 1.35 * (own * driven / rate + gap) / rate ** (1 + k)
    for slot, part in parts.items():
        bounds = []
        for size in (0.0, 1.0, 2.0):
            other = list(m)
            for cubic in cubics:
                other[cubic : cubic + 4] = [0.0] * 4
            other[slot] = size if slot == at.SERIES_GAP + 2 else sign * size  # it opens
            bounds.append(series.fifth_derivative_bound(other))
        for low, high in zip(bounds, bounds[1:], strict=False):
            assert 9.8 * part <= (high - low) / rate**4 <= 10.1 * part, slot
