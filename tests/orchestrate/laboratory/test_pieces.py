"""Cubic pieces: they are as near to their signal as they say, for all kinds of excitation."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import orchestrate
from orchestrate import Random, Sampled, Shock, SteppedSine, SweptSine
from orchestrate.units import Units

ACCURACY = st.floats(-8.0, -2.0).map(lambda power: 10.0**power)
HERTZ = st.floats(0.1, 500.0)


def times_within(duration, seed=1, count=4000):
    return np.sort(np.random.default_rng(seed).uniform(0.0, duration, count))


@st.composite
def sweeps(draw):
    first, last = draw(HERTZ), draw(HERTZ)
    assume(first != last)
    level = draw(st.one_of(st.floats(0.1, 50.0), st.just("profile")))
    if level == "profile":
        ends = 0.09, 600.0
        middle = draw(st.floats(0.2, 400.0))
        values = draw(st.tuples(*[st.floats(0.1, 10.0)] * 3))
        level = tuple(zip((ends[0], middle, ends[1]), values, strict=True))
    duration = draw(st.floats(5.0, 200.0)) / min(first, last)
    duration = min(duration, 20_000.0 / max(first, last))
    spacing = draw(st.sampled_from(["linear", "log"]))
    return SweptSine(first=first, last=last, acceleration=level, duration=duration, spacing=spacing)


@st.composite
def stepped_sines(draw):
    cycles = {"settle_cycles": draw(st.integers(0, 30)), "measured_cycles": 5}
    level = draw(st.sampled_from([3.0, ((0.05, 1.0), (3.0, 8.0), (600.0, 2.0))]))
    frequencies = draw(st.lists(HERTZ, min_size=1, max_size=6))
    return SteppedSine(frequencies=frequencies, acceleration=level, **cycles)


@settings(deadline=None)
@given(st.one_of(sweeps(), stepped_sines()), ACCURACY)
def test_a_sine_is_within_its_bound(sine, accuracy):
    pieces = sine.pieces(accuracy)
    times = times_within(sine.duration)
    peak = float(sine.level(np.linspace(0.0, sine.duration, 200_001)).max())
    distance = np.abs(pieces(times) - sine(times)).max()
    phase_rounding = 1e-15 * float(sine.phase(sine.duration))
    assert distance <= pieces.error + (1e-13 + phase_rounding) * peak
    assert pieces.error <= 1.02 * accuracy * peak  # what was asked for


def test_swept_sine_is_the_standard_one():
    sweep = SweptSine(first=20.0, last=90.0, duration=7.0, acceleration=4.0)
    t = times_within(7.0)
    phase = 2.0 * math.pi * (20.0 * t + (90.0 - 20.0) * t**2 / (2.0 * 7.0))
    assert np.allclose(sweep(t), 4.0 * np.sin(phase), rtol=0.0, atol=1e-10)
    from scipy.signal import chirp

    log = SweptSine(first=90.0, last=20.0, duration=7.0, acceleration=4.0, spacing="log")
    expected = 4.0 * chirp(t, 90.0, 7.0, 20.0, method="logarithmic", phi=-90.0)
    assert np.allclose(log(t), expected, rtol=0.0, atol=1e-9)


STEPPED = SteppedSine(
    frequencies=(20.0, 31.0, 25.0), acceleration=4.0, settle_cycles=7, measured_cycles=5
)


def test_a_stepped_sine_neither_jumps_nor_drifts():
    """Acceleration and velocity go on where the frequency changes; the place stays bounded."""
    pieces = STEPPED.pieces(1e-8)
    assert pieces.duration == STEPPED.duration == STEPPED.measured_times()[-1, 1]
    for change in STEPPED.measured_times()[:-1, 1]:
        before, after = pieces.derivatives_at(np.array([change - 1e-9, change + 1e-9]))
        assert abs(before[0] - 4.0) < 1e-6 and abs(after[0] - 4.0) < 1e-6
    h = np.diff(pieces.nodes)
    a, b, c, d = pieces.derivatives.T
    gained = h * (a + h * (b / 2.0 + h * (c / 6.0 + h * d / 24.0)))
    start = -4.0 / (2.0 * math.pi * 20.0)  # of a box that has long moved as the first sine does
    velocity = start + np.concatenate([[0.0], np.cumsum(gained)])
    moved = h * velocity[:-1] + h**2 * (a / 2.0 + h * (b / 6.0 + h * (c / 24.0 + h * d / 120.0)))
    place = np.cumsum(moved)
    assert np.abs(velocity).max() < 1.001 * abs(start)
    assert np.abs(place).max() < 2.001 * 4.0 / (2.0 * math.pi * 20.0) ** 2


PROFILE = ((20.0, 0.5), (80.0, 2.0), (200.0, 0.1))


def sines(shaking):
    """Amplitudes, angular frequencies and phases of its sines, by the definition alone."""
    f = np.arange(math.floor(200.0 * shaking.duration) + 1) / shaking.duration
    corners, values = np.log(np.array(shaking.psd)).T
    inside = (f >= shaking.psd[0][0]) & (f <= shaking.psd[-1][0])
    density = np.exp(np.interp(np.log(np.maximum(f, 1e-9)), corners, values)) * inside
    phases = np.random.default_rng(shaking.seed).uniform(0.0, 2.0 * math.pi, len(f))
    return np.sqrt(2.0 * density / shaking.duration), 2.0 * math.pi * f, phases


@given(st.floats(1e-6, 1e6))
def test_random_vibration_has_the_rms_asked_for(rms):
    shaking = Random(psd=PROFILE, duration=2.0, rms=rms)
    amplitudes, *_ = sines(shaking)
    assert shaking.rms == rms
    assert np.sqrt(0.5 * (amplitudes**2).sum()) == pytest.approx(rms, rel=1e-9)
    ratios = np.array(shaking.psd)[:, 1] / np.array(PROFILE)[:, 1]
    np.testing.assert_allclose(ratios, ratios[0])


@settings(deadline=None)
@given(st.floats(0.5, 8.0), st.integers(0, 1000), ACCURACY)
def test_random_vibration_within_its_bound(duration, seed, accuracy):
    shaking = Random(psd=PROFILE, duration=duration, seed=seed)
    amplitudes, omega, phases = sines(shaking)
    times = times_within(duration, count=500)
    exact = np.cos(np.outer(times, omega) + phases) @ amplitudes
    pieces = shaking.pieces(accuracy)
    assert np.abs(pieces(times) - exact).max() <= pieces.error + 1e-11 * shaking.rms
    assert pieces.error <= 30.0 * accuracy * shaking.rms * math.sqrt(3.0)


@pytest.mark.parametrize(
    ("shape", "area"), [("half-sine", 2.0 / math.pi), ("sawtooth", 0.5), ("trapezoid", 0.9)]
)
def test_shocks(shape, area):
    shock = Shock(peak=50.0, length=0.011, shape=shape, delay=0.003)
    pieces = shock.pieces()
    a, b, c, d = pieces.derivatives.T
    h = np.diff(pieces.nodes)
    change = (h * (a + h * (b / 2.0 + h * (c / 6.0 + h * d / 24.0)))).sum()
    assert math.isclose(change, area * 50.0 * 0.011, rel_tol=1e-5)
    assert shock.duration == pytest.approx(0.003 + 20 * 0.011)
    times = times_within(shock.duration)
    part = (times - 0.003) / 0.011
    exact = {
        "half-sine": 50.0 * np.sin(np.pi * part),
        "sawtooth": 50.0 * part,
        "trapezoid": 50.0 * np.clip(np.minimum(10.0 * part, 10.0 * (1.0 - part)), None, 1.0),
    }[shape]
    expected = np.where((part >= 0.0) & (part <= 1.0), exact, 0.0)
    assert np.abs(pieces(times) - expected).max() <= pieces.error + 1e-11


def test_sampled_acceleration_goes_through_its_samples_smoothly():
    values = np.random.default_rng(2).normal(size=50)
    pieces = Sampled(acceleration=values, sample_rate=100.0).pieces()
    assert np.allclose(pieces.derivatives[:, 0], values[:-1])
    ends = pieces.derivatives_at(pieces.nodes[1:-1] - 1e-12)
    starts = pieces.derivatives_at(pieces.nodes[1:-1])
    for order, size in ((0, 1e-8), (1, 1e-6), (2, 1e-3)):
        assert np.abs(ends[:, order] - starts[:, order]).max() < size


@pytest.mark.parametrize("odd", [np.ma.array([1.0, 2.0], mask=[True, False]), np.ma.masked])
def test_what_is_no_number_or_list_is_refused_in_one_line(odd):
    """It was Python's ValueError or TypeError."""
    sweep = {"first": 1.0, "last": 2.0, "acceleration": 1.0}
    sine, made = SweptSine(**sweep, duration=1.0), {"acceleration1": [0.0, 1.0, 0.0, -1.0]}
    for call in (
        lambda: orchestrate.Hammer(peak=1.0, width=0.1, duration=odd),
        lambda: Shock(peak=1.0, length=0.1, duration=odd),
        lambda: SweptSine(**sweep, duration=odd),
        lambda: SweptSine(**sweep, rate=odd),
        lambda: SteppedSine(frequencies=odd, acceleration=1.0),
        lambda: Sampled(acceleration=odd, sample_rate=1.0),
        lambda: orchestrate.shake(orchestrate.Structure(), sine, frequency=odd),
        lambda: orchestrate.write_record(orchestrate.record(**made, sample_rate=1.0), odd),
        lambda: Units.from_text(odd),
        lambda: Random(psd=PROFILE, duration=2.0, rms=0.0),  # its pieces had no numbers
    ):
        with pytest.raises(orchestrate.InputError, match="expected"):
            call()


