"""Frequency response, coherence, power density and spectrogram against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrate import frf, psd, spectrogram

from ....sparing import ordinary
from .records import HEAVY, make, random_record, transfer

BAND = slice(14.0, 140.0)


def complex_response(answer, estimator="H1", channel="acceleration1"):
    part = answer.sel(estimator=estimator, channel=channel, frequency=BAND)
    return part.frequency.values, (part.magnitude * np.exp(1j * part.phase)).values


@pytest.mark.parametrize("estimator", ["H1", "H2", "Hv"])
@pytest.mark.parametrize("seed", ordinary(range(2)))
def test_response_of_a_bonded_structure_is_its_transfer_function(seed, estimator):
    """Without noise all that is left is leakage, which the coherence and its error know."""
    answer = frf(random_record(HEAVY.as_bonded(), seed, 80.0), resolution=0.2)
    for channel in ("acceleration1", "acceleration2"):
        frequency, found = complex_response(answer, estimator, channel)
        expected = transfer(HEAVY, frequency)
        error = answer.random_error.sel(channel=channel, frequency=BAND).values
        assert (np.abs(found - expected) < 5.0 * error * np.abs(expected)).all()
        assert np.abs(found / expected - 1.0).max() < 0.01


@pytest.mark.parametrize(
    ("window", "overlap"),
    ordinary([("hann", 0.5), ("boxcar", 0.5), ("hann", 0.75)], 2, several_names=True),
)
def test_independent_averages_are_those_of_the_scatter(window, overlap):
    """Of white noise: the relative variance of a line is one over their number."""
    values = np.random.default_rng(5).normal(size=(120, 64 * 12))
    densities = [
        psd(make(64.0, row, row), resolution=1.0, window=window, overlap=overlap) for row in values
    ]
    lines = np.stack([one.psd.sel(channel="acceleration1").values[3:-3] for one in densities])
    scatter = (lines.var(axis=0) / lines.mean(axis=0) ** 2).mean()
    assert np.isclose(1.0 / scatter, float(densities[0].averages), rtol=0.1)


def test_density_integrates_to_the_mean_square():
    values = np.random.default_rng(2).normal(1.0, 3.0, (3, 4000))
    answer = psd(make(200.0, *values), resolution=0.05, window="boxcar", overlap=0.0)
    assert np.allclose(answer.rms, values.std(axis=1), rtol=1e-12)  # Parseval's theorem
    integral = answer.psd.sum("frequency") * answer.resolution
    assert np.allclose(integral, values.var(axis=1), rtol=1e-12)
    smoothed = psd(make(200.0, *values), resolution=1.0)
    assert np.allclose(smoothed.rms, values.std(axis=1), rtol=0.03)


@pytest.mark.parametrize("begin", [0.0, 3.0])
def test_a_sine_has_its_amplitude_where_and_when_it_is(begin):
    rate, time = 1000.0, np.arange(8000) / 1000.0
    first = np.where(time < 4.0, 3.0 * np.sin(2 * np.pi * 40.0 * time), 0.0)
    second = np.where(time >= 4.0, 5.0 * np.cos(2 * np.pi * 120.0 * time), 0.0)
    record = make(rate, first, first + second + 0.5, begin=begin)
    answer = spectrogram(record, resolution=4.0)
    shown = answer.amplitude.sel(channel="acceleration1")
    early = shown.sel(time=slice(begin, begin + 3.8))
    late = shown.sel(time=slice(begin + 4.2, None))
    assert np.allclose(early.sel(frequency=40.0), 3.0, rtol=1e-9)
    assert np.allclose(late.sel(frequency=120.0), 5.0, rtol=1e-9)
    assert np.allclose(late.sel(frequency=0.0), 0.5, rtol=1e-9)
    assert float(early.sel(frequency=slice(100, None)).max()) < 1e-9
    assert answer.sizes["time"] <= 201
    half = 0.5 / 4.0  # whole parts alone
    assert begin + half - 1e-3 <= float(answer.time[0]) <= begin + half + 0.05
    assert begin + 8.0 - half - 0.05 <= float(answer.time[-1]) <= begin + 8.0 - half + 1e-3
