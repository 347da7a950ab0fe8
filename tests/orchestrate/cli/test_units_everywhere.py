"""Every command takes ``--units``: a number that it prints follows, or it says why none does."""

from __future__ import annotations

import argparse
import functools
import hashlib
import json
import re

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import orchestrate
from orchestrate import cli
from orchestrate.cli import couple as couple_command
from orchestrate.cli import diagnose, passage
from orchestrate.figures import diagnosis, weak_drive
from orchestrate.units import Units, with_units

from ...exports import BUILD

BOX = ("--structure", "beam", "--hz", "12", "--g", "0.02")
SWEPT = ("--structure", "beam", "--hz", "12:13:1", "--g", "0.02", "--direction", "up")
SHORT = ("--transient", "10", "--samples", "4")
PLANE = ("--x", "x_rel,0,1e-3,3", "--y", "v_rel,-0.1,0.1,3")
ASKED = {  # command, a unit, what is printed in it
    "simulate": ((*BOX, "--periods", "3"), "mm", r"[\d.]+ mm\b"),
    "shake": (
        ("--structure", "beam", "--shock", "sawtooth", "--length", "0.01", "--g", "2"),
        "um",
        r"largest gap [\d.e+]+ um\b",
    ),
    "cosimulate": (
        (
            *("--structure", "beam", "--duration", "0.2", "--step", "0.01"),
            *("--drive", str(BUILD / "fmi2" / "MotorShaker.fmu")),
            *("--connect", "box_acceleration=box_acceleration", "box_force=box_force"),
        ),
        "mm",
        r"largest displacement [\d.e+-]+ mm\b",
    ),
    "resonance": ((*SWEPT, *SHORT), "rpm", r"720 rpm"),
    "sweep": ((*SWEPT, *SHORT), "rpm", r"at 7[28]0 rpm"),
    "spectra": ((*BOX, "--transient", "5", "--periods", "8"), "rpm", r"at 720 rpm"),
    "map": (
        (*BOX[:2], "--hz", "12,13", *BOX[4:], "--over", "e", "--values", "0.3,0.7", *SHORT),
        "rpm",
        r"7[28]0 rpm",
    ),
    "lyapunov": (("--eta", "0.8", "--transient", "20", "--periods", "40"), "Hz", r"0\.127324 Hz"),
    "poincare": (
        (*BOX, "--transient", "5", "--periods", "9"),
        "mm",
        r"gap from [\d.e-]+ to [\d.]+ mm\b",
    ),
    "attractors": (
        ("--eta", "1.4", "--starts", "2", *SHORT, "--settle", "5"),
        "Hz",
        r"at 0\.222817 Hz",
    ),
    "basin": ((*BOX, *PLANE, *SHORT), "um", r"v_rel -1e\+05 to 1e\+05 um/s, x_rel 0 to 1000 um"),
    "orbit": (("--eta", "3.0"), "mm", r"closing at [\d.]+ mm/s"),
    "manifold": (("--eta", "3.0", "--length", "0.2"), "mm", r"curve [\d.e-]+ to [\d.]+ mm"),
    "branch": (("--eta", "2.62", "--limits", "2.6:2.63"), "Hz", r"from 0\.4\d+ Hz to 0\.4\d+ Hz"),
    "couple": (
        ("--eta0", "1.4:1.41", "--rate", "2e-4", "--step", "0.2", "--settle", "9", "--one-way"),
        "rpm",
        r"revolutions at [\d.]+ to [\d.]+ rpm",
    ),
}
REFUSED = {"build": "FMUs are in SI", "paper": "ratios"}
ELSEWHERE = {"analyse", "diagnose", "border", "capture", "passage", "drive-branch"}
ELSEWHERE |= {"jump-voltages", "explore", "report"}  # tested below, or where a page is written


def parsers():
    (action,) = (
        action
        for action in cli.make_parser([])._actions
        if isinstance(action, argparse._SubParsersAction)
    )
    return action.choices


def sums(folder):
    """Check sums of the stored results."""
    return {
        path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.glob("*.nc")
    }


def test_every_command_has_the_option_and_is_tested():
    known = parsers()
    assert set(known) == set(ASKED) | set(REFUSED) | ELSEWHERE
    for name, parser in known.items():
        assert "--units" in parser._option_string_actions, name


