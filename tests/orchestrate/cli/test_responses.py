"""What commands print and leave: results that describe themselves, pictures; finished ones stay."""

from __future__ import annotations

import functools
import math
import re

import netCDF4
import numpy as np
import pytest
import xarray as xr
from matplotlib import image

import orchestrate
from orchestrate import InputError, Structure, cli
from orchestrate.cli import responses
from orchestrate.cli.diagnosis import Plan
from orchestrate.cli.options import OfBox
from orchestrate.dynamics.borders import lies_on_curve
from orchestrate.fmu import OSCILLATOR, find
from orchestrate.version import __version__

SWEEP = ("sweep", "--eta", "1.28:1.31:0.005", "--transient", "20", "--samples", "12")
SHORT = ("--transient", "60", "--samples", "16")


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "results"


def shows_something(path):
    """Whether a picture has lines, dots or colours on white."""
    grey = image.imread(path)[..., :3].mean(axis=2)
    return min(grey.shape) > 100 and 0.001 < (grey < 0.95).mean() < 0.95


def test_the_excitation_of_the_file(ask, folder, tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(
        "[structure]\nm1 = 1.5\nomega_hz = 11.9\nD = 0.005\n\n"
        "[excitation]\nfrequency_hz = 12.6\nacceleration_g = 0.02\nphase = 0.5\n"
    )
    short = ("simulate", "--structure", path, "--periods", "1", "--plot", "none")
    told = ("--hz", "12.6", "--g", "0.02", "--phase", "0.5")
    done, same = ask(*short), ask(*short, *told)
    assert done.code == same.code == 0, done.err
    assert done.out.splitlines()[:-1] == same.out.splitlines()[:-1]


def test_exponents_along_a_sweep(ask, folder):
    eta = [1.36, 1.3]
    options = ("--eta", "1.36,1.3", "--periods", "100", "--transient", "50", "--plot", "none")
    assert ask("lyapunov", *options, "--follow", "down").code == 0
    (path,) = folder.glob("*.nc")
    swept = orchestrate.sweep(
        Structure(), eta=eta, direction="down", transient=50, samples=1, progress=False
    )
    along = {"start": swept, "transient": 50, "periods": 100, "progress": False}
    expected = orchestrate.lyapunov(Structure(), eta=eta, **along)
    np.testing.assert_array_equal(xr.load_dataset(path).exponent, expected.exponent)


TRIVIAL = [
    (("simulate", "--eta", "1", "--set", "kappa=1"), "both oscillators are alike"),
    (("sweep", "--eta", "1.2", *SHORT), "one value, eta = 1.2: a table and no picture"),
    (
        ("resonance", "--eta", "1.2", *SHORT),
        "bonded up  bonded down  delaminated up  delaminated down  unit\n  xi_rel_max",
    ),
    (("sweep", "--eta", "2:2.1:0.05", "--direction", "both", "--samples", "8"), "gap nowhere"),
    (("resonance", "--eta", "0.3:0.4:0.05", *SHORT), "no peak in this range"),
    (
        ("resonance", "--set", "mu=0.5", "--set", "kappa=1.9", "--set", "D=0.02", "--set", "e=0.8")
        + ("--eta", "3.4:4.2:0.01"),
        "peaks of irregular responses, left out: ",
    ),
    (
        ("sweep", "--set", "e=0.86", "--eta", "0.827,0.9", "--transient", "240", "--samples", "60"),
        "undecided (50 %); undecided: slow to converge or nearly periodic, --transient 5000",
    ),
    (("lyapunov", "--eta", "2.9", "--periods", "50", "--spectrum"), "kaplan_yorke_dimension"),
    (("lyapunov", "--eta", "1", "--set", "bonded=true", "--periods", "20"), "there are no impacts"),
]


@pytest.mark.parametrize(("words", "said"), TRIVIAL, ids=lambda value: " ".join(value)[:60])
def test_what_is_trivial_is_said(ask, words, said):
    done = ask(*words, "--plot", "none")
    assert done.code == 0 and said in done.out, done.err


def made_sweep(kinds, impacts, **sizes):
    """A made-up sweep of responses: their kinds, as ``multiplicity_decided`` has them."""
    words = {"flag_values": [0, 1, 2], "flag_meanings": "irregular repeated undecided"}
    count = len(kinds)
    eta = 1.0 + 0.01 * np.arange(count)
    numbers = {"xi_rel_max": np.linspace(1.0, 2.0, count), "impacts_per_period": impacts}
    numbers |= {name: np.full(count, 0.5) for name in ("x1_max", "x2_max", "a1_max", "a2_max")}
    numbers |= {"multiplicity": np.ones(count, dtype=int), "permanent_contact": np.zeros(count)}
    data = xr.Dataset({name: ("eta", values) for name, values in numbers.items()}, {"eta": eta})
    data = data.assign(multiplicity_decided=("eta", kinds, words))
    for name in ("x1_max", "x2_max"):
        data[name].attrs["units"] = "m"
    return data.assign_attrs(k1=1.0, m1=1.0)


def test_a_sweep_is_summed_up_in_a_table_of_ten_lines():
    """Made-up: twelve windows of which the shortest are left out; impacts divide windows too."""
    kinds = np.repeat([1, 0, 1, 2, 1, 0, 1, 0, 1, 0, 1, 0], [9, 2, 20, 6, 8, 3, 7, 1, 5, 1, 4, 1])
    impacts = np.where(np.arange(len(kinds)) < 21, 1.0, 2.0)
    lines = list(responses.Sweep().summary(made_sweep(kinds, impacts)))
    counts = "67 responses: 53 repeat (79 %), 8 irregular (12 %), 6 undecided (9 %); undecided"
    assert any(line.startswith(counts) and "--transient 5000" in line for line in lines)
    first = next(i for i, line in enumerate(lines) if "widest windows" in line)
    rows = [line for line in lines[first:] if line.startswith("  ")]
    assert len(rows) == 10
    assert rows[1].split() == ["eta", "=", "1", "to", "1.08", "after", "1", "T", "1"]
    assert rows[2].split() == ["eta", "=", "1.11", "to", "1.2", "after", "1", "T", "1"]
    assert rows[3].split() == ["eta", "=", "1.21", "to", "1.3", "after", "1", "T", "2"]
    assert "undecided" in rows[4]
    assert not any("permanent contact" in line for line in lines)


# -- files ----------------------------------------------------------------------------------------


def fingerprint(folder):
    """Bytes and times of all that is there."""
    return {p.name: (p.read_bytes(), p.stat().st_mtime_ns) for p in folder.iterdir()}


def test_a_finished_sweep_describes_itself_and_stays(ask, folder):
    done = ask(*SWEEP)
    assert done.code == 0
    (result,), (picture,) = folder.glob("*.nc"), folder.glob("*.png")
    assert re.fullmatch("sweep_paper_[0-9a-f]{6}", result.stem) and picture.stem == result.stem
    assert "largest gap: xi_Rel = " in done.out and str(picture) in done.out
    assert shows_something(picture)
    data, fmu = xr.load_dataset(result), find(OSCILLATOR)
    assert data.xi_rel.dims == ("eta", "sample") and data.xi_rel.shape == (7, 12)
    np.testing.assert_array_equal(data.sample, np.arange(21, 33))
    about = {"e": 0.7, "d1": 0.01, "k2": 1.2, "transient": 20, "samples": 12, "direction": "up"}
    about |= {"fmu_guid": fmu.guid, "fmu_model": fmu.name, "fmi_version": fmu.fmi_version}
    assert {key: data.attrs[key] for key in about} == about
    assert "e0.7_D0.005" in data.attrs["title"]
    assert __version__ in data.attrs["source"] and data.attrs["call"].startswith("sweep(")
    assert all(len(str(value)) < 4000 for value in data.attrs.values())
    with netCDF4.Dataset(result) as stored:
        assert all(v.units and v.long_name for v in stored.variables.values())
    before = fingerprint(folder)
    again = ask(*SWEEP)
    assert again.code == 0 and f"{result.name}: complete already" in again.out
    assert fingerprint(folder) == before
    assert ask(*SWEEP, "--samples", "13", "--plot", "none").code == 0
    after = fingerprint(folder)
    assert len(after) == 3 and before[result.name] == after[result.name]


def test_force_computes_the_same_bytes_anew(ask, folder, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    ask(*SWEEP)
    before = fingerprint(folder)
    with monkeypatch.context() as patch:
        patch.setattr("orchestrate.response.sweep.SweepJob.work", interrupt)
        assert ask(*SWEEP, "--force").code == 130
    assert fingerprint(folder) == before
    assert ask(*SWEEP, "--force").code == 0
    for name, (content, time) in fingerprint(folder).items():
        assert content == before[name][0] and time != before[name][1]


def interrupt(*_):
    raise KeyboardInterrupt


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


@pytest.mark.slow
def test_a_failed_picture_is_drawn_by_the_same_command(ask, folder):
    ask(*SWEEP)
    (picture,) = folder.glob("*.png")
    picture.unlink()
    picture.mkdir()  # stands for a full disk, or a kill, at that moment
    ask(*SWEEP, "--force").complaint(picture, code=1)
    picture.rmdir()
    assert ask(*SWEEP).code == 0
    assert picture.is_file()


def test_a_motion(ask, folder):
    short = ("simulate", "--transient", "50", "--periods", "2", "--points", "50")
    done = ask(*short, "--eta", "0.4", "--plot", "none")
    assert "60 impacts" in done.out and "2 begin permanent contact" in done.out
    done = ask(*short, "--eta", "1.047", "--beside")
    assert done.code == 0 and "no impacts" in done.out and "the fastest at" in done.out
    assert len(list(folder.glob("*.nc"))) == 3
    assert shows_something(next(folder.glob("*.png")))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            ("--swept-sine", "12:14", "--duration", "2", "--g", "0.02", "--beside"),
            ("no impacts", "delaminated:", "impacts, the fastest at"),
        ),
        (
            ("--swept-sine", "20:10", "--rate", "20", "--spacing", "log", "--g", "5:0.01,50:0.1"),
            ("acceleration of the box: -0.", "impacts"),
        ),
        (("--random", "5:0.1,40:0.1", "--duration", "2"), ("gap x2 - x1", "impacts")),
        (
            ("--shock", "half-sine", "--length", "0.011", "--acceleration", "49"),
            ("acceleration of the box: ", "4 impacts", "; 0 begin permanent contact"),
        ),
        (
            ("--hammer", "20:0.01", "--half", "2", "--at", "0.1", "--duration", "0.3", "--beside"),
            ("force on mass 2: ", "impacts"),
        ),
    ],
)
def test_shaken_as_in_the_laboratory(ask, folder, options, words):
    drawn = "--beside" in options
    few = ("--sample-rate", "400", *(() if drawn else ("--plot", "none")))
    done = ask("shake", "--structure", "beam", *few, *options)
    assert done.code == 0, done.err
    assert all(word in done.out for word in words), done.out
    assert len(list(folder.glob("*.nc"))) == 1 + drawn
    assert not drawn or shows_something(next(folder.glob("*.png")))


