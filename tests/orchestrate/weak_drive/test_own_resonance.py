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


def closure(system, Omega):
    """How far the elastic system is from closing a revolution with one impact and no gap there."""
    structure, drive = system
    beta, mu, kappa = drive.beta(structure), structure.mu, structure.kappa
    masses, first, second = np.array([beta, beta * mu, 1.0]), beta, beta * kappa
    last = first + second + drive.Omega_b(structure) ** 2
    springs = np.array([[first, 0.0, -first], [0.0, second, -second], [-first, -second, last]])
    none, rates = np.zeros((3, 3)), -springs / masses[:, None]
    impact = np.eye(6)
    pair, share = np.array([-1.0, 1.0]), 1.0 / masses[:2]
    impact[3:5, 3:5] -= 2.0 * np.outer(share * pair, pair) / share.sum()
    flight = expm(np.block([[none, np.eye(3)], [rates, none]]) * 2.0 * np.pi / Omega)
    gap = np.array([[-1.0, 1.0, 0.0, 0.0, 0.0, 0.0]])
    return np.linalg.svd(np.vstack([impact @ flight - np.eye(6), gap]), compute_uv=False)[-1]


@pytest.mark.parametrize("system", [QUICK, BEAM, APART])
def test_the_elastic_mode_repeats_after_a_revolution(system):
    """Where it lies apart from the bonded structure's it divides the motions, elsewhere not."""
    Omega = own_resonance.elastic_resonance(*system)
    assert closure(system, Omega) < 1e-10 and closure(system, Omega + 0.01) > 1e-4
    shift = own_resonance.resonance_shift(*system)
    moved = own_resonance.dividing_speed(*system) - averaged.bonded_dividing_speed(*system)
    if system is APART:
        assert Omega > averaged.folds(*APART)[-1].Omega and moved == shift > 0.04
    else:
        assert 0.0 < abs(shift) < 1e-3 and moved == 0.0
    bonded = system.as_bonded()
    assert own_resonance.dividing_speed(*bonded) == averaged.bonded_dividing_speed(*bonded)
    alike = Structure.nondimensional(mu=1.3, kappa=1.3)  # halves that swing alike never part
    assert own_resonance.resonance_shift(alike, QUICK.drive) == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("rate", [2e-4, 5e-5])
def test_jumps_beyond_the_bonded_resonance_both_ways(rate):
    """There is no false none: lost where held voltages lose its motion, or undecided."""
    found = run(APART, (1.3, 1.6), rate, step=None)
    for way in ("up", "down"):
        at = found.sel(jump=way)
        place = float(at.jumps) / APART.drive.volts(APART.structure)
        assert at.decided == "undecided" or 1.4370 < place < 1.4460
