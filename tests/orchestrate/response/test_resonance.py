"""Resonance curves, at levels too: against linear theory, sweeps, and curves that are known."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import orchestrate
from orchestrate.model import Structure
from orchestrate.response.maxima_and_jumps import (
    in_irregular_range,
    jump_indices,
    prominent_maximum_indices,
)
from orchestrate.response.resonance import ResonanceJob, resonance
from orchestrate.response.sweep import sweep

BEAM = Structure.from_file("beam")
OMEGA = 2.0 * np.pi * np.linspace(8.0, 20.0, 60)
HELD = {"frequency": OMEGA, "amplitude": 0.02 * 9.80665 / OMEGA**2}
pytestmark = pytest.mark.usefixtures("exported")


@pytest.fixture(scope="module")
def found(exported):
    return resonance(BEAM, **HELD, progress=False)


def test_bonded_is_the_linear_oscillator(found):
    stiffness, damper, mass = BEAM.k1 + BEAM.k2, BEAM.d1 + BEAM.d2, BEAM.m1 + BEAM.m2
    force = mass * HELD["amplitude"] * OMEGA**2
    exact = force / np.hypot(stiffness - mass * OMEGA**2, damper * OMEGA)
    for direction in ("up", "down"):
        curve = found.sel(structure="bonded", direction=direction)
        np.testing.assert_allclose(curve.x1_max, exact, rtol=1e-4)  # what is left of the transient
        np.testing.assert_array_equal(curve.x_rel_max, 0.0)
    (peak,) = np.flatnonzero(found.peak_structure.values == "bonded")
    assert float(found.peak_frequency[peak]) == OMEGA[np.argmax(exact)]
    np.testing.assert_allclose(found.hertz, OMEGA / (2.0 * np.pi))


def test_delaminated_is_what_a_sweep_finds(found):
    swept = sweep(BEAM, **HELD, direction="both", samples=60, progress=False)
    part = found.sel(structure="delaminated")
    for name in ("x1_max", "x2_max", "a1_max", "a2_max", "impacts_per_period", "multiplicity"):
        np.testing.assert_array_equal(part[name], swept[name])
    np.testing.assert_allclose(part.xi_rel_max, swept.xi_rel_max)


def test_where_two_motions_exist_both_jumps_are_told():
    found = resonance(Structure(), eta=np.arange(1.2, 1.45, 0.01), transient=400)
    up, down = (found.jump_eta[found.jump_direction == word].values for word in ("up", "down"))
    assert up.max() == pytest.approx(1.37, abs=0.011) and 1.27 < down.min() < 1.31
    assert set(found.jump_structure.values) == {"delaminated"}
    for one in (found.isel(jump=i) for i in range(found.sizes["jump"])):
        curve = found.x_rel_max.sel(structure="delaminated", direction=one.jump_direction)
        passed = one.jump_eta - (0.01 if one.jump_direction == "up" else -0.01)
        places = curve.sel(eta=[passed, one.jump_eta], method="nearest")
        assert places.values.tolist() == [one.jump_before, one.jump_after]
    one_way = resonance(Structure(), eta=np.arange(1.2, 1.45, 0.01), transient=400, direction="up")
    assert one_way.direction.values.tolist() == ["up"]
    np.testing.assert_array_equal(one_way.x1_max[:, 0], found.x1_max.sel(direction="up"))


@pytest.mark.parametrize(("gap", "differ"), [(0.84, True), (0.86, False)])
def test_directions_differ_by_more_than_a_jump(gap, differ):
    data = xr.Dataset({"x_rel_max": (("direction", "eta"), [[1.0], [gap]])})
    job = SimpleNamespace(jump=0.15, series=SimpleNamespace(name="eta"))
    assert ResonanceJob.directions_differ(job, data).tolist() == [differ]


def test_a_steep_step_that_both_directions_have_is_no_jump():
    """Two of its frequencies lie at both sides of an impact's end; with finer ones it is steep."""
    halves = {"m1": 0.15, "m2": 0.12, "f1": 42.0, "f2": 53.0, "zeta1": 0.007, "zeta2": 0.007}
    frequency = 2.0 * np.pi * np.arange(47.0, 51.1, 0.25)
    asked = {"frequency": frequency, "amplitude": 0.49 / 300.0**2}
    structure = Structure.from_halves(**halves, e=0.6)
    assert resonance(structure, **asked).sizes["jump"] == 0
    assert resonance(structure, **asked, direction="up").sizes["jump"]