def test_a_record_is_played_again(ask, folder, tmp_path):
    path = tmp_path / "base.csv"
    rows = (f"{i};{math.sin(0.2 * i):.6f};{0.02 * math.sin(0.075 * i):.6f}" for i in range(1500))
    text = "t [ms];top [g];base [g]\n" + "\n".join(rows) + "\n"
    path.write_text(text.replace(".", ","))
    played = ("--structure", "beam", "--record", path, "--plot", "none")
    done = ask("shake", *played, "--column", "2")
    assert done.code == 0, done.err
    assert re.search(r"acceleration of the box: -0\.19\d+ to 0\.19", done.out)
    named = ask("shake", *played)
    assert named.out.splitlines()[0] == done.out.splitlines()[0]
    done = ask("shake", *played, "--column", "side")
    assert done.code and "no column 'side'; expected one of t, top, base" in done.err


OF_BOX = {name: kind for name, kind in cli.COMMANDS.items() if issubclass(kind, OfBox)}
MORE = {
    "map": "--over e --values 0.5,0.6 --over D --values 0.1,0.2",
    "branch": "--over e --limits 0.5:0.9",
}


@pytest.mark.parametrize("name", OF_BOX)
@pytest.mark.parametrize("shaken", ["--hz 12 --g 0.1", "--hz 12 --amplitude 0", "--eta 1.2"])
def test_gravity_and_forces_reach_the_function(ask, monkeypatch, name, shaken):
    asked, function = {}, getattr(orchestrate, OF_BOX[name].calls)

    @functools.wraps(function)
    def stop(_, **question):
        asked.update(question)
        raise InputError("stop")

    monkeypatch.setattr(orchestrate, OF_BOX[name].calls, stop)
    options = f"{shaken} --box-acceleration -1g --force1 2 {MORE.get(name, '')}"
    assert ask(name, *options.split()).complaints[-1].startswith("error: stop")
    assert (asked["box_acceleration"], asked["force1"]) == (-9.80665, 2.0)


