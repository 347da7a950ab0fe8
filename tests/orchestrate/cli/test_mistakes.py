"""A user's mistake: one line that names the thing, its value and what is expected."""

from __future__ import annotations

import json
import os
import random
import shlex
import subprocess
import sys

import netCDF4
import pytest

from orchestrate import cli
from orchestrate.errors import InputError
from tests import ROOT

QUICK = ("--transient", "5", "--samples", "8")
SWEEP = ("sweep", "--eta", "1", *QUICK, "--plot", "none")
MISTAKES = {  # options of each command, with names of `files`, then what its line says
    "sweep": """
        --eta -1 : --eta -1: | 0 < FIRST
        --eta 2:1:0.1 : --eta 2:1:0.1: | FIRST <= LAST
        --over e --values 0.1,0.2 : frequency: nothing given | --eta
        --over amplitude --values 1,2 --hz 1 : --over amplitude | --g VALUES
        --over k1 --values 1,2 --eta 1 --g 1 : --over k1 | --hz
        --set e : --set e | NAME=VALUE
        --set gap=1mm : --set gap: no parameter | did you mean clearance?
        --set zeta=1% --set zeta2=0.1 : zeta2 is set already
        --set e=1.2 : e = 1.2 | 0 <= e <= 1
        --structure nowhere.toml : nowhere.toml | no such file | paper
        --structure README.md : README.md: not readable as TOML | looks like a record
        --fmu nowhere.fmu : nowhere.fmu | no such file
    """,
    "simulate": """
        : frequency: nothing given | --eta | --hz | --rpm | --frequency
        --eta 1,2 : --eta 1,2 | 2 values | with a decimal point, 1.2
        --eta 1 --frequency 2 : --eta and --frequency | one of them
        --frequency 2 : --frequency 2 | --amplitude | --g
        --structure beam --eta 1 : --eta 1 | 75 rad/s | --amplitude | --g
        --eta 1 --store mine.dat : --store mine.dat | .nc
        --eta 1 --start 0,1 : --start 0,1 | four numbers
    """,
    "shake": """
        : nothing given | --swept-sine, --stepped-sine, --random, --shock, --hammer, --record
        --hammer 20:0.004 --half 3 : --half 3 | 1 to 2
        --swept-sine 8:20 --g 1 --shock trapezoid : --swept-sine and --shock given | one of
        --swept-sine 8:20 --g 1 : nothing given | one of --duration and --rate
        --swept-sine 8,20 --g 1 --duration 2 : --swept-sine 8,20 | in Hz, such as 8:20
        --swept-sine 8:20 --duration 2 : level | --g and --acceleration
        --stepped-sine 8:20 --g 1 : --stepped-sine 8:20 | FIRST:LAST:STEP
        --random 5:1,9:nan --duration 2 : --random 5:1,9:nan | HZ:VALUE
        --swept-sine 8:20 --g 1 --unit g : --unit | only with --record
    """,
    "analyse": """
        nowhere.nc : FILE nowhere.nc: no such file
        README.md --show frequency : --show frequency | expected some of frf, psd
        README.md --beside whole.nc : --beside whole.nc: expected LABEL=FILE
        README.md --beside README=x.nc : a second record README
        README.md --damping 0.1 : --damping: expected only with --show shock
        parted.nc --beside x=lost.nc : --beside lost.nc: no such file
        parted.nc --show orders --orders 2.5 : orders = 2.5: expected
        parted.nc --resolution 0.001 : resolution = 0.001 Hz | parted.nc
        parted.nc --from 20 : nothing between --from and --to; it has 0 to 9.999 s
        simulated.nc --sensor fast : --sensor fast: expected HZ or HZ:RATE
        bench.csv : bench.csv | no unit | --unit
        bench.csv --unit stone : unit = 'stone'
        bench.csv --unit g --columns acceleration1=9 : no column 9
        bench.csv --unit g --columns mass=1 : no channel 'mass'
    """,
    "diagnose": """
        sine.csv --set e=0.4 : --set: of a guess | --structure FILE.toml
        lost.csv : lost.csv: no such file; expected a record
        sine.csv --structure beam.toml --participation 1,2,3 : --participation 1,2,3: | face 1
        sine.csv --structure lost.toml : lost.toml
        sine.csv --structure beam.toml --channels 0 : channels = '0' | base=...,face1=
        sine.csv --structure beam.toml --columns 0,1 : no acceleration of a face in time | --ch
        sine.csv sine.csv --structure beam.toml --other sine.csv : --other: of one beam
        sine.csv --structure beam.toml --unit furlong : furlong | give it by --unit
        sine.csv --structure beam.toml : sine | sine
    """,
    "plan": """
        --sensor 9:8:7 : --sensor 9:8:7: expected HZ or HZ:RATE
        --noise 3um : --noise 3um: expected a number
    """,
    "halves": """
        : RECORDS is missing
        a.csv b.csv c.csv : c.csv: expected one record of each half
        a.csv --thicknesses 3 : --thicknesses 3: expected H1,H2
    """,
    "map": """
        --eta 1 --over e --values 0.3,0.7 : map | two parameters
        --eta 1,2 --over e : --over and --values | exactly one --values for each --over
    """,
    "attractors": """
        --structure beam --eta 1.32 : --eta 1.32 | --amplitude in m or --g
    """,
    "basin": """
        --eta 1 --x x_rel,0,1 : --x x_rel,0,1 | NAME,FIRST,LAST,COUNT
    """,
    "branch": """
        : --limits | FIRST:LAST
        --eta 3 --limits 2.4:2.6 : eta = 3.0 at the start | inside
        --over hz --g 1 --limits 2:3 --set clearance=1e-4 : --amplitude 0.0621013 at 2 Hz
        --over frequency --eta 1 --limits 2.4:2.6 : --over frequency | --amplitude
    """,
    "border": """
        --start lost.nc --limits 1:2,0.1:0.9 : --start lost.nc | no such file
        --start README.md --limits 1:2,0.1:0.9 : --start README.md | not readable
    """,
    "spectra": """
        --eta abc : --eta abc | not numbers
        --eta 1 --eta0 1.3 : --eta | --eta0
        --drive paper : paper | no drive | [motor] and [box]
    """,
    "paper": """
        --figures '' : unknown figure ''
    """,
    "couple": """
        --structure beam : --drive is missing | too slow for 75 rad/s
        --rated-voltage 12 : --rated-voltage 12 | without --no-load-rpm | --stall-torque together
        --rated-voltage 9 --no-load-rpm 9 --stall-torque 1 --set motor_constant=2 : given with --r
        --eta0 1:2 --voltage 1:2 : --eta0 and --voltage | one of them
        --eta0 1.2 : voltage 1.2 V | --duration
        --rate 1e-4,5e-5 : --rate 1e-4,5e-5 | expected one | jump-voltages
        --speed-control 1.5 --speed-gradient : --speed-control and --speed-gradient
        --gain 2 : --gain | --speed-control
    """,
    "jump-voltages": """
        --rate 1:2:3 : --rate 1:2:3 | several such as 1e-4,5e-5
    """,
    "drive-branch": """
        --speed 1 : --speed 1 | FIRST:LAST
    """,
}
CASES = [
    (command, *map(str.strip, f" {line.strip()}".partition(" : ")[::2]))
    for command, lines in MISTAKES.items()
    for line in lines.strip().splitlines()
]


