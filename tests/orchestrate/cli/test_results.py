"""What commands leave: results that describe themselves, pictures; finished ones stay."""

from __future__ import annotations

import functools
import math

import netCDF4
import numpy as np
import pytest
import xarray as xr
from matplotlib import image

import orchestrate
from orchestrate.access import OSCILLATOR, find
from orchestrate.version import __version__

SWEEP = ("sweep", "--eta", "1.28:1.31:0.005", "--transient", "20", "--samples", "12")
NAME = "sweep_e0.7_D0.005_eta1.28-1.31_up_1cc308"


def fingerprint(folder):
    """Bytes and times of all that is there."""
    return {p.name: (p.read_bytes(), p.stat().st_mtime_ns) for p in folder.iterdir()}


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "results"


def result_in(folder):
    """The one result in a folder."""
    (path,) = folder.glob("*.nc")
    return xr.load_dataset(path)


def shows_something(path):
    """Whether a picture has dots, frame and labels on white."""
    grey = image.imread(path)[..., :3].mean(axis=2)
    return min(grey.shape) > 300 and 0.001 < (grey < 0.5).mean() < 0.5


def test_a_sweep(ask, folder):
    done = ask(*SWEEP)
    assert done.code == 0
    assert sorted(fingerprint(folder)) == [f"{NAME}.nc", f"{NAME}.png"]
    assert "largest gap: xi_Rel = " in done.out and str(folder / f"{NAME}.png") in done.out
    assert shows_something(folder / f"{NAME}.png")
    data, fmu = xr.load_dataset(folder / f"{NAME}.nc"), find(OSCILLATOR)
    assert data.xi_rel.dims == ("eta", "sample") and data.xi_rel.shape == (7, 12)
    np.testing.assert_array_equal(data.sample, np.arange(21, 33))
    about = {"e": 0.7, "d1": 0.01, "k2": 1.2, "transient": 20, "samples": 12, "direction": "up"}
    about |= {"fmu_guid": fmu.guid, "fmu_model": fmu.name, "fmi_version": fmu.fmi_version}
    assert {key: data.attrs[key] for key in about} == about
    assert __version__ in data.attrs["source"] and data.attrs["call"].startswith("sweep(")
    assert all(len(str(value)) < 4000 for value in data.attrs.values())
    with netCDF4.Dataset(folder / f"{NAME}.nc") as found:
        assert all(v.units and v.long_name for v in found.variables.values())


def test_what_is_finished_stays_as_it_is(ask, folder):
    ask(*SWEEP)
    before = fingerprint(folder)
    again = ask(*SWEEP)
    assert again.code == 0 and f"{NAME}.nc: complete already" in again.out
    assert fingerprint(folder) == before
    (folder / f"{NAME}.png").unlink()
    ask(*SWEEP)
    assert fingerprint(folder).keys() == before.keys()
    assert fingerprint(folder)[f"{NAME}.nc"] == before[f"{NAME}.nc"]