def test_the_picture_of_attractors_is_under_their_forces(ask, monkeypatch):
    asked, simulate = [], orchestrate.simulate

    def noted(structure, **question):
        asked.append(question)
        return simulate(structure, **question)

    monkeypatch.setattr(orchestrate, "simulate", noted)
    ask("attractors", "--eta", "1.2", "--force1", "0.1", "--starts", "4").success()
    assert asked and all(question["force1"] == 0.1 for question in asked)


def test_levels_do_not_know_forces(ask):
    asked = ("resonance", "--structure", "beam", "--hz", "12", "--g", "0.1,0.2", "--force2", "1")
    ask(*asked).complaint("--force2: expected one level, --g, with it")


# -- branches over a picture -----------------------------------------------------------------------

FEW = ("sweep", "--eta", "2.45:2.55:0.05", "--transient", "10", "--samples", "4")


@pytest.fixture
def window(ask, tmp_path):
    path = tmp_path / "window.nc"
    limits = ("--eta", "2.5", "--limits", "2.48:2.52", "--plot", "none")
    ask("branch", *limits, "--store", path).success()
    return path


@pytest.mark.slow
def test_a_branch_over_a_sweep(ask, folder, window):
    ask(*FEW, "--plot", "none").success()
    done = ask(*FEW, "--overlay", window).success()
    assert "complete already" in done.out
    (plain,), (over,) = folder.glob("*.nc"), folder.glob("*.png")
    assert over.name.startswith(f"{plain.stem}_over_") and str(over) in done.out
    assert shows_something(over)


