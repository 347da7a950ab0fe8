"""What a command takes for granted, and what somebody hardly means: said, from which number on."""

import functools
import json
import logging
import warnings
from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate import Structure
from orchestrate.cli import grammar, notes
from orchestrate.cli.options import print_assumptions
from orchestrate.errors import InputError

TURN = 2.0 * np.pi
HALVES = Structure.from_halves(m1=1.5, m2=1.2, f1=40.0, f2=50.0, zeta1=0.01, zeta2=0.01, e=0.5)
PRESSED = HALVES.replace(clearance=-2e-5)


@pytest.fixture
def said(caplog):
    """Run something, and return what is warned of and noted."""

    def heard(ask):
        caplog.clear()
        with warnings.catch_warnings(record=True) as caught, caplog.at_level(logging.WARNING):
            warnings.simplefilter("always")
            list(ask() or ())
        words = [str(one.message) for one in caught]
        return " ".join([*words, *(one.getMessage() for one in caplog.records)])

    return heard


def frequency_notes(hertz, **options):
    given = SimpleNamespace(structure="mine", set=[], **options)
    question = {"frequency": TURN * hertz}
    return lambda: notes.print_and_warn_of_frequencies(given, HALVES, question)


def notes_on_rad_s(value):
    return frequency_notes(value / TURN, frequency=f"{value:g}")


def clearance_notes(times):
    given = {"frequency": np.array([TURN * 20.0]), "level": np.array([1.0])}
    given["level"] = notes.smallest_threshold_over_level(PRESSED, given) / times
    return lambda: notes.clearance_notes(PRESSED, given, xr.Dataset())


FAR, UNIT = "are far from it", "own frequencies are 40 and 50 Hz; is --hz meant?"


@pytest.mark.parametrize(
    ("ask", "inside", "outside", "words"),
    [
        (frequency_notes, 24.9 * 40.0, 25.1 * 40.0, FAR),
        (frequency_notes, 40.0 / 24.9, 40.0 / 25.1, FAR),
        (notes_on_rad_s, 40.0 / 1.11, 40.0 / 1.09, UNIT),  # within a tenth of one
        (notes_on_rad_s, 56.0, 50.0 / 0.91, UNIT),
        (clearance_notes, 199.0, 201.0, "times what this level moves"),
    ],
)
def test_each_number_from_which_one_is_asked(said, ask, inside, outside, words):
    assert words not in said(ask(inside)) and words in said(ask(outside))


def test_voltages_and_masses_that_are_hardly_meant(said):
    for ratios, far in (((0.4, 0.49), 1), ((0.4, 0.51), 0), ((5.1, 9.0), 1), ((4.9, 9.0), 0)):
        asked = "--voltage x", tuple(6.5 * ratio for ratio in ratios), 6.5
        words = said(functools.partial(notes.warn_of_unusual_voltage, *asked))
        assert ("omega with 6.5 V (eta0 = 1)" in words) == far
    heavy = [bool(notes.heavy_mass_note(HALVES.replace(m2=mass))) for mass in (19.9, 20.1)]
    assert heavy == [False, True]
    for ratio, unlike in ((2.9, False), (3.1, True), (1.0 / 2.9, False), (1.0 / 3.1, True)):
        beam = Structure.from_halves(m1=1.0, m2=1.0, f1=40.0, f2=ratio * 40.0, zeta1=0.01)
        with pytest.raises(InputError, match="f2 would be") if unlike else nullcontext():
            print_assumptions(beam, "paper", {"f1": 40.0})


def test_what_is_not_said(said, capsys):
    """Of ratios, of the halves' own frequencies, of a set that is asked for, of a play."""
    ratios, shown, one = Structure.nondimensional(mu=30.0), xr.Dataset(), np.ones(1)
    wide = Structure.from_halves(m1=1.0, m2=1.0, f1=40.0, f2=TURN * 40.0, zeta1=0.01)
    cases = (ratios, "", ""), (wide, "", ""), (wide, "paper", "e"), (wide, "paper", "")
    for beam, name, changed in cases:
        given = SimpleNamespace(structure=name, set=changed, frequency="251.3")
        box = {"frequency": beam.omega * one, "amplitude": one / beam.omega}
        ask = functools.partial(notes.print_and_warn_of_frequencies, given, beam, box)
        assert not said(ask)
        assert bool(capsys.readouterr().out) == (name == "paper" and not changed)
    assert not notes.heavy_mass_note(ratios)
    assert notes.box_frequencies_and_amplitudes(ratios, {"eta": 2.0}) == (2.0, 0.25)
    for over, count in (("level", 1), ("frequency", 0)):
        assert len([*notes.trivial_question_notes(HALVES, {"over": over}, shown)]) == count
    asked, play = {"frequency": TURN * 20.0 * one, "level": 0.1 * one}, {"clearance": 1e-4}
    for more, over, count in (({}, {}, 1), ({"stroke": 2e-3}, {}, 0), ({}, {"over": "e"}, 0)):
        beam = HALVES.replace(**play, **more)
        assert len([*notes.clearance_notes(beam, asked | over, shown)]) == count
    assert [len([*clearance_notes(times)()]) for times in (0.99, 1.01)] == [0, 1]


