"""What shakers do, what sensors read, random beams, and the records of the manual's tutorial."""

import math

import numpy as np
import pytest
from scipy.signal import butter, freqs

import orchestrate
from tests.benches import recipe, tutorial
from tests.benches.excitation import Swept
from tests.benches.lumped import TURN
from tests.benches.sensors import Sensor


@pytest.mark.parametrize("log", [False, True])
@pytest.mark.parametrize("ends", [(20.0, 90.0), (90.0, 20.0)])
def test_a_sweep_goes_from_end_to_end(log, ends):
    sweep = Swept(*ends, duration=10.0, level=3.0, log=log)
    time = np.linspace(0.0, 10.0, 100_001)
    frequency = np.gradient(sweep.phase(time), time) / TURN
    assert (frequency[1], frequency[-2]) == (pytest.approx(ends[0], rel=1e-3),) + (
        pytest.approx(ends[1], rel=1e-3),
    )
    middle = math.sqrt(20.0 * 90.0) if log else 55.0
    assert frequency[50_000] == pytest.approx(middle, rel=1e-6)
    assert abs(sweep(time)).max() == pytest.approx(3.0, rel=1e-3)
    assert sweep(time)[0] == 0.0 == pytest.approx(sweep(time)[-1], abs=1e-9)


def test_a_sensor_filters_delays_and_scales():
    rate, factor, frequency = 80_000.0, 40, 300.0
    time = np.arange(80_000) / rate
    sensor = Sensor(bandwidth=1000.0, order=2, gain=1.03, delay=1e-4, noise=0.0)
    read = sensor.read(np.sin(TURN * frequency * time), rate, factor, np.random.default_rng(0))
    response = freqs(*butter(2, TURN * 1000.0, analog=True), [TURN * frequency])[1][0]
    response *= 1.03 * np.exp(-1j * TURN * frequency * 1e-4)
    expected = np.imag(response * np.exp(1j * TURN * frequency * time[::factor]))
    assert np.abs(read - expected)[200:-200].max() < 2e-3


@pytest.fixture
def short(monkeypatch):
    """Records of some seconds."""
    monkeypatch.setattr(recipe, "DURATION", 4.0)


FAST = [kind for kind in recipe.KINDS if "elements" not in kind]


@pytest.mark.parametrize("kind", FAST)
def test_a_beam_of_each_kind(kind, short):
    """All but the guess of a beam is the same for one seed; the truth is what moved."""
    for seed in range(2):
        conditions = recipe.Conditions(noise=(0.001, 0.1), excitation="any")
        case, again = (
            recipe.draw_levels(np.random.default_rng(seed), kind, conditions)[0] for _ in range(2)
        )
        assert case.record.identical(again.record) and case.truth.setup == again.truth.setup
        assert case.guess == again.guess
        truth, guess = case.truth, case.guess
        assert truth.is_delaminated == (kind in recipe.SPLIT)
        assert not (truth.opened and not truth.is_delaminated)
        assert np.isfinite(case.record.acceleration1).all()
        if truth.is_delaminated:
            assert guess.f1 == pytest.approx(truth.halves.f1, rel=0.1001)
        assert 0.001 <= truth.setup.noise <= 0.1 and 2.0 <= truth.setup.level <= 10.0


def test_the_records_of_the_tutorial_are_read_as_they_are():
    """Three files, small enough for the repository; what they say of themselves, and the signs."""
    ratios = {}
    for name in tutorial.BEAMS:
        path = tutorial.FOLDER / f"{name}.csv"
        assert path.stat().st_size < 1.2e6
        head = path.read_text("utf-8")[:400]
        assert head.startswith("Virtual bench with compliant contact: computed, not measured\n")
        record = orchestrate.read_record(path)
        assert record.sample_rate == tutorial.RATE and record.sizes["time"] == 50_001
        assert set(record.data_vars) == {"box_acceleration", "acceleration1"}
        orders = orchestrate.track_orders(record).amplitude.sel(channel="acceleration1")
        ratios[name] = float((orders.sel(order=2) / orders.sel(order=1)).median())
    assert ratios["beam_a"] > 0.1 > 0.03 > max(ratios["beam_b"], ratios["beam_c"])
    guess = orchestrate.Structure.from_file(tutorial.FOLDER / "beam.toml")
    for name in ("m1", "m2", "f1", "f2"):
        assert getattr(guess, name) == pytest.approx(getattr(tutorial.BEAM, name), rel=0.1)
