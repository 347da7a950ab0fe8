"""What sensors read against an independent solution of motion and filter together."""

import dataclasses
import functools
import math

import mpmath
import numpy as np
import pytest
from scipy import signal
from scipy.linalg import expm

from orchestrate import Hammer, Sampled, Sensor, SweptSine, measure, shake
from orchestrate.laboratory.analog_filter import anti_aliasing_zeros_and_poles, phi_functions

from ...sparing import ordinary
from .files import BEAM, CHANNELS

BOX = Sampled(
    acceleration=20.0 * np.sin(2.0 * np.pi * 47.0 * np.arange(300) / 1000.0), sample_rate=1000.0
)
SENSOR = Sensor(bandwidth=2000.0, sample_rate=5120.0, antialiasing=False)


def state_space(sensor):
    """The sensor's filter as SciPy makes it, times in ms so that the matrices are well scaled."""
    edge = 2.0 * np.pi * sensor.bandwidth / 1000.0
    if sensor.kind == "bessel":
        zpk = signal.bessel(sensor.order, edge, analog=True, output="zpk", norm="mag")
    else:
        zpk = signal.butter(sensor.order, edge, analog=True, output="zpk")
    parts = [zpk]
    if sensor.antialiasing:
        zeros, poles = (x / 1000.0 for x in anti_aliasing_zeros_and_poles(sensor.sample_rate))
        parts.append((zeros, poles, (np.prod(-poles) / np.prod(-zeros)).real))
    a, b, c, _ = (np.zeros((0, 0)), np.zeros((0, 1)), None, None)
    for part in parts:  # in series, each by its own state-space form
        a2, b2, c2, d2 = signal.zpk2ss(*part)
        assert abs(d2).max() == 0.0
        if c is None:
            a, b, c = a2, b2, c2
            continue
        a = np.block([[a, np.zeros((len(a), len(a2)))], [b2 @ c, a2]])
        b = np.vstack([b, np.zeros((len(a2), 1))])
        c = np.hstack([np.zeros((1, len(a) - len(a2))), c2])
    return a, b[:, 0], c[0]


def system(structure, sensor, touching):
    """Motion, three filters and the box's cubic as one linear system, times in ms."""
    a, b, c = state_space(sensor)
    n, s = len(a), structure
    size = 4 + 3 * n + 4
    whole, box = np.zeros((size, size)), size - 4
    whole[0, 2] = whole[1, 3] = 1e-3
    one, two = np.zeros(size), np.zeros(size)
    one[[0, 2]], two[[1, 3]] = (-s.k1, -s.d1), (-s.k2, -s.d2)
    both = (one + two) / (s.m1 + s.m2)
    felt = (both, both) if touching else (one / s.m1, two / s.m2)
    excited = np.eye(size)[box]
    whole[2], whole[3] = 1e-3 * (felt[0] - excited), 1e-3 * (felt[1] - excited)
    for i, source in enumerate((excited, *felt)):
        rows = slice(4 + i * n, 4 + (i + 1) * n)
        whole[rows, rows] += a
        whole[rows] += np.outer(b, source)
    for i in range(3):
        whole[box + i, box + i + 1] = 1e-3
    return whole, b, c


def reference(structure, excitation, history, sensor, times):
    """From node to node by matrix exponentials; impacts by (15) from their times alone."""
    s, pieces = structure, excitation.pieces()
    free, b, c = system(s, sensor, s.bonded)
    hits = dict(zip(history.impact_time.values, history.sticks.values, strict=True))
    assert not any(hits.values()) and not (history.in_contact.values[1:].any() and not s.bonded)
    nodes = np.unique(np.concatenate([times, list(hits), pieces.nodes[:-1]]))
    n, state, found = len(b), np.zeros(len(free)), []
    state[:4] = [float(history[name][0]) for name in ("x1", "x2", "v1", "v2")]
    exponential = functools.lru_cache(maxsize=None)(lambda length: expm(free * (1e3 * length)))
    for now, after in zip(nodes, np.append(nodes[1:], nodes[-1] + 1e-3), strict=True):
        if now in hits:
            closing = state[2] - state[3]
            share = (1.0 + s.e) * closing / (s.m1 + s.m2)
            state[2] -= s.m2 * share
            state[3] += s.m1 * share
            state[4 + n : 4 + 2 * n] -= 1e3 * b * s.m2 * share
            state[4 + 2 * n : 4 + 3 * n] += 1e3 * b * s.m1 * share
        if now in times:
            found.append([c @ state[4 + i * n : 4 + (i + 1) * n] for i in range(3)])
        state[-4:] = pieces.derivatives_at(np.array([now]))[0]
        state = exponential(after - now) @ state
    return np.array(found)


START = (0.0, 2e-4, 0.0, 0.0)
SENSORS = {
    "butterworth": SENSOR,
    "filter against aliasing": dataclasses.replace(SENSOR, antialiasing=True),
    "bessel": dataclasses.replace(SENSOR, kind="bessel", order=3, bandwidth=500.0),
}


@functools.cache
def shaken(bonded, sample_rate=1000.0):
    if bonded:
        return shake(BEAM.as_bonded(), BOX, sample_rate=sample_rate, progress=False)
    return shake(BEAM, BOX, sample_rate=sample_rate, start=START, progress=False)