SIMULATE = "simulate --periods 2 --plot none --set f1=42 --set f2=55 "
MASSES = "--set m1=1.5 --set m2=1.2 "
ZETAS = "--set zeta1=0.7% --set zeta2=0.007 "
G = "--g 0.3 "
MOVES = "times what this level moves"
QUIET = "--hz 20 --g 0.001 --set clearance="
LEVEL = "resonance --structure beam --transient 2 --samples 4 --plot none "
SHAKE = "shake --structure beam --swept-sine 8:10 --duration 1 --g 0.02 --plot none --sample-rate "
SAID = {  # a command; what is printed (or not, after a "!"), and what is warned of
    SIMULATE + "--hz 42 " + G: (
        "assumed, as in the set paper|m1 = 1 kg|zeta1 = 0.5 %|e = 0.7|only the ratio of the masses",
        "",
    ),
    SIMULATE + MASSES + ZETAS + "--set e=0.6 --hz 42 " + G: ("!assumed, as|!are in kg", ""),
    SIMULATE + "--set mu=0.8 --hz 42 " + G: ("!m1 =", ""),
    SIMULATE + "--set m1=20.1kg --set m2=1 --hz 42 " + G: ("masses are in kg", ""),
    SIMULATE + "--set zeta1=0.7 --hz 42 " + G: ("", "zeta1 = 0.7 is 70 %"),
    SIMULATE + MASSES + "--set clearance=-20 --hz 42 " + G: ("", "clearance = -20 m"),
    SIMULATE + MASSES + "--frequency 42 " + G: ("", "is --hz meant?"),
    SIMULATE + MASSES + "--hz 264 " + G: ("", "is --frequency meant?"),
    SIMULATE + MASSES + "--rpm 2500 " + G: ("", ""),
    SIMULATE + MASSES + QUIET + "-2e-5": ("opens at|is linear|no impacts|um, it first", MOVES),
    SIMULATE + MASSES + QUIET + "1.5e-3": ("touches at|is linear|no impacts", MOVES),
    SIMULATE + MASSES + "--set clearance=-2e-5 --hz 48 --g 3": ("!is linear|!no impacts", ""),
    "simulate --set wall=true --set f1=12 --set zeta1=1% --set clearance=0.3mm --hz 11 --g 0.1"
    " --periods 2 --plot none": (
        "assumed, as in the set paper: m1 = 1 kg, e = 0.7|impacts|mass 1|!mass 2",
        "",
    ),
    "branch --structure beam --over hz --limits 16.5:16.6 --plot none --g 0.02": (
        "--g 0.02: is --amplitude 1.82483e-05 at 16.5 Hz, constant along the branch",
        "",
    ),
    LEVEL + "--amplitude 49mm --hz 12": ("", ""),
    LEVEL + "--amplitude 51mm --hz 12": ("", "beyond what shakers do"),
    LEVEL + "--g 99 --hz 40": ("", ""),
    LEVEL + "--g 101,120 --hz 40": ("", "the box moves by up to "),
    SHAKE + "19": ("", "default is 200"),
    SHAKE + "21": ("", ""),
}


@pytest.mark.parametrize("command", SAID)
def test_what_is_assumed_or_implausible_is_said_in_one_line(ask, command):
    printed, warned = SAID[command]
    done = ask(*command.split())
    assert done.code == 0, done.err
    for words in filter(None, printed.split("|")):
        assert (words.removeprefix("!") in done.out) != words.startswith("!"), (words, done.out)
    assert [warned in line for line in done.complaints] == [True] * bool(warned), done.complaints


STORED = Structure.from_file("beam").replace(e=0.65)
COMMANDS = {
    "branch": "--over hz --limits 14:18 --start",
    "border": "--over hz,e --limits 14:18,0.6:0.8 --start",
    "manifold": "--start",
    "explore": "--no-open --branches",
}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_stored_result_brings_its_structure(ask, tmp_path, monkeypatch, command):
    """Another one is taken and said in one line."""
    asked, path = [], tmp_path / "stored.nc"
    attributes = {name: float(value) for name, value in STORED.parameters().items()}
    call = {"call": "branch(...)", "over": "frequency", "identity": json.dumps({"question": {}})}
    xr.Dataset({"stable": ("point", [1])}, attrs={**attributes, **call}).to_netcdf(path)
    place = (
        "orchestrate.explorer.page.explore" if command == "explore" else f"orchestrate.{command}"
    )

    @functools.wraps(getattr(orchestrate, command, Structure))
    def ask_only(structure, **question):
        asked.append(structure)
        raise RuntimeError("not computed")

    once = functools.cache(grammar.load_earlier_result)  # its isolated process takes long to start
    monkeypatch.setattr(grammar, "load_earlier_result", once)
    monkeypatch.setattr(place, ask_only)
    words = (command, *COMMANDS[command].split(), path)
    assert ask(*words).out == "" and asked.pop() == STORED
    others = [(("--structure", "paper"), Structure(), "m1 = 1.5 there, 1 here")]
    if command != "explore":
        others += [(("--set", "e=0.6"), STORED.replace(e=0.6), "e = 0.65 there, 0.6 here")]
        assert ask(*words, "--structure", "beam", "--set", "e=0.65").out == ""
        asked.pop()
    for options, structure, difference in others:
        (line,) = ask(*words, *options).out.splitlines()
        assert asked.pop() == structure
        text = f"{words[-2]} {path} was computed for another structure: {difference}"
        assert line.startswith(text)
    once.cache_clear()
    xr.Dataset({"x": ("t", [1.0])}, attrs={"call": "analyse(...)"}).to_netcdf(path, mode="w")
    if command == "branch":
        ask(*words).complaint(f"--start {path}", "over t, without a structure", "expected an orbit")
        assert ask("branch", "--eta", "2.5", "--limits", "2.4:2.8").out == ""
        assert asked.pop() == Structure()
