"""``analyse``: records in, numbers and one picture out."""

from __future__ import annotations

import re

import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread
from scipy.io import wavfile

import orchestrate

RATE = 1000.0


def sweep(order_2=0.0, second=True, noise=0.0):
    """A swept sine from 20 to 60 Hz, and a response of known orders."""
    time = np.arange(10_000) / RATE
    angle = 2.0 * np.pi * (20.0 * time + 2.0 * time**2)
    box, response = 2.0 * np.sin(angle), 6.0 * np.sin(angle) + order_2 * np.sin(2.0 * angle)
    response += noise * np.random.default_rng(1).normal(size=len(time))
    channels = {"box_acceleration": box, "acceleration1": response, "acceleration2": 0.5 * response}
    chosen = list(channels)[: 2 + second]
    return xr.Dataset(
        {name: ("time", channels[name]) for name in chosen},
        {"time": time},
        {"sample_rate": RATE, "title": "A sweep"},
    )


@pytest.fixture
def files(tmp_path):
    """Three records: bonded, delaminated, and measured with one accelerometer."""
    records = {
        "bonded": sweep(),
        "parted": sweep(0.6),
        "measured": sweep(0.5, second=False, noise=0.01),
    }
    for name, record in records.items():
        record.to_netcdf(tmp_path / f"{name}.nc")
    return {name: tmp_path / f"{name}.nc" for name in records}


def shows_something(path):
    picture = imread(path)
    return picture.std() > 0.02 and min(picture.shape[:2]) > 100


ALL = ("frf", "psd", "orders", "harmonics", "spectrogram", "shock", "density")


@pytest.mark.parametrize("show", ALL)
def test_each_analysis_says_its_numbers(ask, tmp_path, files, show):
    cut = ("--from", "0.5", "--to", "9.5", "--plot", "none")
    done = ask("analyse", files["parted"], "--show", show, *cut).success()
    words = {
        "frf": ["largest |H1|", "mass 1   3 at", "mass 2   1.5 at"],
        "psd": ["rms m/s2", "1.41", "4.2"],
        "orders": ["order 1", "6 m/s2 at", "0.6 m/s2 at"],
        "harmonics": ["largest distortion", "0.1 at"],
        "spectrogram": ["largest amplitude", "box      1.", "mass 1   "],
        "shock": ["largest maximax", "mass 1   "],
        "density": ["skewness_error", "1.5"],
    }[show]
    assert all(word in done.out for word in words), done.out
    folder = tmp_path / "results"
    (stored,) = folder.glob("*")
    assert str(stored) in done.out
    assert stored.name.startswith(f"analyse_{show}_parted_")
    assert show in xr.load_dataset(stored).attrs["analysis"]


def test_three_records_in_one_picture(ask, tmp_path, files):
    done = ask(
        *("analyse", files["parted"], "--label", "delaminated", "--show", "frf"),
        *("--beside", f"bonded={files['bonded']}", "--beside", f"measured={files['measured']}"),
        *("--format", "nc,csv", "--resolution", "2"),
    ).success()
    for label in ("delaminated", "bonded", "measured"):
        assert f"{label}:\nfrequency response" in done.out
    assert done.out.count("mass 2") == 2 and done.out.count("mass 1") == 3
    folder = tmp_path / "results"
    (picture,) = folder.glob("*.png")
    assert str(picture) in done.out and shows_something(picture)
    assert len(list(folder.glob("*.nc"))) == 3
    assert list(folder.glob("*.csv"))


def test_options_reach_the_analysis(ask, tmp_path, files):
    ask(
        *("analyse", files["parted"], "--show", "orders,shock,density,psd", "--plot", "none"),
        *("--orders", "0.5,1,2", "--periods", "20", "--damping", "0.02", "--bins", "30"),
        *("--resolution", "4", "--window", "flattop", "--overlap", "0.7"),
    ).success()
    stored = {path.name.split("_")[1]: path for path in (tmp_path / "results").glob("*.nc")}
    orders, shock, density, psd = (
        xr.load_dataset(stored[name]) for name in ("orders", "shock", "density", "psd")
    )
    assert orders.order.values.tolist() == [0.5, 1.0, 2.0] and orders.attrs["periods"] == 20.0
    assert float(shock.damping) == 0.02 and density.sizes["bin"] == 30
    assert float(psd.resolution) == 4.0 and psd.attrs["window"] == "flattop"
    assert psd.attrs["overlap"] == 0.7 and not list((tmp_path / "results").glob("*.png"))