@pytest.mark.parametrize("command", ASKED)
def test_a_printed_number_follows_and_the_result_stays(ask, tmp_path, command):
    options, unit, words = ASKED[command]
    few = ("--jobs", "1", "--plot", "none", "--format", "csv")
    plain = ask(command, *options, *few).success().out
    stored, tables = sums(tmp_path / "results"), set((tmp_path / "results").glob("*.csv"))
    shown = ask(command, *options, *few, "--units", unit).success().out
    assert not re.search(words, plain) and re.search(words, shown), (plain, shown)
    assert sums(tmp_path / "results") == stored and stored
    new = set((tmp_path / "results").glob("*.csv")) - tables
    assert new and all(f"_{unit}." in path.name for path in new)
    columns = {name for path in new for name in pd.read_csv(path).columns}
    assert any(f"[{unit}]" in name for name in columns), columns


def test_bifurcations_stand_in_the_unit_of_the_range_above_them(ask):
    """A branch over eta that is shown in Hz has its bifurcations in Hz too, and ratios without."""
    options = ("--eta", "2.62", "--limits", "2.62:2.66", "--jobs", "1", "--plot", "none")
    ratios = ask("branch", *options).success().out
    hertz = ask("branch", *options, "--units", "Hz").success().out
    assert re.search(r"number +bifurcation +eta\n", ratios)
    assert re.search(r"number +bifurcation +frequency \(Hz\)\n", hertz)
    row = re.compile(r"^ +0  .*?([\d.]+)$", re.MULTILINE)
    (ratio,), (frequency,) = row.findall(ratios), row.findall(hertz)
    assert float(frequency) == pytest.approx(float(ratio) / (2.0 * np.pi), abs=1e-8)


@pytest.mark.parametrize("command", REFUSED)
def test_a_command_without_such_numbers_says_why(ask, command):
    words = ask(command, "--units", "Hz") if command == "paper" else run("build", "--units", "Hz")
    if command == "paper":
        words.complaint("--units Hz: ", REFUSED[command])
    else:
        assert words == 2


def run(*options):
    """Run a command that has no ``--output``; return its exit code."""
    return cli.main(list(options))


def answer_with(monkeypatch, name, data):
    """Let a public function give a made-up answer; its signature stays."""
    function = functools.wraps(getattr(orchestrate, name))(lambda *_, **__: data)
    monkeypatch.setattr(orchestrate, name, function)


def variable(values, unit, dims=()):
    return (dims, values, {"units": unit})


def test_the_weak_drive_prints_speeds_in_the_unit_asked_for(ask, monkeypatch, tmp_path):
    """Made-up answers, as their functions give them."""
    speed = np.array([[[100.0, 110.0, 105.0]], [[101.0, 111.0, 106.0]]])
    along = {"structure": ["bonded", "delaminated"], "leg": ["from below"]}
    dims = (*along, "point")
    branch = {
        "voltage": variable(speed / 100.0, "V", dims),
        "speed": variable(speed, "rad/s", dims),
    }
    branch |= {"amplitude": variable(1e-5 * speed, "m", dims), "stable": (dims, speed < 200.0)}
    branch |= {"revolutions": (dims, np.ones_like(speed)), "end": (tuple(along), [["limit"]] * 2)}
    at = {"structure": ["bonded"], "kind": ["period doubling"]}
    branch |= {f"bifurcation_{name}": ("bifurcation", value) for name, value in at.items()}
    numbers = {"voltage": (1.05, "V"), "speed": (105.0, "rad/s"), "amplitude": (1e-3, "m")}
    for name, (value, unit) in {**numbers, "revolutions": (1.0, "1")}.items():
        branch[f"bifurcation_{name}"] = variable([value], unit, ("bifurcation",))
    (tmp_path / "results").mkdir()
    branch = xr.Dataset(branch, along, {"k1": 8437.5, "m1": 1.5})
    answer_with(monkeypatch, "drive_branch", branch)
    done = ask("drive-branch", "--drive", "beam", "--units", "rpm,um").success()
    assert "at 1.05000 V, 1002.7 rpm" in done.out and "rad/s" not in done.out
    assert next((tmp_path / "results").glob("*.png")).stem.endswith("_rpm-um")
    assert "105 rad/s" in ask("drive-branch", "--drive", "beam", "--plot", "none").out

    each = {"structure": ["bonded", "delaminated"], "jump": ["up", "down"]}
    jumps = {"jumps": variable([[1.5, 1.4]] * 2, "V", tuple(each))}
    jumps["standard_error"] = variable([[0.1, 0.1]] * 2, "V", tuple(each))
    jumps["decided"] = (tuple(each), [["by held voltages"] * 2] * 2)
    answer_with(monkeypatch, "jump_voltages", xr.Dataset(jumps, each))
    asked = ("jump-voltages", "--plot", "none")
    note = "--units rpm: these have no such numbers, only V"
    assert note in ask(*asked, "--units", "rpm").success().out
    assert "--units" not in ask(*asked).success().out

    capture = {"passes": ("voltage", [0, 1]), "decision": ("voltage", ["converged"] * 2)}
    capture |= {"passage_time": variable([np.nan, 5.0], "s", ("voltage",)), "above_fold": 0.0}
    capture |= {"border": ((), 1.5, {"units": "V", "tolerance": 1.0}), "border_low": 1.4}
    capture |= {"border_high": 1.6, "speed_low": variable(100.0, "rad/s")}
    capture |= {"speed_high": variable(110.0, "rad/s")}
    tried = xr.Dataset(capture, {"voltage": [1.4, 1.6]}, {"k1": 8437.5, "m1": 1.5})
    answer_with(monkeypatch, "capture", tried)
    options = ("capture", "--plot", "none", "--only", "bonded")
    assert "954.9 rpm below, 1050 rpm beyond" in ask(*options, "--units", "rpm").success().out
    assert "1.333 below, eta = 1.467 beyond" in ask(*options, "--units", "eta").success().out
    assert "100 rad/s below, 110 rad/s beyond" in ask(*options).success().out
    sheet = ("--rated-voltage", "2", "--no-load-rpm", "16", "--stall-torque", "60")
    assert "1050 rpm beyond" in ask(*options, *sheet, "--eta0", "1:2").success().out


