"""Orders of swept sines: of signals that are known, and of shaken structures."""

import numpy as np
import pytest

from orchestrate import InputError, SteppedSine, SweptSine, harmonics, track_orders

from .records import DAMPED, make, random_record, swept_record, transfer

RATE = 2000.0
SWEEPS = {
    "up": SweptSine(first=20.0, last=50.0, duration=6.0, acceleration=2.0),
    "down": SweptSine(first=50.0, last=20.0, duration=6.0, acceleration=2.0),
    "log": SweptSine(first=20.0, last=50.0, duration=6.0, acceleration=2.0, spacing="log"),
}
KNOWN = {0.5: (0.3, 1.0), 1.0: (5.0, -0.7), 2.0: (1.0, 2.0), 3.0: (0.2, -2.5)}


def synthetic(sweep, begin=0.0):
    time = np.arange(int(sweep.duration * RATE)) / RATE
    angle = sweep.phase(time)
    response = 0.4 + sum(a * np.sin(n * angle + theta) for n, (a, theta) in KNOWN.items())
    return make(RATE, sweep(time), response, begin=begin)


@pytest.mark.parametrize("name", SWEEPS)
def test_known_orders_are_found(name):
    sweep = SWEEPS[name]
    answer = track_orders(synthetic(sweep), orders=(0.5, 1, 2, 3), phase=sweep)
    shown = answer.sel(channel="acceleration1")
    for n, (amplitude, theta) in KNOWN.items():
        assert np.abs(shown.amplitude.sel(order=n) - amplitude).max() < 1e-9
        assert np.abs(shown.phase.sel(order=n) - theta).max() < 1e-8 / amplitude
    assert float(shown.residual.max()) < 1e-9
    box = answer.sel(channel="box_acceleration", order=1.0)
    assert np.abs(box.amplitude - 2.0).max() < 1e-9 and np.abs(box.phase).max() < 1e-9
    expected = sweep.frequency(answer.time.values)
    assert np.abs(answer.frequency / expected - 1.0).max() < 1e-5
    assert (np.sign(answer.sweep_rate) == np.sign(sweep.last - sweep.first)).all()


@pytest.mark.parametrize("name", SWEEPS)
def test_the_phase_is_measured(name):
    sweep = SWEEPS[name]
    record = synthetic(sweep, begin=7.0)
    noise = 0.02 * np.random.default_rng(1).normal(size=record.sizes["time"])
    record["box_acceleration"] = record.box_acceleration + noise
    answer = track_orders(record, orders=(0.5, 1, 2, 3)).sel(channel="acceleration1")
    for n, (amplitude, theta) in KNOWN.items():
        assert np.abs(answer.amplitude.sel(order=n) - amplitude).max() < 1e-3 * 5.0
        if n >= 1:
            turned = np.angle(np.exp(1j * (answer.phase.sel(order=n) - theta)))
            assert np.abs(turned).max() < 0.01 * n
    expected = sweep.frequency(answer.time.values - 7.0)
    assert np.abs(answer.frequency / expected - 1.0).max() < 1e-3


STEPPED = SteppedSine(
    frequencies=(30.0, 52.0, 45.0), acceleration=3.0, settle_cycles=60, measured_cycles=20
)


def test_a_settled_stepped_sine_has_the_steady_state():
    """Bonded: the transfer function at each frequency; the free vibration is exp(-15) of it."""
    record = swept_record(DAMPED.as_bonded(), STEPPED)
    answer = track_orders(record, phase=STEPPED)
    assert np.allclose(answer.frequency, STEPPED.frequencies, rtol=1e-9)
    assert np.allclose(answer.time, STEPPED.measured_times().mean(axis=1), atol=1e-3)
    amplitude = (answer.amplitude * np.exp(1j * answer.phase)).sel(order=1.0)
    box, first = (amplitude.sel(channel=name) for name in ("box_acceleration", "acceleration1"))
    expected = transfer(DAMPED.as_bonded(), STEPPED.frequencies)
    assert np.abs((first / box).values / expected - 1.0).max() < 2e-5
    assert float(answer.amplitude.sel(channel="acceleration1", order=2.0).max()) < 1e-3
    distortion = harmonics(record, phase=STEPPED).distortion.sel(channel="acceleration1")
    assert distortion.sizes["time"] == 3 and float(distortion.max()) < 1e-3


def test_distortion_of_a_known_signal():
    sweep = SWEEPS["up"]
    time = np.arange(int(6.0 * RATE)) / RATE
    angle = sweep.phase(time)
    response = 4.0 * np.sin(angle) + 0.3 * np.sin(2 * angle) + 0.4 * np.cos(3 * angle)
    answer = harmonics(make(RATE, sweep(time), response), phase=sweep, highest=3)
    shown = answer.sel(channel="acceleration1")
    assert np.allclose(shown.distortion, 0.5 / 4.0, rtol=1e-9)
    assert np.allclose(shown.ratio.sel(order=3.0), 0.1, rtol=1e-9)
    short = harmonics(make(RATE, sweep(time), response), phase=sweep, highest=2)
    short = short.sel(channel="acceleration1")
    assert np.allclose(short.distortion, 0.3 / 4.0, atol=1e-3)
    assert np.allclose(short.distortion_and_noise, 0.5 / 4.0, atol=2e-3)


def test_orders_beyond_the_sampling_rate_are_not_known():
    sweep = SweptSine(first=20.0, last=50.0, duration=6.0, acceleration=2.0)
    time = np.arange(1800) / 300.0
    record = make(300.0, sweep(time), sweep(time))
    answer = track_orders(record, orders=4, phase=sweep)
    known = np.isfinite(answer.amplitude.sel(channel="acceleration1", order=4.0))
    assert (known == (4.0 * answer.frequency <= 0.45 * 300.0)).all()
    assert np.isfinite(answer.amplitude.sel(order=1.0)).all()


def test_random_vibration_has_no_orders():
    with pytest.raises(InputError, match="expected a swept sine"):
        track_orders(random_record(DAMPED.as_bonded(), 1, 40.0))
    still = make(100.0, np.zeros(1000), np.zeros(1000))
    with pytest.raises(InputError, match="does not move"):
        track_orders(still)


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_silence_between_two_sweeps_has_no_orders(noise):
    """Its phase is that of noise, whose frequency may be below zero."""
    sweep, rng = SWEEPS["up"], np.random.default_rng(4)
    time = np.arange(int(sweep.duration * RATE)) / RATE
    box = np.concatenate([sweep(time), np.zeros(int(4.0 * RATE)), sweep(time)])
    answer = track_orders(make(RATE, box + noise * rng.normal(size=len(box)), 3.0 * box))
    moving = (answer.time < 6.1) | (answer.time > 9.9)
    assert moving.all() and len(answer.time) > 40
    expected = sweep.frequency(np.where(answer.time < 8.0, answer.time, answer.time - 10.0))
    assert np.abs(answer.frequency - expected).max() < 2.0  # of a window that is partly silent
