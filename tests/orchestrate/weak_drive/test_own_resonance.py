"""Where the delaminated structure resonates, and that `couple` looks there."""

import numpy as np
import pytest
from scipy.linalg import expm

from orchestrate import Structure
from orchestrate.weak_drive import averaged, own_resonance

from .coupled import BEAM, QUICK, system_of
from .test_couple import run

APART = system_of(
    *(0.542255, 1.685337, 0.006784, 0.011107, 0.819721),
    **{"beta": 0.059791, "epsilon": 0.001979, "b": 0.065491, "Omega_b": 0.224885, "D_b": 0.009442},
)
OWN_LOSSES = (1.4370, 1.4460)  # over K omega: where held voltages lose its motion, down and up


def closure(system, Omega):
    """How far the elastic system is from closing a revolution with one impact and no gap there."""
    structure, drive = system
    beta, mu, kappa = drive.beta(structure), structure.mu, structure.kappa
    masses = np.array([beta, beta * mu, 1.0])
    first, second, box = beta, beta * kappa, drive.Omega_b(structure) ** 2
    springs = np.array(
        [[first, 0.0, -first], [0.0, second, -second], [-first, -second, first + second + box]]
    )
    rates = np.block(
        [[np.zeros((3, 3)), np.eye(3)], [-springs / masses[:, None], np.zeros((3, 3))]]
    )
    impact = np.eye(6)
    pair, share = np.array([-1.0, 1.0]), np.array([1.0 / masses[0], 1.0 / masses[1]])
    impact[3:5, 3:5] -= 2.0 * np.outer(share * pair, pair) / share.sum()
    gap = np.array([[-1.0, 1.0, 0.0, 0.0, 0.0, 0.0]])
    once = impact @ expm(rates * 2.0 * np.pi / Omega) - np.eye(6)
    return np.linalg.svd(np.vstack([once, gap]), compute_uv=False)[-1]


@pytest.mark.parametrize("system", [QUICK, BEAM, APART])
def test_the_elastic_mode_repeats_after_a_revolution(system):
    Omega = own_resonance.elastic_resonance(*system)
    assert closure(system, Omega) < 1e-10
    assert closure(system, Omega + 0.01) > 1e-4


def test_it_is_mostly_that_of_the_bonded_structure():
    """And the speed that divides motions is then that of the averaged theory, to the bit."""
    for system in (QUICK, BEAM):
        assert 0.0 < abs(own_resonance.resonance_shift(*system)) < 1e-3
        assert own_resonance.dividing_speed(*system) == averaged.dividing_speed(*system)
        assert own_resonance.resonance(*system) == averaged.resonance(*system)


def test_where_it_lies_apart_it_divides_the_motions():
    """Beyond both bonded folds."""
    folds = averaged.folds(*APART)
    assert own_resonance.elastic_resonance(*APART) > folds[-1].Omega
    moved = own_resonance.dividing_speed(*APART) - averaged.dividing_speed(*APART)
    assert moved == own_resonance.resonance_shift(*APART) > 0.04
    bonded = APART.as_bonded()
    assert own_resonance.dividing_speed(*bonded) == averaged.dividing_speed(*bonded)


def test_halves_that_swing_alike_never_part():
    alike = Structure.nondimensional(mu=1.3, kappa=1.3)
    assert own_resonance.resonance_shift(alike, QUICK.drive) == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("rate", [2e-4, 5e-5])
def test_jumps_beyond_the_bonded_resonance_both_ways(rate):
    """There is no false none: lost where held voltages lose its motion, or undecided."""
    found = run(APART, (1.3, 1.6), rate, step=None)
    for way in ("up", "down"):
        at = found.sel(jump=way)
        place = float(at.jumps) / APART.drive.volts(APART.structure)
        assert at.decided == "undecided" or OWN_LOSSES[0] < place < OWN_LOSSES[1]
