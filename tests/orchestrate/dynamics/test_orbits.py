"""Periodic orbits against closed forms, against the FMU's own map, and where they must say no."""

import functools

import numpy as np
import pytest

from orchestrate.dynamics.orbits import orbit
from orchestrate.errors import InputError
from orchestrate.flags import flag_words
from orchestrate.model import Structure
from orchestrate.response.sweep import sweep

from .single_impact import SingleImpact

PAPER = Structure.nondimensional(e=0.7, D=0.005)
UNDECIDED = "undecided"
CONTACT = 0.4  # eta at which chattering ends in permanent contact


@functools.cache
def known(eta, period=1, structure=PAPER):
    return orbit(structure, eta=eta, period=period)


def multipliers(found):
    return found.multipliers.values @ np.array([1.0, 1.0j])


@pytest.mark.parametrize(("period", "eta"), [(1, 1.5), (1, 3.0), (2, 4.0), (3, 5.6), (4, 8.0)])
def test_one_impact_in_n_periods_is_that_of_the_closed_form(period, eta):
    found, truth = known(eta, period), SingleImpact(eta, period)
    assert found.node_kind.values.tolist() == [0]
    assert found.node_closing.item() == pytest.approx(truth.closing, abs=1e-11)
    assert np.cos(found.node_phase.item() - truth.phase) == pytest.approx(1.0, abs=1e-14)
    assert np.abs(multipliers(found) - truth.multipliers).max() < 1e-9
    assert bool(found.stable) == (truth.largest < 1.0)
    assert found.fmu_same_impacts
    assert found.fmu_return < 1e-13 * max(1.0, truth.largest)


def test_chattering_into_permanent_contact_leaves_two_multipliers():
    found = known(CONTACT)
    kinds = found.node_kind.values.tolist()
    assert kinds.count(1) == kinds.count(2) == 1
    assert kinds.count(0) > 20
    assert found.permanent_contact
    assert found.fmu_same_impacts
    assert found.fmu_return < 1e-13
    assert np.abs(multipliers(found)[2:]).max() == 0.0
    assert np.abs(multipliers(found)[:2]).min() > 0.5
    assert found.multiplier_product.item() == 0.0


@pytest.mark.parametrize("form", ["state", "times", "other times", "orbit"])
def test_guesses_in_all_forms(form):
    near = known(3.02)
    guesses = {
        "state": known(3.0).state.values[0] + 1e-4,
        "times": {"impact_time": near.impact_time.values},
        "other times": {"impact_time": (near.impact_time.values + 1.0) % (2.0 * np.pi / 3.0)},
        "orbit": near,
    }
    found = orbit(PAPER, eta=3.0, guess=guesses[form])
    assert np.abs(found.state.values - known(3.0).state.values).max() < 1e-12


def test_the_physical_form_is_the_same_orbit_in_metres():
    beam = Structure.nondimensional(omega=75.0, m1=1.5)
    found = orbit(beam, frequency=4.0 * 75.0, amplitude=0.002, period=2)
    plain = known(4.0, 2)
    length = 0.002 * 16.0
    assert found.xi.values == pytest.approx(plain.xi.values, abs=1e-12)
    assert found.impact_velocity.item() == pytest.approx(plain.node_closing.item() * length * 75.0)
    assert found.impact_time.item() == pytest.approx(plain.impact_time.item() / 75.0)
    assert found.fmu_return < 1e-13
    assert found.exponent.item() == pytest.approx(plain.exponent.item(), rel=1e-9)


def test_no_orbit_is_said():
    """4T/1 does not exist at 7.4: its flight would go through mass 1."""
    with pytest.raises(InputError, match="period = 4: no orbit found"):
        orbit(PAPER, eta=7.4, period=4, guess={"impact_time": [0.4]})


def test_an_impact_at_phase_0_makes_no_longer_period():
    """There its phase is 0 or a whole turn by rounding: a T orbit is no 2T orbit."""
    structure, eta = Structure.nondimensional(e=0.5), 2.093969319892331
    single = orbit(structure, eta=eta)
    assert abs(np.sin(eta * single.impact_time.values)).max() < 1e-9
    with pytest.raises(InputError, match="repeats after 1 already"):
        orbit(structure, eta=eta, period=2)


def test_a_stable_root_whose_impacts_are_not_those_of_the_fmu_is_undecided():
    """With a larger gamma the FMU ends the chattering earlier than the orbit it is begun with."""
    structure = PAPER.replace(e=0.3)
    own = orbit(structure, eta=0.7)
    assert bool(own.stable) and int(own.stability) == 1
    other = orbit(structure.replace(gamma=0.05), eta=0.7, guess=own)
    assert np.abs(multipliers(other)).max() < 0.95 and not other.fmu_same_impacts
    assert not other.stable and flag_words(other.stability.attrs)[int(other.stability)] == UNDECIDED
    unstable = known(3.0)
    assert not unstable.stable and int(unstable.stability) == 0


@pytest.mark.parametrize(("eta", "period"), [(1.5, 1), (4.0, 2), (0.4, 1), (1.0, 1)])
def test_amplitudes_are_those_of_the_settled_response(eta, period):
    structure = Structure.nondimensional()
    found = orbit(structure, eta=eta, period=period)
    seen = sweep(structure, eta=[eta], transient=4000, samples=8)
    assert found.xi_rel_max.item() == pytest.approx(seen.xi_rel_max.item(), rel=1e-9)
    for name in ("xi1_max", "xi2_max"):
        assert found[name].item() == pytest.approx(seen[name].item(), rel=1e-5)
