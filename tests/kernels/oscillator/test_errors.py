"""What cannot be computed is said with a code, within bounded work: never a hang, an exception or a
number that is not one.
"""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import nodes, stepper

from .kernel import examples, least_work, sizes, unstarted


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


@least_work
@examples(60)
@given(st.data())
def test_extreme_parameters_end_with_a_code(data):
    draw = data.draw
    values = {name: draw(sizes(1e-6, 1e6)) for name in ("m1", "m2", "k1", "k2", "box_frequency")}
    values |= {name: draw(st.just(0.0) | sizes(1e-6, 1e6)) for name in ("d1", "d2")}
    values |= {
        name: draw(st.just(0.0) | sizes(1e-9, 1e9))
        for name in ("box_amplitude", "box_jerk", "x2_start")
    }
    values |= {
        "e": draw(st.floats(0.0, 1.0)),
        "gamma": draw(sizes(1e-9, 1.0)),
        "v1_start": draw(st.floats(-1e6, 1e6)),
        "e_slope": draw(st.just(0.0) | sizes(1e-100, 1e100)),
    }
    m = unstarted(**values)
    assume(stepper.initialize(m, 0.0) == at.OK)
    for step in (1e-6, 1.0, 1e4):
        code = stepper.advance(m, m[at.TIME] + step)
        assert code in (at.OK, at.UNFINISHED, at.NOT_FINITE)
        if code != at.OK:
            return
        assert all(math.isfinite(value) for value in m[at.X1 : at.TIME + 1])
        assert m[at.X_REL] >= 0.0
