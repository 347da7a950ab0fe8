"""Basins: what the coordinates of a plane mean, and that each start leads where it says."""

import math

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate.dynamics.attractors import attractors
from orchestrate.dynamics.basins import PlaneAxis, basin, starts_of_plane
from orchestrate.fmu import REST
from orchestrate.model import Excitation, Structure
from orchestrate.response.questions import Point

from .stroboscopic import after

PAPER = Structure.nondimensional()
ETA = 1.315
POINT = Point(PAPER, Excitation.nondimensional(ETA, PAPER))
AT = (-1.0, 2.0, 0.3, -0.1)
SIDES = {"x": ("x_rel", -0.4, 1.2, 5), "y": ("v_rel", -1.0, 1.0, 4)}


def starts(x, y, at=AT):
    states, phases = starts_of_plane(POINT, PlaneAxis(*x), PlaneAxis(*y), at)
    return states.reshape(y[3], x[3], 4), phases.reshape(y[3], x[3])


@pytest.fixture(scope="module")
def found(exported):
    return basin(PAPER, eta=ETA, **SIDES)


def test_what_the_coordinates_of_a_plane_mean():
    """Gap and gap rate keep the means of both masses, or what is given with them."""
    states, _ = starts(("x_rel", 0.0, 3.0, 4), ("v_rel", -2.0, 2.0, 3))
    np.testing.assert_allclose(states[..., :2].mean(axis=-1), 0.5)
    np.testing.assert_allclose(states[1, :, 1] - states[1, :, 0], [0.0, 1.0, 2.0, 3.0])
    np.testing.assert_allclose(states[:, 0, 3] - states[:, 0, 2], [-2.0, 0.0, 2.0])
    states, _ = starts(("x1", 0.0, 1.0, 3), ("x_rel", 0.0, 2.0, 2))
    np.testing.assert_array_equal(states[1, :, 1], [2.0, 2.5, 3.0])
    states, _ = starts(("v2", 0.0, 1.0, 2), ("v_rel", -1.0, 1.0, 2))
    np.testing.assert_array_equal(states[0, :, 2], [1.0, 2.0])


def test_starts_that_overlap_count_in_no_share(found):
    labels = found.attractor_of.values
    assert (labels[:, 0] == -1).all()
    assert (labels[:, 1:] >= 0).all()
    np.testing.assert_allclose(found.share, np.bincount(labels[labels >= 0]) / 16)
    assert float(found.share.sum()) == pytest.approx(1.0)


def test_responses_of_a_plane_at_another_phase_are_those_of_its_starts(instances):
    """Labels and states were those of another excitation at any phase but 0."""
    plane = {"x": ("x_rel", 0.0, 1.3, 4), "y": ("v_rel", -1.3, 1.3, 4)}
    found = basin(PAPER, eta=ETA, phase=1.0, **plane)
    excitation = Excitation.nondimensional(ETA, PAPER, phase=1.0)
    states, _ = starts(plane["x"], plane["y"], REST)
    labels = found.attractor_of.values
    for state, label in zip(states.reshape(-1, 4), labels.ravel(), strict=True):
        n = int(found.multiplicity[label])
        assert returns_after(instances[0], excitation, state, 3000) == n
    still = excitation.replace(phase=0.0)
    for state, n in zip(found.state.values, found.multiplicity.values, strict=True):
        assert returns_after(instances[0], still, state, 0) == n
    assert set(found.multiplicity.values) == {1.0, 2.0}


def returns_after(instance, excitation, state, transient):
    """After how many periods, 1 or 2, a motion is back where it is after a transient; else 0."""
    point = Point(PAPER, excitation)
    first = after(instance, point, state, transient) if transient else state
    apart = [np.abs(after(instance, point, first, n) - first).max() for n in (1, 2)]
    return next((n for n, most in enumerate(apart, 1) if most < 1e-6), 0)


@pytest.mark.usefixtures("exported")
def test_the_default_plane_holds_the_attractors_and_shows_both_basins(monkeypatch):
    monkeypatch.setattr("orchestrate.dynamics.basins.COUNT", 12)
    structure = Structure(m1=1.5, m2=1.5, k1=8437.5, k2=10125.0).replace(D=0.005)
    asked = {"frequency": 1.315 * structure.omega, "amplitude": 1e-4}
    found = basin(structure, **asked)
    assert found.attractor_of.dims == ("v_rel", "x_rel")
    assert found.multiplicity.values.tolist() == [1.0, 2.0]
    from_random = attractors(structure, **asked, starts=12, seed=3).isel(frequency=0)
    for name in ("attractor", "multiplicity", "impacts_per_period", "xi_rel_max", "state"):
        np.testing.assert_allclose(found[name], from_random[name], rtol=1e-8)
    assert (found.share > 0.05).all()  # not one flat colour
    gap, rate = found.state[:, 1] - found.state[:, 0], found.state[:, 3] - found.state[:, 2]
    assert (gap < found.x_rel.max()).all() and (abs(rate) < found.v_rel.max()).all()
    scale = 1e-4 * 1.315**2
    assert 0.5 < float(found.x_rel.max()) / scale < 2.0  # of the size of the motion


X, Y = np.meshgrid(np.linspace(-2.0, 2.0, 400), np.linspace(-2.0, 2.0, 400))


def basin_entropy(labels):
    basins = {"attractor_of": (("v_rel", "x_rel"), np.asarray(labels, dtype=np.int16))}
    return orchestrate.basin_entropy(xr.Dataset(basins))


def test_a_smooth_boundary_is_a_line():
    found = basin_entropy(X + 0.31 * Y > 0.123)
    assert float(found.uncertainty_exponent) == pytest.approx(1.0, abs=0.05)
    assert float(found.boundary_dimension) == pytest.approx(1.0, abs=0.05)
    assert float(found.boundary_basin_entropy) < math.log(2.0)


def test_the_basins_of_newtons_method_are_fractal():
    """Of z^3 = 1: their boundary has the dimension 1.42 to 1.44 (Nusse and Yorke; Daza et al.)."""
    z, roots = X + 1j * Y, np.exp(2j * np.pi * np.arange(3) / 3.0)
    for _ in range(40):
        z = z - (z**3 - 1.0) / (3.0 * z**2)
    found = basin_entropy(np.abs(z[..., np.newaxis] - roots).argmin(axis=-1))
    assert float(found.boundary_dimension) == pytest.approx(1.43, abs=0.04)
    assert float(found.boundary_basin_entropy) > math.log(2.0)


def test_one_basin_has_no_boundary():
    found = basin_entropy(np.zeros((40, 40)))
    assert float(found.basin_entropy) == 0.0
    assert math.isnan(float(found.boundary_basin_entropy))
    assert math.isnan(float(found.uncertainty_exponent))


@pytest.mark.filterwarnings("error")
def test_sizes_of_which_all_boxes_overlap_are_no_points_of_the_line():
    labels = np.random.default_rng(0).integers(0, 2, (40, 40))
    labels[:, 5:] = -1  # so all boxes of 8 x 8 starts have some
    found = basin_entropy(labels)
    assert np.isnan(found.uncertain_fraction.values).tolist() == [False, False, True]
    assert math.isnan(float(found.uncertainty_exponent))
