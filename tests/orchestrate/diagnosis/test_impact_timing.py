"""What strikes, by its timing, on benches that share no dynamics with the package."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from orchestrate.constants import TURN
from orchestrate.diagnosis import impact_timing
from orchestrate.diagnosis.impact_timing import (
    TIMING,
    Strikes,
    measure_strikes,
    power_over_phase,
    project_on_waves,
    rest_frequency_and_stiffness,
    strikes_of_sensor,
)
from orchestrate.diagnosis.order_windows import checked_base_and_faces
from orchestrate.laboratory.analysis.channels import Channels
from tests.benches import recipe
from tests.benches.strikers import STRIKERS

from ...sparing import ordinary

KINDS = {**recipe.KINDS, **STRIKERS}
FACES = Strikes(
    heard=60.0, base=1.2, locked=0.99, one_sided=0.85, blow=0.5, opposite=math.nan,
    order2=0.2, stiffens=0.0, from_shut=-0.1, place=0.5, spread=0.1, stiffness=1.0,
)  # fmt: skip
WORDS = {  # on both sides of each threshold
    "nothing heard": [{"heard": 2.9}, {"heard": 4.9, "locked": 0.61}],
    "something faint": [{"heard": 3.1}, {"heard": 9.9}, {"heard": 5.1, "locked": 0.61}],
    "base strikes": [{"base": 16.0}],
    "not locked": [{"locked": 0.61}, {"one_sided": 0.58}, {"locked": 0.61, "opposite": -0.99}],
    "kinks": [{"blow": 0.27}, {"blow": 0.27, "opposite": -0.99}],
    "something small strikes": [{"order2": 0.024}],
    "stop": [
        {"stiffens": 0.26, "place": 0.81, "spread": 0.14},
        {"stiffens": 0.26, "place": 0.79, "spread": 0.16},
        {"stiffens": 1.51, "place": 0.81, "spread": 0.16},
        {"stiffens": -0.14},
        {"stiffens": -0.14, "place": -0.79},
        {"order2": 0.44, "place": -0.79},
        {"stiffens": 0.26, "place": -0.81},
        {"stiffens": 0.8, "base": 14.9},
        {"stiffens": 0.8, "stiffness": math.nan, "opposite": 0.9},
        {"stiffens": -0.14, "opposite": -0.98},  # clamps that twist make such blows too
        {"stiffens": 0.8, "place": 0.81, "from_shut": -0.25},
        {"stiffens": 0.8, "from_shut": -0.27, "opposite": -0.98},
    ],
    "stop or softer face": [
        {"stiffness": math.nan},
        {"stiffness": 1.07},
        {"stiffness": 0.82},
        {"opposite": 0.01},
        {"opposite": -0.94, "stiffness": math.nan},
    ],
    "faces strike": [
        {"heard": 10.1, "base": 2.9, "locked": 0.63, "one_sided": 0.6, "blow": 0.29},
        {"order2": 0.026, "stiffens": 0.24, "stiffness": 1.05},
        {"stiffens": -0.12, "stiffness": 0.84},
        {"stiffens": -9.0, "place": -0.81},
        {"order2": 0.44, "place": 0.81},
        {"order2": 0.42},
        {"stiffens": 1.49, "place": 0.81, "spread": 0.16},
        {"stiffens": 9.0, "place": 0.81, "from_shut": -0.27},  # softer than shut faces
        {"stiffens": 0.24, "from_shut": -9.0},
        {"opposite": -0.01},
        {"heard": 3.5, "opposite": -0.96, "stiffens": 0.8, "order2": 0.01, "stiffness": math.nan},
    ],
}


def strikes_of(monkeypatch, windows):
    """What is said of made-up windows: how far the bins rise, power, peak and stroke."""
    rest = 0.9, 0.5, 0.1, math.nan, 1.0, 1.0
    rows = [(*bins, power, peak, *rest, stroke) for *bins, power, peak, stroke in windows]
    monkeypatch.setattr(impact_timing, "window_quantities", lambda *given: iter(rows))
    return strikes_of_sensor(None, [0], 40.0, TIMING)


@pytest.mark.parametrize(
    ("power", "stroke", "heard", "locked"),
    [
        *((0.29, 1.0, 9.0, 1.0), (0.31, 1.0, 9.0, 0.53), (0.31, 0.051, 9.0, 0.53)),
        *((0.31, 0.049, 9.0, 1.0), (3.0, 0.049, 9.0, 1.0)),
        *((0.31, 1.0, 1.01, 0.53), (0.31, 1.0, 0.99, 1.0)),
    ],
)
def test_windows_count_that_are_loud_and_move(monkeypatch, power, stroke, heard, locked):
    """Two windows whose peaks are opposite: the second one counts from `loud` and `moves` on, and
    where its bin rises over the limit of noise.

    At a sweep's ends, where the base stops, noise alone made 22 in sound beams, at 5 and 10 kHz.
    """
    both = (9.0, 1.0, 1.0, 0.0, -1.0), (heard, 1.0, power, math.pi, -stroke)
    assert strikes_of(monkeypatch, both).locked == pytest.approx(locked, abs=0.01)


def test_a_window_in_which_noise_peaks_is_no_base_that_strikes(monkeypatch):
    """A rubbing sound beam, 14 samples in a period: the base's noise made 3.9 in one of many."""
    for base, expected in (((1.2, 3.9, 1.1), 1.2), ((3.9, 3.8, 1.1), 3.8)):
        made = [(9.0, one, 1.0, 0.0, -1.0) for one in base]
        assert strikes_of(monkeypatch, made).base == expected