@pytest.mark.parametrize(("command", "options", "words"), CASES)
def test_mistake(ask, tmp_path, files, command, options, words):
    if command == "sweep" and not ("--eta" in options or "--over" in options):
        options = f"--eta 1 {options}"
    done = ask(command, *(files.get(word, word) for word in shlex.split(options)))
    assert done.out == ""
    done.complaint(*(word.strip() for word in words.split("|")))
    assert done.complaints[0].startswith("error: ")
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


SYNTAX = """
    : COMMAND
    swep : swep: no command; did you mean sweep?
    jump : did you mean jump-voltages?
    sweep --e 0.3 : --e: | did you mean --set e=0.3?
    map --e=0.1:0.9:0.1 : --e: | did you mean --over e --values 0.1:0.9:0.1?
    analyse --shw=psd x.csv : --shw: | did you mean --show?
    spectra --eta0=1 --volt 1 : --volt: | did you mean --voltage?
    resonance my.toml : my.toml: no option of resonance; did you mean --structure my.toml?
    sweep --gravity 9.81 : --gravity: no option of sweep; did you mean --box-acceleration -1g?
    shake --g-rms 1 : did you mean --g?
    plan --levels 1 : did you mean --g?
    simulate --duration 5 : did you mean --periods?
    diagnose --guess a.toml : did you mean --structure?
    couple --level 1 : --level: no option of couple
    simulate beam : beam: no option of simulate; did you mean --structure beam?
"""