NOT_FITTING = {
    ("--set", "e=0.3"): "a branch of another structure, e = 0.7; expected e = 0.3",
    ("--eta", "1", "--over", "e", "--values", "0.3,0.5"): "a branch along eta; expected",
    ("--eta", "1.2"): "one value has no picture",
    ("--overlay", "lost.nc"): "lost.nc: no such file",
}


def test_what_does_not_fit_is_refused_before_anything_is_computed(ask, tmp_path, window):
    for options, words in NOT_FITTING.items():
        ask(*FEW, "--overlay", window, *options).complaint("--overlay", words)
    assert not list((tmp_path / "results").glob("*.nc"))
    (tmp_path / "other").mkdir()
    path = tmp_path / "other" / "sweep.nc"
    ask(*FEW, "--store", path, "--plot", "none").success()
    ask(*FEW, "--overlay", path).complaint(path, "an answer of sweep; expected one of branch")
    levels = ("resonance", "--hz", "0.4,0.41", "--g", "0.1,0.2", "--overlay", window)
    ask(*levels).complaint("--overlay", "several levels, --g 0.1,0.2; expected one")


# -- first steps -----------------------------------------------------------------------------------


def test_all_bifurcations_of_a_branch_and_a_map_under_them(ask, folder, tmp_path):
    path, none = tmp_path / "window.nc", ("--plot", "none")
    ask("branch", "--eta", "2.6", "--limits", "2.55:2.65", "--store", path, *none).success()
    limits = ("--limits", "2.55:2.65,0.695:0.705", "--longest", "0.5")
    done = ask("border", "--start", path, "--bifurcation", "all", *limits).success()
    assert "Neimark-Sacker" in done.out and len(list(folder.glob("border_all*.png"))) == 1
    (curve,) = folder.glob("border_window*.nc")
    of = {
        "start": xr.load_dataset(path),
        "bifurcation": 0,
        "over": ("eta", "e"),
        "limits": [(2, 3)],
    }
    data = xr.load_dataset(curve)
    assert lies_on_curve(data, of) and not lies_on_curve(data.isel(point=slice(2)), of)
    few = ("map", "--eta", "2.6,2.7", "--over", "e", "--values", "0.69,0.71", "--samples", "4")
    ask(*few, "--transient", "5", "--overlay", f"{curve},{curve}").success()
    assert shows_something(next(folder.glob("map_*_over_*.png")))
    ask(*few, "--overlay", path).complaint("--overlay", "of branch; expected one of border")
    ask(*few, "--set", "D=0.1", "--overlay", curve).complaint("another structure", "d1 = ")
    ask("border", "--start", path, "--bifurcation", "one", *limits).complaint("a number, or all")


