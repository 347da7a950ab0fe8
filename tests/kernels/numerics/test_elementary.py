"""Sine, cosine and exponential function to 2 units in the last place, also for large arguments."""

import math

import mpmath as mp
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fmu_src.kernels.numerics.elementary import exp_decay, fraction_of_turn, sincos_turns

from ..oscillator.kernel import examples

TURNS = (
    st.floats(-1.0, 1.0)
    | st.floats(-(2.0**50), 2.0**50)
    | st.builds(math.ldexp, st.integers(-(2**20), 2**20), st.integers(-23, 10))
)


def ulps(value, exact):
    return float(abs(mp.mpf(value) - exact) / math.ulp(float(exact)))


@examples(400)
@given(TURNS)
@example(-0.490049370409392)
def test_sine_and_cosine_of_turns(u):
    with mp.workdps(40):
        sine, cosine = sincos_turns(u)
        assert ulps(sine, mp.sinpi(2 * mp.mpf(u))) <= 2.0
        assert ulps(cosine, mp.cospi(2 * mp.mpf(u))) <= 2.0


@pytest.mark.parametrize("full", [0, 1, -1, 2**40, -(2**40)])
def test_quarter_turns_are_exact(full):
    quarters = [sincos_turns(full + 0.25 * i) for i in range(4)]
    assert quarters == [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)]


@examples(400)
@given(st.floats(0.0, 700.0) | st.floats(0.0, 1.0))
@example(0.0)
@example(700.0)
def test_exponential_decay(x):
    with mp.workdps(40):
        assert ulps(exp_decay(x), mp.exp(-mp.mpf(x))) <= 2.0


@examples(300)
@given(st.floats(-1e15, 1e15) | st.floats(-1e-15, 1e-15))
@example(-1e-20)
@example(-0.0)
@example(1.0)
def test_fraction_is_in_the_unit_interval(u):
    part = fraction_of_turn(u)
    assert 0.0 <= part < 1.0
    distance = abs(part - mp.frac(mp.mpf(u)))
    assert min(distance, 1 - distance) <= 2.0**-53  # next to a full turn, 1 - tiny is 0