@pytest.mark.parametrize("line", SYNTAX.strip().splitlines())
def test_what_is_no_command(ask, line):
    """Abbreviated options are refused too: a later version may have another that begins so."""
    options, _, words = f" {line.strip()}".partition(" : ")
    done = ask(*options.split())
    *usage, last = done.err.splitlines()
    assert (done.code, done.out) == (2, "")
    assert not usage or usage[0].startswith("usage: ")
    assert "error: " in last and all(word.strip() in last for word in words.split("|")), last


@pytest.mark.parametrize("command", [("sweep", "--eta", "1"), ("couple",), ("paper", "--quick")])
def test_an_output_that_is_or_is_named_like_a_file(ask, tmp_path, command):
    ask(*command, output=tmp_path / "rep.html").complaint("rep.html", "expected a folder")
    (tmp_path / "results").write_text("mine")
    ask(*command, output=tmp_path / "results" / "below").complaint("--output", "expected a folder")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["mine"]


def test_a_foreign_fmu_is_refused(ask, tmp_path, exported):
    shaker, path = exported / "fmi2-python" / "MotorShaker.fmu", tmp_path / "empty.fmu"
    ask(*SWEEP, "--fmu", shaker).complaint("MotorShaker", "expected TwoMass")
    ask("couple", "--fmu", shaker, "--fmu", shaker).complaint("a second MotorShaker")
    path.touch()
    ask(*SWEEP, "--fmu", path).complaint("not readable")
    os.truncate(path, 8 << 30)
    ask(*SWEEP, "--fmu", path).complaint(path, f"{8 << 30} bytes, at most")


def test_something_else_in_the_place_of_the_result(ask, tmp_path):
    (tmp_path / "folder.nc").mkdir()
    (tmp_path / "garbage.nc").write_bytes(b"garbage" * 1000)
    with netCDF4.Dataset(tmp_path / "others.nc", "w") as data:
        data.title = "of others"
    before = {path: path.is_file() and path.read_bytes() for path in tmp_path.iterdir()}
    for path in before:
        words = "not a result of this project" if path.is_file() else "a folder; expected a place"
        ask(*SWEEP, "--store", path).complaint(path, words, code=1 if path.is_file() else 2)
    assert before == {path: path.is_file() and path.read_bytes() for path in tmp_path.iterdir()}


def test_a_stale_result_is_refused_with_what_has_changed(ask, tmp_path):
    ask(*SWEEP).success()
    (result,) = (tmp_path / "results").glob("*.nc")
    with netCDF4.Dataset(result, "a") as data:
        identity = json.loads(data.identity)
        identity["code"]["orchestrate.response.respond"] = "older"
        data.identity = json.dumps(identity)
        del data.content_sha256
    before = result.read_bytes()
    ask(*SWEEP).complaint("stale", "response/respond.py", "--force", "--keep-stale")
    assert result.read_bytes() == before
    assert "complete already" in ask(*SWEEP, "--keep-stale").success().out
    for more in (("--force",), ()):
        ask(*SWEEP, *more).success()


