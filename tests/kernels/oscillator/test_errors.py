"""What cannot be computed is said with a code, within bounded work: never a hang, an exception or a
number that is not one.
"""

import pytest

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import nodes, stepper

from .kernel import unstarted


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
