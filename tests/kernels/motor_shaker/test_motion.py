"""The motor's kernel: its formula's error, energies, and the force on the box as a cubic that runs
on until one of its inputs is set again.
"""

import pytest

from fmu_src.kernels.motor_shaker import integrate, rates, stepper
from fmu_src.kernels.motor_shaker import memory as at

from .truth import DEFAULTS, STATES, solve

MOVING = {"angle_start": 0.3, "speed_start": 40.0, "position_start": 1e-3, "velocity_start": -0.05}
FORCE = {"box_force": 3.0, "box_force_1": -40.0, "box_force_2": 900.0, "box_force_3": -3e4}
FORCED = {"voltage": 5.0, **FORCE, **MOVING}


def advanced(values, *times):
    """A memory of some values, initialised and advanced through communication points."""
    m = [0.0] * at.SIZE
    for name, value in {**DEFAULTS, **values}.items():
        m[getattr(at, name.upper())] = float(value)
    assert stepper.initialize(m, 0.0) == at.OK
    assert all(stepper.advance(m, time) == at.OK for time in times)
    return m


def state(m):
    """Position, velocity, angle, speed, current."""
    return [m[getattr(at, name.upper())] for name in STATES]


def set_force(m, *values):
    """Set inputs of the force, as the exporters do."""
    m[at.BOX_FORCE : at.BOX_FORCE + len(values)] = values
    m[at.FORCE_SET] = 1.0


def test_tolerance_bounds_the_error(monkeypatch):
    """The formula's own error falls with its tolerance, and stays near it over many sub-steps."""
    values, errors = {"voltage": 9.0, **MOVING}, []
    expected = solve({"voltage": 9.0}, (1e-3, -0.05, 0.3, 40.0, 0.0), 1.0)
    monkeypatch.setattr(integrate, "RADIANS", 1e9)
    for tolerance in (1e-6, 1e-9, 1e-12):
        monkeypatch.setattr(integrate, "TOLERANCE", tolerance)
        errors.append(abs(advanced(values, 1.0)[at.ANGLE] - expected[2]))
    assert errors[0] > 10 * errors[1] > 100 * errors[2]
    assert errors[2] < 1e-10


@pytest.mark.parametrize("inductance", [0.0, 0.05])
def test_energy_is_kept_and_the_force_runs_on_over_steps(inductance):
    """Sub-steps begin anew at each point: the same within their tolerance, not to the last bit."""
    values = {**FORCED, "armature_inductance": inductance}
    m, whole = advanced(values), advanced(values, 0.013 * 199)
    before = m[at.STORED_ENERGY]
    for k in range(1, 200):
        assert stepper.advance(m, k * 0.013) == at.OK
        balance = m[at.MOTOR_ENERGY] + m[at.BOX_FORCE_WORK] - m[at.STORED_ENERGY] + before
        loss = m[at.BOX_DAMPER_ENERGY]
        if not inductance:  # what it stores is no output
            assert abs(balance - loss) < 1e-12 * (1.0 + abs(m[at.BOX_FORCE_WORK]))
    assert state(m) == pytest.approx(state(whole), rel=1e-9)
    assert m[at.BOX_FORCE_WORK] == pytest.approx(whole[at.BOX_FORCE_WORK], rel=1e-9)


def test_the_acceleration_belongs_to_the_force_that_has_run_on():
    """Acceleration, jerk and their rates at a step's end are those of a force set to that value."""
    m, t = advanced(FORCED, 0.05), 0.05
    f0, f1, f2, f3 = FORCE.values()
    again = list(m)
    now = (f0 + t * (f1 + t * (f2 / 2 + t * f3 / 6)), f1 + t * (f2 + t * f3 / 2), f2 + t * f3)
    set_force(again, *now, f3)
    assert stepper.refresh(again, t) == at.OK
    for one in (m, again):
        rates.differentiate(one, t)
    slots = (at.BOX_ACCELERATION, at.BOX_JERK, *range(at.OUTPUT_RATES, at.SIZE))
    assert [m[i] for i in slots] == pytest.approx([again[i] for i in slots], rel=1e-12)
    assert m[at.BOX_FORCE] == f0  # read as it was set


def test_the_force_begins_where_it_is_set_to_the_value_it_has():
    m, other, untouched = (advanced(FORCED, 0.05) for _ in range(3))
    set_force(m, FORCE["box_force"])
    set_force(other, *FORCE.values())
    assert all(stepper.advance(one, 0.1) == at.OK for one in (m, other, untouched))
    assert state(m) == state(other) != state(untouched)
