"""Thresholds of the notes on gains, samples and lines of the mains: just inside, just outside."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.constants import TURN
from orchestrate.diagnosis import wiring
from orchestrate.diagnosis.wiring import WIRING, LowResponse
from orchestrate.laboratory.analysis.channels import Channels

RATE = 512.0
BASE, FACE = "box_acceleration", "acceleration1"


@pytest.mark.parametrize(
    ("factor", "delay", "kinds"),
    [
        (9.80665 * math.exp(0.24), 0.0, ["unit"]),
        (9.80665 * math.exp(0.26), 0.0, ["scale"]),
        (math.exp(-0.24) / 9.80665, 0.0, ["unit"]),
        (math.exp(-0.26) / 9.80665, 0.0, ["scale"]),
        (2.49, 0.0, []),
        (2.51, 0.0, ["scale"]),
        (1.0 / 2.49, 0.0, []),
        (1.0 / 2.51, 0.0, ["scale"]),
        (-1.0, 0.0, ["polarity"]),
        (1.0, 0.99e-3, []),
        (1.0, -1.01e-3, ["delay"]),
        (1.0, 0.01 * 7.4 / (2.0 * math.pi * 10.0), []),  # below 7.5 times the misfit's phase
        (1.0, 0.01 * 7.6 / (2.0 * math.pi * 10.0), ["delay"]),
    ],
)
def test_each_threshold_of_a_gain_and_a_delay(factor, delay, kinds):
    misfit = 0.01 if abs(delay) > 1.1e-3 else 0.0
    fit = LowResponse(10.0, factor, delay, misfit)
    assert [note.kind for note in fit.notes("face 1", WIRING)] == kinds


def orders(face, base, floor=0.0):
    """Orders of a record whose windows have some amplitudes of order 1."""
    face, base = np.array(face, dtype=complex), np.array(base, dtype=complex)
    return SimpleNamespace(
        channels=SimpleNamespace(names=(FACE,)),
        amplitude=face[None, None, :],
        floor=np.full((1, len(face)), floor),
        order_amplitudes=lambda number, name: base,
        windows=SimpleNamespace(frequency=np.linspace(10.0, 20.0, len(face))),
        level=np.ones(len(face)),
    )


@pytest.mark.parametrize(
    ("face", "base", "floor", "kinds"),
    [
        ([1.0, 1.0, 1.0, 0.1], [1.0] * 4, 0.33, []),
        ([1.0, 1.0, 0.1, 0.1], [1.0] * 4, 0.33, ["dead"]),  # in half of the windows
        ([1.0, 1.0, 1.0, 0.1], [1.0] * 4, 0.34, ["dead"]),  # three times the floor
        ([0.051] * 4, [1.0] * 4, 0.0, []),
        ([0.049] * 4, [1.0] * 4, 0.0, ["dead"]),
        ([0.049, 0.049, 0.15, 0.049], [1.0] * 4, 0.0, []),  # but with a resonance
        ([0.049, 0.049, 0.14, 0.049], [1.0] * 4, 0.0, ["dead"]),
        ([1.0] * 4, [1.0, 1.0, 3.1, 1.0], 0.0, ["swapped"]),
        ([1.0] * 4, [1.0, 1.0, 2.9, 0.5], 0.0, []),  # over the larger end
    ],
)
def test_each_threshold_of_a_dead_or_exchanged_sensor(face, base, floor, kinds):
    made = orders(face, base, floor)
    assert [note.kind for note in wiring.sensor_notes(made, 0, WIRING)] == kinds
    assert wiring.is_above_floor(made, 0, WIRING) or kinds == ["dead"]


@pytest.mark.parametrize(("highest", "fitted"), [(27.9, True), (28.1, False)])
def test_a_fit_needs_five_windows_below_seven_tenths_of_the_peak(highest, fitted):
    hertz = np.array([20.0, 22.0, 24.0, 26.0, highest, 40.0])
    response = np.where(hertz == 40.0, 9.0, 1.0).astype(complex)
    assert (LowResponse.fit(hertz, response, np.ones(6), WIRING) is not None) == fitted


@pytest.mark.parametrize("delay", [-0.011, 0.011])
def test_a_fit_knows_delays_of_many_milliseconds(delay):
    hertz = np.linspace(5.0, 40.0, 36)
    square = (hertz / 40.0) ** 2
    response = (1.0 + square / (1.02 - square)) * np.exp(-2j * np.pi * hertz * delay)
    response *= 1.0 + 0.05 * (-1.0) ** np.arange(36)
    fits = [LowResponse.fit(hertz, response, np.full(36, level), WIRING) for level in (1.0, 9.0)]
    assert fits[0].delay == pytest.approx(delay, abs=1e-3)
    assert [fit.misfit for fit in fits] == pytest.approx([0.05, 0.05], rel=0.1)


@pytest.mark.parametrize("mode", [0.12, 1.75])
def test_a_fit_knows_modes_of_any_size(mode):
    """Up to seven tenths of the peak at 40 Hz, to a third of a percent."""
    hertz = np.linspace(5.0, 40.0, 36)
    square = (hertz / 40.01) ** 2
    response = np.where(hertz < 30.0, -2.0 * (1.0 + mode * square / (1.0 - square)), 99.0 + 0j)
    fit = LowResponse.fit(hertz, response, np.ones(36), WIRING)
    assert fit.factor == pytest.approx(-2.0, rel=0.005) and fit.misfit < 0.003


@pytest.mark.parametrize(
    ("straight", "velocity", "kinds"),
    [
        *((0.14, 1.0, ["polarity"]), (0.16, 1.0, [])),  # what a fit may miss
        *((0.21, 0.139, ["quantity"]), (0.2, 0.139, [])),  # half as much again better
        *((0.9, 0.149, ["quantity"]), (0.9, 0.151, [])),
    ],
)
def test_how_well_a_fit_describes_a_sensor(monkeypatch, straight, velocity, kinds):
    misfits = iter((1.0, 1.0, straight, velocity, 1.0))  # by the power of i w, from -2 on
    fits = lambda *given: LowResponse(10.0, -1.0, 0.0, next(misfits))  # noqa: E731
    monkeypatch.setattr(LowResponse, "fit", fits)
    made = orders(np.ones(6), np.ones(6))
    assert [note.kind for note in wiring.sensor_notes(made, 0, WIRING)] == kinds


def record(values, hertz):
    """Orders of a record of one sensor, at a frequency of the base in each of its seconds."""
    time = np.arange(len(values)) / RATE
    windows = SimpleNamespace(
        time=np.arange(len(hertz)) + 0.5, frequency=np.array(hertz), parts=[slice(None)]
    )
    channels = Channels(time, RATE, (BASE,), np.asarray(values)[None], "made")
    return SimpleNamespace(channels=channels, windows=windows, level=np.ones(len(hertz)))


def mains(seconds=30.0, hertz=44.0, other=0.0, off=2.0, turn=0.0, until=None):
    """Whether a line at 50 Hz is named, with another one beside it, and that turns to and fro from
    one window of 2 s to the next; the order comes near it at some time, if any.
    """
    time = np.arange(int(seconds * RATE)) / RATE
    sides = np.where(time // 2.0 % 2, turn, 0.0)
    line = np.sin(100.0 * np.pi * time + sides) + other * np.sin(TURN * (50.0 + off) * time)
    seconds = np.arange(int(seconds)) + 0.5
    swept = hertz + 0.0 * seconds if until is None else 45.0 + 0.1 * (seconds - until)
    orders = record(line, swept)
    return bool(list(wiring.hum_notes(orders, 0, WIRING)))


@pytest.mark.parametrize(
    ("inside", "outside"),
    [
        ({"seconds": 10.1}, {"seconds": 9.9}),  # five windows of 2 s
        *(  # away from each order by 5 Hz
            ({"hertz": 44.9 / order}, {"hertz": 45.1 / order}) for order in (0.5, 1.0, 2.0, 3.0)
        ),
        *(  # six times a line beside it
            ({"other": 1.0 / 6.3, "off": off}, {"other": 1.0 / 5.7, "off": off})
            for off in (-3.0, -2.0, 2.0, 3.0)
        ),
        ({"until": 9.3}, {"until": 8.8}),  # in the middle of the fifth window, 9 s
        ({"turn": np.arccos(0.81)}, {"turn": np.arccos(0.79)}),
    ],
)
def test_each_threshold_of_a_line_of_the_mains(inside, outside):
    assert mains(**inside) and not mains(**outside)


def jumps(turn, noise=0.0, level=1.0):
    """Whether lost samples are named in a sine of 20 Hz whose phase jumps by so much at 10 s, where
    the base moves by a part of what it does elsewhere.
    """
    time = np.arange(20 * int(RATE)) / RATE
    phase = 40.0 * np.pi * time + turn * (time > 10.0)
    values = np.sin(phase) + noise * np.random.default_rng(1).standard_normal(len(time))
    orders = record(values, np.full(20, 20.0))
    orders.level[7:13] = level
    return bool(list(wiring.lost_sample_notes(orders, WIRING)))


def test_each_threshold_of_a_jump_of_the_phase():
    assert [jumps(0.49), jumps(0.44)] == [True, False]  # three quarters of it are seen
    assert [jumps(0.8, noise) for noise in (0.2, 0.25)] == [True, False]  # ten times a usual one
    assert [jumps(0.8, level=level) for level in (0.51, 0.49)] == [True, False]


@pytest.mark.parametrize(("turns", "named"), [(1.0, False), (1.1, True)])
def test_whole_turns_are_how_a_phase_is_counted(monkeypatch, turns, named):
    measured = wiring.phase_of_box
    slipped = lambda record: measured(record) + TURN * turns * (record.time > 10.0)  # noqa: E731
    monkeypatch.setattr(wiring, "phase_of_box", slipped)
    assert jumps(0.0) == named


@pytest.mark.parametrize(("count", "saturated"), [(39_500, True), (40_500, False)])
def test_one_in_ten_thousand_samples_at_an_extreme_is_a_saturated_channel(count, saturated):
    """Each of the spikes alone: a sweep has none."""
    values = np.sin(np.arange(count) * 0.1)
    values[5000::9000] = 2.0
    channels = Channels(np.arange(count) / RATE, RATE, (FACE,), values[None], "made")
    notes = list(wiring.clipped_notes(channels, WIRING.clipped, WIRING.plateau))
    assert (values == 2.0).sum() == 4 and bool(notes) == saturated


@pytest.mark.parametrize(("ratio", "kept"), [(1.9, True), (2.1, False)])
def test_the_phase_of_the_base_is_taken_up_to_twice_its_frequency(monkeypatch, ratio, kept):
    boxes = []
    measured = wiring.phase_of_box

    def note(channels):
        boxes.append(channels.box)
        return measured(channels)

    monkeypatch.setattr(wiring, "phase_of_box", note)
    time = np.arange(20 * int(RATE)) / RATE
    other = 0.1 * np.sin(40.0 * np.pi * ratio * time)
    orders = record(np.sin(40.0 * np.pi * time) + other, np.full(20, 20.0))
    list(wiring.lost_sample_notes(orders, WIRING))
    assert (boxes[0] @ other > 0.5 * other @ other) == kept


@pytest.mark.parametrize(("resonance", "few"), [(51.0, False), (51.5, True)])
def test_ten_samples_in_a_period_of_the_resonance_are_enough(monkeypatch, resonance, few):
    orders = record(np.zeros(20 * int(RATE)), np.full(20, 20.0))
    orders.resonance, orders.rows = resonance, ()
    orders.windows.is_tone = False
    monkeypatch.setattr(wiring, "sine_windows_and_amplitudes", lambda channels: ())
    monkeypatch.setattr(wiring, "orders_with_floors", lambda channels: orders)
    for name in ("clipped_notes", "lost_sample_notes", "hum_notes"):
        monkeypatch.setattr(wiring, name, lambda *given: ())
    kinds = [note.kind for note in wiring.wiring_notes(orders.channels)]
    assert kinds == ["sampling"] * few
