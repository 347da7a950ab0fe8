"""Sections of a motion: against its histories, its impacts, and the contact force."""

import math

import numpy as np
import pytest

import orchestrate
from orchestrate import Structure

PAPER = Structure.nondimensional()
BEAM = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=0.9, e=0.6)
QUIET = {"progress": False}


@pytest.mark.parametrize("phase", [0.0, 2.0, -1.0])
def test_at_a_phase_it_has_the_states_of_the_histories(exported, phase):
    """200 points a period: those nearest to the phase, from the same start."""
    box = {"frequency": 1.05 * BEAM.omega, "amplitude": 1e-3}
    section = orchestrate.poincare(BEAM, **box, phase=phase, transient=0, periods=4, **QUIET)
    share = (phase / math.tau) % 1.0
    motion = orchestrate.simulate(BEAM, **box, periods=4, points=4000, **QUIET)
    rows = (np.arange(4) + share) * 4000
    for name in ("x1", "x2", "v1", "v2", "x_rel"):
        expected = np.interp(rows, np.arange(len(motion.time)), motion[name].values)
        scale = float(abs(motion[name]).max())
        np.testing.assert_allclose(section[name].values, expected, atol=2e-3 * scale)
    np.testing.assert_allclose(section.phase, phase % math.tau)
    period = 2.0 * math.pi / box["frequency"]
    np.testing.assert_allclose(section.time, (np.arange(4) + share) * period)


def test_at_impacts_it_has_the_impacts(exported):
    section = orchestrate.poincare(PAPER, eta=0.8, at="impacts", transient=0, periods=20, **QUIET)
    motion = orchestrate.simulate(PAPER, eta=0.8, periods=20, **QUIET)
    np.testing.assert_array_equal(section.time.values, motion.impact_time.values)
    np.testing.assert_array_equal(section.impact_velocity.values, motion.impact_velocity.values)
    away = PAPER.e * section.impact_velocity.values
    flies = section.sticks.values == 0
    np.testing.assert_allclose(section.v_rel.values[flies], away[flies], rtol=1e-9)
    assert (section.v_rel.values[~flies] == 0.0).all() and (section.x_rel.values == 0.0).all()


def test_at_releases_the_masses_part(exported):
    """Gap and gap rate are zero, and by (19) the force of (18) is, too: masses accelerate alike."""
    section = orchestrate.poincare(PAPER, eta=0.4, at="releases", transient=50, periods=5, **QUIET)
    assert section.sizes["point"] == 5
    pull = [
        (getattr(PAPER, f"k{i}") * section[f"x{i}"] + getattr(PAPER, f"d{i}") * section[f"v{i}"])
        / getattr(PAPER, f"m{i}")
        for i in (1, 2)
    ]
    np.testing.assert_allclose(pull[0], pull[1], atol=1e-12 * float(abs(pull[0]).max()))
    assert float(abs(section.v_rel).max()) < 1e-12 * float(abs(section.v1).max())