def test_force_computes_the_same_bytes_anew(ask, folder, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    ask(*SWEEP)
    before = fingerprint(folder)
    assert ask(*SWEEP, "--force").code == 0
    for name, (content, time) in fingerprint(folder).items():
        assert content == before[name][0] and time != before[name][1]


@pytest.mark.parametrize("option", [("--samples", "13"), ("--eta", "1.28:1.31:0.01")])
def test_another_question_has_another_file(ask, folder, option):
    ask(*SWEEP)
    before = fingerprint(folder)
    assert ask(*SWEEP, *option).code == 0
    after = fingerprint(folder)
    assert len(after) == 4 and before.items() <= after.items()


def test_a_file_of_ones_own_is_not_replaced_by_another_question(ask, folder):
    own = folder / "mine.nc"
    assert ask(*SWEEP, "--store", own).code == 0
    before = fingerprint(folder)
    assert sorted(before) == ["mine.nc", "mine.png"]
    ask(*SWEEP, "--samples", "13", "--store", own).complaint(own, "different calculation", "force")
    own.unlink()
    for force in ([], ["--force"]):
        ask(*SWEEP, "--store", own, *force).complaint("mine.png", "choose another --store")
    assert fingerprint(folder) == {"mine.png": before["mine.png"]}


def test_an_interrupted_force_leaves_the_result_that_was_there(ask, folder, monkeypatch):
    assert ask(*SWEEP).code == 0
    before = fingerprint(folder)

    def interrupt(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("orchestrate.response.sweep.SweepJob.work", interrupt)
        assert ask(*SWEEP, "--force").code == 130
    assert fingerprint(folder) == before
    assert "complete already" in ask(*SWEEP).out


def test_a_file_of_others_stays_whatever_is_forced(ask, folder):
    folder.mkdir()
    own = folder / "mine.nc"
    own.write_text("my notes")
    for force in ([], ["--force"]):
        ask(*SWEEP, "--store", own, *force).complaint("mine.nc", "remove it", code=1)
    assert own.read_text() == "my notes" and len(fingerprint(folder)) == 1


def test_a_failed_picture_is_drawn_by_the_same_command(ask, folder):
    picture = folder / f"{NAME}.png"
    picture.mkdir(parents=True)  # stands for a full disk, or a kill, at that moment
    ask(*SWEEP, "--force").complaint(picture, code=1)
    picture.rmdir()
    assert ask(*SWEEP).code == 0
    assert picture.is_file()


def test_a_list_is_taken_in_its_own_order(ask, folder):
    ask("sweep", "--eta", "1.31, 1.28,2", "--transient", "3", "--samples", "2")
    data = result_in(folder)
    assert data.eta.values.tolist() == [1.31, 1.28, 2.0]
    assert data.attrs["direction"] == "given"


def test_up_and_down_in_one_picture(ask, folder):
    done = ask(*SWEEP, "--direction", "both")
    data = result_in(folder)
    assert data.direction.values.tolist() == ["up", "down"]
    assert "up and down differ" in done.out
    assert shows_something(next(folder.glob("*.png")))


def test_over_another_parameter_of_an_own_structure(ask, folder, tmp_path):
    path = tmp_path / "own.toml"
    path.write_text("[structure]\nm1 = 1.5\nm2 = 1.2\nk1 = 8000.0\nk2 = 9000.0\nd1 = 1.0\n")
    asked = ("--over", "e", "--values", "0.1:0.9:0.2", "--eta", "1.1", "--samples", "4")
    assert ask("sweep", "--structure", path, "--set", "d2=2", *asked).code == 0
    data = result_in(folder)
    assert data.xi_rel.dims == ("e", "sample")
    assert {n: data.attrs[n] for n in ("m1", "d2")} == {"m1": 1.5, "d2": 2.0}


def test_the_default_range_is_the_papers(ask, monkeypatch):
    asked = {}

    @functools.wraps(orchestrate.sweep)  # whose options are its arguments
    def sweep(structure, **question):
        asked.update(question, structure=structure)
        raise KeyboardInterrupt

    monkeypatch.setattr("orchestrate.sweep", sweep, raising=False)
    assert ask("sweep").code == 130
    assert list(asked["eta"]) == [float(f"{n / 1000:.3f}") for n in range(100, 8001)]
    assert asked["structure"].label() == "e0.7_D0.005"


def test_a_motion(ask, folder):
    done = ask("simulate", "--eta", "0.4", "--transient", "50", "--periods", "2", "--points", "50")
    assert "60 impacts" in done.out and "2 of them begin permanent contact" in done.out
    assert shows_something(next(folder.glob("*.png")))


def test_the_same_motion_told_in_other_units(ask, folder):
    short = ("simulate", "--structure", "beam", "--periods", "2", "--plot", "none")
    told = (
        ("--frequency", "80", "--amplitude", "0.001"),
        ("--hz", f"{80 / (2 * np.pi)!r}", "--g", f"{0.001 * 80**2 / 9.80665!r}"),
        ("--rpm", f"{80 * 30 / np.pi!r}", "--amplitude", "0.001"),
        ("--eta", f"{80 / 75!r}", "--amplitude", "0.001"),
    )
    for options in told:
        assert ask(*short, *options).code == 0
    motions = [xr.load_dataset(path).x1.values for path in folder.glob("*.nc")]
    for motion in motions:
        np.testing.assert_allclose(motion, motions[0], rtol=1e-9, atol=1e-15)


def test_a_motion_with_the_bonded_structure_beside_it(ask, folder):
    done = ask("simulate", "--eta", "1.047", "--periods", "2", "--beside")
    assert done.code == 0 and "no impacts" in done.out and "the fastest at" in done.out
    assert len(list(folder.glob("*.nc"))) == 2
    assert shows_something(next(folder.glob("*.png")))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            ("--swept-sine", "12:14", "--duration", "2", "--g", "0.02", "--beside"),
            ("no impacts", "delaminated:", "impacts, the hardest of"),
        ),
        (
            ("--swept-sine", "20:10", "--rate", "20", "--spacing", "log", "--g", "5:0.01,50:0.1"),
            ("largest accelerations: box 0.", "impacts"),
        ),
        (("--random", "5:0.1,40:0.1", "--duration", "2"), ("largest gap", "impacts")),
        (
            ("--shock", "half-sine", "--length", "0.011", "--acceleration", "49"),
            ("box 48.5, masses", "4 impacts", "no permanent contact begins"),
        ),
    ],
)
def test_shaken_as_in_the_laboratory(ask, folder, options, words):
    done = ask("shake", "--structure", "beam", "--sample-rate", "400", *options)
    assert done.code == 0, done.err
    assert all(word in done.out for word in words), done.out
    assert len(list(folder.glob("*.nc"))) == 1 + ("--beside" in options)
    assert shows_something(next(folder.glob("*.png")))


def test_another_record_has_files_of_its_own(ask, folder, tmp_path):
    """Though it has as many samples at the same rate."""
    for name, level in (("one", 1.0), ("other", 2.0)):
        rows = [f"{i / 200.0!r},{level * (i % 7)!r}" for i in range(60)]
        (tmp_path / f"{name}.csv").write_text("time [s],box [m/s2]\n" + "\n".join(rows) + "\n")
        ask("shake", "--structure", "beam", "--record", tmp_path / f"{name}.csv").success()
    assert len(list(folder.glob("*.nc"))) == 2


def test_a_record_is_played_again(ask, folder, tmp_path):
    path = tmp_path / "base.csv"
    rows = (f"{i};{math.sin(0.2 * i):.6f};{0.02 * math.sin(0.075 * i):.6f}" for i in range(1500))
    text = "t [ms];top [g];base [g]\n" + "\n".join(rows) + "\n"
    path.write_text(text.replace(".", ","))
    done = ask("shake", "--structure", "beam", "--record", path, "--column", "2")
    assert done.code == 0, done.err
    assert "largest accelerations: box 0.196" in done.out and "impacts" in done.out
    named = ask("shake", "--structure", "beam", "--record", path)
    assert named.out.splitlines()[0] == done.out.splitlines()[0]
    done = ask("shake", "--structure", "beam", "--record", path, "--column", "side")
    assert done.code and "no column 'side'; expected one of t, top, base" in done.err


def test_spectra(ask, folder):
    short = ("--transient", "300", "--periods", "8", "--points", "256")
    done = ask("spectra", "--eta", "1.047", *short)
    assert "delaminated at eta = 1.047: largest line" in done.out
    assert shows_something(next(folder.glob("*.png")))