def test_debug_shows_where_an_error_came_from(tmp_path):
    for arguments in (["--debug", "sweep"], ["sweep", "--debug"]):
        with pytest.raises(InputError, match="e = 2"):
            cli.main([*arguments, "--set", "e=2", "--output", str(tmp_path)])


def test_what_a_file_says_is_shown_in_one_line(ask, tmp_path):
    """Neither a line of its own, nor a terminal's commands, nor pages of it."""
    path = tmp_path / "own.toml"
    path.write_text('[structure]\n"one\\ntwo\\u001b[2J" = 1\n')
    line = ask(*SWEEP, "--structure", path).complaint("no key of [structure]")
    assert "one\\ntwo\\x1b[2J" in line
    path.write_text(f"[structure]\nm1 = '{'x' * 50_000}'\n")
    assert len(ask(*SWEEP, "--structure", path).complaint(" ... ")) < 1100


@pytest.mark.skipif(sys.platform != "linux", reason="names of any bytes")
def test_a_path_that_is_not_utf_8_is_refused_before_anything_is_computed(ask, tmp_path):
    name = tmp_path / os.fsdecode(b"results-\xff")
    ask(*SWEEP, output=name).complaint("results-\\udcff", "not UTF-8")
    ask(*SWEEP, "--store", name / "a.nc").complaint("not UTF-8")
    copy = name.with_suffix(".nc")
    ask(*SWEEP, "--store", tmp_path / "a.nc")
    copy.write_bytes((tmp_path / "a.nc").read_bytes())
    ask("explore", copy, "--no-open", output=tmp_path / "page.html").complaint("not UTF-8")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.nc", copy.name]


def test_a_backend_of_the_environment_that_is_none_is_refused(exported, tmp_path):
    """The result is stored, only its picture is not drawn."""
    asked = ("sweep", "--eta", "1,1.1", *QUICK, "--output", str(tmp_path))
    command = [sys.executable, "-m", "orchestrate", *asked]
    environment = {**os.environ, "MPLBACKEND": "nonsense"}
    done = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True)
    (line,) = [line for line in done.stderr.splitlines() if "MPLBACKEND" in line]
    assert line.startswith("error: MPLBACKEND = 'nonsense' in the environment") and "agg" in line
    assert done.returncode == 2 and "Traceback" not in done.stderr
    assert [path.suffix for path in tmp_path.iterdir()] == [".nc"]


def test_a_time_of_the_environment_that_is_none_is_refused(ask, monkeypatch):
    for value in ("abc", "1.5", "-1", "9" * 30, "\u0661"):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", value)
        ask(*SWEEP).complaint("SOURCE_DATE_EPOCH", "whole number of seconds")


WORDS = ["1", "-1", "nan", "1:2:0.5", "1,2", "", "a=b", "e=1.2", "beam", "x.nc", "--", "ä", "1_000"]


def test_random_command_lines_end_in_one_line(ask, monkeypatch):
    def stop(*_):
        raise InputError("nothing is computed")

    monkeypatch.setattr("orchestrate.cli.output.HowRun.running_keywords", stop)
    chance = random.Random(62)
    for _ in range(80):
        name = chance.choice([one for one in cli.COMMANDS if one not in ("build", "explore")])
        flags, words = {*cli.COMMANDS[name].flags()} - {"--debug"}, [name]
        for flag in chance.choices(sorted(flags), k=chance.randrange(5)):
            words += [flag, chance.choice(WORDS)]
        done = ask(*words)
        assert done.code in (0, 2), words
        assert done.code == 0 or [line for line in done.complaints if line.startswith("error: ")]
