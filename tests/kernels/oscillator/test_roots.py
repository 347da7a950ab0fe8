"""The certified step never passes a root; the walk finds the first root, which a scan in high
precision finds too.
"""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fmu_src.kernels.numerics.first_root import (
    clear_step,
    lowest_curvature,
    parabola_root,
    taylor_root,
)
from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator.roots import walk
from tests import exact_motion as truth

from .kernel import DEFAULTS, examples, rest_together, sizes, started, structures, unloaded

SIGNED = st.just(0.0) | sizes(1e-12, 1e3) | sizes(1e-12, 1e3).map(lambda x: -x)
HEIGHTS = st.just(0.0) | sizes(1e-15, 1e3)
STATES = st.tuples(
    st.floats(-1.0, 0.0), st.floats(-1.0, 1.0), st.floats(0.01, 1.0), st.floats(-1.0, 1.0)
)


REACH = 6.0


def quintic(h, bound, s):
    """The lower bound of an event function, and the size of its terms."""
    terms = [mp.mpf(value) * s**k / mp.factorial(k) for k, value in enumerate(h)] + [
        -mp.mpf(bound) * s**5 / 120
    ]
    return sum(terms), sum(map(abs, terms))


def lowest(h, bound, stop):
    """The quintic's least value on (0, stop], relative to the size of its terms there."""
    with mp.workdps(60):
        slope = [
            -mp.mpf(bound) / 24,
            mp.mpf(h[4]) / 6,
            mp.mpf(h[3]) / 2,
            mp.mpf(h[2]),
            mp.mpf(h[1]),
        ]
        flat = [
            mp.re(s)
            for s in mp.polyroots(slope[::-1], maxsteps=500, extraprec=400, asc=True)
            if abs(mp.im(s)) <= abs(s) * mp.mpf("1e-20")
        ]
        values = [quintic(h, bound, s) for s in (mp.mpf(stop), *flat) if 0 < s <= stop]
        return float(min(value / terms for value, terms in values))


@examples(150)
@given(HEIGHTS, SIGNED, SIGNED, SIGNED, SIGNED, sizes(1e-9, 1e6))
@example(0.0, 0.0, 1.0, 0.0, 0.0, 3.0)
@example(0.5, -1.0, 1.0, 0.0, 0.0, 1e-9)  # double root of the parabola
@example(1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
@example(0.0, 1.0, 0.0, -1.0, 0.0, 1.0)
@example(0.0, 1.0, -2.0, 3.0, -4.0, 1.0)
@example(0.0, 0.0, 1.0, 3.0, -8.0, 1.0)
def test_a_clear_step_is_certified(h0, h1, h2, h3, h4, bound):
    assume(h0 > 0.0 or h1 > 0.0 or (h1 == 0.0 and h2 > 0.0))
    step = clear_step(h0, h1, h2, h3, h4, bound, REACH)
    assert 0.0 < step <= REACH
    assert lowest((h0, h1, h2, h3, h4), bound, step) >= -4e-15


@examples(300)
@given(
    sizes(1e-3, 1.0),
    sizes(1e-3, 1.0),
    SIGNED,
    SIGNED,
    SIGNED,
    sizes(1e-3, 10.0),
    st.floats(0.01, 1.0),
)
@example(0.641, 0.0593, -18.0, 79.8, 3.57, 0.1, 0.353)  # these rise somewhere between
@example(0.531, 0.669, 0.164, -0.0128, 1.85, 0.1, 0.973)
def test_a_root_by_taylor_is_the_only_one_from_the_clear_step_on(h0, fall, h2, h3, h4, bound, step):
    root = taylor_root(h0, -fall, h2, h3, h4, bound, step, 1e3)
    if root > 0.0:
        for s in (step + (root - step) * i / 20 for i in range(21)):
            assert -fall + s * (h2 + s * (h3 / 2 + s * (h4 / 6 + s * bound / 24))) < 0.0


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e-9])
def test_the_parabola_is_below_the_quintic(scale):
    """All along the step, however slightly the derivatives bend it."""
    rng = np.random.default_rng(3)
    part = np.linspace(0.0, 1.0, 201)
    for _ in range(300):
        h2, h3, h4 = scale * rng.uniform(-1.0, 1.0, 3) * (0.0, 1.0, 3.0)
        bound, s = scale * rng.uniform(0.0, 1.0) * rng.integers(2), rng.uniform(0.1, 2.0)
        t = s * part
        least = (h2 + t * (h3 / 3.0 + t * (h4 / 12.0 - bound * t / 60.0))).min()
        assert lowest_curvature(h2, h3, h4, bound, s) <= least + 1e-15 * scale


def test_an_event_function_that_never_falls_has_no_root():
    assert clear_step(1.0, 0.5, 0.2, 0.0, 0.0, 0.0, REACH) == REACH
    assert parabola_root(1.0, -0.1, 1.0) == math.inf
    assert parabola_root(0.0, 0.0, 1.0) == math.inf


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