MISTAKES = """
    FILE --beside x=lost.nc : --beside lost.nc: no such file
    FILE --show orders --orders 2.5 : orders = 2.5: expected
    FILE --resolution 0.001 : resolution = 0.001 Hz | parted.nc
    FILE --from 20 : nothing between --from and --to; it has 0 to 9.999 s
    FILE --sensor fast : --sensor fast: expected HZ or HZ:RATE
    bench.csv : bench.csv | no unit | --unit
    bench.csv --unit stone : unit = 'stone'
    bench.csv --unit g --columns acceleration1=9 : no column 9
    bench.csv --unit g --columns mass=1 : no channel 'mass'
"""


@pytest.mark.parametrize("line", MISTAKES.strip().splitlines())
def test_mistakes_are_one_line(ask, tmp_path, files, line):
    in_g(sweep(second=False), tmp_path / "bench.csv")
    options, _, words = line.strip().partition(" : ")
    options = options.replace("FILE", str(files["parted"]))
    options = options.replace("bench.csv", str(tmp_path / "bench.csv"))
    if "--sensor" in options:  # of a result of shake
        with_impulses = xr.load_dataset(files["parted"]).assign(impulse=("impact", [1.0]))
        with_impulses.to_netcdf(files["parted"])
    ask("analyse", *options.split()).complaint(*(word.strip() for word in words.split("|")))
    assert not (tmp_path / "results").exists() or not any((tmp_path / "results").iterdir())


def test_sensors_read_a_result_of_shake(ask, tmp_path):
    beam = orchestrate.Structure.from_file("beam")
    sweep = orchestrate.SweptSine(first=11.0, last=13.0, duration=4.0, acceleration=1.0)
    file = tmp_path / "shaken.nc"
    orchestrate.shake(beam, sweep, sample_rate=400.0, store=file, progress=False)
    between = ask("analyse", file, "--show", "psd").success().out
    read = ask("analyse", file, "--show", "psd", "--sensor", "150").success().out
    assert "rms" in read and read != between


def test_what_sensors_read_of_a_simulated_test_is_a_record(ask, tmp_path):
    shaken = "--structure beam --swept-sine 11:13 --duration 4 --acceleration 1 --plot none"
    sensors = "--sensor 150:400 --noise 30ug --range 9g --format nc,csv"
    own = tmp_path / "mine.nc"
    out = ask("shake", *f"{shaken} {sensors}".split(), "--store", own).success().out
    paths = re.findall("(.*): what the sensors read", out)
    assert paths == [str(tmp_path / f"mine_sensors.{ending}") for ending in ("nc", "csv")]
    assert re.search(r"acceleration of the box: -1 to 1 m/s2, rms 0\.7\d* m/s2", out), out
    sweep = orchestrate.SweptSine(first=11.0, last=13.0, duration=4.0, acceleration=1.0)
    history = orchestrate.shake(orchestrate.Structure.from_file("beam"), sweep)
    sensor = orchestrate.Sensor(
        bandwidth=150.0, sample_rate=400.0, noise=30e-6 * 9.80665, range=9.0 * 9.80665
    )
    felt = orchestrate.measure(history, sensor, excitation=sweep)
    for path in paths:
        read = orchestrate.read_record(path).acceleration1.values
        assert read == pytest.approx(felt.acceleration1.values, rel=1e-9, abs=1e-9)
    assert "by its name" in ask("channels", paths[0], output=tmp_path / "setup.toml").out


def test_columns_in_their_order_are_a_proposal_and_said_to_be_one(ask, tmp_path):
    for names, proposed in (("t [s],Ch1 [g],Ch2 [g]", True), ("t [s],base [g],top [g]", False)):
        path = tmp_path / "run.csv"
        path.write_text("\n".join([names, *(f"{i / 100},{i % 3},{i % 7}" for i in range(60))]))
        done = ask("channels", path, output=tmp_path / "setup.toml")
        assert done.code == 0
        said = '"Ch1" as base, "Ch2" as face 1; see that it is right'
        assert any("a proposal by the columns' order" in one for one in done.complaints) == proposed
        assert not proposed or said in done.complaints[0]


@pytest.mark.parametrize(("rate", "few"), [("19", 1), ("21", 0)])
def test_a_rate_that_does_not_show_the_excitation_is_wondered_at(ask, rate, few):
    options = "--structure beam --swept-sine 8:10 --duration 1 --g 0.02 --plot none --sample-rate"
    done = ask("shake", *options.split(), rate)
    assert len(done.complaints) == few and (not few or "default is 200" in done.complaints[0])


