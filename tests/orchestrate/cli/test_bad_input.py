"""A user's mistake: one line that names the thing, its value and what is expected."""

from __future__ import annotations

import json
import os
import socket
import sys

import netCDF4
import pytest

QUICK = ("--transient", "5", "--samples", "8")
SWEEP = [
    (["--eta", "0"], ["--eta 0:", "> 0"]),
    (["--eta", "-1"], ["--eta -1:", "0 < FIRST"]),
    (["--eta", "-1:2:0.5"], ["--eta -1:2:0.5:", "0 < FIRST"]),
    (["--eta", "nan"], ["--eta nan:", "FIRST:LAST:STEP"]),
    (["--eta", "1:inf:0.1"], ["--eta 1:inf:0.1:", "FIRST:LAST:STEP"]),
    (["--eta", "1e7"], ["eta = 10000000.0", "<= eta <= 1e+06"]),
    (["--eta", "abc"], ["--eta abc:", "not numbers", "FIRST:LAST:STEP"]),
    (["--eta", "1,2,"], ["--eta 1,2,:", "not numbers"]),
    (["--eta", "1:2"], ["--eta 1:2:", "FIRST:LAST:STEP"]),
    (["--eta", "2:1:0.1"], ["--eta 2:1:0.1:", "FIRST <= LAST"]),
    (["--eta", "1:2:0"], ["--eta 1:2:0:", "STEP > 0"]),
    (["--eta", "1:2:1e-9999999"], ["--eta 1:2:1e-9999999:", "10000000 values"]),
    (["--eta", "1,1", "--direction", "up"], ["eta", "1.0 twice"]),
    (["--over", "e", "--eta", "1"], ["--over and --values", "both"]),
    (["--over", "e", "--values", "0.1,0.2"], ["frequency: nothing given", "--eta"]),
    (["--over", "eta", "--values", "1,2"], ["--over eta", "--eta VALUES"]),
    (["--over", "amplitude", "--values", "1,2", "--hz", "1"], ["--over amplitude", "--g VALUES"]),
    (["--over", "k1", "--values", "1,2", "--eta", "1", "--g", "1"], ["--over k1", "--hz"]),
    (["--over", "e", "--values", "0.1,0.2", "--eta", "1,2"], ["--eta 1,2", "2 values"]),
    (["--over", "f", "--values", "0.1", "--eta", "1"], ["'f'", "no parameter"]),
    (["--over", "e", "--values", "0.1,1.2", "--eta", "1"], ["e = 1.2", "0 <= e <= 1"]),
    (["--set", "f=1"], ["f", "no parameter of a structure", "gamma"]),
    (["--set", "e"], ["--set e", "NAME=VALUE"]),
    (["--set", "e="], ["--set e=", "nothing is no number"]),
    (["--set", "e=abc"], ["--set e=abc", "abc is no number"]),
    (["--set", "e=0.1", "--set", "e=0.2"], ["--set e=0.2", "set twice"]),
    (["--set", "e=1.2"], ["e = 1.2", "0 <= e <= 1"]),
    (["--set", "e=nan"], ["e = nan", "0 <= e <= 1"]),
    (["--set", "D=-0.01"], ["D = -0.01", "0 <= D"]),
    (["--set", "gamma=0"], ["gamma = 0.0", "1e-09 <= gamma <= 1"]),
    (["--set", "mu=0"], ["mu = 0.0", "<= mu <="]),
    (["--set", "D=0.1", "--set", "D1=0.2"], ["D and D1", "one of them"]),
    (["--structure", "nowhere.toml"], ["nowhere.toml", "no such file", "paper"]),
    (["--samples", "0"], ["samples = 0", "from 1"]),
    (["--transient", "-1"], ["transient = -1", "from 0"]),
    (["--samples", "1000000000000"], ["samples = 1000000000000"]),
    (["--jobs", "0"], ["jobs = 0", "from 1"]),
    (["--tolerance", "0"], ["tolerance = 0.0", "> 0"]),
    (["--tolerance", "nan"], ["tolerance = nan", "finite"]),
    (["--fmu", "nowhere.fmu"], ["nowhere.fmu", "no such file"]),
]
SIMULATE = [
    ([], ["frequency: nothing given", "--eta", "--hz", "--rpm", "--frequency"]),
    (["--eta", "1,2"], ["--eta 1,2", "2 values"]),
    (["--eta", "1", "--frequency", "2"], ["--eta and --frequency", "one of them"]),
    (["--hz", "1", "--rpm", "2", "--g", "1"], ["--hz and --rpm", "one of them"]),
    (["--frequency", "2"], ["--frequency 2", "--amplitude", "--g"]),
    (["--hz", "2", "--amplitude", "1", "--g", "1"], ["--amplitude and --g", "one of them"]),
    (["--hz", "2", "--g", "x"], ["--g x", "expected a number > 0"]),
    (["--hz", "2", "--amplitude", "1,2"], ["--amplitude 1,2", "expected a number > 0"]),
    (["--hz", "1:2:0.1", "--g", "1"], ["--hz 1:2:0.1", "11 values"]),
    (["--structure", "beam", "--eta", "1"], ["--eta 1", "75 rad/s", "--amplitude", "--g"]),
    (["--eta", "1", "--beside", "--store", "a.nc"], ["--beside", "--store"]),
    (["--eta", "1", "--store", "mine.dat"], ["--store mine.dat", ".nc"]),
    (["--eta", "1", "--format", "nc,doc"], ["--format nc,doc", "doc", "xlsx"]),
    (["--eta", "1", "--plot", "gif"], ["--plot gif", "png", "svg"]),
    (["--frequency", "-2", "--amplitude", "1"], ["--frequency -2", "> 0"]),
    (["--eta", "1", "--periods", "0"], ["periods = 0", "from 1"]),
    (["--eta", "1", "--points", "0"], ["points = 0", "from 1"]),
    (["--eta", "1", "--start", "0,1"], ["--start 0,1", "four numbers"]),
    (["--eta", "1", "--start", "0,-1,0,0"], ["start = ", "x2 >= x1"]),
    (["--eta", "1", "--phase", "nan"], ["phase = nan", "<= phase <="]),
]
SPECTRA = [
    (["--eta", "abc"], ["--eta abc", "not numbers"]),
    (["--eta", "1", "--eta0", "1.3"], ["--eta", "--eta0"]),
    (["--eta", "1", "--points", "10"], ["highest = 40", "points/2"]),
    (["--eta", "1", "--periods", "0"], ["periods = 0"]),
    (["--eta", "1", "--transient", "-1"], ["transient = -1"]),
    (["--eta0", "1", "--voltage", "1"], ["--eta0 and --voltage"]),
    (["--drive", "paper"], ["paper", "no drive", "[motor] and [box]"]),
    (["--drive", "nowhere.toml"], ["nowhere.toml", "no such file"]),
    (["--voltage", "nan"], ["voltage = nan"]),
    (["--set", "box_mass=-1"], ["box_mass = -1.0", "<= box_mass"]),
]
SHAKEN = [  # mistakes in the box's motion and the structure, the same for all questions
    (["--hz", "10"], ["--hz 10", "--amplitude", "--g"]),
    (["--hz", "10", "--eta", "1", "--g", "1"], ["--eta and --hz", "one of them"]),
    (["--eta", "0"], ["--eta 0:", "> 0"]),
    (["--eta", "one"], ["--eta one", "not numbers"]),
    (["--rpm", "600", "--g", "-1"], ["--g -1", "expected a number > 0"]),
    (["--rpm", "600", "--amplitude", "nan"], ["--amplitude nan"]),
    (["--eta", "1", "--set", "e=2"], ["e = 2.0", "0 <= e <= 1"]),
    (["--eta", "1", "--set", "E=0.5"], ["E: no parameter", "did you mean e?"]),
    (["--eta", "1", "--structure", "lost.toml"], ["lost.toml", "no such file"]),
    (["--eta", "1", "--format", "txt"], ["--format txt", "csv"]),
    (["--eta", "1", "--plot", "gif"], ["--plot gif", "png"]),
    (["--eta", "1", "--store", "a.txt"], ["--store a.txt", ".nc"]),
    (["--eta", "1", "--fmu", "lost.fmu"], ["lost.fmu", "no such file"]),
]
RESONANCE = [
    *SHAKEN,
    ([], ["frequency: nothing given", "--hz"]),
    (["--structure", "beam", "--eta", "1:2:0.1"], ["--eta 1:2:0.1", "75 rad/s", "--g"]),
    (["--eta", "1,1"], ["eta", "1.0 twice"]),
    (["--eta", "2:1:0.1"], ["--eta 2:1:0.1", "FIRST <= LAST"]),
    (["--eta", "1", "--transient", "-1"], ["transient = -1"]),
    (["--eta", "1", "--samples", "0"], ["samples = 0"]),
    (["--eta", "1", "--prominence", "0"], ["prominence = 0.0"]),
    (["--eta", "1", "--jump", "-1"], ["jump = -1.0"]),
]
OVER_E = ["--over", "e", "--values", "0.3,0.7"]
MAP = [
    *[(["--eta", "1,2", *OVER_E, *options[2:]], words) for options, words in SHAKEN[6:]],
    (OVER_E, ["frequency: nothing given"]),
    (["--eta", "1", *OVER_E], ["map", "two parameters"]),
    (["--eta", "1,2"], ["map", "two parameters"]),
    (["--eta", "1,2", *OVER_E, "--over", "D", "--values", "0.1,0.2"], ["--eta 1,2", "2 values"]),
    (["--eta", "1", *OVER_E, *OVER_E], ["--over e", "twice"]),
    (["--eta", "1,2", "--over", "e"], ["--over and --values", "as many"]),
    (["--hz", "1,2", "--g", "0,1"], ["--g 0,1"]),
    (["--hz", "1,2", "--g", "1", "--amplitude", "1", *OVER_E], ["--g", "--amplitude"]),
    (["--eta", "1,2", "--over", "x", "--values", "1,2"], ["x: no parameter"]),
    (["--eta", "1,2", "--over", "e", "--values", "0.1,7"], ["e = 7.0"]),
    (["--eta", "1,2", "--over", "amplitude", "--values", "1,2"], ["--over amplitude"]),
    (["--eta", "1,1", *OVER_E], ["eta: a value twice"]),
    (["--eta", "1,2", *OVER_E, "--samples", "1"], ["samples = 1", "from 4"]),
    (["--eta", "1,2", *OVER_E, "--settle", "0"], ["settle = 0.0"]),
]
LYAPUNOV = [
    *SHAKEN,
    (["--over", "e"], ["--over and --values", "both"]),
    (["--eta", "1,2", *OVER_E], ["--eta 1,2", "2 values"]),
    (["--eta", "1", "--periods", "0"], ["periods = 0"]),
    (["--eta", "1.047", "--periods", "5"], ["periods = 5: 10 impacts", "periods >= 8"]),
    (["--eta", "1", "--sigmas", "0"], ["sigmas = 0.0"]),
    (["--eta", "1", "--transient", "-5"], ["transient = -5"]),
]
ATTRACTORS = [
    *SHAKEN,
    (["--eta", "1", "--starts", "0"], ["starts = 0"]),
    (["--eta", "1", "--seed", "-1"], ["seed = -1"]),
    (["--eta", "1", "--scale", "0"], ["--scale 0", "> 0"]),
    (["--eta", "1", "--scale", "big"], ["--scale big", "not numbers"]),
    (["--eta", "1", "--width", "nan"], ["width = nan"]),
    (["--eta", "1", "--samples", "2"], ["samples = 2", "from 4"]),
    (["--eta", "1", "--set", "bonded=true"], ["bonded", "a delaminated structure"]),
]
BASIN = [
    *SHAKEN,
    (["--eta", "1:2:0.5"], ["--eta 1:2:0.5", "3 values"]),
    (["--structure", "beam", "--eta", "1"], ["75 rad/s", "--amplitude"]),
    (["--eta", "1", "--x", "x_rel,0,1"], ["--x x_rel,0,1", "NAME,FIRST,LAST,COUNT"]),
    (["--eta", "1", "--x", "gap,0,1,5"], ["x = ('gap'", "x_rel"]),
    (["--eta", "1", "--x", "x1,1,0,5"], ["x = ('x1'", "low < high"]),
    (["--eta", "1", "--y", "x_rel,0,1,5"], ["x_rel twice"]),
    (["--eta", "1", "--y", "v1,-1,1,1"], ["y: count = 1"]),
    (["--eta", "1", "--at", "0,0,0"], ["--at 0,0,0", "four numbers"]),
    (["--eta", "1", "--at", "0,-1,0,0"], ["at = ", "x2 >= x1"]),
    (["--eta", "1", "--x", "x_rel,-2,-1,5"], ["the masses overlap at every start"]),
    (["--eta", "1", "--set", "bonded=true"], ["bonded", "a delaminated structure"]),
]
ORBIT = [
    *SHAKEN,
    (["--eta", "1", "--period", "0"], ["period = 0"]),
    (["--eta", "1", "--guess", "1,2"], ["--guess 1,2", "four numbers"]),
    (["--eta", "1", "--guess", "1,0,0,0"], ["guess = ", "x2 >= x1"]),
    (["--eta", "1", "--box-acceleration", "inf"], ["box_acceleration = inf"]),
    (["--eta", "1", "--set", "bonded=true"], ["bonded"]),
    (["--hz", "1:2:0.5", "--g", "1"], ["--hz 1:2:0.5", "3 values"]),
]
LIMITS = ["--limits", "2.4:2.6"]
BRANCH = [
    *[([*options, "--limits", "0.9:1.1"], words) for options, words in SHAKEN],
    ([], ["--limits", "FIRST:LAST"]),
    (["--limits", "2"], ["--limits 2", "FIRST:LAST"]),
    (["--eta", "2.5", "--limits", "2.6:2.4"], ["limits", "the lower one first"]),
    (["--eta", "3", *LIMITS], ["eta = 3.0 at the start", "inside"]),
    (["--over", "x", "--eta", "1", *LIMITS], ["x", "expected one of"]),
    (["--over", "hz", "--g", "1", *LIMITS], ["--g", "--amplitude"]),
    (["--over", "frequency", "--eta", "1", *LIMITS], ["--over frequency", "--amplitude"]),
    (["--over", "e", *LIMITS], ["frequency: nothing given"]),
    (["--start", "lost.nc", *LIMITS], ["--start lost.nc", "no such file"]),
    (["--eta", "2.5", "--switch", "0", *LIMITS], ["switch = 0", "expected a branch"]),
    (["--eta", "2.5", "--most", "0", *LIMITS], ["most = 0"]),
]
PAIRS = ["--limits", "1:2,0.1:0.9"]
BORDER = [
    ([], ["--start", "nothing given"]),
    (["--start", "lost.nc"], ["--limits", "nothing given"]),
    (["--start", "lost.nc", *PAIRS], ["--start lost.nc", "no such file"]),
    (["--start", "README.md", *PAIRS], ["--start README.md", "not readable"]),
    (["--start", "lost.nc", "--limits", "1:2,3"], ["--limits 3", "FIRST:LAST"]),
    (["--start", "lost.nc", *PAIRS, "--structure", "paper", "--set", "e=2"], ["e = 2.0"]),
    (["--start", "lost.nc", *PAIRS, "--structure", "paper", "--set", "E=2"], ["E: no parameter"]),
    (["--start", "lost.nc", *PAIRS, "--set", "e"], ["--set e", "NAME=VALUE"]),
    (["--start", "lost.nc", *PAIRS, "--structure", "lost.toml"], ["lost.toml"]),
    (["--start", "lost.nc", "--limits", "a:b,c:d"], ["--limits a:b"]),
]
PAPER = [
    (["--figures", ""], ["unknown figure ''"]),
    (["--figures", "5,x"], ["unknown figure 'x'", "choose from"]),
    (["--figures", "12,13"], ["unknown figure '13'"]),
    (["--figures", "Basin"], ["unknown figure 'Basin'"]),
    (["--figures", "spectra", "--jobs", "-1"], ["jobs = -1"]),
    (["--figures", "spectra", "--jobs", "5000"], ["jobs = 5000", "1024"]),
    (["--figures", "spectra", "--fmu", "lost.fmu"], ["lost.fmu", "no such file"]),
    (["--figures", "4"], ["unknown figure '4'", "choose from", "12", "maps"]),
    (["--figures", "5,,7"], ["unknown figure ''"]),
    (["--figures", "spectra", "--jobs", "0"], ["jobs = 0"]),
]
SWEPT = ["--swept-sine", "8:20", "--g", "1"]
LABORATORY = [
    ([], ["nothing given", "--swept-sine, --stepped-sine, --random, --shock, --record"]),
    ([*SWEPT, "--shock", "trapezoid"], ["--swept-sine and --shock given", "one of"]),
    (SWEPT, ["nothing given", "one of duration and rate"]),
    (["--swept-sine", "8:20", "--duration", "2"], ["level", "--g and --acceleration"]),
    ([*SWEPT, "--duration", "2", "--seed", "1"], ["--seed", "with --random alone"]),
    ([*SWEPT, "--duration", "-2"], ["--duration -2", "a number > 0"]),
    ([*SWEPT, "--duration", "2", "--spacing", "cubic"], ["spacing = 'cubic'", "linear, log"]),
    ([*SWEPT, "--duration", "2", "--accuracy", "1"], ["accuracy = 1.0", "<= 0.01"]),
    (["--swept-sine", "8", "--g", "1", "--duration", "2"], ["--swept-sine 8", "FIRST:LAST"]),
    (["--stepped-sine", "8:20", "--g", "1"], ["--stepped-sine 8:20", "FIRST:LAST:STEP"]),
    (["--stepped-sine", "8,9", "--g", "1", "--duration", "2"], ["--stepped-sine", "no --dur"]),
    (["--stepped-sine", "8,9", "--g", "1", "--settle-cycles", "x"], ["--settle-cycles x", "whole"]),
    (["--random", "5-9", "--duration", "2"], ["--random 5-9", "HZ:VALUE"]),
    (["--random", "5:1,9:nan", "--duration", "2"], ["--random 5:1,9:nan", "HZ:VALUE"]),
    (["--random", "5:1,9:1"], ["--random", "--duration"]),
    (["--random", "5:1,9:1", "--duration", "2", "--seed", "x"], ["--seed x", "whole number"]),
    (["--shock", "sine", "--length", "1", "--g", "1"], ["shape = 'sine'", "half-sine"]),
    (["--shock", "sawtooth", "--g", "1"], ["--shock", "--length"]),
    (["--record", "no.csv"], ["no.csv", "a file to read"]),
    (["--record", "a.csv", "--g", "1"], ["--record", "expected no --g"]),
    ([*SWEPT, "--unit", "g"], ["--unit", "with --record alone"]),
    ([*SWEPT, "--settle-cycles", "3"], ["--settle-cycles", "with --stepped-sine alone"]),
]
MISTAKES = [
    (command, options, words)
    for command, cases in (
        ("sweep", SWEEP),
        ("simulate", [*SIMULATE, *SHAKEN]),
        ("shake", LABORATORY),
        ("resonance", RESONANCE),
        ("map", MAP),
        ("lyapunov", LYAPUNOV),
        ("attractors", ATTRACTORS),
        ("basin", BASIN),
        ("orbit", ORBIT),
        ("branch", BRANCH),
        ("border", BORDER),
        ("spectra", SPECTRA),
        ("paper", PAPER),
    )
    for options, words in cases
]


