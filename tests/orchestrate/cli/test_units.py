"""Units at the command line: as the question is asked, or as ``--units`` says; the result in SI."""

import hashlib
import re

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from orchestrate.cli.question import print_attractors

from orchestrate.cli import map as map_command
from orchestrate.cli import orbit as orbit_command
from orchestrate.dynamics.orbit_records import STABILITY
from orchestrate.response.labels import flags
from orchestrate.units import with_units

BEAM = ("--structure", "beam", "--set", "clearance=-2e-5")
ASKED = ("--hz", "11:13:1", "--g", "0.02")
SHORT = ("--transient", "20", "--samples", "6", "--direction", "up")
FOREIGN = r"\bHz\b|rad/s|\d m\b|\d mm\b| m\b|m/s2|\beta\b"


def said(done):
    """What a command prints, without the names of files."""
    return "\n".join(line for line in done.out.splitlines() if not line.startswith("/"))


@pytest.mark.parametrize("command", ["resonance", "sweep", "simulate", "poincare"])
def test_prints_are_in_the_units_asked_for_and_in_no_other(ask, command):
    box = ASKED if command in ("resonance", "sweep") else ("--hz", "12", "--g", "0.02")
    short = SHORT if command in ("resonance", "sweep") else ("--periods", "5")
    done = ask(command, *BEAM, *box, *short, "--plot", "none", "--units", "rpm, um, g").success()
    text = said(done).replace("um/s", "um")
    assert not re.search(FOREIGN, text), text
    assert " um" in text
    usual = said(ask(command, *BEAM, *box, *short, "--plot", "none").success())
    assert re.search(r" [mu]m\b", usual) and not re.search(r"\d m\b| m\b", usual)
    plain = said(ask(command, *BEAM, *box, *short, "--plot", "none", "--units", "m").success())
    assert " um" not in plain and re.search(r"\d m\b| m\b|m/s", plain)


def test_every_number_of_a_length_or_an_acceleration_has_its_unit(ask):
    """A line with a unit has one after each number, or in the head of its column."""
    options = (*BEAM, *ASKED, *SHORT, "--plot", "none", "--units", "Hz,mm,g")
    text = said(ask("sweep", *options).success())
    for line in text.splitlines():
        if re.search(r"\b(mm|g)\b", line):
            bare = re.sub(r"mass \d|xi_Rel = [\d.e+-]+|\d+ %", "", line)
            for number in re.finditer(r"(?<![\w.])[-+]?\d+\.?\d*(e[-+]?\d+)?", bare):
                assert re.match(r" (mm|g|Hz)\b", bare[number.end() :]), line
    table = said(ask("resonance", *options[:-4], "--g", "0.02,0.04", *options[-4:]))
    assert "|x1| mm" in table and "gap mm" in table and "0.04 g" in table


def test_the_same_question_shown_in_other_units_has_the_same_bits(ask, tmp_path):
    folder, sums, columns = tmp_path / "results", set(), {}
    for units in ("Hz,mm,g", "eta", "rpm, m/s2", ""):
        more = ("--units", units) if units else ()
        done = ask("resonance", *BEAM, *ASKED, *SHORT, "--format", "csv", *more).success()
        (result,) = folder.glob("*.nc")
        sums.add(hashlib.sha256(result.read_bytes()).hexdigest())
        tables = [line for line in done.out.splitlines() if line.endswith("frequency.csv")]
        named = [path for path in tables if "structure" in path]
        columns[units] = set(pd.read_csv(named[0]).columns)
        assert ("complete already" in done.out) == (units != "Hz,mm,g")
    assert len(sums) == 1
    assert {"frequency [Hz]", "x1_max [mm]", "a1_max [g]"} <= columns["Hz,mm,g"]
    assert {"frequency [rpm]", "x1_max [m]", "a1_max [m/s2]"} <= columns["rpm, m/s2"]
    assert {"eta", "frequency [rad/s]", "a1_max [g]"} <= columns["eta"]
    assert {"frequency [Hz]", "x1_max [m]", "a1_max [g]"} <= columns[""]
    pictures = {path.name.rpartition("_up_")[2][7:] for path in folder.glob("*.png")}
    assert pictures == {"Hz-mm-g.png", "eta.png", "rpm-m_s2.png", "png"}


