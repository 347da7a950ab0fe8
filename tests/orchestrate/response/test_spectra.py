"""Spectra hold the impulses: against the sum over the impacts that the FMU reports."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from orchestrate.model import Structure
from orchestrate.response.simulate import simulate
from orchestrate.response.spectra import spectra

PAPER = Structure.nondimensional()
OWN = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=1.9, e=0.6)
LINES = np.arange(1, 31)


def fourier(structure, eta, mass, impulses):
    motion = simulate(structure, eta=eta, transient=1200, periods=1, points=8_000)
    time, acceleration = motion.time.values, motion[f"a{mass}_abs"].values
    speed = eta * structure.omega
    turns = np.exp(-1j * speed * np.outer(LINES, time))
    found = trapezoid(acceleration * turns, time, axis=1)
    if impulses:
        jumps = motion.impulse.values * {1: -1.0, 2: 1.0}[mass] / getattr(structure, f"m{mass}")
        found += np.exp(-1j * speed * np.outer(LINES, motion.impact_time.values)) @ jumps
    return 2.0 * np.abs(found) * speed / (2.0 * np.pi)


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize(("structure", "eta"), [(PAPER, 0.4), (OWN, 1.6)])
def test_lines_of_a_periodic_response(structure, eta):
    found = spectra(structure, eta=eta, transient=1200, periods=8).isel(eta=0)
    at_lines = found.acceleration.sel(order=LINES.astype(float))
    for mass in (1, 2):
        whole = fourier(structure, eta, mass, True)
        between = fourier(structure, eta, mass, False)
        of_mass = at_lines.sel(mass=mass)
        np.testing.assert_allclose(of_mass.sel(kind="delaminated"), whole, rtol=0.01)
        top = between.max()
        np.testing.assert_allclose(of_mass.sel(kind="sampled"), between, atol=1e-3 * top)
    np.testing.assert_allclose(found.line, found.order * eta * structure.omega)


@pytest.mark.usefixtures("exported")
def test_a_bonded_structure_has_one_line():
    structure = Structure.nondimensional(D=0.05)
    found = spectra(structure, eta=[0.5, 1.1], transient=300, periods=8, points=64, highest=20.0)
    for eta in found.eta.values:
        part = found.acceleration.sel(eta=eta, kind="bonded", mass=2)
        reach = complex(structure.omega_3**2 - eta**2, 2.0 * structure.D3 * eta)
        assert float(part.sel(order=1.0)) == pytest.approx(abs(1.0 + eta**2 / reach), rel=1e-6)
        assert float(part.sel(order=slice(1.5, None)).max()) < 1e-6


@pytest.mark.usefixtures("exported")
def test_lines_at_and_beside_zero_of_a_motion_with_impacts():
    """Forces and impulses have the mean 0; what is sampled lacks the impulses'."""
    found = spectra(PAPER, eta=1.047, transient=1200, periods=16).acceleration.isel(eta=0)
    motion = simulate(PAPER, eta=1.047, transient=1200, periods=1)
    period = 2.0 * np.pi / (1.047 * PAPER.omega)
    low = found.sel(order=slice(None, 0.8))
    for mass in (1, 2):
        free, felt = (low.sel(mass=mass, kind=kind) for kind in ("delaminated", "sampled"))
        assert float(free.max()) < 1e-6 * float(found.sel(mass=mass, kind="delaminated").max())
        mean = float(motion.impulse.sum()) / getattr(PAPER, f"m{mass}") / period
        assert float(felt[0]) == pytest.approx(mean, rel=1e-2)
        assert float(felt[1:].max()) < 1e-3 * mean
