"""Every command runs once: its function, its numbers in the units asked for, and its files."""

from __future__ import annotations

import functools
import re

import netCDF4
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib import image

import orchestrate
from orchestrate import InputError, Structure, cli
from orchestrate.cli import grammar, responses
from orchestrate.cli.options import OfBox
from orchestrate.fmu import OSCILLATOR, find_or_export

from ...exports import BUILD
from ...sparing import ordinary

TURN, G = 2.0 * np.pi, 9.80665
BEAM = "--structure beam"
BOX = f"{BEAM} --hz 12 --g 0.02"
AT = {"frequency": 12.0 * TURN, "amplitude": 0.02 * G / (12.0 * TURN) ** 2}
SHORT, LONGER = "--transient 10 --samples 4", "--transient 60 --samples 16"
LINKS = {name: name for name in ("box_acceleration", "box_force")}
CONNECTED = "--connect box_acceleration=box_acceleration box_force=box_force"
DRIVEN = "--step 0.2 --jobs 1"
ONE_WAY = f"--rate 4e-4 --settle 9 --one-way {DRIVEN}"
SHOCK = orchestrate.Shock(peak=2 * G, length=0.01, shape="sawtooth")
ASKED = {  # command: options, a unit and what is printed in it, what is printed anyhow, keywords
    "simulate": (f"{BOX} --periods 3", "mm", r"[\d.]+ mm\n", (), {**AT, "periods": 3}),
    "shake": (
        *(f"{BEAM} --shock sawtooth --length 0.01 --g 2", "um", r"gap x2 - x1.* to [\d.e+]+ um\b"),
        *(("acceleration of the box: ", "impacts"), {"excitation": SHOCK}),
    ),
    "cosimulate": (
        f"{BEAM} --duration 0.2 --step 0.002 --drive MOTOR {CONNECTED}",
        *("mm", r"displacement of mass 1.* to [\d.e+-]+ mm\b", ()),
        {"duration": 0.2, "step": 0.002, "connect": LINKS},
    ),
    "resonance": (
        *(f"{BEAM} --hz 12:13:0.1 --g 0.02 {LONGER}", "rpm", r"frequency rpm"),
        *(("peaks", "bonded", "delaminated  up", "no jump"), {"transient": 60, "samples": 16}),
    ),
    "sweep": (
        *(f"{BEAM} --hz 12:13:1 --g 0.02 --direction up {SHORT}", "rpm", r"at 7[28]0 rpm"),
        *((), {"direction": "up", "transient": 10}),
    ),
    "spectra": (
        *(f"{BOX} --transient 5 --periods 8", "rpm", r"\n +720 +delaminated +0\.[\d]+ "),
        *((), {**AT, "periods": 8}),
    ),
    "map": (
        *(f"{BEAM} --hz 12,13 --g 0.02 --over e --values 0.3,0.7 {SHORT}", "rpm", "frequency rpm"),
        *(("repeated", "largest gap"), {"samples": 4}),
    ),
    "lyapunov": (
        *("--eta 0.8,1.047 --transient 100 --periods 300", "Hz", r"frequency Hz"),
        ("exponent", "chaotic", "-0.007", "periodic"),
        {"eta": (0.8, 1.047), "transient": 100, "periods": 300},
    ),
    "poincare": (
        *(f"{BOX} --transient 5 --periods 9", "mm", r"gap .*: [\d.e-]+ to [\d.]+ mm\b"),
        *((), {**AT, "periods": 9}),
    ),
    "attractors": (
        *(f"--eta 1.3,1.4 --starts 5 {LONGER} --settle 20", "Hz", r"at 0\.222817 Hz"),
        ("5 random starts", "multiplicity", "state at phase 0"),
        {"starts": 5, "eta": (1.3, 1.4)},
    ),
    "basin": (
        *(f"--eta 1.4 --x x_rel,-0.1,0.8,4 --y v_rel,-1,1,3 {LONGER}", "um"),
        r"v_rel -1000 to 1000 mm/s, x_rel -1e\+05 to 8e\+05 um",
        *(("of 9 starts", "share", "3 starts left out"), {"x": ("x_rel", -0.1, 0.8, 4)}),
    ),
    "orbit": (
        *("--eta 3.0", "mm", r"impact at 0\.480678\d* s, closing at [\d.]+ mm/s"),
        ("unstable", "-3.359480", "impact at tau = 0.480678", "state at phase 0"),
        {"eta": 3.0, "period": 1},
    ),
    "manifold": (
        *("--eta 3.0 --length 1", "mm", r"[\d.e-]+ to [\d.]+ mm"),
        ("saddle: multiplier -3.359480", "length over the orbit's size", "length  "),
        {"eta": 3.0, "length": 1.0},
    ),
    "branch": (  # whose bifurcations are in Hz as well
        *("--eta 2.62 --limits 2.6:2.7", "Hz"),
        r"0\.4\d+ to 0\.4\d+ Hz[^$]*kind +frequency Hz\n +0 .* 0\.42143",
        *(("Neimark-Sacker", "limit"), {"limits": (2.6, 2.7), "over": "eta"}),
    ),
    "couple": (
        *(f"--eta0 1.4:1.41 --only bonded --hold 0 {ONE_WAY}", "rpm"),
        *(r"revolution: [\d.]+ to [\d.]+ rpm", ("undecided",), {}),
    ),
    "capture": (
        "--voltage 1.45:1.6 --count 2 --tolerance 0.05 --only bonded "
        f"--over rotor_inertia --values 800,1400 {DRIVEN}",
        *("", r"\n +1400 +1\.54375", ("passes: 2 (50 %)",)),
        {"voltage": (1.45, 1.6), "values": (800.0, 1400.0)},
    ),
    "passage": (
        f"--eta0 1.55:1.65 --around 60 --revolutions 4 --only delaminated {ONE_WAY}",
        *("", "jump up at 1.569", ("around jumps",), {"around": 60.0}),
    ),
    "jump-voltages": (
        f"--eta0 1.5:1.66 --one-way {DRIVEN} --rate 4e-4,3e-4",
        *("", "1.58.*by held voltages", (), {"rates": (4e-4, 3e-4), "voltage": (1.5, 1.66)}),
    ),
    "drive-branch": (
        "--speed 1.29:1.32 --longest 0.3 --jobs 1",
        *("", r"bonded +fold +1\.583", (), {"speed": (1.29, 1.32), "longest": 0.3}),
    ),
}
ELSEWHERE = {"analyse", "build", "paper", "channels", "diagnose", "border", "halves", "explore"}
ELSEWHERE |= {"report", "plan"}  # below, or in modules of their own
SLOW = {"manifold", "branch", "jump-voltages", "drive-branch", "passage"}
DRAWN = {"orbit", "simulate", "capture", "passage", "drive-branch", "jump-voltages", "sweep"}


