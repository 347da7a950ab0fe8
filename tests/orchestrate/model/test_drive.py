"""Motor and box: both ways, the units they give, refusals."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from orchestrate.errors import InputError
from orchestrate.model import Drive
from orchestrate.model.ranges import DRIVE

from .strategies import DRIVES, SMALL, STRUCTURES

GIVEN = st.fixed_dictionaries(
    {"beta": SMALL, "epsilon": SMALL, "b": SMALL, "Omega_b": SMALL, "D_b": SMALL}
)


def numbers_of(drive, structure):
    by_structure = {
        name: getattr(drive, name)(structure) for name in ("beta", "b", "Omega_b", "D_b")
    }
    return {"epsilon": drive.epsilon, **by_structure}


@given(GIVEN, STRUCTURES, SMALL)
def test_numbers_to_si_and_back(numbers, structure, length):
    drive = Drive.nondimensional(**numbers, structure=structure, length=length)
    found = numbers_of(drive, structure)
    for name, value in numbers.items():
        assert math.isclose(found[name], value, rel_tol=1e-12), name
    assert math.isclose(drive.length, length, rel_tol=1e-12)


@given(DRIVES)
def test_repr_can_be_evaluated(drive):
    assert eval(repr(drive)) == drive
    assert drive.parameters() == {name: getattr(drive, name) for name in DRIVE}


@pytest.mark.parametrize("name", DRIVE)
def test_ranges_are_the_fmu_s(name):
    drive, quantity = Drive.from_file("beam"), DRIVE[name]
    assert getattr(drive.replace(**{name: quantity.maximum}), name) == quantity.maximum
    for value in (-1.0, 2.0 * quantity.maximum, math.nan, "1"):
        with pytest.raises(InputError, match=f"^{name} = .*: expected .*{name}"):
            drive.replace(**{name: value})


SHEET = {"rated_voltage": 24.0, "no_load_speed": 300.0, "stall_torque": 0.4}
REST = {
    **{"unbalance_mass": 0.05, "unbalance_radius": 0.01},
    **{"box_mass": 5.0, "box_stiffness": 300.0, "box_damping": 4.0},
}


def test_a_datasheet():
    """The torque line goes through both points, and the rotor starts with its time constant."""
    drive = Drive.from_datasheet(**SHEET, **REST, mechanical_time_constant=0.02)
    constant, resistance = drive.motor_constant, drive.armature_resistance

    def torque(speed):
        return constant * (24.0 - constant * speed) / resistance

    assert torque(300.0) == pytest.approx(0.0, abs=1e-12)
    assert torque(0.0) == pytest.approx(0.4)
    rotor = drive.rotor_inertia - 0.05 * 0.01**2
    assert rotor * resistance / constant**2 == pytest.approx(0.02)
    by_inertia = Drive.from_datasheet(**SHEET, **REST, rotor_inertia=rotor)
    assert by_inertia.rotor_inertia == pytest.approx(drive.rotor_inertia)