@pytest.mark.parametrize(
    ("command", "options", "words"),
    MISTAKES,
    ids=lambda v: v if isinstance(v, str) else " ".join(v),
)
def test_mistake(ask, tmp_path, command, options, words):
    if command == "sweep" and not {"--eta", "--over"} & set(options):
        options = ["--eta", "1", *options]
    done = ask(command, *options)
    assert done.out == ""
    done.complaint(*words)
    assert done.complaints[0].startswith("error: ")
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


SYNTAX = [
    ([], ["COMMAND"]),
    (["swep"], ["'swep'"]),
    (["--eta", "1"], ["COMMAND"]),
    (["sweep", "--bogus", "1"], ["--bogus"]),
    (["spectra", "--eta0=1", "--volt", "1"], ["--volt"]),  # no abbreviations
    (["sweep", "--samples", "1.5"], ["--samples", "'1.5'", "int"]),
    (["sweep", "--direction", "sideways"], ["--direction", "'sideways'", "up"]),
    (["build", "now"], ["now"]),
    (["build", "--folder"], ["--folder", "expected one argument"]),
    (["build", "--format", "fmi4"], ["--format"]),
    (["lyapunov", "--follow", "me"], ["--follow", "'me'", "up"]),
    (["resonance", "--direction", "given"], ["--direction", "'given'", "both"]),
    (["basin", "--samples", "many"], ["--samples", "'many'", "int"]),
    (["couple", "--only", "glued"], ["--only", "'glued'", "bonded"]),
]


