"""Orders in short windows, against signals whose orders are known."""

import warnings

import numpy as np
import pytest

import orchestrate
from orchestrate.diagnosis.order_windows import ORDERS

from .records import record_orders

RATE = 1000.0
SWEEPS = {
    "up": {"first": 20.0, "last": 60.0, "duration": 12.0},
    "down": {"first": 60.0, "last": 20.0, "duration": 12.0},
    "logarithmic": {"first": 15.0, "last": 60.0, "duration": 15.0, "spacing": "log"},
}


def made(sweep="up", noise=0.0):
    """A record whose mass has orders 1, 2, 3 and 1/2 of amplitudes 4, 1, 0.5 and 0.3."""
    if isinstance(sweep, str):
        sweep = orchestrate.SweptSine(acceleration=2.0, **SWEEPS[sweep])
    time = np.arange(0.0, sweep.duration, 1.0 / RATE)
    phase, rng = sweep.phase(time), np.random.default_rng(3)
    mass = 4.0 * np.sin(phase + 0.7) + np.sin(2 * phase) + 0.5 * np.sin(3 * phase)
    mass += 0.3 * np.sin(0.5 * phase)
    mass, box = (x + noise * rng.standard_normal(len(x)) for x in (mass, 2.0 * np.sin(phase)))
    return orchestrate.record(time=time, box_acceleration=box, acceleration1=mass)


@pytest.mark.parametrize("name", SWEEPS)
def test_orders_are_those_of_the_signal(name):
    sweep = orchestrate.SweptSine(acceleration=2.0, **SWEEPS[name])
    found = record_orders(made(sweep, noise=0.02))
    frequency = sweep.frequency(found.windows.time)
    np.testing.assert_allclose(found.windows.frequency, frequency, rtol=2e-3)
    got = np.array([found.order_amplitudes(n, "acceleration1") for n in ORDERS])
    assert abs(got[0] - 4.0 * np.exp(0.7j)).max() < 0.05
    for order, expected in zip(got[1:], (1.0, 0.5, 0.3), strict=True):
        np.testing.assert_allclose(abs(order), expected, atol=0.03)


def test_the_floor_is_that_of_the_noise_and_not_of_orders():
    quiet, loud = (record_orders(made(noise=n)) for n in (1e-6, 0.1))
    assert quiet.noise.max() < 1e-3
    expected = 0.1 * 2.0 * np.sqrt(1.5 / 350)  # Hann windows of about 350 samples
    np.testing.assert_allclose(loud.noise, expected, rtol=0.3)


def test_an_order_above_the_sampling_is_missing_and_not_wrong():
    sweep = orchestrate.SweptSine(first=120.0, last=220.0, duration=12.0, acceleration=2.0)
    found = record_orders(made(sweep))
    above = 3.0 * found.windows.frequency > 0.45 * RATE
    assert 0 < above.sum() < len(above)
    assert (np.isnan(found.order_amplitudes(3.0, "acceleration1")) == above).all()
    assert np.isfinite(found.floor).all()


def resonant(rate):
    """A swept sine from 20 to 70 Hz, and a mass that moves most at 46 Hz."""
    sweep = orchestrate.SweptSine(first=20.0, last=70.0, duration=20.0, acceleration=2.0)
    time = np.arange(0.0, sweep.duration, 1.0 / rate)
    box = 2.0 * np.sin(sweep.phase(time))
    mass = box * (1.0 + 9.0 * np.exp(-(((sweep.frequency(time) - 46.0) / 5.0) ** 2)))
    return orchestrate.record(time=time, box_acceleration=box, acceleration1=mass)


def test_a_sampling_that_does_not_read_order_2_is_refused():
    """Of faster ones the windows are left out in which order 2 is not read."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(orchestrate.InputError, match=r"143 samples a second are 3.1.*4.44"):
            record_orders(resonant(143.0))
        found = record_orders(resonant(250.0))
    assert 54.0 < found.windows.frequency.max() < 57.0
    assert (
        np.isfinite(found.order_amplitudes(2.0, "acceleration1")).all()
        and np.isfinite(found.noise).all()
    )


def test_what_is_no_swept_sine_of_a_structure_is_refused_in_one_line():
    noise = np.random.default_rng(5).standard_normal((2, 20_000))
    records = {
        "not described by this method": {"box_acceleration": noise[0], "acceleration1": noise[1]},
        "not described by this method ": {
            **{"box_acceleration": np.sin(np.arange(40)), "acceleration1": noise[0, :40]}
        },
        "acceleration1, acceleration2 or both": {"box_acceleration": np.sin(np.arange(9000) / 9)},
        r"face 1 \(acceleration1\): does not move": {
            **{"box_acceleration": made().box_acceleration.values},
            **{"acceleration1": np.zeros(made().sizes["time"])},
        },
    }
    for words, channels in records.items():
        record = orchestrate.record(**channels, sample_rate=RATE)
        with pytest.raises(orchestrate.InputError, match=words.strip()) as caught:
            record_orders(record)
        assert "\n" not in str(caught.value)
