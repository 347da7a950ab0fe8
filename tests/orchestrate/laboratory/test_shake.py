"""Shaken structures against independent integrations, and what the record must not change."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orchestrate import Random, Sampled, Shock, SteppedSine, Structure, SweptSine, shake
from orchestrate.laboratory.shake import ShakeJob, transient_time
from orchestrate.show.labels import title_from_attributes

from ...fmu.event_driven import Motion
from ...sparing import ordinary
from .files import BEAM, random_structure

SWEEP = SweptSine(first=40.0, last=52.0, duration=1.5, acceleration=4.9)
OPEN = (0.0, 2e-4, 0.0, 0.0)  # a start with a gap: the reference knows of no permanent contact
SIGNALS = {
    "sweep": SWEEP,
    "log sweep down": SweptSine(
        first=60.0, last=30.0, duration=1.0, spacing="log", acceleration=[(20.0, 1.0), (70.0, 9.0)]
    ),
    "stepped": SteppedSine(
        frequencies=(44.0, 47.0), acceleration=4.9, settle_cycles=10, measured_cycles=20
    ),
    "random": Random(psd=[(10.0, 1.0), (200.0, 0.2)], duration=0.7, seed=5),
    "shock": Shock(peak=100.0, length=0.011, delay=0.01, duration=0.2),
    "sawtooth": Shock(peak=100.0, length=0.011, shape="sawtooth", duration=0.2),
    "samples": Sampled(
        acceleration=np.random.default_rng(1).normal(size=200).tolist(), sample_rate=400.0
    ),
}


def exact(signal):
    """The signal as a function of one time, by its definition where it has a simple one."""
    if isinstance(signal, SweptSine) and signal.spacing == "linear":  # the same, and quicker
        first, half = signal.first, 0.5 * (signal.last - signal.first) / signal.duration
        turn, level = 2.0 * math.pi, signal.acceleration
        return lambda t: level * math.sin(turn * t * (first + half * t))
    if isinstance(signal, (SweptSine, SteppedSine)):
        return lambda t: float(signal(t))
    pieces = signal.pieces(1e-10)  # its own test shows that these are the signal
    return lambda t: float(pieces(np.array([t]))[0])


def linear_motion(mass, spring, damper, signal, times):
    """Displacement of one oscillator in the box, by DOP853."""

    def rates(t, y):
        return [y[1], -(spring * y[0] + damper * y[1]) / mass - acceleration(t)]

    acceleration = exact(signal)
    y, found = [0.0, 0.0], []
    pulse = isinstance(signal, Shock)  # at its corners the integration begins anew
    corners = [signal.delay, signal.delay + signal.length] if pulse else []
    ends = sorted({0.0, *corners, float(times[-1])})
    for begin, end in pairwise(ends):
        inside = times[(times >= begin) & ((times < end) | (end == ends[-1]))]
        grid = np.union1d(inside, [end])
        run = solve_ivp(
            rates, (begin, end), y, "DOP853", grid, rtol=1e-11, atol=1e-14, max_step=1e-3
        )
        found.append(run.y[0, : len(inside)])
        y = run.y[:, -1]
    return np.concatenate(found)


@pytest.mark.parametrize("name", ordinary(SIGNALS, ["sweep", "shock"]))
def test_bonded_structure_is_the_linear_oscillator(name):
    signal = SIGNALS[name]
    data = shake(BEAM.as_bonded(), signal, sample_rate=500.0, accuracy=1e-8, progress=False)
    sums = [getattr(BEAM, x + "1") + getattr(BEAM, x + "2") for x in "mkd"]
    expected = linear_motion(*sums, signal, data.time.values)
    assert np.abs(data.x1.values - expected).max() <= 1e-7 * np.abs(expected).max()
    assert (data.x1 == data.x2).all() and data.sizes["impact"] == 0
    box = [exact(signal)(t) for t in data.time.values[1:]]
    peak = np.abs(box).max()
    assert np.abs(data.box_acceleration.values[1:] - box).max() <= 1e-7 * peak
    felt = -(sums[1] * data.x1 + sums[2] * data.v1) / sums[0]
    assert np.allclose(data.a1_abs, felt, rtol=1e-12, atol=1e-12)


def reference(structure, signal):
    """The motion from ``OPEN`` by the solver that is written without the kernel."""
    return Motion(structure.parameters() | {"x2_start": OPEN[1]}, exact(signal))


@pytest.mark.parametrize("seed", ordinary(range(20), [0, 2]))
def test_impacts_of_a_swept_sine_are_those_of_an_independent_integration(seed):
    """All impacts up to chaos, to 1e-7 of a period."""
    structure = random_structure(seed)
    first = structure.f1 * np.random.default_rng(seed + 1000).uniform(0.7, 1.0)
    signal = SweptSine(first=first, last=1.4 * first, duration=0.4, acceleration=5.0)
    data = shake(structure, signal, start=OPEN, accuracy=1e-10, progress=False)
    motion = reference(structure, signal).run(float(data.time[-1]))
    impacts, sticks = np.array(motion.impacts), np.array(motion.sticks)
    times = data.impact_time.values
    times = times[times <= float(data.time[-1])]  # the excitation goes on to its end
    alike = min(len(times), len(impacts))
    away = np.abs(times[:alike] - impacts[:alike]) * structure.f1
    chaos = np.flatnonzero(away > 1e-7)
    regular = int(chaos[0]) if len(chaos) else alike
    assert regular >= 5
    assert regular < alike or len(times) == len(impacts)
    # what differs has grown by itself, as in chaos: never more than a factor of 1000 an impact
    assert regular == alike or away[regular] <= 1e3 * max(away[regular - 1], 1e-11)
    assert (data.sticks.values[:regular] == sticks[:regular]).all()


@pytest.mark.parametrize("seed", ordinary(range(20)))
def test_sticking_and_release_are_those_of_an_independent_integration(seed):
    """The whole motion with its sticking and releases, to 1e-6 of the peak."""
    structure = random_structure(seed, (0.05, 0.35), (0.01, 0.04))
    first = structure.f1 * np.random.default_rng(seed + 1000).uniform(0.3, 0.5)
    signal = SweptSine(first=first, last=1.2 * structure.f1, duration=0.25, acceleration=5.0)
    data = shake(structure, signal, start=OPEN, accuracy=1e-10, progress=False)
    motion = reference(structure, signal)
    states = np.array([motion.run(time).state.copy() for time in data.time.values])
    found = np.stack([data[name].values for name in ("x1", "v1", "x2", "v2")], axis=1)
    away = float((np.abs(found - states) / np.abs(states).max(axis=0)).max())
    whole = data.impact_time.values <= float(data.time[-1])  # the excitation goes on to its end
    assert (data.sticks.values[whole] == motion.sticks).all() and sum(motion.sticks) >= 4
    assert away <= 1e-6
    assert np.abs(data.impact_time.values[whole] - motion.impacts).max() * structure.f1 <= 1e-6


@pytest.mark.parametrize("name", SIGNALS)
def test_the_record_does_not_change_the_motion(name):
    """Not the sampling rate, not the parts in which it is computed: to the last bit."""
    data = shake(BEAM, SIGNALS[name], sample_rate=300.0, progress=False)
    assert "Omega" not in title_from_attributes(data)  # no force has a frequency here
    finer = shake(BEAM, SIGNALS[name], sample_rate=900.0, progress=False)
    for column in ("x1", "x2", "v1", "v2", "contact_force", "a1_abs"):
        assert (data[column].values == finer[column].values[::3]).all(), column
    for column in ("impact_time", "impact_velocity", "impulse", "sticks"):
        assert (data[column].values == finer[column].values).all(), column


def test_transient_time_is_when_a_thousandth_is_left():
    bonded = BEAM.as_bonded()
    data = shake(bonded, Shock(peak=100.0, length=0.005, duration=8.0), sample_rate=2000.0)
    end = float(data.transient_time)
    energy = np.hypot(data.x1, data.v1 / (2.0 * math.pi * 48.0)).values
    late = energy[np.searchsorted(data.time.values, end + 0.005)]
    assert math.isclose(late / energy[20], 1e-3, rel_tol=0.1)
    undamped = Structure(d1=0.0)
    assert transient_time(undamped) == math.inf


@pytest.mark.parametrize("rate", [400.0, 1e3, 1234.5, 1e4 / 3.0, 20.0])
def test_parts_of_the_record_are_the_whole_record(rate):
    """Where a time of reading is a node of the pieces as well, or none lies in a piece."""
    asked = {"structure": BEAM, "excitation": SIGNALS["samples"], "start": (0.0,) * 4}
    job = ShakeJob(name="", **asked, sample_rate=rate, accuracy=1e-6)
    nodes = job.pieces.nodes
    cuts = [0.0, *nodes[[1, 2, 30, 31, len(nodes) // 2]], math.inf]
    parts = [job.sample_times(one, other) for one, other in pairwise(cuts)]
    np.testing.assert_array_equal(np.concatenate(parts), job.sample_times())
    assert (
        np.all(np.diff(job.sample_times()) > 0.0) and job.sample_times()[-1] <= job.pieces.duration
    )
    assert job.sample_times()[-1] + 1.0 / rate > job.pieces.duration


def test_the_last_sample_is_not_lost_by_rounding():
    """14 periods of 50 samples: 700/rate is above the duration by a digit in one of nine sweeps."""
    for first in np.random.default_rng(0).uniform(5.0, 80.0, 100).tolist():
        sweep = SweptSine(first=first, last=1.1 * first, duration=14 / first, acceleration=1.0)
        asked = {"structure": BEAM, "excitation": sweep, "start": (0.0,) * 4}
        times = ShakeJob(name="", **asked, sample_rate=50.0 * first, accuracy=1e-6).sample_times()
        assert len(times) == 701 and 0.0 <= sweep.duration - times[-1] < 1e-14