@pytest.mark.parametrize("nothing", [np.float64(0.0), np.int64(0), np.array(0)])
def test_a_zero_of_numpy_is_a_duration_that_is_not_given(nothing):
    sweep = SweptSine(first=10.0, last=14.0, rate=2.0, duration=nothing, acceleration=1.0)
    assert sweep.duration == 2.0
    shock = {"peak": 1.0, "length": 0.1}
    assert Shock(**shock, duration=nothing).duration == Shock(**shock).duration


def test_a_weak_random_vibration_has_pieces_that_are_numbers():
    weak = Random(psd=[(20.0, 1e24), (1e4, 1e24)], duration=0.1, rms=1e-120)
    assert 0.0 < np.abs(weak.pieces().derivatives[:, 0]).max() < 1e-119


def test_sum_of_signals():
    sweep = SweptSine(first=5.0, last=9.0, duration=2.0, acceleration=1.0)
    shock = Shock(peak=3.0, length=0.1, delay=0.5)
    both = (sweep + shock).pieces()
    times = times_within(3.0)
    alone = sweep.pieces()(times) + shock.pieces()(times)
    assert np.abs(both(times) - alone).max() < 1e-12
    assert both.error == sweep.pieces().error + shock.pieces().error
    assert (sweep + shock).duration == shock.duration == both.duration
    three = sweep + shock + sweep
    assert len(three.parts) == 3 and three.usual_rate == shock.usual_rate