@given(st.lists(st.booleans(), min_size=1, max_size=40))
def test_ranges_of_irregular_responses_reach_over_narrow_windows_alone(irregular):
    inside = in_irregular_range(irregular)
    for index, flag in enumerate(inside):
        if flag and not irregular[index]:
            assert any(irregular[max(0, index - 2) : index])
            assert any(irregular[index + 1 : index + 3])
        assert flag or not irregular[index]
    if len(irregular) >= 3:
        window = [True, *[False] * 3, True]
        assert in_irregular_range(window).tolist() == window
        assert in_irregular_range([True, False, False, True]).all()


GRID = np.linspace(0.5, 1.5, 401)


def test_the_peak_of_a_linear_oscillator():
    damping = 0.02
    curve = 1.0 / np.hypot(1.0 - GRID**2, 2.0 * damping * GRID)
    exact = np.sqrt(1.0 - 2.0 * damping**2)
    assert GRID[prominent_maximum_indices(curve, 0.1)] == pytest.approx([exact], abs=0.0013)


def test_ripples_are_no_peaks_and_zeros_do_no_harm():
    ripples = 1.0 + 0.04 * np.sin(80.0 * GRID)
    assert len(prominent_maximum_indices(ripples, 0.05)) > 10
    for curve in (ripples, np.zeros(5)):
        assert len(prominent_maximum_indices(curve, 0.1)) == 0


def test_a_jump_and_what_is_none():
    steep, jumping = np.exp(6.0 * GRID), np.where(GRID > 1.2, 0.6, 1.0) * GRID
    assert len(jump_indices(steep, 0.01)) == 0
    (at,) = jump_indices(jumping, 0.15)
    assert GRID[at] <= 1.2 < GRID[at + 1]
    irregular = np.random.default_rng(1).uniform(1.0, 1.5, 400)
    assert len(jump_indices(irregular, 0.15)) < 8


HALVES = {"m1": 1.0, "m2": 1.2, "f1": 42.0, "f2": 55.0, "zeta1": 0.01, "zeta2": 0.01}
PRESSED = Structure.from_halves(**HALVES, clearance=-2e-5)
HERTZ = (2.0 * np.pi) * 47.0
LEVELS = [0.05, 1.0, 6.0]
SHORT = {"transient": 60, "samples": 6, "progress": False}


def test_a_sweep_over_the_level_is_one_over_the_amplitude():
    over = {"over": "level", "values": LEVELS}
    by_level = orchestrate.sweep(PRESSED, frequency=HERTZ, **over, **SHORT)
    amplitudes = [level / HERTZ**2 for level in LEVELS]
    by_amplitude = orchestrate.sweep(PRESSED, frequency=HERTZ, amplitude=amplitudes, **SHORT)
    assert by_level.xi_rel.dims == ("level", "sample")
    assert by_level.level.attrs["units"] == "m/s2"
    np.testing.assert_array_equal(by_level.xi_rel.values, by_amplitude.xi_rel.values)
    np.testing.assert_array_equal(by_level.amplitude.values, amplitudes)
    gaps = by_level.xi_rel_max.values
    assert gaps[0] == 0.0 and (gaps[1:] > 0.0).all()  # it opens between the first two


def test_resonance_at_levels_is_resonance_at_each():
    frequency = (2.0 * np.pi) * np.arange(44.0, 52.0, 1.0)
    shared = {"frequency": frequency, **SHORT}
    family = orchestrate.resonance_levels(PRESSED, level=LEVELS, **shared)
    for level in LEVELS:
        alone = orchestrate.resonance(PRESSED, amplitude=level / frequency**2, **shared)
        for name in ("x1_max", "a2_max", "x_rel_max", "multiplicity", "permanent_contact"):
            assert family[name].dims == ("level", *alone[name].dims)
            np.testing.assert_array_equal(family[name].sel(level=level), alone[name])
        peaks = family.peak_hertz.values[family.peak_level.values == level]
        np.testing.assert_array_equal(peaks, alone.peak_hertz.values)
    assert family.amplitude.dims == ("level", "frequency")
