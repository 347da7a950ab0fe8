"""Options are declared once, by the public function; numbers are read by one grammar."""

from __future__ import annotations

import argparse
import inspect
import subprocess
import sys

import pytest
from orchestrate.cli.declared_options import argument_documentation, option_keywords

import orchestrate
from orchestrate import cli
from orchestrate.cli import grammar
from orchestrate.cli.options import excitation_by_level, read_excitation
from orchestrate.errors import InputError

from .commands import ROOT

CONVERTED = {  # options in other units or words than the argument's, by their commands
    **dict.fromkeys([("couple", "settle"), ("passage", "settle"), ("jump-voltages", "settle")]),
    ("sweep", "direction"): "up for a range, a list as it stands",
    ("border", "over"): "a text",
    ("border", "bifurcation"): "required in Python",
}


def parsers():
    (action,) = (
        action
        for action in cli.make_parser()._actions
        if isinstance(action, argparse._SubParsersAction)
    )
    return action.choices


def options():
    """Command, option and parameter of each option that is an argument of its function."""
    for command, parser in parsers().items():
        if command == "report":  # of stored results; its folder is no argument of the function
            continue
        function = getattr(orchestrate, command.replace("-", "_"), None)
        parameters = inspect.signature(function).parameters if inspect.isfunction(function) else {}
        for action in parser._actions:
            if action.dest in parameters and action.dest not in ("structure", "drive"):
                yield command, action, parameters[action.dest]


def test_every_default_is_that_of_the_function():
    compared = 0
    for command, action, parameter in options():
        if (command, action.dest) in CONVERTED or parameter.default is inspect.Parameter.empty:
            continue
        unset = action.default in (None, [])
        assert (None if unset else action.default) == parameter.default, (command, action.dest)
        compared += 1
    assert compared > 80


def test_every_declared_option_has_a_meaning_and_its_default_in_the_help():
    for command, action, parameter in options():
        assert action.help, (command, action.dest)
        if parameter.default not in (None, False, inspect.Parameter.empty):
            assert "(default: " in action.help, (command, action.dest)


def test_a_function_is_imported_for_its_own_command_alone():
    code = (
        "import sys; from orchestrate.cli import make_parser; make_parser(sys.argv[1:]);"
        "print('numpy' in sys.modules, 'orchestrate.dynamics.basins' in sys.modules)"
    )
    for words, expected in ((["--help"], "False False"), (["sweep", "--help"], "True False")):
        command = [sys.executable, "-c", code, *words]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        assert done.stdout.split() == expected.split(), words


@pytest.mark.slow
def test_without_docstrings_options_are_the_same(tmp_path):
    """As ``python -OO`` leaves them; only the help is poorer."""
    command = [sys.executable, "-OO", "-m", "orchestrate", "resonance", "--eta", "1.1,1.2"]
    words = ["--direction", "up", "--transient", "5", "--samples", "8", "--plot", "none"]
    done = subprocess.run(
        [*command, *words, "--output", str(tmp_path)], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "resonance_" in next(tmp_path.glob("*.nc")).name


def test_a_meaning_that_is_told_elsewhere_is_followed():
    assert argument_documentation(orchestrate.basin, "settle") == argument_documentation(
        orchestrate.attractors, "settle"
    )
    assert argument_documentation(orchestrate.lyapunov, "eta")[1].startswith("Frequency ratio")
    with pytest.raises(LookupError, match="sweep"):
        argument_documentation(orchestrate.sweep, "nothing")
    details = option_keywords(orchestrate.resonance, "direction")
    assert details["choices"] == ["up", "down", "both"] and details["default"] == "both"


def test_every_number_is_read_by_the_grammar():
    """Python's own ``float`` takes ``1_000`` and digits of any script."""
    plain = {grammar.plain_float, grammar.plain_int}
    for command, parser in parsers().items():
        for action in parser._actions:
            assert action.type not in (float, int), (command, action.dest)
            assert (
                action.type in plain
                or not isinstance(action.default, (int, float))
                or (isinstance(action.default, bool))
            ), (command, action.dest)


@pytest.mark.parametrize(
    "reader, text, value",
    [
        (grammar.positive_number, "0.5", 0.5),
        (grammar.parse_ends, "1.2:1.65", (1.2, 1.65)),
        (grammar.parse_number_or_ends, "1.5", (1.5,)),
        (grammar.parse_number_or_ends, "2:1", (2.0, 1.0)),
        (grammar.parse_rates, "1e-4,5e-5", (1e-4, 5e-5)),
        (grammar.parse_orders, "3", 3.0),
        (grammar.parse_orders, "0.5,1", (0.5, 1.0)),
        (grammar.parse_state, "0,0.5,-1,0", (0.0, 0.5, -1.0, 0.0)),
        (grammar.parse_plane_side, "x_rel, 0,0.8,60", ("x_rel", 0.0, 0.8, 60)),
        (grammar.parse_breakpoints, "10:0.5,200:1", ((10.0, 0.5), (200.0, 1.0))),
        (grammar.parse_one_or_more, "1", 1.0),
        (grammar.parse_one_or_more, "1:2:0.5", (1.0, 1.5, 2.0)),
    ],
)
def test_texts_of_options(reader, text, value):
    assert reader("--x", text) == value
    for wrong in (f"{text}_0", "", "abc", "1:2:3:4", "nan,,"):
        with pytest.raises(InputError, match="--x"):
            reader("--x", wrong)


def motion(**given):
    names = ("eta", "hz", "rpm", "frequency", "amplitude", "g")
    return argparse.Namespace(**{**dict.fromkeys(names), "structure": "beam", **given})


def test_levels_of_the_box_are_a_number_or_several():
    """Held as peak accelerations; where a command does not take several, one is expected."""
    beam = orchestrate.Structure.from_file("beam")
    asked = excitation_by_level(motion(hz="12", g="0.1:2:0.05"), beam)
    assert isinstance(asked["frequency"], float) and len(asked["level"]) == 39
    single = read_excitation(motion(hz="12", g="0.1"), beam)
    assert asked["level"][0] == pytest.approx(single["amplitude"] * single["frequency"] ** 2)
    with pytest.raises(InputError, match="--hz 12:14:1: 3 values; expected one"):
        excitation_by_level(motion(hz="12:14:1", g="0.1,0.2"), beam, one=True)
    with pytest.raises(InputError, match="--g 0.1,0.2: expected a number > 0"):
        read_excitation(motion(hz="12", g="0.1,0.2"), beam)
    with pytest.raises(InputError, match="--amplitude and --g"):
        excitation_by_level(motion(hz="12", g="0.1", amplitude="1"), beam)
