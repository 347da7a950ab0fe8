"""The shaker's kernel against scipy: motion, energies, sub-steps, and steps that cannot be done."""

from unittest.mock import patch

import pytest

from fmu_src.kernels.motor_shaker import integrate, stepper
from fmu_src.kernels.motor_shaker import memory as at

from .truth import DEFAULTS, STATES, solve

MOVING = {"angle_start": 0.3, "speed_start": 40.0, "position_start": 1e-3, "velocity_start": -0.05}
FORCED = {
    "voltage": 5.0,
    "box_force": 3.0,
    "box_force_1": -40.0,
    "box_force_2": 900.0,
    "box_force_3": -3e4,
}


def started(**values):
    """A memory after a successful ``initialize``."""
    m = [0.0] * at.SIZE
    for name, value in {**DEFAULTS, **values}.items():
        m[getattr(at, name.upper())] = float(value)
    assert stepper.initialize(m, 0.0) == at.OK
    return m


def state(m):
    """Position, velocity, angle, speed, current."""
    return [m[getattr(at, name.upper())] for name in STATES]


@pytest.mark.parametrize("inductance", [0.0, 0.05])
@pytest.mark.parametrize("stop", [0.01, 0.3])
def test_motion_is_that_of_the_equations(inductance, stop):
    values = {**FORCED, "armature_inductance": inductance}
    m = started(**values, **MOVING)
    first = state(m)
    assert stepper.advance(m, stop) == at.OK
    expected = solve(values, first, stop)
    if not inductance:
        expected[4] = (values["voltage"] - 0.06 * expected[3]) / 12.0
    assert state(m) == pytest.approx(list(expected[:5]), rel=2e-11, abs=1e-13)
    assert m[at.MOTOR_ENERGY] == pytest.approx(expected[5], rel=1e-11)


def test_tolerance_bounds_the_error():
    """The formula's own error falls with its tolerance, and stays near it over many sub-steps."""
    values, errors = {"voltage": 9.0, **MOVING}, []
    expected = solve({"voltage": 9.0}, (1e-3, -0.05, 0.3, 40.0, 0.0), 1.0)
    for tolerance in (1e-6, 1e-9, 1e-12):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(integrate, "TOLERANCE", tolerance)
            patch.setattr(integrate, "RADIANS", 1e9)
            m = started(**values)
            assert stepper.advance(m, 1.0) == at.OK
        errors.append(abs(m[at.ANGLE] - expected[2]))
    assert errors[0] > 10 * errors[1] > 100 * errors[2]
    assert errors[2] < 1e-10


def test_energy_is_kept():
    m = started(**FORCED, **MOVING)
    before = m[at.STORED_ENERGY]
    for k in range(1, 200):
        assert stepper.advance(m, k * 0.013) == at.OK
        balance = (
            m[at.MOTOR_ENERGY]
            + m[at.BOX_FORCE_WORK]
            - m[at.BOX_DAMPER_ENERGY]
            - (m[at.STORED_ENERGY] - before)
        )
        assert abs(balance) < 1e-12 * (1.0 + abs(m[at.BOX_FORCE_WORK]))


@pytest.mark.parametrize(
    "values",
    [
        {"armature_inductance": 1e-9},
        {"armature_inductance": 1e-30, "armature_resistance": 1e30},
        {"rotor_inertia": 1e-15, "unbalance_mass": 0.0},
        {"box_damping": 1e12},
    ],
)
def test_a_time_constant_far_below_the_step_is_known_at_once(values):
    m = started(voltage=5.0, **values)
    with patch.object(stepper, "integrate_step") as through:
        assert stepper.advance(m, 1.0) == at.UNFINISHED
    through.assert_not_called()
    assert m[at.WORK] > m[at.WORK_LIMIT]


@pytest.mark.parametrize("values", [{"armature_inductance": 3e-4}, {"box_damping": 1e5}])
def test_a_short_time_constant_that_can_be_followed_is(values):
    m = started(voltage=5.0, **values)
    assert stepper.advance(m, 0.1) == at.OK
    decay = stepper.fastest_decay(m)
    assert m[at.WORK] >= at.STAGES / stepper.STABLE * decay * 0.1  # what is counted on beforehand


@pytest.mark.parametrize(
    "values", [{"box_force": 1e30, "box_force_3": 1e30}, {"voltage": 1e30, "motor_constant": 1e30}]
)
def test_what_leaves_the_numbers_ends(values):
    m = started(**values)
    assert stepper.advance(m, 1e90) in (at.NOT_FINITE, at.UNFINISHED)
