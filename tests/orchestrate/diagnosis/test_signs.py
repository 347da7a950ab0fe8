"""Signs of records whose orders, noise and pulses are known."""

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate.diagnosis.indicators import INDICATORS
from orchestrate.errors import InputError

from .records import BEAM

RATE, SECONDS = 1000.0, 8.0
TIME = np.arange(int(RATE * SECONDS)) / RATE


def angle(down=False):
    """Phase of a sweep from 20 to 60 Hz, or down."""
    first, rate = (60.0, -5.0) if down else (20.0, 5.0)
    return 2.0 * np.pi * (first * TIME + 0.5 * rate * TIME**2)


def record(orders, noise=0.0, seed=0, down=False, level=1.0, **others):
    """A box of 2 m/s2, and a response of known orders."""
    phase, generator = angle(down), np.random.default_rng(seed)
    response = sum(a * np.sin(n * phase + 0.3) for n, a in orders.items())
    channels = {"box_acceleration": 2.0 * level * np.sin(phase), "acceleration1": response}
    channels |= others
    noisy = {
        name: ("time", values + noise * generator.normal(size=len(TIME)) * (name != BOX))
        for name, values in channels.items()
    }
    return xr.Dataset(noisy, {"time": TIME})


BOX = "box_acceleration"


def signs(*records, channel="acceleration1", **settings):
    first, *others = records
    answer = orchestrate.signs(first, other=others or None, seeds=2, **settings)
    return answer.sel(channel=channel)


def of(answer, sign, name="value"):
    return float(answer[name].sel(sign=sign))


def test_orders_are_those_of_the_record_and_stand_out_of_noise():
    answer = signs(record({1: 6.0, 2: 0.6, 3: 0.3}, noise=0.05))
    assert of(answer, "order_2") == pytest.approx(0.1, rel=0.02)
    assert of(answer, "order_3") == pytest.approx(0.05, rel=0.02)
    assert of(answer, "distortion") == pytest.approx(np.hypot(0.1, 0.05), rel=0.02)
    assert [of(answer, sign, "exceeds") for sign in ("order_2", "order_3")] == [1, 1]
    assert of(answer, "order_half", "exceeds") == 0
    assert of(answer, "order_half") < 2.0 * of(answer, "order_half", "floor")


def test_the_noise_is_found_although_there_are_orders():
    for noise in (0.02, 0.5):
        assert float(signs(record({1: 6.0, 2: 3.0, 0.5: 1.0}, noise=noise)).noise) == pytest.approx(
            noise, rel=0.15
        )


@pytest.mark.parametrize("seed", range(2))
def test_nothing_stands_out_of_a_sound_structure(seed):
    phase = angle()
    base = xr.Dataset(
        {BOX: ("time", 2.0 * np.sin(phase)), "acceleration1": ("time", np.zeros_like(phase))},
        {"time": TIME},
        {"sample_rate": RATE},
    )
    made = linear(base, 42.0, 0.02)
    generator = np.random.default_rng(seed)
    noisy = made + 0.05 * generator.normal(size=len(TIME))
    answer = signs(base.assign(acceleration1=("time", noisy)))
    assert float(answer.sound_f) == pytest.approx(42.0, rel=0.01)
    assert not (answer.exceeds == 1).any()


def linear(base, f, zeta):
    """A linear oscillator's acceleration, by an integrator of states."""
    from scipy.signal import StateSpace, lsim

    w = 2.0 * np.pi * f
    system = StateSpace(
        [[0.0, 1.0], [-(w**2), -2.0 * zeta * w]],
        [[0.0], [-1.0]],
        [[-(w**2), -2.0 * zeta * w]],
        [[0.0]],
    )
    return lsim(system, base[BOX].values, base.time.values)[1]


def test_a_delaminated_beam_stands_out(exported):
    beam = orchestrate.Structure.from_halves(
        m1=1.5, m2=1.2, f1=42.0, f2=55.0, zeta1=0.01, zeta2=0.01, e=0.6
    )
    sweep = orchestrate.SweptSine(first=35.0, last=60.0, duration=8.0, acceleration=4.0)
    sensor = orchestrate.Sensor(bandwidth=700.0, sample_rate=2000.0, noise=0.01)
    felt = {}
    for name, structure in (("delaminated", beam), ("bonded", beam.as_bonded())):
        history = orchestrate.shake(structure, sweep, sample_rate=2000.0, progress=False)
        felt[name] = orchestrate.measure(history, sensor, excitation=sweep)
    parted = orchestrate.signs(felt["delaminated"], structure=beam, seeds=2).exceeds
    whole = orchestrate.signs(felt["bonded"], structure=beam, seeds=2).exceeds
    moved = ("order_2", "order_3", "distortion", "skewness", "kurtosis_high", "sensor_difference")
    assert (parted.sel(sign=list(moved)) == 1).all()
    assert not (whole == 1).any()
    assert not (orchestrate.signs(felt["delaminated"], seeds=1, factor=1e6).exceeds == 1).any()


