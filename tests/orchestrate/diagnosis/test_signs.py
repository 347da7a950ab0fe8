"""Signs of records whose orders, noise and pulses are known."""

import numpy as np
import pytest
import xarray as xr
from scipy.signal import StateSpace, lsim

import orchestrate
from orchestrate.diagnosis.indicators import INDICATORS
from orchestrate.errors import InputError

from .records import BEAM

RATE, SECONDS = 1000.0, 8.0
TIME = np.arange(int(RATE * SECONDS)) / RATE
BOX = "box_acceleration"


def angle(down=False):
    """Phase of a sweep from 20 to 60 Hz, or down."""
    first, rate = (60.0, -5.0) if down else (20.0, 5.0)
    return 2.0 * np.pi * (first * TIME + 0.5 * rate * TIME**2)


def record(orders, noise=0.0, down=False, level=1.0, **others):
    """A box of 2 m/s2, and a response of known orders."""
    phase, generator = angle(down), np.random.default_rng(0)
    response = sum(a * np.sin(n * phase + 0.3) for n, a in orders.items())
    response = response + noise * generator.normal(size=len(TIME))
    channels = {BOX: 2.0 * level * np.sin(phase), "acceleration1": response, **others}
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, {"time": TIME})


def signs(*records, structure=BEAM, **settings):
    first, *others = records
    found = orchestrate.signs(first, other=others or None, structure=structure, seeds=1, **settings)
    return found.sel(channel="acceleration1")


def of(answer, sign, name="value"):
    return float(answer[name].sel(sign=sign))


def test_orders_are_those_of_the_record_and_stand_out_of_noise(tmp_path):
    """Each sign says what it is; the noise is found although there are orders."""
    answer = signs(record({1: 6.0, 2: 0.6, 3: 0.3}, noise=0.05))
    assert of(answer, "order_2") == pytest.approx(0.1, rel=0.02)
    assert of(answer, "order_3") == pytest.approx(0.05, rel=0.02)
    assert of(answer, "distortion") == pytest.approx(np.hypot(0.1, 0.05), rel=0.02)
    exceeds = [of(answer, sign, "exceeds") for sign in ("order_2", "order_3", "order_half")]
    assert exceeds == [1, 1, 0]
    assert of(answer, "order_half") < 2.0 * of(answer, "order_half", "floor")
    loud = signs(record({1: 6.0, 2: 3.0, 0.5: 1.0}, noise=0.5))
    assert [float(one.noise) for one in (answer, loud)] == pytest.approx([0.05, 0.5], rel=0.15)
    assert list(answer.sign.values) == list(INDICATORS)
    for name in ("meaning", "formula", "source", "moved_by"):
        assert all(len(text) > 3 for text in answer[name].values), name
    answer.to_netcdf(tmp_path / "signs.nc")
    assert xr.load_dataset(tmp_path / "signs.nc").equals(answer)


def linear(base, f, zeta):
    """A linear oscillator's acceleration, by an integrator of states."""
    w = 2.0 * np.pi * f
    rows = [[0.0, 1.0], [-(w**2), -2.0 * zeta * w]]
    system = StateSpace(rows, [[0.0], [-1.0]], rows[1:], [[0.0]])
    return lsim(system, base[BOX].values, base.time.values)[1]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("rate", [1000.0, 120.0])
def test_nothing_stands_out_of_a_sound_structure(rate):
    """Of two sweeps with silence between: it has no frequency, and at a low rate no window may
    resolve an order between orders.
    """
    time, rng = np.arange(int(8.0 * rate)) / rate, np.random.default_rng(4)
    sweep = 2.0 * np.sin(2.0 * np.pi * (26.0 * time + 1.5 * time**2))
    box = np.concatenate([sweep, np.zeros(int(2.0 * rate)), sweep])
    base = xr.Dataset({BOX: ("time", box)}, {"time": np.arange(len(box)) / rate})
    response = linear(base, 42.0, 0.02) + 0.01 * rng.normal(size=len(box))
    answer = signs(base.assign(acceleration1=("time", response)), structure=None)
    assert float(answer.sound_f) == pytest.approx(42.0, rel=0.02)
    assert not (answer.exceeds == 1).any()


@pytest.fixture(scope="module")
def felt(exported):
    """What sensors read of a beam that opens and of the bonded one."""
    beam = orchestrate.Structure.from_halves(
        m1=1.5, m2=1.2, f1=42.0, f2=55.0, zeta1=0.01, zeta2=0.01, e=0.6
    )
    sweep = orchestrate.SweptSine(first=35.0, last=60.0, duration=8.0, acceleration=4.0)
    sensor = orchestrate.Sensor(bandwidth=700.0, sample_rate=2000.0, noise=0.01)
    read = [
        orchestrate.measure(
            orchestrate.shake(structure, sweep, sample_rate=2000.0, progress=False),
            sensor,
            excitation=sweep,
        )
        for structure in (beam, beam.as_bonded())
    ]
    return beam, *read


def test_a_delaminated_beam_stands_out(felt):
    beam, *records = felt
    parted, whole = (orchestrate.signs(one, structure=beam, seeds=2).exceeds for one in records)
    moved = ("order_2", "order_3", "distortion", "skewness", "kurtosis_high", "sensor_difference")
    assert (parted.sel(sign=list(moved)) == 1).all() and not (whole == 1).any()
    assert not (orchestrate.signs(records[0], seeds=1, factor=1e6).exceeds == 1).any()