@pytest.mark.parametrize(("arguments", "words"), SYNTAX, ids=lambda value: " ".join(value))
def test_what_is_no_command(ask, arguments, words):
    done = ask(*arguments)
    *usage, line = done.err.splitlines()
    assert (done.code, done.out) == (2, "")
    assert usage[0].startswith("usage: ")
    assert "error: " in line and all(word in line for word in words), line


@pytest.mark.parametrize("command", [("sweep", "--eta", "1"), ("couple",), ("paper", "--quick")])
def test_output_that_is_a_file(ask, tmp_path, command):
    (tmp_path / "results").write_text("mine")
    ask(*command, output=tmp_path / "results" / "below").complaint("--output", "expected a folder")
    assert (tmp_path / "results").read_text() == "mine"


def test_a_foreign_fmu_is_refused(ask, tmp_path, exported):
    shaker = exported / "fmi2-python" / "MotorShaker.fmu"
    ask("sweep", "--eta", "1", "--fmu", shaker).complaint("MotorShaker", "expected TwoMass")
    ask("couple", "--fmu", shaker, "--fmu", shaker).complaint("a second MotorShaker")
    (tmp_path / "empty.fmu").touch()
    ask("sweep", "--eta", "1", "--fmu", tmp_path / "empty.fmu").complaint("not readable")


