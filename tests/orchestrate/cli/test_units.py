"""Units at the command line: as the question is asked, or as ``--units`` says; the result in SI."""

from __future__ import annotations

import hashlib
import re

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from orchestrate import cli
from orchestrate.cli import dynamics, printing, responses
from orchestrate.cli.dynamics import attractor_table
from orchestrate.dynamics.orbit_records import STABILITY
from orchestrate.response.labels import flags
from orchestrate.units import with_units

from ...exports import BUILD
from ...sparing import ordinary

BEAM = ("--structure", "beam", "--set", "clearance=-2e-5")
BOX = ("--structure", "beam", "--hz", "12", "--g", "0.02")
SWEPT = ("--structure", "beam", "--hz", "12:13:1", "--g", "0.02", "--direction", "up")
SHORT = ("--transient", "10", "--samples", "4")
LONGER = ("--transient", "60", "--samples", "16")
FOREIGN = r"\bHz\b|rad/s|\d m\b|\d mm\b| m\b|m/s2|\beta\b"
GRID = ("--hz", "12,13", *BOX[4:], "--over", "e", "--values", "0.3,0.7", *SHORT)
CONNECTED = ("box_acceleration=box_acceleration", "box_force=box_force")
ASKED = {  # command, a unit, what is printed in it, and what is printed anyhow
    "simulate": ((*BOX, "--periods", "3"), "mm", r"[\d.]+ mm\n", ()),
    "shake": (
        ("--structure", "beam", "--shock", "sawtooth", "--length", "0.01", "--g", "2"),
        *("um", r"gap x2 - x1.* to [\d.e+]+ um\b", ()),
    ),
    "cosimulate": (
        (
            *("--structure", "beam", "--duration", "0.2", "--step", "0.002"),
            *("--drive", str(BUILD / "fmi2" / "MotorShaker.fmu"), "--connect", *CONNECTED),
        ),
        *("mm", r"displacement of mass 1.* to [\d.e+-]+ mm\b", ()),
    ),
    "resonance": (
        ("--structure", "beam", "--hz", "12:13:0.1", "--g", "0.02", *LONGER),
        *("rpm", r"frequency rpm"),
        ("peaks", "bonded", "delaminated  up", "no jump"),
    ),
    "sweep": ((*SWEPT, *SHORT), "rpm", r"at 7[28]0 rpm", ()),
    "spectra": (
        (*BOX, "--transient", "5", "--periods", "8"),
        *("rpm", r"delaminated at 720 rpm: largest line", ()),
    ),
    "map": (
        (*BOX[:2], *GRID),
        *("rpm", r"7[28]0 rpm"),
        ("4 responses: ", "largest gap"),
    ),
    "lyapunov": (
        ("--eta", "0.8,1.047", "--transient", "100", "--periods", "300"),
        *("Hz", r"frequency Hz"),
        ("exponent", "chaotic", "-0.007", "periodic"),
    ),
    "poincare": (
        (*BOX, "--transient", "5", "--periods", "9"),
        *("mm", r"gap .*: [\d.e-]+ to [\d.]+ mm\b", ()),
    ),
    "attractors": (
        ("--eta", "1.3,1.4", "--starts", "5", *LONGER, "--settle", "20"),
        *("Hz", r"at 0\.222817 Hz"),
        ("(5 random starts)", "multiplicity", "state at phase 0"),
    ),
    "basin": (
        ("--eta", "1.4", "--x", "x_rel,-0.1,0.8,4", "--y", "v_rel,-1,1,3", *LONGER),
        *("um", r"v_rel -1000 to 1000 mm/s, x_rel -1e\+05 to 8e\+05 um"),
        ("of 9 starts", "share", "3 starts left out"),
    ),
    "orbit": (
        ("--eta", "3.0"),
        *("mm", r"impact at 0\.480678\d* s, closing at [\d.]+ mm/s"),
        ("unstable", "-3.359480", "0.480678", "state at phase 0"),
    ),
    "manifold": (
        ("--eta", "3.0", "--length", "1"),
        *("mm", r"[\d.e-]+ to [\d.]+ mm"),
        ("saddle: multiplier -3.359480", "length over the orbit's size", "length  "),
    ),
    "branch": (  # whose bifurcations are in Hz as well
        ("--eta", "2.62", "--limits", "2.6:2.7"),
        *("Hz", r"0\.4\d+ to 0\.4\d+ Hz[^$]*kind +frequency Hz\n +0 .* 0\.42143"),
        ("Neimark-Sacker", "limit"),
    ),
    "couple": (
        ("--eta0", "1.4:1.41", "--rate", "2e-4", "--step", "0.2", "--settle", "9", "--one-way"),
        *("rpm", r"revolutions at [\d.]+ to [\d.]+ rpm", ()),
    ),
}
ELSEWHERE = {
    "analyse",
    "build",
    "paper",
    "channels",
    "diagnose",
    "border",
    "capture",
    "passage",
    "drive-branch",
    "halves",
}
ELSEWHERE |= {"jump-voltages", "explore", "report", "plan"}  # below, or where a page is written