def test_what_each_sign_is_moved_by():
    """Gains move no difference of sensors; pulses are seen above the band alone; other levels and
    directions are compared.
    """
    phase, wave = angle(), np.sin(angle() + 0.3)
    assert of(signs(record({1: 6.0}, acceleration2=3.1 * wave)), "sensor_difference") < 1e-3
    drifts = record({1: 6.0}, acceleration2=3.1 * wave * (1.0 + 0.02 * TIME))
    assert of(signs(drifts), "sensor_difference") > 0.03
    smooth = record({1: 6.0}, noise=0.1)
    pulses = np.where(np.arange(len(phase)) % 500 == 0, 4.0, 0.0)
    struck = signs(smooth.assign(acceleration1=smooth.acceleration1 + pulses))
    assert of(signs(smooth), "kurtosis_high") == pytest.approx(3.0, abs=0.3)
    assert of(struck, "kurtosis_high") > 20.0 and of(struck, "kurtosis_high", "exceeds") == 1
    assert np.isnan(of(signs(smooth.isel(time=slice(None, None, 8))), "kurtosis_high"))
    alike = (record({1: 6.0}), record({1: 18.0}, level=3.0), record({1: 6.0}, down=True))
    bent = (alike[0], record({1: 15.0}, level=3.0), record({1: 3.0}, down=True))
    expected = {"level_dependence": 1.0 / 6.0, "direction_difference": 0.5}
    same, other, alone = signs(*alike), signs(*bent), signs(alike[0])
    for name, value in expected.items():
        assert of(same, name) < 1e-3 and of(other, name) == pytest.approx(value, rel=0.01)
        assert np.isnan(of(alone, name)) and of(alone, name, "exceeds") == -1


def test_other_excitations_have_no_orders_but_other_signs(exported):
    """Random vibration; and a shock whose few periods are no sweep."""
    beam = orchestrate.Structure.from_file("beam").replace(D=0.05)
    noise = orchestrate.Random(psd=[(5.0, 0.05), (30.0, 0.05)], duration=40.0, seed=3)
    sensor = orchestrate.Sensor(bandwidth=200.0, sample_rate=500.0)
    parted, whole = (
        signs(
            orchestrate.measure(
                orchestrate.shake(one, noise, sample_rate=500.0, progress=False), sensor
            ),
            **{"structure": beam, "noise": 1e-3},
        )
        for one in (beam, beam.as_bonded())
    )
    assert np.isnan(of(parted, "order_2")) and of(parted, "order_2", "exceeds") == -1
    assert of(parted, "coherence_loss") > 3.0 * of(whole, "coherence_loss")
    assert parted.attrs["noise_from"] == "given"
    beam = BEAM.replace(f1=42.0, f2=52.0, zeta1=0.01, zeta2=0.01, e=0.6)
    shock = orchestrate.Shock(peak=50.0, length=0.05, duration=0.5)
    history = orchestrate.shake(beam, shock, sample_rate=2000.0, progress=False)
    sensor = orchestrate.Sensor(bandwidth=500.0, noise=0.01)
    read = orchestrate.measure(history, sensor, excitation=shock)
    known = np.isfinite(orchestrate.signs(read, structure=beam, seeds=2).value).all("channel")
    assert known.sel(sign="coherence_loss") and known.sel(sign="kurtosis")
    assert not known.sel(sign="level_dependence") and not known.sel(sign="sensor_difference")


def drive_run(jump, power, lag=0.01):
    """A run of a motor that takes a power and jumps at a voltage."""
    voltage = np.linspace(1.0, 10.0, 200)
    speed = np.where(voltage < jump, voltage, voltage + 20.0)
    time = np.cumsum(2.0 * np.pi / speed)
    work = np.concatenate([[0.0], np.cumsum(power * speed[1:] ** 2 * np.diff(time))])
    columns = {"time": time, "speed": speed, "voltage": voltage, "motor": work}
    data = xr.Dataset({name: ("revolution", values) for name, values in columns.items()})
    return data.assign(jumps=("jump", [jump]), jump_lag=("jump", [lag])).assign_coords(jump=["up"])


def test_a_weak_drive_jumps_earlier_and_takes_more_power():
    """The same where it turns backward; a fall whose floor is unknown is unknown."""
    runs = drive_run(6.3, 1.3), drive_run(7.0, 1.0)
    whole = orchestrate.signs(runs[0], other=runs[1])
    answer = whole.sel(channel="motor")
    assert of(answer, "jump_voltage_fall") == pytest.approx(0.1)
    assert of(answer, "extra_power") == pytest.approx(0.3, rel=0.03)
    assert of(answer, "jump_voltage_fall", "exceeds") == 1
    with pytest.raises(InputError, match="run of the sound beam"):
        orchestrate.signs(runs[0])
    signed = ("speed", "voltage", "jumps", "jump_lag")
    one, other = (run.assign({name: -run[name] for name in signed}) for run in runs)
    assert orchestrate.signs(one, other=other).equals(whole)
    unknown = orchestrate.signs(drive_run(6.3, 1.3, np.nan), other=runs[1]).sel(channel="motor")
    assert [of(unknown, s, "exceeds") for s in ("jump_voltage_fall", "extra_power")] == [-1, 1]