def test_a_passage_prints_its_motion_in_the_unit_asked_for(capsys, monkeypatch):
    moved = {"x1": variable([1e-3, -2e-3], "m", ("time",)), "passage_time": 0.5}
    moved["speed"] = variable([100.0, 110.0], "rad/s", ("time",))
    moved |= {"jumps": ("jump", [np.nan]), "decided": ("jump", ["no"])}
    data = xr.Dataset(moved, {"time": [0.0, 1.0], "jump": ["up"]}, {"kept": "all"})
    monkeypatch.setattr("orchestrate.figures.passage.jump_texts", lambda _: [])
    passage.print_result("bonded", data)
    assert "largest |x1| 0.002 m, speed up to 110 rad/s" in capsys.readouterr().out
    passage.print_result("bonded", with_units(data, "rpm, mm"))
    assert "largest |x1| 2 mm, speed up to 1050 rpm" in capsys.readouterr().out


def test_pictures_of_the_weak_drive_move_with_their_axes(ask, tmp_path):
    """Runs and the averaged theory under them."""
    short = ("--eta0", "1.4:1.41", "--rate", "2e-4", "--step", "0.2", "--settle", "9", "--one-way")
    ask("couple", *short, "--only", "delaminated", "--units", "rpm,um").success()
    (result,), (picture,) = ((tmp_path / "results").glob(f"*.{e}") for e in ("nc", "png"))
    assert picture.stem == f"{result.stem}_rpm-um"
    data = xr.load_dataset(result)
    plain = weak_drive.draw({"delaminated": data})
    shown = weak_drive.draw({"delaminated": with_units(data, "rpm, um")})
    in_rpm = 60.0 / (2.0 * np.pi)
    for figure, speed, length in ((plain, 1.0, 1.0), (shown, in_rpm, 1e6)):
        x, y = figure.axes[1].lines[0].get_xydata()[-1]
        expected = weak_drive.drop_spin_up(data)
        part = weak_drive.split_directions(expected)[0][0]
        assert x == pytest.approx(speed * float(expected.speed[part][-1]))
        assert y == pytest.approx(length * float(expected.amplitude[part][-1]))
    assert plain.axes[1].get_ylabel() == "amplitude of $x_1$ in m"
    assert shown.axes[1].get_ylabel() == "amplitude of $x_1$ in µm"
    assert shown.axes[1].get_xlabel() == shown.axes[0].get_ylabel() == "mean speed in rpm"
    text = couple_command.format_revolutions(with_units(data, "eta"))
    assert re.search(r"at eta = [\d.]+ to [\d.]+$", text)


