"""What becomes of a record's numbers: times, units, conversions, delays; what is doubted."""

import numpy as np
import pytest

from orchestrate import InputError, read_record, record
from orchestrate.laboratory.record import ReadingOptions, make_record
from orchestrate.laboratory.record_checks import clipped_share

from .files import CHANNELS, RATE, G, drawn, swept, table_file


def five_digits(count=12_000, rate=1024.0):
    time = np.arange(count) / rate
    return np.array([float(f"{one:.5g}") for one in time]), np.sin(300.0 * time)


def test_rounded_times_say_so_and_a_sampling_rate_corrects_them():
    time, values = five_digits()
    alone = record(time=time, acceleration1=values)
    assert alone.attrs["time_base"] == "rounded to 0.001 s, taken as 1024 Hz"
    assert (alone.time.values == np.arange(len(time)) / 1024.0).all()
    data = record(time=time, acceleration1=values, sample_rate=1024.0)
    assert (data.time.values == np.arange(len(time)) / 1024.0).all()
    with pytest.raises(InputError, match=r"sample_rate = 1000.0 Hz: expected 102\d"):
        record(time=time, acceleration1=values, sample_rate=1000.0)
    kept = np.delete(np.arange(len(time)), [5000, 7000, 9000])
    for rate in (1024.0, None):
        with pytest.raises(InputError, match="time, row"):
            record(time=time[kept], acceleration1=values[kept], sample_rate=rate)


def changed(column, row, value):
    data = drawn(50)
    columns = {name: data[name].values.copy() for name in ("time", *CHANNELS)}
    columns[column][row] = value
    return columns


FIVE = [0.0, 1.0, 2.0, 3.0, 4.0]
UNEQUAL = {"time": np.arange(99) / 2.05, "acceleration1": [1.0] * 99, "sample_rate": 2.0}
WRONG = {
    "acceleration1, row 17: nan": changed("acceleration1", 17, np.nan),
    "box_acceleration, row 3: inf": changed("box_acceleration", 3, np.inf),
    "time, row 20: a step of 9.7656": changed("time", 20, 19.5 / RATE),
    "time, row 20: 0 s after 0.00371093": changed("time", 20, 0.0),
    "no channel given": {"time": [0.0, 1.0]},
    "neither time nor sample_rate": {"acceleration1": [1.0] * 5},
    "acceleration1: 0 values": {"acceleration1": [], "sample_rate": 9.0},
    "acceleration1: expected a list of numbers": {"acceleration1": "abc", "sample_rate": 9.0},
    "4 values; expected 5": {"time": FIVE, "acceleration1": [1.0] * 4},
    "time, row 3: a step of 2 s": {"time": [0.0, 1.0, 2.0, 4.0], "acceleration1": [1.0] * 4},
    "time, row 1: 0 s after 0 s": {"time": [0.0] * 4, "acceleration1": [1.0] * 4},
    "sample_rate = 2.0 Hz: expected 2.05": UNEQUAL,
}


@pytest.mark.parametrize("words", WRONG)
def test_what_is_no_record_is_refused_in_one_line(words):
    with pytest.raises(InputError) as error:
        record(**WRONG[words])
    assert words in str(error.value) and "\n" not in str(error.value)


SWEPT = 4.0 * np.sin(2.0 * np.pi * (30.0 + 2.0 * np.arange(4000) / 1000.0) * np.arange(4000) / 1e3)
SHORT = np.sin(np.arange(99.0))
PAUSED = np.concatenate([SWEPT, np.zeros(2000), SWEPT])
DOUBTED = {  # a channel, the base, and what is said: nothing of what is right
    "in V": (0.01 * SHORT, None, "in g, or in V"),
    "counts": (1e6 * SHORT, None, "mV, or counts"),
    "gravity": (1.0 + 0.1 * SHORT, None, "as gravity has in g"),
    "saturated": (3.0 * SWEPT[::-1].clip(-2.0, 2.0), SWEPT, "67 % of its samples repeat"),
    "dead": (np.where(np.arange(4000) < 3000, SWEPT[::-1], 0.0), SWEPT, "0 from 3 to 3.999 s"),
    "doubled": (SWEPT.copy(), SWEPT, "the same values as box_acceleration"),
    "hardly moves": (1e-3 * SWEPT[::-1], SWEPT, "are these numbers in g"),
    "small": (0.2 * SHORT, None, ""),
    "large": (5000.0 * SHORT, None, ""),
    "at rest": (np.zeros(9), None, ""),
    "gravity in m/s2": (G + 0.2 * SHORT, None, ""),
    "silence of all": (np.roll(PAUSED, 7), PAUSED, ""),
}


@pytest.mark.parametrize("name", DOUBTED)
def test_what_is_hardly_right_warns_once_and_what_is_right_does_not(recwarn, name):
    values, base, words = DOUBTED[name]
    channels = {"acceleration1": values} | ({} if base is None else {"box_acceleration": base})
    record(**channels, sample_rate=1000.0)
    said = [str(one.message) for one in recwarn]
    assert len(said) == bool(words) and all(words in one and "acceleration1" in one for one in said)
    record(**channels, sample_rate=1000.0, source="simulated")
    assert len(recwarn) == len(said)