@pytest.mark.parametrize(("samples", "bins"), [(96, 32), (64, 16), (16, 16)])
def test_the_loudest_bin_is_compared_with_the_quietest_third(samples, bins):
    """Over what noise makes of it once in 10,000 windows; with three samples in a bin or more."""
    number, each = np.arange(bins), samples // bins
    power, middle = 1.0 + 7 * number % bins, TURN * (number + 0.5) / bins  # 1 to 32, in disorder
    both = [np.sqrt(power).repeat(each), -1.0 * (np.arange(samples) % each > 0)]
    found = power_over_phase(both, TURN * (5.0 + (np.arange(samples) + 0.5) / samples), TIMING)
    floor, limit = np.sort(power)[: bins // 3].mean(), chi2.isf(1e-4 / bins, each) / each
    above, place = np.maximum(power - floor, 0.0), middle[power.argmax()]
    moment = abs(above @ np.exp(1j * middle)) / above.sum()
    rise, opposite = bins / floor / limit, -math.sqrt(1.0 - 1.0 / each)
    assert found == pytest.approx((rise, bins - floor, place, moment, opposite))
    few = power_over_phase([np.array([1.0, 1.0, 3.0])], TURN * np.array([0.1, 0.2, 0.3]), TIMING)
    assert few[2] == pytest.approx(TURN * 4.5 / 16)  # of a record too slow to fill its bins


def test_noise_alone_is_far_below_a_strike():
    """White noise in 10 periods: the loudest of 32 bins, and of records too slow to judge."""
    rng = np.random.default_rng(3)
    for count, most in ((1024, 0.7 * TIMING.faint), (60, TIMING.heard)):
        phase = 10.0 * TURN * np.arange(count) / count
        rises = [
            power_over_phase([rng.standard_normal(count)], phase, TIMING)[0] for _ in range(500)
        ]
        assert max(rises) < most


def swept_channels(face, samples):
    """Return channels of a base at 45 Hz and a face, of some samples in a period."""
    turns = np.arange(len(face)) / samples
    names, values = ("box_acceleration", "acceleration1"), np.array([np.sin(TURN * turns), face])
    return Channels(turns / 45.0, 45.0 * samples, names, values, "")


def test_a_blow_is_the_median_of_orders_6_to_12_over_order_2():
    """Over its root over order 1; of 20 samples in a period up to order 8, at 0.45 of the rate."""
    for samples, expected in ((40, 0.9), (20, 0.7)):
        phase = TURN * np.arange(3000) / samples
        face = 20.0 * np.sin(phase) + np.sin(2.0 * phase)
        face += sum(
            0.1 * order * np.sin(order * phase) for order in range(3, min(13, samples // 2))
        )
        found = strikes_of_sensor(swept_channels(face, samples), [1], 45.0, TIMING)
        assert found.blow == pytest.approx(expected * math.sqrt(19.0), rel=0.01)


@pytest.mark.parametrize(("samples", "memory"), [(100, 27), (15, 4), (10, 4)])
def test_lengths_are_parts_of_the_period(monkeypatch, samples, memory):
    """Of 100 samples a period, blows are predicted from 27, in windows of ten periods, 32 bins."""
    face = 2.0 * np.sin(TURN * np.arange(62 * samples) / samples)
    face[int(0.31 * samples) :: samples] += 1.0
    lengths, predicted, cuts = [], impact_timing.prediction_error, []
    integrate_in_time = impact_timing.integrate_in_time

    def prediction(signal, order):
        lengths.append((len(signal), order))
        return predicted(signal, order)

    monkeypatch.setattr(impact_timing, "prediction_error", prediction)
    monkeypatch.setattr(
        impact_timing,
        "integrate_in_time",
        lambda *all: cuts.append(all[2:]) or integrate_in_time(*all),
    )
    found = strikes_of_sensor(swept_channels(face, samples), [1], 45.0, TIMING)
    assert {order for _, order in lengths} == {memory}
    assert [length for length, _ in lengths] == pytest.approx([10 * samples] * 2 * 5, abs=2)
    own = (0.31 - 0.75) % 1.0  # of a period after the top of the stroke
    expected = math.cos((math.floor(32 * own) + 0.5) / 32 * TURN)
    assert samples < 100 or found.place == pytest.approx(expected, abs=0.005)
    assert cuts == [(pytest.approx(0.5 * TURN * 45.0, rel=0.02), 2)]  # twice, from half an order on


def test_the_sensor_that_hears_most_is_asked(monkeypatch):
    heard = lambda channels, rows, *rest: replace(FACES, heard=(9.0, 3.0, 5.0)[rows[0]])  # noqa: E731
    monkeypatch.setattr(impact_timing, "strikes_of_sensor", heard)
    names = ("box_acceleration", "acceleration1", "acceleration2")
    channels = Channels(np.zeros(1), 1.0, names, np.zeros((3, 1)), "")
    assert measure_strikes(channels).heard == 5.0


def test_one_window_by_itself_does_not_move_the_place(monkeypatch):
    """A stop at the end of the stroke was taken for faces: one window of ten had its peak off."""
    for off, expected in ((1, 0.0), (2, 0.3), (3, 1.5), (8, 0.3), (9, 0.0)):
        peaks = [2.0 * math.pi / 3.0] * off + [0.0] * (10 - off)
        made = [(9.0, 1.0, 1.0, peak, -1.0) for peak in peaks]
        assert strikes_of(monkeypatch, made).spread == pytest.approx(expected)


@pytest.mark.parametrize("word", WORDS)
def test_each_quantity_has_its_word(word):
    for changes in WORDS[word]:
        assert replace(FACES, **changes).what_strikes() == word, changes


def test_an_offset_is_in_no_order_of_a_sweep():
    phase = 20.0 * np.pi * np.linspace(0.0, 1.0, 900) ** 1.2
    waves, face = np.exp(-1j * np.outer([1, 2], phase)), np.sin(phase)
    assert project_on_waves(face + 9.8, waves) == pytest.approx(
        project_on_waves(face, waves), abs=1e-12
    )
    assert abs(project_on_waves(face, waves)) == pytest.approx([1.0, 0.0], abs=0.01)


@pytest.fixture(autouse=True)
def short(monkeypatch):
    """Half as long sweeps of the benches."""
    monkeypatch.setattr(recipe, "DURATION", 20.0)


def timed(kind, seed, sensors=1):
    """Draw a record of a kind; return what strikes in it, shut faces' frequency 3 % uncertain."""
    rng = np.random.default_rng([seed, 17])
    (case,) = recipe.draw_levels(rng, kind, recipe.Conditions(sensors=sensors), kinds=KINDS)
    truth, guess = case.truth.halves, case.guess
    masses, turns = np.array([guess.m1, guess.m2]), np.array([truth.f1, truth.f2])
    shut = math.sqrt((masses * turns**2).sum() / masses.sum()) * rng.uniform(0.97, 1.03)
    return measure_strikes(checked_base_and_faces(case.record), shut)


def windows(part=0.5, growth=0.2, count=60):
    """Order 1 of a mass whose stiffness has grown in ten windows about its resonance of 1 rad/s."""
    turns, loud = np.linspace(0.5, 1.6, count), np.arange(count) // 10 == 2
    stroke = -1.0 / (1.0 + growth * loud - turns**2 + 0.02j * turns)
    return np.array([-part * turns**2 * stroke, np.ones(count), part * stroke]), loud


@pytest.mark.parametrize("quiet", [0, 7, 8, 50])
@pytest.mark.parametrize("loudest", [True, False])
def test_a_participation_is_told_by_the_windows_in_which_nothing_strikes(quiet, loudest):
    """Near the loud ones: if these are eight, else by those that move less than half of them."""
    motion, loud = windows()
    size, turns = abs(motion[2]), np.sqrt(abs(motion[0] / motion[2]))
    struck = size == size.max() if loudest else loud
    near = abs(np.log(turns / np.median(turns[struck]))) <= math.log(TIMING.near)
    mask = ~struck & (np.cumsum(near & ~struck) <= quiet)
    rest, squares = rest_frequency_and_stiffness(motion, struck, mask, TIMING)
    used = np.zeros(60, bool)
    for k in range(60):
        off = np.array(motion)
        off[0, k] *= 1.0001
        used[k] = (
            abs(rest_frequency_and_stiffness(off, struck, mask, TIMING)[0] / rest - 1.0) > 1e-9
        )
    least = near & (size <= max(0.5 * size[struck].min(), np.quantile(size[near], 1.0 / 3.0)))
    assert used.tolist() == (near & mask if (near & mask).sum() > 7 else least).tolist()
    growth = (TURN * np.sqrt(squares)) ** 2 - 1.0
    assert loudest or rest == pytest.approx(0.5 / math.pi, rel=0.015)
    assert loudest or growth == pytest.approx(np.where(loud, 0.2, 0.0), abs=0.03)


def test_at_one_frequency_a_participation_is_1():
    """There the windows do not tell it from the stiffness."""
    motion = windows()[0][:, :1] * np.linspace(1.0, 2.0, 60)
    rest, _ = rest_frequency_and_stiffness(motion, np.arange(60) == 0, np.ones(60, bool), TIMING)
    moved, base, stroke = motion[:, 0]
    assert TURN * rest == pytest.approx(math.sqrt(-((moved + base) / stroke).real), rel=1e-4)
    # strokes that differ by as little as 1 weighs: midway between it and the true one of 0.5
    size, base = 1.0 + 1e-3 * (-1.0) ** np.arange(60), 3.0
    motion = np.array([-(0.5 * base + size), np.full(60, base), size + 0j])
    rest, _ = rest_frequency_and_stiffness(motion, np.arange(60) == 0, np.ones(60, bool), TIMING)
    assert TURN * rest == pytest.approx(math.sqrt(1.0 - 0.25 * base), rel=1e-3)


@pytest.mark.parametrize(("factor", "is_near"), [(1.4, True), (1.5, False)])
def test_the_beam_at_rest_is_measured_near_the_loud_windows(factor, is_near):
    """Of a long delamination windows were quiet at 2.6 resonances only, where others move it."""
    motion, loud = windows(growth=0.0, count=2000)
    turns = np.sqrt(abs(motion[0] / motion[2]))
    quiet = turns > factor * np.median(turns[loud])
    motion[0, quiet] -= 0.03 * motion[2, quiet]  # as if the beam were stiffer
    found = rest_frequency_and_stiffness(motion, loud, quiet, TIMING)[0] * TURN
    assert found == pytest.approx(math.sqrt(1.03 if is_near else 1.0), abs=0.003)


@pytest.mark.parametrize(("growth", "shut"), [(0.0, math.nan), (0.2, 1.157), (-0.2, 0.9)])
def test_a_growth_is_counted_from_rest_and_from_the_least_stiffness_of_shut_faces(
    monkeypatch, growth, shut
):
    """By an order 2 of a fifth; the frequency of shut faces is known to 3 %."""
    motion, loud = windows(growth=growth)
    rest = np.ones(60), 9.0 * loud, np.zeros(60), np.ones(60), np.ones(60), np.full(60, 0.2)
    rows = zip(np.where(loud, 9.0, 0.5), *rest, np.full(60, math.nan), *motion, strict=True)
    monkeypatch.setattr(impact_timing, "window_quantities", lambda *given: iter(rows))
    found = strikes_of_sensor(None, [0], shut / TURN, TIMING)
    assert found.stiffens == pytest.approx(growth / 0.2, abs=0.05)
    from_shut = ((1.0 + growth) / (0.97 * shut) ** 2 - 1.0) / 0.2
    assert found.from_shut == pytest.approx(from_shut, abs=0.05, nan_ok=True)
    stiffness = math.sqrt(1.0 + growth) / shut
    assert found.stiffness == pytest.approx(stiffness, abs=0.01, nan_ok=True)


def test_beams_of_other_frequencies_have_the_same_numbers():
    """Six milliseconds were a fifteenth of a period at 12 Hz: blows were not told as opposite."""
    (case,) = recipe.draw_levels(np.random.default_rng(5), "delaminated")
    channels = checked_base_and_faces(case.record)
    slow = replace(channels, time=4.0 * channels.time, sample_rate=0.25 * channels.sample_rate)
    expected, found = measure_strikes(channels, 45.0), measure_strikes(slow, 11.25)
    assert expected.heard > 20.0
    assert list(vars(found).values()) == pytest.approx([*vars(expected).values()], nan_ok=True)


OTHERS = ["sound", "crack", "play", "fixture", "bearing", "washer"]


@pytest.mark.parametrize("kind", ["delaminated", "stop", *ordinary(OTHERS)])
def test_faces_are_told_from_stops_and_kinks(kind):
    """Order 2, bursts and misfits of both overlap; where and when they strike does not."""
    word = timed(kind, 203).what_strikes()
    assert (word == "faces strike") == (kind == "delaminated"), word
    assert (word == "stop") == (kind in ("stop", "play")), word


@pytest.mark.parametrize("kind", ["delaminated", "stop"])
def test_two_faces_are_struck_in_opposite_directions(kind):
    struck = timed(kind, 203, sensors=2)
    assert struck.opposite < -0.97 if kind == "delaminated" else struck.opposite > 0.9
    assert (struck.what_strikes() == "faces strike") == (kind == "delaminated")