def test_a_wrong_file_is_named_with_section_and_key(ask, tmp_path):
    path = tmp_path / "own.toml"
    path.write_text("[structure]\nm1 = 1.0\nstiffness = 2.0\n")
    ask("sweep", "--eta", "1", "--structure", path).complaint("own.toml", "stiffness")
    path.write_text("[structure]\nm1 = \n")
    ask("sweep", "--eta", "1", "--structure", path).complaint("own.toml")


def not_netcdf(path):
    path.write_bytes(b"garbage" * 1000)


def netcdf_of_others(path):
    with netCDF4.Dataset(path, "w") as data:
        data.title = "of others"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (not_netcdf, "not a result of this project"),
        (netcdf_of_others, "not a result of this project"),
        (lambda path: path.mkdir(), "a folder; expected a place for a file"),
    ],
)
def test_something_else_in_the_place_of_the_result(ask, tmp_path, make, words):
    result = tmp_path / "results" / "mine.nc"
    result.parent.mkdir()
    make(result)
    before = result.read_bytes() if result.is_file() else b""
    done = ask("sweep", "--eta", "1", *QUICK, "--store", result)
    done.complaint(result, words, code=done.code)
    assert done.code in (1, 2)
    assert [path.name for path in result.parent.iterdir()] == [result.name]
    assert (result.read_bytes() if result.is_file() else b"") == before


