"""Short flights by their series: as exact relative to the gap itself, however low it is, as the
closed form is relative to the displacements.
"""

import mpmath as mp
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import series
from fmu_src.kernels.oscillator.event_function import evaluate
from fmu_src.kernels.oscillator.motion import state_at
from fmu_src.kernels.oscillator.parameters import SAME
from tests import exact_motion as truth

from .kernel import DEFAULTS, examples, flight, sizes, structures, unloaded

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
def test_a_short_flight_is_that_of_the_gap(values, x, v, slope):
    """Value, slope and curvature all along, and the end: those of Newton's law, to rounding of the
    gap's own terms; the fifth derivative stays below the bound that makes the root certain.
    """
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
            h0, h1, h2, *_ = evaluate(m, float(tau))
            assert abs(h0 - gap(tau)) <= bound
            assert abs(h1 - closing(tau)) <= 1e-12 * (slope + terms)
            assert abs(h2 - curvature(tau)) <= 1e-12 * (slope + abs(curvature(0)) + terms)
            x1, v1, *_ = state_at(m, float(tau))
            assert abs(v1 - speed(tau)) <= 1e-14 * size
            assert values["clearance"] or abs(x1 - first(tau)) <= 1e-15  # counted from rest else
        assert abs(gap(mp.mpf(end))) <= 1e-13 * (slope + terms * end) * end + 4.0 * start
        assert all(gap(mp.mpf(end) * i / 64) > -start for i in range(1, 64))
        fifth = curvature.derivative().derivative().derivative()
        reach = 0.3 / m[at.RATE]
        largest = max(abs(fifth(mp.mpf(reach * i / 8))) for i in range(9))
        assert largest <= m[at.SERIES_BOUND]


def test_a_gap_that_is_not_concave_is_walked():
    m = flight(1.0, 0.0, 1.0, 1e-3, box_amplitude=0.0)
    assert series.short_flight_duration(m, 8) == m[at.END] > 0.0
    m[at.OSCILLATOR_1 + at.DRIVE + 1] = 1e9
    assert series.short_flight_duration(m, 8) == 0.0
    m[at.OSCILLATOR_1 + at.DRIVE + 1] = 0.0
    m[at.SERIES_GAP + 6] = 1e3
    assert series.short_flight_duration(m, 8) == 0.0


@pytest.mark.parametrize(
    ("angle", "order"), [(0.0199, 8), (0.0201, 12), (0.199, 12), (0.201, 4), (-0.01, 4)]
)
def test_the_order_of_a_series_goes_by_the_flights_angle(angle, order):
    """Of the fastest change over twice the way to its summit; none if it is not pulled back."""
    m = flight(0.1, 0.0, 0.1, 1.0, box_frequency=1.7)
    assert m[at.RATE] == 1.7
    assert series.required_order(m, 0.5, -1.7 / angle) == order
    assert series.required_order(m, 0.5, 0.0) == 4


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_all_that_moves_the_masses_raises_the_bound(sign):
    """Each part of drive and state by its size, whichever way it acts."""
    m = flight(0.1, 0.2, 0.1, 0.3, k2=3.0, d1=0.3, d2=0.1, box_acceleration=0.1, box_jerk=0.2)
    drive = at.OSCILLATOR_1 + at.DRIVE
    for slot in (drive, drive + 1, at.REST_1, at.SERIES_X, at.SERIES_X + 2, at.PRELOAD):
        m[slot] = 0.0
        bounds = []
        for size in (0.0, 1.0, 2.0):
            m[slot] = sign * size
            bounds.append(series.fifth_bound(m))
        assert 0.0 < bounds[0] < bounds[1] < bounds[2]
