"""The level of the shaking as a parameter: sweeps, maps and resonance curves over it."""

import math

import numpy as np
import pytest

import orchestrate
from orchestrate import Structure

PRESSED = Structure.from_halves(
    m1=1.0, m2=1.2, f1=42.0, f2=55.0, zeta1=0.01, zeta2=0.01, clearance=-2e-5
)
HERTZ = math.tau * 47.0
LEVELS = [0.05, 1.0, 6.0]
SHORT = {"transient": 60, "samples": 6, "progress": False}


def test_a_sweep_over_the_level_is_one_over_the_amplitude(exported):
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


@pytest.mark.parametrize("direction", ["up", "both"])
def test_resonance_at_levels_is_resonance_at_each(exported, direction):
    frequency = math.tau * np.arange(44.0, 52.0, 1.0)
    shared = {"frequency": frequency, "direction": direction, **SHORT}
    family = orchestrate.resonance_levels(PRESSED, level=LEVELS, **shared)
    for level in LEVELS:
        alone = orchestrate.resonance(PRESSED, amplitude=level / frequency**2, **shared)
        for name in ("x1_max", "a2_max", "x_rel_max", "multiplicity", "permanent_contact"):
            assert family[name].dims == ("level", *alone[name].dims)
            np.testing.assert_array_equal(family[name].sel(level=level), alone[name])
        peaks = family.peak_hertz.values[family.peak_level.values == level]
        np.testing.assert_array_equal(peaks, alone.peak_hertz.values)
    assert family.amplitude.dims == ("level", "frequency")