def printed(done):
    """What a command prints, without the names of files."""
    return "\n".join(line for line in done.out.splitlines() if not line.startswith("/"))


def sums(folder):
    """Check sums of the stored results."""
    return {
        path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.glob("*.nc")
    }


def test_every_command_is_tested():
    assert set(cli.COMMANDS) == set(ASKED) | ELSEWHERE


@pytest.mark.parametrize("command", ordinary(ASKED, set(ASKED) - {"manifold", "branch", "couple"}))
def test_a_printed_number_follows_and_the_result_stays(ask, tmp_path, command):
    options, unit, words, always = ASKED[command]
    drawn = () if command == "orbit" else ("--plot", "none")  # figures are tested elsewhere
    few, folder = ("--jobs", "1", *drawn, "--format", "csv"), tmp_path / "results"
    plain = ask(command, *options, *few).success().out
    stored, tables = sums(folder), set(folder.glob("*.csv"))
    shown = ask(command, *options, *few, "--units", unit).success().out
    assert not re.search(words, plain) and re.search(words, shown), (plain, shown)
    assert all(word in plain and word in shown for word in always), plain
    assert sums(folder) == stored and all(name.startswith(f"{command}_") for name in stored)
    assert stored and "complete already" in shown and "complete already" not in plain
    told = re.findall(r"^/.*?(?=: complete already$|$)", f"{plain}{shown}", re.MULTILINE)
    assert set(told) == {str(path) for path in folder.iterdir()}
    new = set(folder.glob("*.csv")) - tables
    assert new and all(f"_{unit}." in path.name for path in new)
    columns = {name for path in new for name in pd.read_csv(path).columns}
    assert any(f"[{unit}]" in name for name in columns), columns


@pytest.mark.parametrize("command", ["resonance", "simulate"])
def test_prints_are_in_the_units_asked_for_and_in_no_other(ask, command):
    asked = (*SWEPT[2:], *SHORT) if command == "resonance" else (*BOX[2:], "--periods", "5")
    options = (command, *BEAM, *asked, "--plot", "none")
    text = printed(ask(*options, "--units", "rpm, um, g").success()).replace("mm/s", "")
    assert not re.search(FOREIGN, text), text
    assert " um" in text
    plain = printed(ask(*options).success())
    assert re.search(r" [mu]m\b", plain) and not re.search(r"\d m\b| m\b", plain)


@pytest.mark.parametrize(
    ("asked", "word"),
    [
        (("--hz", "11:13:1"), "Hz"),
        (("--rpm", "660:780:60"), "rpm"),
        (("--frequency", "70:80:5"), "rad/s"),
        (("--eta", "0.9:1.1:0.1"), "eta = "),
    ],
)
def test_a_question_is_answered_as_it_is_asked(ask, asked, word):
    short = (*SHORT, "--direction", "up", "--amplitude", "1e-5", "--plot", "none")
    done = ask("sweep", *BEAM, *asked, *short).success()
    assert f"at {word}" in done.out or re.search(rf"\d {word}\b", done.out)


def test_a_file_asks_in_its_own_units(ask, tmp_path):
    path = tmp_path / "beam.toml"
    path.write_text(
        "[structure]\nm1 = 1\nm2 = 1\nf1_hz = 12\nf2_hz = 13\nzeta1 = 0.01\nzeta2 = 0.01\n"
        "[excitation]\nfrequency_rpm = 720\nacceleration_g = 0.1\n"
    )
    done = ask("simulate", "--structure", path, "--periods", "2", "--plot", "none").success()
    assert re.search(r"[\d.]+ g\b", done.out)
    done = ask("attractors", "--structure", path, "--starts", "1", *SHORT, "--plot", "none")
    assert "at 720 rpm" in done.out


