"""The walk finds the first root, which a scan in high precision finds too."""

import mpmath as mp
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator.roots import walk
from tests import exact_motion as truth

from .kernel import DEFAULTS, examples, rest_together, started, structures, unloaded

STATES = st.tuples(
    st.floats(-1.0, 0.0), st.floats(-1.0, 1.0), st.floats(0.01, 1.0), st.floats(-1.0, 1.0)
)


def first_end(m, horizon):
    """Age at which the present state ends by an event; None if it does not before the horizon."""
    m[at.WORK], m[at.WORK_LIMIT] = 0.0, 1e5
    walk(m, horizon)
    assert m[at.WORK] < 1e5
    return m[at.END] if m[at.END_KIND] == at.END_EVENT and m[at.END] <= horizon else None


def agree(found, expected, signal, horizon):
    """Whether both are the same root, as close as the rounding of the event function's terms lets
    it be.
    """
    if expected is None:
        return found is None or found > horizon * (1 - 1e-9)
    terms = sum(abs(complex(c)) for c, _ in signal.terms) + sum(
        abs(float(p)) * horizon**k for k, p in enumerate(signal.polynomial)
    )
    slope = abs(float(signal.derivative()(expected)))
    return (
        found is not None
        and abs(found - float(expected)) <= 1e-15 * (1.0 + found) + truth.ROUNDING * terms / slope
    )


@examples(80)
@given(structures(clearance=True), STATES)
@example(
    {"m2": 1.274, "k2": 0.448, "d1": 0.0, "d2": 27.1, "box_frequency": 0.117, "phase_start": 0.633},
    (-0.867, 0.783, 0.461, -0.530),
)
def test_first_impact_of_a_flight(values, state):
    m = started(
        x1_start=state[0], v1_start=state[1], x2_start=state[2], v2_start=state[3], **values
    )
    full, start = {**DEFAULTS, **values}, unloaded(values, state)
    gap = truth.gap_signal(full, *truth.free_motion(full, start, mp.mpf(values["phase_start"])))
    expected = truth.first_root(gap, 12.0)
    assert agree(first_end(m, 12.0), expected, gap, 12.0)


@examples(80)
@given(structures(damping=0.5, clearance=True), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_release_from_contact(values, x, v):
    values = {
        **values,
        "box_acceleration": 0.0,
        "box_jerk": 0.0,
        "box_snap": 0.0,
        "box_crackle": 0.0,
    }
    clearance = values["clearance"]
    x2 = x - max(clearance, 0.0)
    m = started(x1_start=x, x2_start=x2, v1_start=v, v2_start=v, **values)
    assume(m[at.MODE] == at.CONTACT)
    place = x + rest_together(values)[0] if clearance < 0.0 else x
    _, push = truth.contact_motion({**DEFAULTS, **values}, place, v, mp.mpf(values["phase_start"]))
    assume(push(0) > 1e-3)
    expected = truth.first_root(push, 12.0)
    assert agree(first_end(m, 12.0), expected, push, 12.0)


def gap_of(x2, values, state, phase=0.0):
    """Gap by Newton's law, the start of mass 2 displaced."""
    first, second = truth.free_motion(
        {**DEFAULTS, **values}, (state[0], state[1], x2, state[3]), mp.mpf(phase)
    )
    return second - first


def first_minimum(gap):
    """Time of the gap's first minimum after the start."""
    slope = gap.derivative()
    summit = float(truth.first_root(slope, 20.0)) + 1e-6 if slope(0) > 0 else 0.0
    return truth.first_root(-1 * slope, 20.0, summit)


def grazing_start(values, state, depth):
    """x2 at the start for which the gap's first minimum is ``depth``, by Newton's method; and the
    time of that minimum.
    """
    x2 = mp.mpf(state[2])
    for _ in range(7):
        gap, nearby = (gap_of(x2 + shift, values, state) for shift in (0, mp.mpf("1e-20")))
        bottom = first_minimum(gap)
        x2 -= (gap(bottom) - depth) / (nearby(bottom) - gap(bottom)) * mp.mpf("1e-20")
    return float(x2), bottom


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("depth", [1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize(
    "values",
    [
        {"box_frequency": 0.4},
        {"box_frequency": 1.3, "d1": 0.2},
        {"box_frequency": 2.2, "d1": 0.0, "d2": 0.4},
    ],
)
def test_a_near_miss_and_a_graze(values, depth, sign):
    # closing, but the stiffer spring pulls mass 2 back
    values, state = {"k2": 3.0, **values}, (-2.0, 0.5, -1.6, -0.8)
    x2, bottom = grazing_start(values, state, sign * depth)
    m = started(x1_start=state[0], v1_start=state[1], x2_start=x2, v2_start=state[3], **values)
    gap = gap_of(x2, values, state)
    assert abs(float(gap(bottom)) - sign * depth) < 1e-14
    expected = truth.first_root(gap, 20.0)
    assert (expected < bottom) == (sign < 0)
    assert agree(first_end(m, 20.0), expected, gap, 20.0)
