"""Motor and box: both ways, the units they give, refusals."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from orchestrate.errors import InputError
from orchestrate.model import Drive
from orchestrate.model.ranges import DRIVE

from .strategies import SMALL, STRUCTURES

GIVEN = st.fixed_dictionaries(dict.fromkeys(("beta", "epsilon", "b", "Omega_b", "D_b"), SMALL))


def numbers_of(drive, structure):
    names = ("beta", "b", "Omega_b", "D_b")
    return {"epsilon": drive.epsilon, **{n: getattr(drive, n)(structure) for n in names}}


@given(GIVEN, STRUCTURES, SMALL)
def test_numbers_to_si_and_back(numbers, structure, length):
    drive = Drive.nondimensional(**numbers, structure=structure, length=length)
    found = numbers_of(drive, structure)
    for name, value in numbers.items():
        assert math.isclose(found[name], value, rel_tol=1e-12), name
    assert math.isclose(drive.length, length, rel_tol=1e-12)


@pytest.mark.parametrize("name", DRIVE)
def test_ranges_are_the_fmu_s(name):
    drive, quantity = Drive.from_file("beam"), DRIVE[name]
    assert getattr(drive.replace(**{name: quantity.maximum}), name) == quantity.maximum
    for value in (-1.0, 2.0 * quantity.maximum, math.nan, "1"):
        with pytest.raises(InputError, match=f"^{name} = .*: expected .*{name}"):
            drive.replace(**{name: value})