def test_repeated_extreme_values_are_those_of_a_saturated_channel():
    """Digits, tones of few samples a period, pulses from rest and noise are no saturation."""
    time, rng = np.arange(20_000) / 1000.0, np.random.default_rng(2)
    sweep = 4.0 * np.sin(2.0 * np.pi * (30.0 * time + 0.2 * time**2))
    passed = sweep * (0.1 + np.exp(-(((time - 9.0) / 1.5) ** 2)))
    pulse = np.where(time < 0.011, np.sin(np.pi * time / 0.011), 0.0)
    tones = [np.sin(2.0 * np.pi * hertz * time) for hertz in (50.0, 5.0)]
    sound = [rng.normal(size=20_000), pulse, *tones, *(np.round(sweep, n) for n in (0, 1, 2, 3))]
    assert [clipped_share(values) for values in sound] == [0.0] * len(sound)
    spiked = sweep + 9.0 * (rng.random(20_000) < 1e-3) * rng.random(20_000)
    cut = spiked.clip(-5.0, 7.0)
    assert clipped_share(spiked, 1) == clipped_share(cut) == 0.0 < clipped_share(cut, 1)
    for noise in (0.0, 0.05):
        values = passed + rng.normal(0.0, noise, len(passed))
        peak = np.abs(values).max()
        limited = [np.clip(values, -share * peak, share * peak) for share in (0.8, 0.5)]
        assert clipped_share(values) == 0.0 and clipped_share(limited[0]) > 0.01
        at = np.mean(np.abs(limited[1]) == 0.5 * peak)
        assert clipped_share(limited[1]) == pytest.approx(at, rel=0.02)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_velocities_displacements_and_voltages_become_accelerations(tmp_path):
    time, acceleration, velocity, displacement = swept()
    heading = "t [s],Tisch [mV],Aufnehmer 1 [mm/s],mass 2 [um]"
    columns = (time, 100.0 * acceleration / G, 1e3 * velocity, 1e6 * displacement)
    path = table_file(tmp_path / "a.csv", heading, *columns)
    for sensitivity in ("base=100 mV/g", {"base": "0.1 V/g"}, "base=10,197162 mV/(m/s²)"):
        data = read_record(path, sensitivity=sensitivity)
        for name in CHANNELS:
            error = np.abs(data[name].values - acceleration)[20:-20]
            assert error.max() < 2e-3 * np.abs(acceleration).max(), name
    assert "face 2: displacement, differentiated" in data.attrs["converted"]
    assert "base" not in data.attrs["converted"]
    turned = read_record(path, sensitivity="base=-100 mV/g", scale={"face2": 2.0}, delay="face1=0")
    assert np.allclose(turned.box_acceleration, -data.box_acceleration, rtol=1e-6)
    assert (turned.acceleration2.values == 2.0 * data.acceleration2.values).all()
    path.write_text(path.read_text().replace("\n", "\n,100 mV/g,,\n", 1))
    assert np.allclose(read_record(path).box_acceleration, -turned.box_acceleration)
    path = table_file(path, "t [s],base [m/s]", time, 1000.0 * time)
    assert read_record(path).box_acceleration.values == pytest.approx(1000.0, rel=1e-6)


UNITS = {"g": G, "m/s\u00b2": 1.0, "m/s^2": 1.0, "mm/s2": 1e-3, "mg": 1e-3 * G}


@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_of_the_heading_or_another_one_that_is_said(tmp_path, unit):
    path = tmp_path / "a.csv"
    path.write_bytes(f"t [s];base [{unit}]\n0;10\n1;20\n2;70\n3;90\n".encode("cp1252"))
    values, data = np.array([10.0, 20.0, 70.0, 90.0]), read_record(path)
    assert np.allclose(data.box_acceleration, UNITS[unit] * values, 1e-15)
    assert "unit_in_file" not in data.attrs
    other = read_record(path, unit="mm/s2")
    assert np.allclose(other.box_acceleration, 1e-3 * values, 1e-15)
    assert other.attrs["unit"] == "mm/s2" and ("unit_in_file" in other.attrs) == (unit != "mm/s2")


