"""Shock spectra against integrations, densities against closed forms, and what records may be."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orchestrate import probability_density, shock_spectrum

from ....sparing import ordinary
from .records import make


def integrated(time, base, frequency, damping):
    """Largest responses during and after a base acceleration that is straight between samples.

    It is zero a sample before and a sample after.
    """
    time, base = np.pad(time, 1, "reflect", reflect_type="odd"), np.pad(base, 1)
    w = 2.0 * math.pi * frequency

    def acceleration(y):
        return -2.0 * damping * w * y[1] - w**2 * y[0]

    def rates(t, y):
        return [y[1], acceleration(y) - np.interp(t, time, base)]

    state, peaks = [0.0, 0.0], []
    step, end = time[1] - time[0], time[-1]
    for first, last in ((time[0], end), (end, end + 1.5 / frequency)):
        grid = np.linspace(first, last, 4000)
        longest = min(step, 0.05 / frequency)
        run = solve_ivp(
            rates, (first, last), state, "DOP853", grid, rtol=1e-9, atol=1e-12, max_step=longest
        )
        peaks.append(np.abs(acceleration(run.y)).max())
        state = run.y[:, -1]
    return peaks


@pytest.mark.parametrize("damping", ordinary([0.05, 0.0, 0.5]))
@pytest.mark.parametrize("frequency", ordinary([8.0, 110.0, 900.0, 40.0, 300.0], 3))
def test_peaks_are_those_of_an_integration(frequency, damping):
    """A pulse that begins and ends at zero, one that is cut off beside it, and one that is held."""
    rate, time = 2000.0, np.arange(61) / 2000.0
    pulse = 100.0 * np.sin(np.pi * np.minimum(time / 0.011, 1.0))
    cut = np.where(time < 0.02, pulse, 0.0) + 30.0 * np.sin(2 * np.pi * 70.0 * time) * (time > 0.01)
    cut[-1] = 0.0
    held = np.full(61, 5.0)  # from the first sample to the last: no step
    answer = shock_spectrum(make(rate, pulse, cut, held), frequencies=[frequency], damping=damping)
    for channel, base in zip(answer.channel.values, (pulse, cut, held), strict=True):
        primary, residual = integrated(time, base, frequency, damping)
        shown = answer.sel(channel=channel).isel(frequency=0)
        assert np.isclose(float(shown.primary), primary, rtol=4e-3)
        assert np.isclose(float(shown.residual), residual, rtol=4e-3)
        assert float(shown.maximax) == max(float(shown.primary), float(shown.residual))


def test_moments_of_known_signals():
    angle = 2.0 * np.pi * np.arange(20_000) / 1000.0
    gauss = np.random.default_rng(1).normal(size=20_000)
    lopsided = np.random.default_rng(2).exponential(size=20_000)
    answer = probability_density(make(1000.0, np.sin(angle), gauss, lopsided))
    sine, normal, exponential = (answer.isel(channel=i) for i in range(3))
    assert np.isclose(float(sine.kurtosis), 1.5, rtol=1e-12)
    assert abs(float(sine.skewness)) < 1e-12
    assert abs(float(normal.kurtosis) - 3.0) < 4.0 * float(normal.kurtosis_error) < 0.3
    assert abs(float(normal.skewness)) < 4.0 * float(normal.skewness_error) < 0.2
    assert abs(float(exponential.skewness) - 2.0) < 4.0 * float(exponential.skewness_error)


def test_density_of_a_sine_has_its_closed_form():
    angle = 2.0 * np.pi * np.arange(200_000) / 12345.6789
    answer = probability_density(make(1000.0, np.sin(angle), 3.0 * np.sin(angle)), bins=40)
    shown = answer.sel(channel="acceleration1")
    width = float(shown.acceleration[1] - shown.acceleration[0])
    assert np.isclose(float(shown.density.sum()) * width, 1.0)
    ends = np.clip((shown.acceleration.values[:, None] + [-width / 2, width / 2]) / 3.0, -1, 1)
    expected = np.diff(np.arcsin(ends), axis=1)[:, 0] / np.pi / width
    assert np.allclose(shown.density, expected, rtol=0.02)
