"""The force on the box as a cubic that runs on until one of its inputs is set again."""

import pytest

from fmu_src.kernels.motor_shaker import memory as at
from fmu_src.kernels.motor_shaker import rates, stepper

from .test_integration import FORCED, MOVING, started, state

FORCE = ("box_force", "box_force_1", "box_force_2", "box_force_3")
# of the force over 0.25 s, and of what the sub-steps' tolerance leaves of it
INSTANTS = (0.0171, 0.05, 0.0833, 0.25)


def advanced(m, *times):
    """The memory, advanced through communication points."""
    for time in times:
        assert stepper.advance(m, time) == at.OK
    return m


def set_force(m, *values):
    """Set inputs of the force, as the exporters do."""
    for name, value in zip(FORCE, values, strict=False):
        m[getattr(at, name.upper())] = value
    m[at.FORCE_SET] = 1.0


@pytest.mark.parametrize("inductance", [0.0, 0.05])
def test_the_force_runs_on_over_steps(inductance):
    """Sub-steps begin anew at each point: the same within their tolerance, not to the last bit."""
    values = {**FORCED, "armature_inductance": inductance, **MOVING}
    whole, parts = advanced(started(**values), 0.25), advanced(started(**values), *INSTANTS)
    assert state(parts) == pytest.approx(state(whole), rel=1e-10)
    assert parts[at.BOX_FORCE_WORK] == pytest.approx(whole[at.BOX_FORCE_WORK], rel=1e-10)


def test_the_acceleration_belongs_to_the_force_that_has_run_on():
    """Acceleration, jerk and their rates at a step's end are those of a force set to that value."""
    m = advanced(started(**FORCED, **MOVING), 0.05)
    again = list(m)
    t = 0.05
    f0, f1, f2, f3 = (FORCED[name] for name in FORCE)
    now = (f0 + t * (f1 + t * (f2 / 2 + t * f3 / 6)), f1 + t * (f2 + t * f3 / 2), f2 + t * f3)
    set_force(again, *now, f3)
    assert stepper.refresh(again, t) == at.OK
    for one in (m, again):
        rates.differentiate(one, t)
    slots = (at.BOX_ACCELERATION, at.BOX_JERK, *range(at.OUTPUT_RATES, at.SIZE))
    assert [m[i] for i in slots] == pytest.approx([again[i] for i in slots], rel=1e-12)
    assert m[at.BOX_FORCE] == f0  # read as it was set


def test_the_force_begins_where_it_is_set_to_the_value_it_has():
    """As where it is told in pieces: the second begins at 0.05 s."""
    m, other = (advanced(started(**FORCED, **MOVING), 0.05) for _ in range(2))
    set_force(m, FORCED["box_force"])
    set_force(other, *(FORCED[name] for name in FORCE))
    assert state(advanced(m, 0.1)) == state(advanced(other, 0.1))
    untouched = advanced(started(**FORCED, **MOVING), 0.05, 0.1)
    assert state(m) != state(untouched)