def test_structures_without_units_have_ratios(ask, folder):
    done = ask("attractors", "--eta", "1.32", "--starts", "4", "--units", "eta").success()
    assert " m" not in done.out.replace("multiplicity", "") and "number  share" in done.out
    assert shows_something(next(folder.glob("attractors*.png")))
    done = ask("simulate", "--eta", "1.32", "--periods", "2", "--plot", "none").success()
    assert "gap x2 - x1 + clearance: 0 to 0." in done.out and not re.search(
        r"\d m(/s)?2?\b", done.out
    )


def test_levels_have_both_structures_and_where_they_open(ask, folder):
    beam = ("--structure", "beam", "--set", "preload=20um", "--hz", "10,12.5", *SHORT)
    done = ask("resonance", *beam, "--g", "0.002,0.02", "--size", "16:9").success()
    title, low, high = done.out.splitlines()[:3]
    assert "bonded x1" in title and "delaminated x1" in title and "opens at" in title
    assert low.endswith("  12.5 Hz") and high.count(" at 12.5 Hz") == 2 and "0.02 " in high
    picture = image.imread(next(folder.glob("*_16-9.png")))
    assert picture.shape[:2] == (1080, 1920)
    ask("resonance", *beam, "--g", "0.02", "--size", "wide").complaint("--size wide", "16:9")


def test_a_plan(ask, folder, monkeypatch):
    test = ("--set", "zeta=5%", "--g", "0.002,0.02,0.2", "--noise", "1e-3", "--range", "1")
    done = ask("plan", "--structure", "beam", *test).success()
    assert done.out.startswith("sweep ") and "preload=20um" in done.out
    assert "verdict on the guess" in done.out and "on its sound twin" in done.out
    assert "overload" in done.out and shows_something(next(folder.glob("plan_*.png")))
    ask("plan", "--structure", "beam", "--hz", "10").complaint("--hz 10", "FIRST:LAST")
    asked = {}

    @functools.wraps(orchestrate.plan_test)
    def plan(_, **question):
        asked.update(question)
        raise InputError("stop")

    monkeypatch.setattr(orchestrate, "plan_test", plan)
    ask("plan", "--structure", "beam", "--faces", "2", "--noise", "1")
    assert (
        list(asked["sensor"]) == ["acceleration2"] and asked["sensor"]["acceleration2"].noise == 1
    )


@pytest.mark.parametrize(("decides", "said"), [([1, 0], "lower levels only"), ([0, 0], "raise")])
def test_a_plan_of_which_the_higher_levels_do_not_decide(decides, said):
    """It said that no verdict was right, and to raise the level."""
    names = ("recommended_level", "second_level", "recommended_first", "recommended_last")
    numbers = dict.fromkeys((*names, "recommended_duration", "recommended_rate"), ((), 40.0))
    rows = dict.fromkeys(("verdict", "sound_verdict"), ("level", ["undecided"] * 2))
    made = {**numbers, **rows, "decides": ("level", decides), "overload": ("level", [0, 0])}
    made |= {"counts": ((), 0), "opening_level": ((), 0.0)}
    made |= {"opening": ("level", [0.0, 0.0], {"units": "m", "long_name": "opening"})}
    level = ("level", [20.0, 40.0], {"units": "m/s2", "long_name": "level"})
    data = xr.Dataset(made, {"level": level}, {"clearance": 1.0})
    assert any(said in line for line in Plan().summary(data))


def test_forces_of_a_file_act_or_are_refused(ask, tmp_path):
    """Of an excitation in the structure's file: commands take them, or say that they do not."""
    path = tmp_path / "pushed.toml"
    path.write_text(
        "[structure]\nm1 = 1.0\nm2 = 1.0\nk1 = 1000.0\nk2 = 1300.0\nd1 = 0.5\nd2 = 0.5\n"
        "[excitation]\nfrequency_hz = 5.0\namplitude = 0.0\nforce1 = 2.0\n"
    )
    done = ask("simulate", "--structure", path, "--periods", "3", "--plot", "none")
    assert done.code == 0 and "impacts" in done.out, done.err
    done = ask("orbit", "--structure", path, "--plot", "none")
    assert done.code == 0 and "multiplier" in done.out, done.err + done.out
