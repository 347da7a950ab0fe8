"""Impacts are heard at high frequencies, and dry friction is not taken for them."""

import numpy as np
import pytest

import orchestrate
from orchestrate.diagnosis.bursts import burst_excess
from orchestrate.diagnosis.orders import checked_channels

from ...sparing import ordinary
from .records import BEAM, SWEEP, guess

NOISE, RINGING = 0.02, 700.0  # of the rms; Hz
STRIKES = (4.0, 6.0)  # s between which something strikes


def knocks(time, twice):
    """Short ringing of size 1 once a period, or twice with opposite signs."""
    turns = SWEEP.phase(time) / (2.0 * np.pi) * (2.0 if twice else 1.0)
    after = (turns % 1.0) / np.gradient(turns, time)
    sign = np.where(twice & (np.floor(turns) % 2.0 == 1.0), -1.0, 1.0)
    inside = (time > STRIKES[0]) & (time < STRIKES[1])
    return inside * sign * np.exp(-after / 1e-3) * np.sin(2.0 * np.pi * RINGING * after)


def knocked(size, twice=False, rate=2000.0, noise=NOISE, face=None):
    """A record of a base, of a face that follows it, and of knocks while it moves most."""
    time, rng, channels = np.arange(0.0, SWEEP.duration, 1.0 / rate), np.random.default_rng(3), {}
    clean = {"box_acceleration": SWEEP(time), "acceleration1": 4.0 * SWEEP(time)}
    for name, values in clean.items() if face is None else face.items():
        channels[name] = values + noise * values.std() * rng.standard_normal(len(values))
    rms = channels["acceleration1"].std()
    channels["acceleration1"] = channels["acceleration1"] + size * rms * knocks(time, twice)
    return orchestrate.record(time=time, **channels)


def excess(record):
    return burst_excess(checked_channels(record), 42.0)


def test_knocks_once_a_period_are_heard_and_those_at_both_ends_of_the_stroke_are_not():
    assert 0.5 < excess(knocked(0.0)) < 0.9
    assert excess(knocked(0.3)) > 2.0
    assert excess(knocked(0.3, twice=True)) < 0.9


@pytest.mark.parametrize("seed", ordinary(range(3)))
def test_lost_samples_are_no_bursts_once_a_period(seed):
    """Each makes one burst, in all channels, where the record is quiet."""
    record = knocked(0.0, noise=0.002)
    rng, kept = np.random.default_rng(seed), np.ones(record.sizes["time"], bool)
    kept[rng.choice(len(kept), 3, replace=False)] = False
    channels = {name: record[name].values[kept] for name in record.data_vars}
    lost = orchestrate.record(**channels, sample_rate=record.attrs["sample_rate"])
    assert excess(lost) < 0.9


def test_a_record_that_is_sampled_too_slowly_tells_nothing_about_impacts():
    assert np.isnan(excess(knocked(0.3, rate=400.0)))


@pytest.mark.slow
def test_a_beam_in_which_something_strikes_is_not_one_of_which_no_opening_is_seen():
    """Its order 2 is below the threshold, and a bonded beam describes all orders."""
    history = orchestrate.shake(BEAM.as_bonded(), SWEEP, sample_rate=2000.0, progress=False)
    sensor = orchestrate.Sensor(bandwidth=800.0, sample_rate=2000.0)
    felt = orchestrate.measure(history, sensor, excitation=SWEEP).isel(time=slice(20_000))
    face = {name: felt[name].values for name in ("box_acceleration", "acceleration1")}
    answer = orchestrate.detect(knocked(0.3, face=face), guess(), jobs=1, progress=False)
    assert str(answer.verdict.values) == "undecided", answer.attrs["reason"]
    assert float(answer.bursts) > 2.0 and "strikes once a period" in answer.attrs["reason"]
    assert float(answer.order2.max() / answer.order2_threshold.max()) < 1.0
