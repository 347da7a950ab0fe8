"""``analyse``, ``channels`` and ``halves``: records in, numbers, settings and structures out."""

from __future__ import annotations

import re

import pytest
import xarray as xr

import orchestrate

from .test_commands import shows_something

SWEEP = orchestrate.SweptSine(first=11.0, last=13.0, duration=4.0, acceleration=1.0)
NO_PLOT = ("--plot", "none")


def said(done):
    """The numbers that a command prints, without the names of files."""
    return [line for line in done.success().out.splitlines() if line.startswith("  ")]


SHOWN = {
    "frf": ["magnitude", "mass 1   3 ", "mass 2   1.5 "],
    "psd": ["rms m/s2", "1.41", "4.2"],
    "orders": ["amplitude m/s2  at Hz", "mass 1   1      6 ", "mass 1   2      0.6 "],
    "harmonics": ["distortion", "mass 1   0.1 "],
    "spectrogram": ["at Hz", "box      1.", "mass 1   "],
    "shock": ["maximax", "mass 1   "],
    "density": ["skewness_error", "1.5"],
}


def test_each_analysis_says_its_numbers(ask, tmp_path, files):
    cut = ("--from", "0.5", "--to", "9.5", *NO_PLOT)
    done = ask("analyse", files["parted.nc"], "--show", ",".join(SHOWN), *cut).success()
    assert all(word in done.out for words in SHOWN.values() for word in words), done.out
    for show in SHOWN:
        (stored,) = (tmp_path / "results").glob(f"analyse_{show}_parted_*")
        assert str(stored) in done.out and show in xr.load_dataset(stored).attrs["analysis"]


def test_three_records_in_one_picture_by_the_options(ask, tmp_path, files):
    besides = [f"{name}={files[f'{name}.nc']}" for name in ("bonded", "measured")]
    done = ask(
        *("analyse", files["parted.nc"], "--label", "delaminated", "--show", "frf,orders,shock"),
        *("--beside", besides[0], "--beside", besides[1]),
        *("--format", "nc,csv", "--resolution", "2", "--damping", "0.02", "--orders", "0.5,1,2"),
        *("--periods", "20", "--window", "flattop", "--overlap", "0.7"),
    ).success()
    for label in ("delaminated", "bonded", "measured"):
        assert f"{label}:\nfrequency response" in done.out
    folder = tmp_path / "results"
    assert all(map(shows_something, folder.glob("*.png"))) and [*folder.glob("*.png")]
    frf, orders, shock = (
        xr.load_dataset(next(folder.glob(f"analyse_{name}_parted*.nc")))
        for name in ("frf", "orders", "shock")
    )
    assert orders.order.values.tolist() == [0.5, 1.0, 2.0] and orders.attrs["periods"] == 20.0
    assert float(shock.damping) == 0.02 and float(frf.resolution) == 2.0
    assert frf.attrs["window"] == "flattop" and frf.attrs["overlap"] == 0.7
    assert len([*folder.glob("*.csv")]) >= 9


def test_what_sensors_read_of_a_simulated_test_is_a_record(ask, tmp_path):
    """Of a stored one too; played again by its columns; what sensors cannot is refused at once."""
    shaken = "--structure beam --swept-sine 11:13 --duration 4 --acceleration 1 --plot none"
    sensors = "--sensor 150:400 --noise 30ug --range 9g --format nc,csv"
    own = tmp_path / "mine.nc"
    out = ask("shake", *f"{shaken} {sensors}".split(), "--store", own).success().out
    paths = re.findall("(.*): what the sensors read", out)
    assert paths == [str(tmp_path / f"mine_sensors.{ending}") for ending in ("nc", "csv")]
    assert re.search(r"acceleration of the box: -1 to 1 m/s2, rms 0\.7\d* m/s2", out), out
    history = orchestrate.shake(orchestrate.Structure.from_file("beam"), SWEEP)
    errors = {"noise": 30e-6 * 9.80665, "range": 9.0 * 9.80665}
    sensor = orchestrate.Sensor(bandwidth=150.0, sample_rate=400.0, **errors)
    felt = orchestrate.measure(history, sensor, excitation=SWEEP)
    for path in paths:
        read = orchestrate.read_record(path).acceleration1.values
        assert read == pytest.approx(felt.acceleration1.values, rel=1e-9, abs=1e-9)
    assert "by its name" in ask("channels", paths[0], output=tmp_path / "setup.toml").out
    between, read = (
        said(ask("analyse", own, "--show", "psd", *NO_PLOT, *more))
        for more in ((), ("--sensor", "150"))
    )
    assert read and read != between
    played = ("shake", "--structure", "beam", "--record", paths[1], *NO_PLOT)
    assert re.search(r"acceleration of the box: -[\d.]+ to ", ask(*played).success().out)
    done = ask(*played, "--column", "side")
    assert done.code and "no column 'side'; expected one of" in done.err
    for options, words in {
        "--noise 1": "--noise: of sensors; expected --sensor HZ with it",
        "--sensor 9 --noise 3ug/Hz": "--noise 3ug/Hz: expected a number",
        "--sensor 9 --set wall=true": "wall = True: --sensor does not know it yet",
    }.items():
        ask("shake", "--hammer", "20:0.004", *options.split()).complaint(words)


def test_knocks_on_each_half_make_a_structure(ask, tmp_path):
    """From records of a hammer to the file that a plan or a diagnosis begins with."""
    beam = orchestrate.Structure.from_file("beam").replace(clearance=0.001)
    paths = [tmp_path / f"half{half}.csv" for half in (1, 2)]
    for half, path in enumerate(paths, 1):
        knock = orchestrate.Hammer(peak=5.0, width=0.01, half=half, duration=8.0)
        history = orchestrate.shake(beam, knock, sample_rate=500.0)
        channels = {"force1": f"force{half}", "acceleration1": f"a{half}_abs"}
        values = {name: history[one].values for name, one in channels.items()}
        orchestrate.write_record(orchestrate.record(time=history.time.values, **values), path)
    out = ask("halves", *paths, output=tmp_path / "beam.toml").success().out
    assert "half2.csv: taken for knocks on half 2, as the second record" in out
    assert "e = 0.7 and clearance = 0 m are assumed" in out
    shown = [float(found) for found in re.findall(r"^ +[12] +\S+ \+- \S+ +(\S+) \+-", out, re.M)]
    assert shown == pytest.approx((beam.f1, beam.f2), rel=1e-3), out
    ask("halves", paths[0], paths[0]).complaint("half1.csv: the same numbers as", "each half")
    fitted = orchestrate.Structure.from_file(tmp_path / "beam.toml")
    assert (fitted.f1, fitted.f2) == pytest.approx((beam.f1, beam.f2), rel=1e-3)
    assert (fitted.m1, fitted.m2) == pytest.approx((beam.m1, beam.m2), rel=0.04)