@pytest.mark.slow
def test_the_gain_of_a_sensor_moves_no_difference():
    phase = angle()
    alike = record({1: 6.0}, acceleration2=3.1 * np.sin(phase + 0.3))
    other = record({1: 6.0}, acceleration2=3.1 * np.sin(phase + 0.3) * (1.0 + 0.02 * TIME))
    assert of(signs(alike), "sensor_difference") < 1e-3
    assert of(signs(other), "sensor_difference") > 0.03


@pytest.mark.slow
def test_pulses_are_seen_above_the_band_alone():
    pulses = np.where(np.arange(len(TIME)) % 500 == 0, 4.0, 0.0)
    smooth = record({1: 6.0}, noise=0.1)
    struck = smooth.assign(acceleration1=smooth.acceleration1 + pulses)
    assert of(signs(smooth), "kurtosis_high") == pytest.approx(3.0, abs=0.3)
    assert of(signs(struck), "kurtosis_high") > 20.0
    assert of(signs(struck), "kurtosis_high", "exceeds") == 1
    assert np.isnan(of(signs(smooth.isel(time=slice(None, None, 8))), "kurtosis_high"))


@pytest.mark.slow
def test_other_levels_and_directions_are_compared():
    linear_ones = (record({1: 6.0}), record({1: 18.0}, level=3.0), record({1: 6.0}, down=True))
    same = signs(*linear_ones)
    assert of(same, "level_dependence") < 1e-3 and of(same, "direction_difference") < 1e-3
    bent = signs(linear_ones[0], record({1: 15.0}, level=3.0), record({1: 3.0}, down=True))
    assert of(bent, "level_dependence") == pytest.approx(1.0 / 6.0, rel=0.01)
    assert of(bent, "direction_difference") == pytest.approx(0.5, rel=0.01)
    alone = signs(linear_ones[0])
    assert (
        np.isnan(of(alone, "level_dependence")) and of(alone, "level_dependence", "exceeds") == -1
    )


def test_random_vibration_has_no_orders_but_other_signs(exported):
    beam = orchestrate.Structure.from_file("beam").replace(D=0.05)
    noise = orchestrate.Random(psd=[(5.0, 0.05), (30.0, 0.05)], duration=40.0, seed=3)
    sensor = orchestrate.Sensor(bandwidth=200.0, sample_rate=500.0)
    felt = {
        name: orchestrate.measure(
            orchestrate.shake(one, noise, sample_rate=500.0, progress=False), sensor
        )
        for name, one in (("delaminated", beam), ("bonded", beam.as_bonded()))
    }
    parted = signs(felt["delaminated"], structure=beam, noise=1e-3)
    whole = signs(felt["bonded"], structure=beam, noise=1e-3)
    assert np.isnan(of(parted, "order_2")) and of(parted, "order_2", "exceeds") == -1
    assert of(parted, "coherence_loss") > 3.0 * of(whole, "coherence_loss")
    assert parted.attrs["noise_from"] == "given"


def drive_run(jump, power):
    """A run of a motor that takes a power and jumps at a voltage."""
    voltage = np.linspace(1.0, 10.0, 200)
    speed = np.where(voltage < jump, voltage, voltage + 20.0)
    time = np.cumsum(2.0 * np.pi / speed)
    work = np.concatenate([[0.0], np.cumsum(power * speed[1:] ** 2 * np.diff(time))])
    return xr.Dataset(
        {
            **{name: ("revolution", values) for name, values in (("time", time), ("speed", speed))},
            **{"voltage": ("revolution", voltage), "motor": ("revolution", work)},
            **{"jumps": ("jump", [jump]), "jump_lag": ("jump", [0.01])},
        },
        {"jump": ["up"]},
    )


