"""The box's motion over a segment: phase and state go on when inputs change, a cubic may be handed
over in parts.
"""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator.excitation import cubic_at

from .kernel import advanced, examples, set_inputs, started

CUBIC = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
STARTS = {"x1_start": -0.2, "x2_start": 0.1, "v1_start": 0.1, "v2_start": -0.3}


@examples(60)
@given(st.tuples(*[st.floats(-2, 2)] * 4), st.floats(0.0, 10.0))
def test_cubic_by_its_derivatives(cubic, age):
    m = [0.0] * at.SIZE
    m[at.CUBIC : at.CUBIC + 4] = cubic
    expected = [
        sum(cubic[k] * age ** (k - i) / math.factorial(k - i) for k in range(i, 4))
        for i in range(4)
    ]
    assert list(cubic_at(m, at.CUBIC, age)) == pytest.approx(expected, rel=1e-12, abs=1e-12)


def handed_over(cubic, age):
    """The cubic's inputs for a step that begins at an age."""
    return {
        name: sum(cubic[k] * age ** (k - i) / math.factorial(k - i) for k in range(i, 4))
        for i, name in enumerate(CUBIC)
    }


@pytest.mark.parametrize(
    "cubic", [(0.3, -0.2, 0.1, 0.05), (0.0, 0.0, 0.0, 0.2), (-0.5, 0.4, 0.0, 0.0)]
)
def test_a_cubic_in_parts_is_the_cubic_in_one(cubic):
    whole = started(**STARTS, **handed_over(cubic, 0.0))
    parts = started(**STARTS, **handed_over(cubic, 0.0))
    advanced(whole, 6.0)
    for i in range(24):
        set_inputs(parts, **handed_over(cubic, 0.25 * i))
        advanced(parts, 0.25 * (i + 1))
    assert whole[at.IMPACT_COUNT] == parts[at.IMPACT_COUNT] >= 1
    for slot in (at.X1, at.X2, at.V1, at.V2, at.IMPACT_ENERGY):
        assert parts[slot] == pytest.approx(whole[slot], abs=1e-10)


def test_without_a_frequency_the_amplitude_is_nothing():
    m = advanced(started(box_frequency=0.0, phase_start=1.0, **STARTS), 9.0)
    still = advanced(started(box_amplitude=0.0, box_frequency=0.0, phase_start=1.0, **STARTS), 9.0)
    assert [m[i] for i in (at.X1, at.X2, at.V1, at.V2, at.PHASE)] == [
        still[i] for i in (at.X1, at.X2, at.V1, at.V2, at.PHASE)
    ]
    assert (m[at.XI1], m[at.XI2], m[at.XI_REL]) == (0.0, 0.0, 0.0)