def shows_something(path):
    """Whether a picture has lines, dots or colours on white."""
    grey = image.imread(path)[..., :3].mean(axis=2)
    return min(grey.shape) > 100 and 0.001 < (grey < 0.95).mean() < 0.95


def test_every_command_is_tested():
    assert set(cli.COMMANDS) == set(ASKED) | ELSEWHERE


def agree(given, expected):
    """Whether keywords have these values, numbers but for rounding."""
    for name, value in expected.items():
        number = isinstance(value, float) or (isinstance(value, tuple) and value[0] != "x_rel")
        assert given[name] == (pytest.approx(value) if number else value), name
    return True


@pytest.mark.parametrize("command", ordinary(ASKED, set(ASKED) - SLOW))
def test_a_command_asks_its_function_and_shows_the_answer(ask, tmp_path, monkeypatch, command):
    """What is stored is what the function has answered; other units change only what is shown."""
    line, unit, words, always, keywords = ASKED[command]
    motor = str(BUILD / "fmi2" / "MotorShaker.fmu")
    options = [motor if word == "MOTOR" else word for word in line.split()]
    name, folder, calls = cli.COMMANDS[command].calls, tmp_path / "results", []
    function = getattr(orchestrate, name)

    @functools.wraps(function)
    def noted(*structure, **question):
        calls.append((question, function(*structure, **question)))
        return calls[-1][1]

    monkeypatch.setattr(orchestrate, name, noted)
    few, none = ("--format", "csv"), ("--plot", "none")
    plain = ask(command, *options, *few, *(() if command in DRAWN else none)).success().out
    assert all(agree(question, keywords) for question, _ in calls) and bool(calls) == bool(keywords)
    stored = {path: path.read_bytes() for path in folder.glob("*.nc")}
    for _, answer in calls:
        assert any(xr.load_dataset(path).equals(answer.load()) for path in stored)
    assert all(path.name.startswith(f"{name}_") for path in stored)
    assert all(map(shows_something, folder.glob("*.png")))
    assert bool([*folder.glob("*.png")]) == (command in DRAWN)
    tables, shown = set(folder.glob("*.csv")), plain
    if unit:
        shown = ask(command, *options, *few, *none, "--units", unit).success().out
        assert not re.search(words, plain) and "complete already" in shown
        new = set(folder.glob("*.csv")) - tables
        columns = {column for path in new for column in pd.read_csv(path).columns}
        assert any(f"[{unit}]" in column for column in columns), columns
    assert re.search(words, shown), (plain, shown)
    assert all(word in plain for word in always) and "complete already" not in plain, plain
    assert stored == {path: path.read_bytes() for path in folder.glob("*.nc")}
    told = re.findall(r"^/.*?(?=: complete already$|$)", f"{plain}{shown}", re.MULTILINE)
    assert set(told) == {str(path) for path in folder.iterdir()}