@pytest.mark.parametrize("bonded", [False, True])
@pytest.mark.parametrize("name", ordinary(SENSORS))
def test_readings_are_the_filters_exact_response(name, bonded):
    history, structure = shaken(bonded), BEAM.as_bonded() if bonded else BEAM
    assert (history.sizes["impact"] == 0) if bonded else (history.sizes["impact"] > 20)
    felt = measure(history, SENSORS[name])
    expected = reference(structure, BOX, history, SENSORS[name], felt.time.values)
    for channel, column in zip(CHANNELS, expected.T, strict=True):
        peak = np.abs(column).max()
        assert np.abs(felt[channel].values - column).max() <= 1e-9 * peak, channel
    assert felt.attrs["reconstruction_error"] <= 1e-9 * 500.0


def test_the_historys_sampling_rate_does_not_matter_through_contact_and_release():
    beam = dataclasses.replace(BEAM, e=0.3)
    sweep = SweptSine(first=15.0, last=75.0, duration=2.0, acceleration=5.0)
    sensor = Sensor(bandwidth=2000.0)
    histories = [shake(beam, sweep, sample_rate=rate, progress=False) for rate in (8000.0, 1000.0)]
    assert histories[1].sticks.sum() > 10 and 10 < histories[1].in_contact.sum() < 2000
    fine, coarse = (measure(history, sensor, excitation=sweep) for history in histories)
    for channel in CHANNELS:
        peak = float(np.abs(fine[channel]).max())
        assert float(np.abs(fine[channel] - coarse[channel]).max()) <= 2e-6 * peak
    assert coarse.attrs["reconstruction_error"] < 1e-3
    without = measure(histories[0], sensor)
    for channel, bound in zip(CHANNELS, (1e-5, 1e-8, 1e-8), strict=True):
        peak = float(np.abs(fine[channel]).max())
        assert float(np.abs(fine[channel] - without[channel]).max()) <= bound * peak


@pytest.mark.parametrize("size", [1e-9, 0.3, 2.9, 3.1, 12.0, 60.0, 1e4])
def test_phi_functions(size):
    z = size * np.exp(1j * np.pi * np.array([0.5, 0.6, 1.0]))
    found = phi_functions(z, 7)
    for (k, i), value in np.ndenumerate(found):
        exact = mpmath.hyp1f1(1, k + 2, mpmath.mpc(z[i]))
        assert abs(complex(exact) / math.factorial(k + 1) - value) <= 1e-13 * abs(value), (k, i)


def test_the_filter_against_aliasing():
    response = np.abs(
        Sensor(bandwidth=1e6, sample_rate=25_600.0)
        .analog_filter()
        .frequency_response(np.array([0.0, 1e3, 9.9e3, 15_600.0, 25e3]))
    )
    assert response[0] == pytest.approx(1.0, abs=1e-9)
    assert np.abs(response[1:3] - 1.0).max() < 2e-3
    assert response[3:].max() <= 1.01e-4


def test_noise_is_as_dense_as_said_and_has_a_seed():
    history = shaken(True)
    noisy = dataclasses.replace(SENSOR, noise=0.2, seed=4)
    clean, one = measure(history, SENSOR), measure(history, noisy)
    assert one.identical(measure(history, noisy))
    other = measure(history, dataclasses.replace(noisy, seed=5))
    added = [(data[name] - clean[name]).values for data in (one, other) for name in CHANNELS]
    for column in added:
        assert np.std(column) == pytest.approx(0.2 * math.sqrt(2560.0), rel=0.1)
    alike = np.abs(np.corrcoef(added) - np.eye(6)).max()
    assert alike < 0.15  # of 1531 values each


def test_range_and_resolution():
    felt = measure(shaken(False), dataclasses.replace(SENSOR, range=150.0, resolution=0.5))
    values = felt.acceleration1.values
    assert values.max() == 150.0 and values.min() == -150.0
    assert (values == 0.5 * np.round(values / 0.5)).all()
    free = measure(shaken(False), SENSOR).acceleration1.values
    assert np.abs(values - np.clip(free, -150.0, 150.0)).max() <= 0.25


def test_sensors_of_their_own():
    narrow = dataclasses.replace(SENSOR, bandwidth=300.0)
    felt = measure(shaken(False), {"box_acceleration": SENSOR, "acceleration2": narrow})
    assert set(felt.data_vars) == {"box_acceleration", "acceleration2"}
    assert felt.acceleration2.identical(measure(shaken(False), narrow).acceleration2)
    assert "300 Hz" in felt.attrs["sensors"] and felt.attrs["sample_rate"] == 5120.0


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize("given", [True, False])
@pytest.mark.parametrize("knocked", [False, True])
def test_gravity_is_felt_as_another_gap_and_not_read(given, knocked):
    """About the rest under gravity the halves move as without it, at another clearance."""
    gravity, gap = -9.81, 1e-4
    sag = -gravity * np.array([BEAM.m1 / BEAM.k1, BEAM.m2 / BEAM.k2])
    start = (*sag, 0.0, 0.0)
    knock = Hammer(peak=900.0, width=0.004, duration=0.25)
    excitation = (
        knock if knocked else SweptSine(first=30.0, last=60.0, duration=0.25, acceleration=20.0)
    )
    read = {"sensor": SENSOR, "excitation": excitation if given else None}
    heavy, light = BEAM.replace(clearance=gap + sag[0] - sag[1]), BEAM.replace(clearance=gap)
    down = shake(heavy, excitation, box_acceleration=gravity, start=start, progress=False)
    free = shake(light, excitation, progress=False)
    assert down.sizes["impact"] == free.sizes["impact"] > 5
    found, expected = measure(down, **read), measure(free, **read)
    for name in expected.data_vars:
        scale = float(abs(expected[name]).max())
        assert found[name].values == pytest.approx(expected[name].values, abs=1e-7 * scale), name