def test_a_stale_result_is_refused_with_what_has_changed(ask, tmp_path):
    asked = ("sweep", "--eta", "1", *QUICK)
    assert ask(*asked).code == 0
    (result,) = (tmp_path / "results").glob("*.nc")
    with netCDF4.Dataset(result, "a") as data:
        identity = json.loads(data.identity)
        identity["code"]["orchestrate.response.respond"] = "older"
        data.identity = json.dumps(identity)
        del data.content_sha256
    before = result.read_bytes()
    words = "stale", "response/respond.py", "--force", "--keep-stale"
    ask(*asked).complaint(*words)
    assert result.read_bytes() == before
    kept = ask(*asked, "--keep-stale")
    assert kept.code == 0 and "complete already" in kept.out
    assert ask(*asked, "--force").code == 0
    assert ask(*asked).code == 0


def test_debug_shows_where_an_error_came_from(tmp_path):
    from orchestrate.cli import main
    from orchestrate.errors import InputError

    for arguments in (["--debug", "sweep"], ["sweep", "--debug"]):
        with pytest.raises(InputError, match="e = 2"):
            main([*arguments, "--set", "e=2", "--output", str(tmp_path)])


def test_no_scheduler(ask, tmp_path, monkeypatch):
    monkeypatch.setattr("orchestrate.running.cluster.CONNECT_TIMEOUT", "1s")
    address = "tcp://127.0.0.1:1"
    ask("sweep", "--eta", "1", "--cluster", address).complaint(f"cluster {address}", "no scheduler")
    assert list((tmp_path / "results").glob("*.nc")) == []