def test_a_sweep_is_summed_up_by_where_responses_repeat():
    """Made-up: how often, and the three widest ranges of each kind; of few each by itself."""
    kinds = np.repeat([1, 0, 1, 2, 1, 0, 1, 0, 1, 0, 1, 0], [9, 2, 20, 6, 8, 3, 7, 1, 5, 1, 4, 1])
    words = {"flag_values": [0, 1, 2], "flag_meanings": "irregular repeated undecided"}
    numbers = {"xi_rel_max": np.linspace(1.0, 2.0, 67), "multiplicity": np.ones(67, dtype=int)}
    numbers |= {"impacts_per_period": np.ones(67), "eta": 1.0 + 0.01 * np.arange(67)}
    data = xr.Dataset({name: ("eta", values) for name, values in numbers.items()})
    data = data.assign(multiplicity_decided=("eta", kinds, words)).assign_attrs(k1=1.0, m1=1.0)
    lines = list(responses.Sweep().summary_lines(data))
    assert "largest gap: xi_Rel = 2 at eta = 1.66" in lines
    assert "undecided: 6 (9 %) at eta = 1.31 to 1.36" in lines
    assert any(line.startswith("undecided: ") and "--transient 5000" in line for line in lines)
    ranges = "1 to 1.08, 1.11 to 1.3, 1.37 to 1.44 and 3 shorter ranges"
    assert f"multiplicity 1: 53 (79 %) at eta = {ranges}" in lines
    four, five = (
        list(responses.Sweep().summary_lines(data.isel(eta=at)))
        for at in ([0, 9, 30, 31], range(27, 32))
    )
    assert four[0].split()[:4] == ["eta", "largest", "gap", "impacts_per_period"]
    assert four[4].split()[-2:] == ["1", "undecided"] and four[5].startswith("undecided: slow")
    assert len(four) == 6 and "largest gap: xi_Rel = 1.4697 at eta = 1.31" in five


TRIVIAL = {  # options, and what is said of what is trivial
    "simulate --eta 1 --set kappa=1": "both oscillators are alike",
    "sweep --eta 1.2 --transient 60 --samples 16": "one value: no picture",
    "sweep --eta 2:2.1:0.05 --direction both --samples 8": "gap nowhere",
    "resonance --eta 0.3:0.4:0.05 --transient 60 --samples 16": "no peak in this range",
    "lyapunov --eta 2.9 --periods 50 --spectrum": "kaplan_yorke_dimension",
    "lyapunov --eta 1 --set bonded=true --periods 20": "there are no impacts",
    "simulate --eta 0.4 --transient 50 --periods 2": "60 impacts",
    "couple --eta0 1.41:1.4 --rate 4e-4 --hold 0 --step 0.4 --settle 9 --only bonded --one-way": (
        "the voltage falls first"
    ),
    "capture --eta0 1.5:1.6 --count 2 --time 100 --step 0.2 --only bonded": (
        "undecided: 2 (100 %) at voltage = 1.5 to 1.6 V\n"
        "undecided: the speed had not settled; give a longer --time"
    ),
}


@pytest.mark.parametrize("words", TRIVIAL)
def test_what_is_trivial_or_undecided_is_said(ask, words):
    done = ask(*words.split(), "--plot", "none")
    assert done.code == 0 and TRIVIAL[words] in done.out, done.err


SWEEP = ("sweep", "--eta", "1.28:1.31:0.005", "--transient", "20", "--samples", "12")


def fingerprint(folder):
    """Bytes and times of all that is there."""
    return {p.name: (p.read_bytes(), p.stat().st_mtime_ns) for p in folder.iterdir()}


def interrupt(*_):
    raise KeyboardInterrupt