@pytest.mark.parametrize(
    ("asked", "name", "word"),
    [
        (("--hz", "11:13:1"), "_11-13Hz_", "Hz"),
        (("--rpm", "660:780:60"), "_660-780rpm_", "rpm"),
        (("--frequency", "70:80:5"), "_70-80rad_s_", "rad/s"),
        (("--eta", "0.9:1.1:0.1"), "_eta0.9-1.1_", "eta = "),
    ],
)
def test_a_question_is_answered_as_it_is_asked(ask, tmp_path, asked, name, word):
    done = ask("sweep", *BEAM, *asked, "--amplitude", "1e-5", *SHORT, "--plot", "none").success()
    (result,) = (tmp_path / "results").glob("*.nc")
    assert name in result.name
    assert f"at {word}" in done.out or re.search(rf"\d {word}\b", done.out)


def test_a_file_asks_in_its_own_units(ask, tmp_path):
    path = tmp_path / "beam.toml"
    path.write_text(
        "[structure]\nm1 = 1\nm2 = 1\nf1_hz = 12\nf2_hz = 13\nzeta1 = 0.01\nzeta2 = 0.01\n"
        "[excitation]\nfrequency_rpm = 720\nacceleration_g = 0.1\n"
    )
    done = ask("simulate", "--structure", path, "--periods", "2", "--plot", "none").success()
    assert "_720rpm_" in done.out and re.search(r"[\d.]+ g\b", done.out)


def test_names_without_a_unit_asked_for_stay(ask, tmp_path):
    options = ("--eta", "0.9:1.1:0.1", *SHORT, "--plot", "none", "--format", "csv")
    ask("sweep", *options).success()
    (table,) = (tmp_path / "results").glob("*.eta.csv")
    names = set(pd.read_csv(table).columns)
    assert {"eta", "frequency [rad/s]", "x1_max [m]", "a1_max [m/s2]", "amplitude [m]"} <= names


def test_wrong_units_are_refused_before_anything_is_computed(ask):
    done = ask("sweep", "--eta", "1.2", "--units", "Hz,rpm")
    done.complaint("--units Hz,rpm: Hz and rpm; expected one unit of frequency")
    ask("simulate", "--eta", "1.2", "--units", "ft").complaint("--units ft: ft; expected a list of")


@pytest.mark.parametrize("command", ["map", "orbit", "basin"])
def test_the_largest_gap_is_a_length_where_the_motion_of_the_box_is_known(command, capsys):
    """1.5 times a Omega^2/omega^2, which is 0.2/100 m."""
    one = {"xi_rel_max": 1.5, "multiplicity": 1.0, "impacts_per_period": 1.0}
    over = {"map": ("e",), "orbit": (), "basin": ("attractor",)}[command]
    data = xr.Dataset(
        {name: (over, np.full((1,) * len(over), value)) for name, value in one.items()},
        attrs={"k1": 100.0, "m1": 1.0, "level": 0.2},
    )
    data = with_units(data.assign_coords({name: [0.5] for name in over}), "mm")
    if command == "map":
        words = {"flag_values": [0, 1], "flag_meanings": "repeated undecided"}
        map_command.print_result(data.assign(multiplicity_decided=("e", [0], words)))
    elif command == "orbit":
        more = {"stability": flags((), 1, "stability", STABILITY)}
        more |= {"multipliers": (("multiplier", "part"), [[0.5, 0.0]])}
        more |= {"impact_time": ("impact", []), "impact_velocity": ("impact", [])}
        orbit_command.print_result(data.assign({**more, "state": ("sample", [])}))
    else:
        more = {"share": ("attractor", [1.0]), "decided_by": ("attractor", [0])}
        print_attractors(data.assign({**more, "state": ("coordinate", [0.0] * 4)}), "the plane")
    assert "xi_Rel = 1.5, 3 mm" in capsys.readouterr().out


def test_the_picture_of_an_orbit_says_whether_it_is_stable():
    motion = xr.Dataset(attrs={"e": 0.7, "eta": 3.0})
    for number, word in STABILITY.items():
        stability = flags((), number, "stability", STABILITY)
        title = orbit_command.orbit_title(xr.Dataset({"stability": stability}), motion)
        assert title == f"{word} orbit, $e$ = 0.7, $\\eta$ = 3"
