"""``analyse``: records in, numbers and one picture out."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread

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
    return picture.std() > 0.02 and min(picture.shape[:2]) > 300


ALL = ("frf", "psd", "orders", "harmonics", "spectrogram", "shock", "density")


@pytest.mark.parametrize("show", ALL)
def test_each_analysis_says_its_numbers_and_draws(ask, tmp_path, files, show):
    done = ask("analyse", files["parted"], "--show", show, "--from", "0.5", "--to", "9.5").success()
    words = {
        "frf": ["mass 1: |H1| has its largest value 3", "1.0000 in the median", "mass 2: |H1|"],
        "psd": ["box: 1.41", "mass 1: 4.2"],
        "orders": ["mass 1: largest amplitudes in m/s2: order 1 6 at", "order 2 0.6 at"],
        "harmonics": ["mass 1: distortion 10 % in the median"],
        "spectrogram": ["box: largest amplitude 1.", "mass 1: largest amplitude"],
        "shock": ["mass 1: largest response"],
        "density": ["box: skewness", "kurtosis 1.5"],
    }[show]
    assert all(word in done.out for word in words), done.out
    folder = tmp_path / "results"
    (stored,), (picture,) = folder.glob("*.nc"), folder.glob("*.png")
    assert str(stored) in done.out and str(picture) in done.out
    assert stored.name.startswith(f"analyse_{show}_parted_")
    assert show in xr.load_dataset(stored).attrs["analysis"]
    assert shows_something(picture)


def test_three_records_in_one_picture(ask, tmp_path, files):
    done = ask(
        *("analyse", files["parted"], "--label", "delaminated", "--show", "frf,orders"),
        *("--beside", f"bonded={files['bonded']}", "--beside", f"measured={files['measured']}"),
        *("--format", "nc,csv", "--resolution", "2"),
    ).success()
    assert "delaminated: mass 2" in done.out and "bonded: mass 2" in done.out
    assert "measured: mass 1" in done.out and "measured: mass 2" not in done.out
    folder = tmp_path / "results"
    assert len(list(folder.glob("*.png"))) == 2
    assert len(list(folder.glob("*.nc"))) == 6
    assert list(folder.glob("*.csv"))
    assert all(map(shows_something, folder.glob("*.png")))


def test_another_part_of_a_record_has_files_of_its_own(ask, tmp_path, files):
    for end in ("1", "2", "3"):
        ask("analyse", files["parted"], "--show", "psd", "--to", end, "--plot", "none").success()
    assert len(list((tmp_path / "results").glob("*.nc"))) == 3


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


def test_a_stored_result_of_shake(ask, tmp_path):
    options = ("--structure", "beam", "--random", "5:0.05,40:0.05", "--duration", "20")
    ask("shake", *options, "--plot", "none").success()
    (path,) = (tmp_path / "results").glob("shake*.nc")
    done = ask("analyse", path, "--show", "frf", "--from", "5").success()
    assert "mass 1: |H1| has its largest value" in done.out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["nowhere.nc"], ["FILE nowhere.nc: no such file"]),
        (["FILE", "--show", "frequency"], ["--show frequency", "expected some of frf, psd"]),
        (["FILE", "--beside", "whole.nc"], ["--beside whole.nc: expected LABEL=FILE"]),
        (["FILE", "--beside", "x=lost.nc"], ["--beside lost.nc: no such file"]),
        (["FILE", "--beside", "parted=x.nc"], ["a second record parted"]),
        (["FILE", "--damping", "0.1"], ["--damping: expected with --show shock alone"]),
        (["FILE", "--show", "orders", "--orders", "one"], ["--orders one: expected"]),
        (["FILE", "--show", "orders", "--orders", "2.5"], ["orders = 2.5: expected"]),
        (["FILE", "--resolution", "0.001"], ["resolution = 0.001 Hz", "parted.nc"]),
        (["FILE", "--window", "round"], ["window = 'round'", "hann"]),
        (["FILE", "--from", "20"], ["nothing between --from and --to; it has 0 to 9.999 s"]),
        (["FILE", "--plot", "gif"], ["--plot gif", "png"]),
        (["FILE", "--show", "shock", "--damping", "1"], ["damping = 1.0: expected 0 <="]),
    ],
)
def test_mistakes_are_one_line(ask, tmp_path, files, options, words):
    given = [files["parted"] if option == "FILE" else option for option in options]
    done = ask("analyse", *given)
    done.complaint(*words)
    assert not (tmp_path / "results").exists() or not any((tmp_path / "results").iterdir())


def test_a_file_that_is_no_record(ask, tmp_path):
    xr.Dataset({"x": ("y", [1.0, 2.0])}).to_netcdf(tmp_path / "other.nc")
    ask("analyse", tmp_path / "other.nc").complaint("other.nc: record", "without time")
