"""The largest gap over a step is the maximum that high precision finds."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from tests import exact_motion as truth

from .kernel import DEFAULTS, advanced, examples, flight, sizes


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
    m = advanced(flight(*state, **values), length)
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
