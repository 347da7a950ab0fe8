"""Shock spectra against integrations, densities against closed forms, and what records may be."""

import math

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

import orchestrate
from orchestrate import InputError, probability_density, shock_spectrum

from ....sparing import ordinary
from .records import ANALYSES, DAMPED, SWEEP, analyses, make, swept_record

# -- shock spectra --------------------------------------------------------------------------------


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
@pytest.mark.parametrize("frequency", [8.0, 40.0, 110.0, 300.0, 900.0])
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


# -- density --------------------------------------------------------------------------------------


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


# -- all analyses ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ANALYSES)
def test_answers_can_be_written_and_read(tmp_path, name):
    data = analyses()[name]
    data.to_netcdf(tmp_path / "answer.nc")
    assert xr.load_dataset(tmp_path / "answer.nc").equals(data)
    assert data.attrs["analysis"] in name and data.attrs["title"].endswith(": record")


@pytest.mark.parametrize("name", ["frf", "track_orders", "harmonics"])
def test_the_box_is_needed_to_compare_with_it(name):
    record = swept_record(DAMPED)
    with pytest.raises(InputError, match="no box_acceleration; expected box_acceleration over"):
        getattr(orchestrate, name)(record.drop_vars("box_acceleration"))
    with pytest.raises(InputError, match="no acceleration1, m/s2; frf needs it"):
        orchestrate.frf(record[["box_acceleration"]])
    known = orchestrate.track_orders(record.drop_vars("box_acceleration"), phase=SWEEP)
    assert "box_acceleration" not in known.channel.values


def damaged(**changes):
    time = np.arange(200) / 100.0
    record = make(100.0, np.sin(time), np.cos(time))
    for name, value in changes.items():
        record[name] = ("time", value)
    return record


WITH_NAN = np.where(np.arange(200) == 42, np.nan, 1.0)
UNEVEN = np.arange(200) / 100.0 + 0.004 * (np.arange(200) == 70)
REPEATED = np.arange(200) / 100.0 - 0.02 * (np.arange(200) == 70)


@pytest.mark.parametrize(
    ("record", "words"),
    [
        (3.0, "record: float, without time; expected an xarray.Dataset"),
        (damaged().drop_vars(["acceleration1", "box_acceleration"]), "record: no box_acceleration"),
        (damaged().isel(time=slice(5)), "record: 5 samples; expected at least 16"),
        (damaged(acceleration1=WITH_NAN), "acceleration1[42] = nan at 0.42 s: expected finite"),
        (damaged(time=UNEVEN), "time[69] = 0.69 s: a step of 0.014 s after it"),
        (damaged(time=REPEATED), "expected ascending numbers"),
        (damaged().assign_attrs(sample_rate=50.0), "attribute sample_rate = 50.0 Hz: the time has"),
        (damaged().assign_attrs(sample_rate="fast"), "attribute sample_rate = 'fast' Hz"),
    ],
)
def test_records_that_cannot_be_analysed_are_one_line(record, words):
    with pytest.raises(InputError) as error:
        orchestrate.psd(record)
    assert words in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "given", "words"),
    [
        ("frf", {"resolution": 0.01}, "resolution = 0.01 Hz: expected 0.5 <="),
        ("frf", {"resolution": 0.5}, "expected at least 2"),
        ("frf", {"resolution": "fine"}, "resolution = 'fine' Hz: expected"),
        ("psd", {"window": "round"}, "window = 'round': expected one of hann"),
        ("psd", {"overlap": -0.1}, "overlap = -0.1: expected 0 <= overlap <= 0.95"),
        ("spectrogram", {"spectra": 0}, "spectra = 0: expected"),
        ("shock_spectrum", {"damping": 1.0}, "damping = 1.0: expected 0 <= damping < 1"),
        ("shock_spectrum", {"frequencies": [-1.0]}, "frequencies = [-1.0]: expected numbers > 0"),
        ("shock_spectrum", {"frequencies": [60.0]}, "<= 50 Hz, half the sampling rate"),
        ("probability_density", {"bins": 1}, "bins = 1: expected 4 <= bins"),
    ],
)
def test_mistakes_are_one_line(name, given, words):
    with pytest.raises(InputError) as error:
        getattr(orchestrate, name)(damaged(), **given)
    assert words in str(error.value) and "\n" not in str(error.value)