def test_no_scheduler_but_something_that_takes_calls_and_is_silent(ask, monkeypatch):
    monkeypatch.setattr("orchestrate.running.cluster.CONNECT_TIMEOUT", "1s")
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        asked = ask("sweep", "--eta", "1", "--cluster", address)
    asked.complaint(f"cluster {address}", "no scheduler")


@pytest.mark.parametrize("asked", [("--eta", "1"), ("--frequency", "1", "--amplitude", "1")])
def test_no_orbit_is_looked_for_at_an_undamped_resonance(ask, tmp_path, asked):
    ask("orbit", *asked, "--set", "D=0").complaint("frequency = 1.0 rad/s", "d1 = 0.0")
    assert list(tmp_path.rglob("*.nc*")) == []


def test_a_sweep_goes_through_an_undamped_resonance(ask):
    """Impacts take what the resonance feeds in: there is a finite answer."""
    ask("sweep", "--eta", "0.9,1,1.1", "--set", "D=0", *QUICK).success()


def test_what_a_file_says_is_shown_in_one_line(ask, tmp_path):
    """Neither a line of its own, nor a terminal's commands, nor pages of it."""
    path = tmp_path / "own.toml"
    path.write_text('[structure]\n"one\\ntwo\\u001b[2J" = 1\n')
    line = ask("sweep", "--eta", "1", "--structure", path).complaint("no key of [structure]")
    assert "one\\ntwo\\x1b[2J" in line
    path.write_text(f"[structure]\nm1 = '{'x' * 50_000}'\n")
    assert len(ask("sweep", "--eta", "1", "--structure", path).complaint(" ... ")) < 1100