def test_a_finished_result_describes_itself_and_stays(ask, tmp_path, monkeypatch):
    """Another question has another file; ``--force`` computes the same bytes anew."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    folder, out = tmp_path / "results", ask(*SWEEP).success().out
    (result,), (picture,) = folder.glob("*.nc"), folder.glob("*.png")
    assert re.fullmatch("sweep_paper_[0-9a-f]{6}", result.stem) and picture.stem == result.stem
    assert "largest gap: xi_Rel = " in out and str(picture) in out and shows_something(picture)
    data, fmu = xr.load_dataset(result), find_or_export(OSCILLATOR)
    assert data.xi_rel.shape == (7, 12) and data.attrs["call"].startswith("sweep(")
    about = {"e": 0.7, "d1": 0.01, "k2": 1.2, "transient": 20, "samples": 12, "direction": "up"}
    about |= {"fmu_guid": fmu.guid, "fmu_model": fmu.name, "fmi_version": fmu.fmi_version}
    assert {key: data.attrs[key] for key in about} == about
    with netCDF4.Dataset(result) as stored:
        assert all(v.units and v.long_name for v in stored.variables.values())
    before = fingerprint(folder)
    assert f"{result.name}: complete already" in ask(*SWEEP).success().out
    with monkeypatch.context() as patch:
        patch.setattr("orchestrate.response.sweep.SweepJob.work", interrupt)
        assert ask(*SWEEP, "--force").code == 130
    assert fingerprint(folder) == before
    ask(*SWEEP, "--samples", "13", "--plot", "none").success()
    assert len(fingerprint(folder)) == 3 and before.items() <= fingerprint(folder).items()
    ask(*SWEEP, "--force").success()
    for name, (content, time) in before.items():
        new, now = fingerprint(folder)[name]
        assert new == content and time != now


def test_a_file_of_ones_own_is_not_replaced_by_another_question(ask, tmp_path):
    own = tmp_path / "results" / "mine.nc"
    ask(*SWEEP, "--store", own).success()
    before = fingerprint(own.parent)
    assert sorted(before) == ["mine.nc", "mine.png"]
    ask(*SWEEP, "--samples", "13", "--store", own).complaint(own, "different calculation", "force")
    own.unlink()
    for force in ([], ["--force"]):
        ask(*SWEEP, "--store", own, *force).complaint("mine.png", "choose another --store")
    assert fingerprint(own.parent) == {"mine.png": before["mine.png"]}


OF_BOX = {name: kind for name, kind in cli.COMMANDS.items() if issubclass(kind, OfBox)}
MORE = {
    "map": "--over e --values 0.5,0.6 --over D --values 0.1,0.2",
    "branch": "--over e --limits 0.5:0.9",
}


@pytest.mark.parametrize("name", OF_BOX)
def test_gravity_and_forces_reach_the_function(ask, monkeypatch, name):
    asked, function = {}, getattr(orchestrate, OF_BOX[name].calls)

    @functools.wraps(function)
    def stop(_, **question):
        asked.update(question)
        raise InputError("stop")

    monkeypatch.setattr(orchestrate, OF_BOX[name].calls, stop)
    for shaken in ("--hz 12 --g 0.1", "--hz 12 --amplitude 0", "--eta 1.2"):
        options = f"{shaken} --box-acceleration -1g --force1 2 {MORE.get(name, '')}"
        assert ask(name, *options.split()).complaints[-1].startswith("error: stop")
        assert (asked["box_acceleration"], asked["force1"]) == (-G, 2.0)


def test_the_excitation_of_a_file_acts(ask, tmp_path):
    """As by options; with forces; in its own units."""
    path, short = tmp_path / "own.toml", ("--periods", "1", "--plot", "none")
    head = "[structure]\nm1 = 1.5\nomega_hz = 11.9\nD = 0.005\n\n[excitation]\n"
    path.write_text(f"{head}frequency_rpm = 756\nacceleration_g = 0.02\nphase = 0.5\n")
    told = ("--hz", "12.6", "--g", "0.02", "--phase", "0.5", "--units", "rpm")
    done, same = (ask("simulate", "--structure", path, *short, *more) for more in ((), told))
    assert done.success().out.splitlines()[:-1] == same.success().out.splitlines()[:-1]
    path.write_text(f"{head}frequency_hz = 5.0\namplitude = 0.0\nforce1 = 2.0\n")
    assert "impacts" in ask("simulate", "--structure", path, *short).success().out
    levels = f"resonance {BEAM} --hz 12 --g 0.1,0.2 --force2 1"
    ask(*levels.split()).complaint("--force2: expected one level, --g")


def test_curves_over_sweeps_and_maps(ask, tmp_path, monkeypatch):
    """All bifurcations of a branch followed, and drawn over what they fit; refused over others."""
    once = functools.cache(grammar.load_earlier_result)  # its isolated process takes long to start
    monkeypatch.setattr("orchestrate.cli.answer.load_earlier_result", once)
    path, none, folder = tmp_path / "window.nc", ("--plot", "none"), tmp_path / "results"
    ask("branch", "--eta", "2.6", "--limits", "2.55:2.65", "--store", path, *none).success()
    few = ("sweep", "--eta", "2.55:2.65:0.05", "--transient", "10", "--samples", "4")
    refused = {
        ("--set", "e=0.3"): "a branch of another structure, e = 0.7; expected e = 0.3",
        ("--eta", "1", "--over", "e", "--values", "0.3,0.5"): "a branch along eta; expected",
        ("--eta", "1.2"): "one value has no picture",
        ("--overlay", "lost.nc"): "lost.nc: no such file",
    }
    for options, words in refused.items():
        ask(*few, "--overlay", path, *options).complaint("--overlay", words)
    assert not folder.exists() or not list(folder.glob("*.nc"))
    ask(*few, "--overlay", path).success()
    limits = ("--limits", "2.55:2.65,0.695:0.705", "--longest", "0.5", "--jobs", "1")
    done = ask("border", "--start", path, "--bifurcation", "all", *limits).success()
    assert "Neimark-Sacker" in done.out and len(list(folder.glob("border_all*.png"))) == 1
    (curve,) = folder.glob("border_window*.nc")
    few = f"map --eta 2.6,2.7 --over e --values 0.69,0.71 {SHORT}".split()
    ask(*few, "--overlay", f"{curve},{curve}").success()
    assert all(shows_something(picture) for picture in folder.glob("*_over_*.png"))
    ask(*few, "--overlay", path).complaint("--overlay", "of branch; expected one of border")
    ask("border", "--start", path, "--bifurcation", "one", *limits).complaint("a number, or all")


def test_levels_have_both_structures_and_where_they_open(ask, tmp_path):
    beam = f"{BEAM} --set preload=20um --hz 10,12.5 {LONGER} --g 0.002,0.02 --size 16:9"
    done = ask("resonance", *beam.split()).success()
    title, _, low, bonded, high = (line.split() for line in done.out.splitlines()[:5])
    assert title[2:6] == ["structure", "x1_max", "mm", "frequency"]
    assert title[-2:] == ["opens", "at"]
    assert low[-2:] == ["12.5", "Hz"] and bonded[-1] == "nowhere"
    assert high[:2] == ["0.02", "delaminated"] and high[3] == "12.5"
    picture = image.imread(next((tmp_path / "results").glob("*_16-9.png")))
    assert picture.shape[:2] == (1080, 1920)


def test_a_plan(ask, tmp_path, monkeypatch):
    test = f"plan {BEAM} --set zeta=5% --g 0.002,0.2 --noise 1e-3 --range 1 --jobs 1"
    out = ask(*test.split()).success().out
    for words in ("preload=20um", "verdict on the guess", "on its sound twin", "overload"):
        assert words in out
    assert shows_something(next((tmp_path / "results").glob("plan_*.png")))
    asked = {}

    @functools.wraps(orchestrate.plan_test)
    def plan(_, **question):
        asked.update(question)
        raise InputError("stop")

    monkeypatch.setattr(orchestrate, "plan_test", plan)
    ask(*f"plan {BEAM} --faces 2 --noise 1 --g 0.1,0.2".split())
    assert list(asked["sensor"]) == ["acceleration2"] and tuple(asked["g"]) == (0.1, 0.2)
    assert asked["sensor"]["acceleration2"].noise == 1


def test_exponents_along_a_sweep_and_an_orbit_from_a_stored_one(ask, tmp_path):
    """Of two orbits at this frequency the unstable one, which a search from rest does not find."""
    none, eta = ("--plot", "none"), [1.36, 1.3]
    options = ("--eta", "1.36,1.3", "--periods", "100", "--transient", "50", *none)
    ask("lyapunov", *options, "--follow", "down").success()
    (path,) = (tmp_path / "results").glob("*.nc")
    alone = {"transient": 50, "progress": False}
    swept = orchestrate.sweep(Structure(), eta=eta, direction="down", samples=1, **alone)
    expected = orchestrate.lyapunov(Structure(), eta=eta, start=swept, periods=100, **alone)
    np.testing.assert_array_equal(xr.load_dataset(path).exponent, expected.exponent)
    first, near = tmp_path / "first.nc", tmp_path / "near.nc"
    ask("orbit", "--eta", "3.0", *none, "--store", first).success()
    done = ask("orbit", "--eta", "3.01", "--guess", first, *none, "--store", near).success()
    assert done.out.startswith("unstable") and xr.load_dataset(near).attrs["period"] == 1