def test_wrong_units_are_refused_before_anything_is_computed(ask):
    done = ask("sweep", "--eta", "1.2", "--units", "Hz,rpm")
    done.complaint("--units Hz,rpm: Hz and rpm; expected one unit of frequency")
    ask("simulate", "--eta", "1.2", "--units", "ft").complaint("--units ft: ft; expected a list of")


@pytest.mark.parametrize("command", ["map", "orbit", "basin"])
def test_the_largest_gap_is_a_length_where_the_motion_of_the_box_is_known(command):
    """1.5 times a Omega^2/omega^2, which is 0.2/100 m."""
    one = {"xi_rel_max": 1.5, "multiplicity": 1.0, "impacts_per_period": 1.0}
    over = {"map": ("e",), "orbit": (), "basin": ("attractor",)}[command]
    data = xr.Dataset(
        {name: (over, np.full((1,) * len(over), value)) for name, value in one.items()},
        attrs={"k1": 100.0, "m1": 1.0, "level": 0.2},
    )
    data = with_units(data.assign_coords({name: [0.5] for name in over}), "mm")
    if command == "map":
        words = {"flag_values": [0, 1, 2], "flag_meanings": "irregular repeated undecided"}
        lines = responses.Map().summary(data.assign(multiplicity_decided=("e", [1], words)))
    elif command == "orbit":
        more = {"stability": flags((), 1, "stability", STABILITY)}
        more |= {"multipliers": (("multiplier", "part"), [[0.5, 0.0]])}
        more |= {"impact_time": ("impact", []), "impact_velocity": ("impact", [])}
        lines = dynamics.Orbit().summary(data.assign({**more, "state": ("sample", [])}))
    else:
        words = {"flag_values": [0, 1], "flag_meanings": "absent orbit"}
        more = {"share": ("attractor", [1.0]), "decided_by": ("attractor", [1], words)}
        more["state"] = (("attractor", "coordinate"), [[0.0] * 4])
        lines = attractor_table(data.assign(more))
    assert "xi_Rel = 1.5, 3 mm" in " ".join(lines)


def test_a_unit_that_begins_with_one_is_printed_whole():
    """Of a ratio none is."""
    values = {"decay": ("eta", [2.0], {"units": "1/s"}), "ratio": ("eta", [0.5], {"units": "1"})}
    data = xr.Dataset(values, coords={"eta": [1.2], "rate": ("eta", [3.0], {"units": "1/s"})})
    lines = {line.split()[0]: line.split()[1:] for line in responses.table_of_one(data, "eta")}
    assert (lines["decay"], lines["ratio"]) == (["2", "1/s"], ["0.5"])
    assert printing.format_parameter(data, "rate", 3.0) == "rate = 3 1/s"


def test_times_of_impacts_are_tau_in_ratios_unless_a_unit_is_asked_for(ask):
    orbit = ("orbit", "--eta", "3.0", "--plot", "none")
    assert "impact at tau = 0.480678" in ask(*orbit).success().out
    assert re.search(r"impact at 0\.22950\d* periods", ask(*orbit, "--units", "periods").out)


def test_the_picture_of_an_orbit_says_whether_it_is_stable():
    motion = xr.Dataset(attrs={"e": 0.7, "eta": 3.0})
    for number, word in STABILITY.items():
        stability = flags((), number, "stability", STABILITY)
        title = dynamics.orbit_title(xr.Dataset({"stability": stability}), motion)
        assert title == f"{word} orbit, $e$ = 0.7, $\\eta$ = 3"


@pytest.mark.parametrize("command", ["paper", "build"])
def test_a_command_whose_numbers_have_no_units_has_no_such_option(ask, command):
    ask(command, "--units", "Hz").complaint(f"--units: no option of {command}")


def test_lengths_of_no_structure_have_their_unit():
    """A drive that runs without a structure is in SI."""
    about = {"units": "m/s2", "long_name": "acceleration of the box"}
    alone = xr.Dataset({"box_acceleration": ("time", [-0.1, 0.2], about)})
    assert [*printing.extents(alone, "box_acceleration")] == [
        "acceleration of the box: -0.1 to 0.2 m/s2"
    ]