def test_a_result_whose_identity_is_damaged(ask, tmp_path):
    path = tmp_path / "branch.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.setncattr("identity", "[")
    ask("border", "--start", path, *PAIRS).complaint("identity is damaged")


@pytest.mark.skipif(sys.platform != "linux", reason="names of any bytes")
def test_a_path_that_is_not_utf_8_is_refused_before_anything_is_computed(ask, tmp_path):
    name = tmp_path / os.fsdecode(b"results-\xff")
    done = ask("sweep", "--eta", "1", *QUICK, output=name)
    done.complaint("results-\\udcff", "not UTF-8")
    ask("sweep", "--eta", "1", *QUICK, "--store", name / "a.nc").complaint("not UTF-8")
    copy = name.with_suffix(".nc")
    ask("sweep", "--eta", "1:1.1:0.1", *QUICK, "--store", tmp_path / "a.nc")
    copy.write_bytes((tmp_path / "a.nc").read_bytes())
    ask("explore", copy, "--no-open", output=tmp_path / "page.html").complaint("not UTF-8")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.nc", "a.png", copy.name]


@pytest.mark.parametrize("value", ["abc", "1.5", "-1", "1e400", "9" * 30, " 1", "\u0661"])
def test_a_time_of_the_environment_that_is_none_is_refused(ask, monkeypatch, value):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", value)
    done = ask("sweep", "--eta", "1", *QUICK)
    done.complaint("SOURCE_DATE_EPOCH", "whole number of seconds")


def test_an_fmu_of_gigabytes_is_not_read(ask, tmp_path):
    path = tmp_path / "large.fmu"
    with path.open("wb") as file:
        file.truncate(8 << 30)
    ask("sweep", "--eta", "1", "--fmu", path).complaint(path, f"{8 << 30} bytes, at most")


RECOMMENDED = [
    (
        ("map", "--hz", "8:20:4", "--over", "g", "--values", "0.3,0.5"),
        "--over g: expected --g VALUES",
    ),
    (("map", "--hz", "8", "--over", "hz", "--values", "1,2"), "--over hz: expected --hz VALUES"),
    (("branch", "--over", "hz", "--limits", "20:30", "--hz", "20"), "--amplitude in m with it"),
    (("branch", "--over", "hz", "--limits", "20:30"), "--over hz: expected --amplitude in m"),
    (("branch", "--over", "g", "--limits", "1:2", "--hz", "20"), "expected --over amplitude"),
]


@pytest.mark.parametrize(("asked", "words"), RECOMMENDED)
def test_nothing_is_recommended_that_is_refused_then(ask, asked, words):
    line = ask(*asked, "--structure", "beam").complaint(words)
    assert "--g with it" not in line and "--g in" not in line
