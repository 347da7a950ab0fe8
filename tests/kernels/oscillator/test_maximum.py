"""The largest gap over a step is the maximum: not below any sample, not above the best that
optimisation finds.
"""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from tests import exact_motion as truth

from .kernel import DEFAULTS, advanced, examples, sizes, started, structures, unloaded

STATES = st.tuples(
    st.floats(-1.0, 0.0), st.floats(-1.0, 0.0), st.floats(0.2, 1.0), st.floats(0.0, 1.0)
)


def summit(gap, start, stop):
    """Largest value on an interval, by sampling and then Newton's method in high precision."""
    t = np.linspace(start, stop, 2000)
    h = gap.sample(t)
    best, slope = int(h.argmax()), gap.derivative()
    low, high = t[max(best - 1, 0)], t[min(best + 1, len(t) - 1)]
    value = max(gap(start), gap(stop))
    if slope(low) > 0 > slope(high):
        value = max(value, gap(truth.refine_root(slope, low, high)))
    return float(value), float(h.max())


@examples(80)
@given(structures(clearance=True), STATES, st.floats(0.0, 3.0), sizes(1e-3, 10.0))
def test_over_a_piece_of_flight(values, state, start, length):
    names = ("x1_start", "v1_start", "x2_start", "v2_start")
    m = started(**values, **dict(zip(names, state, strict=True)))
    advanced(m, start, start + length)
    full, begun = {**DEFAULTS, **values}, unloaded(values, state)
    gap = truth.gap_signal(full, *truth.free_motion(full, begun, mp.mpf(values["phase_start"])))
    assume(truth.first_root(gap, start + length) is None)
    highest, sampled = summit(gap, start, start + length)
    terms = sum(abs(complex(c)) for c, _ in gap.terms) + 1.0 + abs(values["clearance"])
    assert m[at.X_REL_MAX] >= sampled - 1e-14 * terms
    assert m[at.X_REL_MAX] == pytest.approx(highest, rel=1e-12, abs=1e-14 * terms)


@examples(60)
@given(
    sizes(0.03, 30.0),
    *[st.tuples(sizes(1e-6, 10.0), st.sampled_from([-1.0, 1.0]), sizes(1e-6, 10.0))] * 2,
    *[sizes(1e-3, 100.0)] * 2,
    sizes(0.01, 100.0),
    sizes(1e-8, 10.0),
)
def test_to_the_rounding_of_its_terms(m2, one, other, d1, d2, amplitude, length):
    """Sizes apart, dampers far beyond critical: no further off than the displacements are."""
    values = {**DEFAULTS, "m2": m2, "d1": d1, "d2": d2, "box_amplitude": amplitude}
    state = (-one[0], one[1] * one[2], other[0], other[1] * other[2])
    names = ("x1_start", "v1_start", "x2_start", "v2_start")
    m = advanced(started(**values, **dict(zip(names, state, strict=True))), length)
    assume(not m[at.IMPACT_COUNT])
    first, second = truth.free_motion(values, state, mp.mpf(0))
    gap = second - first
    t = np.concatenate([np.linspace(0.0, length, 200), length * np.geomspace(1e-7, 1.0, 100)])
    t.sort()
    slope = gap.derivative()
    signs = np.sign(slope.sample(t))
    expected = max(gap(0), gap(length))
    for i in np.flatnonzero((signs[:-1] > 0) & (signs[1:] < 0)):
        expected = max(expected, gap(mp.findroot(slope, (t[i], t[i + 1]), solver="anderson")))
    size = sum(abs(complex(c)) for c, _ in gap.terms)
    assert m[at.X_REL_MAX] == pytest.approx(float(expected), rel=0.0, abs=4e-15 * size)
