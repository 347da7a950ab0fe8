"""The box's motion: both ways, units, refusals."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from orchestrate.errors import InputError
from orchestrate.model import Excitation, Structure

from .strategies import EXCITATIONS, STRUCTURES

ETA = st.floats(1e-3, 1e3)


@given(ETA, STRUCTURES)
def test_with_eta_lengths_are_metres(eta, structure):
    excitation = Excitation.nondimensional(eta, structure)
    assert excitation.length(structure) == 1.0
    assert math.isclose(excitation.eta(structure), eta, rel_tol=1e-15)


@given(EXCITATIONS, STRUCTURES)
def test_length_is_a_eta_squared(excitation, structure):
    expected = excitation.amplitude * (excitation.frequency / structure.omega) ** 2
    assert math.isclose(excitation.length(structure), expected, rel_tol=1e-14)


@given(EXCITATIONS)
def test_repr_can_be_evaluated(excitation):
    assert eval(repr(excitation)) == excitation


@pytest.mark.parametrize("natural", [1.0, math.sqrt(1.2), math.sqrt(1.1)])
@pytest.mark.parametrize("detuning", [0.0, 0.9e-6, 1.1e-6])
@pytest.mark.parametrize("damping", [0.0, 0.9e-6, 1.1e-6])
def test_no_periodic_response_is_looked_for_at_a_resonance_without_damping(
    natural, detuning, damping
):
    structure = Structure.nondimensional(D=damping * natural)
    excitation = Excitation(frequency=natural * (1.0 + detuning), amplitude=0.5)
    if math.hypot(detuning, damping) < 1e-6:
        with pytest.raises(InputError, match=f"frequency = {excitation.frequency!r} rad/s"):
            excitation.check(structure)
    else:
        excitation.check(structure)
    excitation.replace(amplitude=0.0).check(structure)