SENSORS = """
    --noise 1 : --noise: of sensors; expected --sensor HZ with it
    --sensor 9 --noise 3ug/Hz : --noise 3ug/Hz: expected a number, with (m/s2)/sqrt(Hz) or ug
    --sensor 9 --set wall=true : wall = True: --sensor does not know it yet
"""


@pytest.mark.parametrize("line", SENSORS.strip().splitlines())
def test_sensors_are_refused_before_anything_is_computed(ask, tmp_path, line):
    options, _, words = line.strip().partition(" : ")
    ask("shake", "--hammer", "20:0.004", *options.split()).complaint(words)
    assert not list(tmp_path.rglob("*.nc"))


def in_g(record, path):
    """An export of an analyser: g, a decimal comma, channels by the names of its inputs."""
    rows = zip(record.time.values, *(record[name].values / 9.80665 for name in record), strict=True)
    lines = [";".join(f"{value:.9f}" for value in row).replace(".", ",") for row in rows]
    path.write_text("\n".join(["Zeit [s];AI 1;AI 2", *lines]) + "\n")


def said(done):
    """The numbers that a command prints, without the names of files."""
    return [line for line in done.out.splitlines() if line.startswith("  ")]


@pytest.mark.parametrize("kind", ["csv", "wav"])
def test_records_of_all_kinds_of_files(ask, tmp_path, files, kind):
    """What is said of a file is what is said of the same record in NetCDF."""
    record, options = sweep(0.5, second=False), []
    path = tmp_path / f"of_the_bench.{kind}"
    if kind == "csv":
        in_g(record, path)
        options = ["--unit", "g", "--columns", "time=0, box_acceleration=AI 1,acceleration1=2"]
    else:
        values = np.stack([record[name].values for name in record], axis=1) / 10.0
        wavfile.write(path, int(RATE), values)
        options = ["--scale", "10"]
    show = ("--show", "psd,orders", "--orders", "2", "--plot", "none", "--units", "m/s2")
    done = ask("analyse", path, *options, *show).success()
    record.to_netcdf(tmp_path / "plain.nc")
    assert said(done) == said(ask("analyse", tmp_path / "plain.nc", *show).success())
    assert any("  0.5 m/s2 at" in line for line in said(done))


def test_knocks_on_each_half_make_a_structure(ask, tmp_path):
    """From records of a hammer to the file that a plan or a diagnosis begins with."""
    beam = orchestrate.Structure.from_file("beam").replace(clearance=0.001)
    paths = [tmp_path / f"half{half}.csv" for half in (1, 2)]
    for half, path in enumerate(paths, 1):
        knock = orchestrate.Hammer(peak=5.0, width=0.01, half=half, duration=8.0)
        history = orchestrate.shake(beam, knock, sample_rate=500.0)
        channels = {"force1": f"force{half}", "acceleration1": f"a{half}_abs"}
        values = {name: history[one].values for name, one in channels.items()}
        record = orchestrate.record(time=history.time.values, **values)
        orchestrate.write_record(record, path)
    out = ask("halves", *paths, output=tmp_path / "beam.toml").success().out
    assert "half2.csv: taken for knocks on half 2, as the second record" in out
    assert "e = 0.7 and clearance = 0 m are assumed" in out
    both = orchestrate.read_record(paths[1]).assign(acceleration2=lambda one: one.acceleration1)
    orchestrate.write_record(both.assign(acceleration1=-both.acceleration1), tmp_path / "both.csv")
    assert said(ask("halves", paths[0], tmp_path / "both.csv")) == said(ask("halves", *paths))
    ask("halves", paths[0], paths[0]).complaint("half1.csv: the same numbers as", "each half")
    hard = orchestrate.Hammer(peak=500.0, width=0.01, half=2, duration=8.0)
    history = orchestrate.shake(beam.replace(clearance=0.0), hard, sample_rate=500.0)
    sensor = orchestrate.Sensor(bandwidth=100.0, sample_rate=500.0)
    orchestrate.write_record(orchestrate.measure(history, sensor), tmp_path / "hard.csv")
    ask("halves", paths[0], tmp_path / "hard.csv").complaint("hard.csv: one oscillator leaves")
    fitted = orchestrate.Structure.from_file(tmp_path / "beam.toml")
    assert (fitted.f1, fitted.f2) == pytest.approx((beam.f1, beam.f2), rel=1e-3)
    assert (fitted.m1, fitted.m2) == pytest.approx((beam.m1, beam.m2), rel=0.04)