@pytest.fixture
def record(tmp_path):
    """A swept sine of 2 g, and a response of twice as much."""
    time = np.arange(4000) / 500.0
    angle = 2.0 * np.pi * (20.0 * time + time**2)
    box = 19.6133 * np.sin(angle)
    data = {"time [s]": time, "base [m/s2]": box, "acc 1 [m/s2]": 2.0 * box}
    path = tmp_path / "swept.csv"
    pd.DataFrame(data).to_csv(path, index=False)
    return path


def test_what_an_analyser_shows(ask, record, tmp_path):
    show = ("--show", "psd,orders,shock,density", "--to", "6")
    plain = ask("analyse", record, *show, "--plot", "none").success().out
    stored = sums(tmp_path / "results")
    done = ask("analyse", record, *show, "--units", "rpm,g", "--format", "csv").success()
    assert sums(tmp_path / "results") == stored and len(stored) == 4
    assert "m/s2 rms" in plain and "(m/s2)2/Hz at" in plain and " Hz\n" in plain
    for words in (r"box: 1\.41\d* g rms", r"g2/Hz at [\d.]+ rpm", r"in g: order 1 4(\.0\d+)? at"):
        assert re.search(words, done.out), words
    assert not re.search(r"m/s2| Hz\b", done.out.replace("g2/Hz", ""))
    tables = [path for path in (tmp_path / "results").glob("*.csv") if "_psd_" in path.name]
    columns = {name for path in tables for name in pd.read_csv(path).columns}
    assert {"frequency [rpm]", "psd [g2/Hz]", "rms [g]"} <= columns
    assert all(path.stem.endswith("_rpm-g") for path in (tmp_path / "results").glob("*.png"))
    (name,) = (n for n in stored if "_density_" in n)
    data = xr.load_dataset(tmp_path / "results" / name)
    curves = [
        orchestrate.plot(data, units=units).axes[0].lines[-1].get_xydata() for units in ("", "g")
    ]
    np.testing.assert_allclose(*curves)


def test_a_verdict_is_said_in_the_units_asked_for(capsys, tmp_path):
    """Made-up: nothing opens up to 0.5 g over 40 to 56 Hz, 20 um would have been seen."""
    numbers = {"level_high": (4.903325, "m/s2"), "smallest_opening": (2e-5, "m")}
    numbers |= {"frequency_low": (40.0, "Hz"), "frequency_high": (56.0, "Hz")}
    made = {name: variable(value, unit) for name, (value, unit) in numbers.items()}
    verdict = xr.Dataset({"verdict": "no opening seen", **made})
    for units, level, words in (
        ("", "4.9 m/s² over 40 to 56 Hz", "20 µm"),
        ("rpm, g, mm", "0.5 g over 2400 to 3360 rpm", "0.02 mm"),
    ):
        diagnose.print_verdict(tmp_path / "a.csv", with_units(verdict, units))
        said = capsys.readouterr().out
        assert f" up to {level}. Faces at the sensor that part by {words} or more would" in said
    data = xr.Dataset(
        {"frequency": variable([40.0, 50.0], "Hz", ("frequency",)), "name": ("frequency", [1, 2])}
    )
    assert (
        diagnosis.label_with_unit("frequency", with_units(data, "rpm").frequency)
        == "frequency in Hz"
    )


TOURS = {  # what the page says of the pressed beam
    **dict.fromkeys(["", "eta", "Hz,mm,g", "mm"], "by 0.05 mm, the halves stay shut at 30 Hz and"),
    "rad/s,um,m/s2": "by 50 µm, the halves stay shut at 188.5 rad/s and 4.903 m/s²:",
}


def test_the_explorer_opens_in_the_units_asked_for(ask, tmp_path):
    page = tmp_path / "page.html"
    asked = (("", "paper"), ("eta", "paper"), ("Hz,mm,g", "g"), ("rad/s,um,m/s2", "g"), ("mm", "g"))
    for units, level in asked:
        more = ("--units", units) if units else ()
        ask("explore", "--no-open", *more, output=page).success()
        text = page.read_text(encoding="utf-8")
        assert re.search(rf'"level": ?\["{level}", ?1', text), units
        shown = json.loads(re.search(r'"shown": ?(\{[^}]*\})', text)[1])
        words = Units.from_text(units).with_defaults(Units("Hz", "mm", "g"))
        assert level == "paper" or Units(**shown) == words
        assert TOURS[units] in text, units