OPTIONS = [  # how a file with a heading is read, and what is said about that
    ("base [mV]", {}, 'column "base" (base): in mV, without a sensitivity'),
    ("base [mV]", {"sensitivity": "100 g/V"}, "sensitivity '100 g/V'"),
    ("base [mV]", {"sensitivity": "tip=1 V/g"}, "no channel 'tip'"),
    ("base [mV]", {"unit": "base=g", "sensitivity": "base=1 V/g"}, "expected volts"),
    ("base [mV]", {"unit": "g,time=us"}, "'g' of which channel?"),
    ("base [mV]", {"unit": "base=N"}, "unit = 'N'"),
    ("base [mV]", {"unit": "g", "scale": "base=x"}, "scale = 'base=x'"),
    ("base [g]", {"delay": "base=3.998"}, "delay: base 3.998 s"),
    ("base [g]", {"delay": {"base": 2.5, "tip": 0.0}}, "no channel 'tip'"),
    ("base [g]", {"delay": 1e300}, "delay = 1e+300"),
    ("base [g]", {"scale": 0}, "scale = 0"),
    ("base [g]", {"scale": "base=nan"}, "scale = 'base=nan'"),
    ("base [g]", {"scale": "time=2"}, "no channel 'time'"),
    ("base [g]", {"unit": "time=g"}, "unit = 'g'"),
    ("base", {"unit": "time=us"}, 'unit="time=us,base=..."'),
    ("base", {"unit": "time=us", "sensitivity": "1 V/g"}, ""),
    ("base", {"unit": "base=V", "sensitivity": "1 V/g"}, ""),
]


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(("heading", "options", "words"), OPTIONS)
def test_mistaken_options_are_one_line(tmp_path, heading, options, words):
    time, acceleration, *_ = swept()
    path = table_file(tmp_path / "a.csv", f"t,{heading}", time, acceleration)
    if not words:
        assert read_record(path, **options).sizes["time"] == 4000
        return
    with pytest.raises(InputError) as error:
        read_record(path, **options)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_uneven_times_are_resampled_on_request_but_not_over_gaps():
    time, acceleration, *_ = swept()
    uneven = time + np.random.default_rng(4).uniform(-2e-4, 2e-4, len(time))
    true = np.interp(uneven, time, acceleration)
    with pytest.raises(InputError, match="expected equal steps: resample= makes them"):
        record(time=uneven, box_acceleration=true)
    resampled = ReadingOptions(resample=True)
    even = make_record(uneven, {"box_acceleration": true}, None, {}, resampled)
    assert np.ptp(np.diff(even.time)) < 1e-12
    assert "jitter 0.00012 s, 0.12 step" in even.attrs["time_base"]
    expected = np.interp(even.time, time, acceleration)
    assert np.abs(even.box_acceleration.values - expected)[5:-5].max() < 0.02 * acceleration.max()
    gap = np.delete(np.arange(len(time)), slice(1000, 1009))
    with pytest.raises(InputError, match="row 1000: .*samples are lost"):
        make_record(uneven[gap], {"box_acceleration": true[gap]}, None, {}, resampled)


TIMES = [  # a heading, a step, how many; the unit that is right, and the rate then
    ("t", 2500, 9, "us", 400.0),
    ("t", 0.5, 8000, "ms", 2000.0),
    ("t", 25, 9, "ms", 40.0),
    ("t [s]", 4.0, 2000, "", 0.25),
    ("t [h]", 1, 2000, "", 1 / 3600),
]


@pytest.mark.parametrize(("heading", "step", "count", "unit", "rate"), TIMES)
def test_times_without_a_unit_that_are_hardly_seconds_are_doubted(
    tmp_path, recwarn, heading, step, count, unit, rate
):
    rows = "".join(f"{step * i:.12g},{i % 3},{i % 4}\n" for i in range(count))
    path = tmp_path / "times.csv"
    path.write_text(f"{heading},base [g],face [g]\n{rows}")
    data = read_record(path)
    assert len(recwarn) == bool(unit)
    if unit:
        assert f"taken as s: {step} s a sample" in str(recwarn.pop().message)
        assert data.attrs["sample_rate"] == 1.0 / step
        data = read_record(path, unit=f"time={unit}")
        assert data.attrs["time_unit"] == unit and data.attrs["unit"] == "g"
        assert "unit_in_file" not in data.attrs
        assert read_record(path, unit={"time": unit, "base": "m/s2"}).attrs["unit"] == "m/s2, g"
    assert data.attrs["sample_rate"] == pytest.approx(rate) and not recwarn


@pytest.mark.parametrize("late", [0.0155, -0.0155, 3.9])
def test_a_delay_cuts_what_a_channel_does_not_have(tmp_path, late):
    time, acceleration, *_ = swept(4000)
    path = table_file(tmp_path / "a.csv", "t [s],base [m/s2],tip [m/s2]", time, acceleration, time)
    whole, data = read_record(path), read_record(path, delay={"face1": late})
    size = 4000 - (16 if abs(late) < 1.0 else 3900)
    assert data.sizes["time"] == size and data.attrs["cut"].startswith(f"{4000 - size} samples of")
    assert data.box_acceleration.equals(whole.box_acceleration.sel(time=data.time))
    assert np.allclose(data.acceleration1, data.time + late, atol=1e-9)
    assert read_record(path, delay="base=0.0155,face1=0.001").sizes["time"] == 3984
    with pytest.raises(InputError, match=r"delay: base 2.5 s, face 1 -2.5 s"):
        read_record(path, delay={"base": 2.5, "face1": -2.5})
