"""Motor and box: both ways, the units they give."""

import math

from hypothesis import given
from hypothesis import strategies as st

from orchestrate.model import Drive

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
