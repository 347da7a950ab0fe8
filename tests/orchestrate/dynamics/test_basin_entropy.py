"""Basin entropy and uncertainty exponent: smooth boundaries, Newton's fractal, a Cantor set."""

import math

import numpy as np
import pytest
import xarray as xr

import orchestrate


def basins(labels):
    return xr.Dataset({"attractor_of": (("v_rel", "x_rel"), np.asarray(labels, dtype=np.int16))})


def plane(count):
    return np.meshgrid(np.linspace(-2.0, 2.0, count), np.linspace(-2.0, 2.0, count))


def newton(count):
    """Which root of z^3 = 1 Newton's method leads to."""
    x, y = plane(count)
    z = x + 1j * y
    for _ in range(40):
        z = z - (z**3 - 1.0) / (3.0 * z**2)
    roots = np.exp(2j * np.pi * np.arange(3) / 3.0)
    return np.abs(z[..., np.newaxis] - roots).argmin(axis=-1)


def test_a_smooth_boundary_is_a_line():
    x, y = plane(600)
    found = orchestrate.basin_entropy(basins(x + 0.31 * y > 0.123))
    assert float(found.uncertainty_exponent) == pytest.approx(1.0, abs=0.05)
    assert float(found.boundary_dimension) == pytest.approx(1.0, abs=0.05)
    assert float(found.boundary_basin_entropy) < math.log(2.0)


def test_the_basins_of_newtons_method_are_fractal():
    """The dimension of their boundary is 1.42 to 1.44 (Nusse and Yorke; Daza and others)."""
    found = orchestrate.basin_entropy(basins(newton(600)))
    assert float(found.boundary_dimension) == pytest.approx(1.43, abs=0.04)
    assert float(found.boundary_basin_entropy) > math.log(2.0)


def test_one_basin_has_no_boundary():
    found = orchestrate.basin_entropy(basins(np.zeros((40, 40))))
    assert float(found.basin_entropy) == 0.0
    assert math.isnan(float(found.boundary_basin_entropy))
    assert math.isnan(float(found.uncertainty_exponent))