def test_a_weak_drive_jumps_earlier_and_takes_more_power():
    answer = orchestrate.signs(drive_run(6.3, 1.3), other=drive_run(7.0, 1.0)).sel(channel="motor")
    assert of(answer, "jump_voltage_fall") == pytest.approx(0.1)
    assert of(answer, "extra_power") == pytest.approx(0.3, rel=0.03)
    assert of(answer, "jump_voltage_fall", "exceeds") == 1
    with pytest.raises(InputError, match="run of the sound beam"):
        orchestrate.signs(drive_run(6.3, 1.3))


def test_a_motor_that_turns_backward_has_the_same_signs():
    first, second = drive_run(6.3, 1.3), drive_run(7.0, 1.0)
    signed = ("speed", "voltage", "jumps", "jump_lag")
    one, other = (run.assign({name: -run[name] for name in signed}) for run in (first, second))
    assert orchestrate.signs(one, other=other).equals(orchestrate.signs(first, other=second))


def test_a_fall_whose_floor_is_unknown_is_unknown():
    run = drive_run(6.3, 1.3).assign(jump_lag=("jump", [np.nan]))
    answer = orchestrate.signs(run, other=drive_run(7.0, 1.0)).sel(channel="motor")
    assert [of(answer, s, "exceeds") for s in ("jump_voltage_fall", "extra_power")] == [-1, 1]


def test_every_sign_says_what_it_is(tmp_path):
    answer = orchestrate.signs(record({1: 6.0}, noise=0.01), seeds=1)
    assert list(answer.sign.values) == list(INDICATORS)
    for name in ("meaning", "formula", "source", "moved_by"):
        assert all(len(text) > 3 for text in answer[name].values), name
    answer.to_netcdf(tmp_path / "signs.nc")
    assert xr.load_dataset(tmp_path / "signs.nc").equals(answer)


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        ({"seeds": 0}, "seeds = 0"),
        ({"noise": -1.0}, "noise = -1.0"),
        ({"periods": 1.0}, "periods = 1.0"),
        ({"high_band": 480.0}, "high_band = 480.0"),
        ({"other": record({1: 6.0}).drop_vars("acceleration1")}, r"other\[0\]: none"),
    ],
)
def test_mistakes_are_one_line(wrong, text):
    with pytest.raises(InputError, match=text):
        orchestrate.signs(record({1: 6.0}), **wrong)


def test_a_record_without_a_response_is_refused():
    with pytest.raises(InputError, match="no acceleration1"):
        orchestrate.signs(record({1: 6.0}).drop_vars("acceleration1"))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("rate", [1000.0, 120.0])
def test_two_sweeps_with_silence_between_have_signs_at_any_sampling_rate(rate):
    """Silence has no frequency, and at a low rate no window may resolve an order between orders."""
    time, rng = np.arange(int(8.0 * rate)) / rate, np.random.default_rng(4)
    sweep = 2.0 * np.sin(2.0 * np.pi * (26.0 * time + 1.5 * time**2))
    box = np.concatenate([sweep, np.zeros(int(2.0 * rate)), sweep])
    data = {"box_acceleration": box, "acceleration1": np.zeros_like(box)}
    base = xr.Dataset(
        {name: ("time", values) for name, values in data.items()},
        {"time": np.arange(len(box)) / rate},
    )
    response = linear(base, 42.0, 0.02) + 0.01 * rng.normal(size=len(box))
    made = base.assign(acceleration1=("time", response))
    assert float(signs(made).sound_f) == pytest.approx(42.0, rel=0.02)


def test_a_shock_whose_few_periods_are_no_sweep_has_signs():
    """The base is tracked for some windows, which are too few for a curve over the frequency."""
    beam = BEAM.replace(f1=42.0, f2=52.0, zeta1=0.01, zeta2=0.01, e=0.6)
    shock = orchestrate.Shock(peak=50.0, length=0.05, duration=0.5)
    history = orchestrate.shake(beam, shock, sample_rate=2000.0, progress=False)
    sensor = orchestrate.Sensor(bandwidth=500.0, noise=0.01)
    felt = orchestrate.measure(history, sensor, excitation=shock)
    answer = orchestrate.signs(felt, structure=beam, seeds=2)
    known = np.isfinite(answer.value).all("channel")
    assert known.sel(sign="coherence_loss") and known.sel(sign="kurtosis")
    assert not known.sel(sign="level_dependence") and not known.sel(sign="sensor_difference")
