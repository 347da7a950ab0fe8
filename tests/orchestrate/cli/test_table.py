"""The table of commands: options declared once, examples that can be typed, help at once."""

from __future__ import annotations

import argparse
import inspect
import os
import re
import shlex
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

import orchestrate
from orchestrate import cli
from orchestrate.cli import grammar
from orchestrate.cli.options import excitation_by_level, read_excitation
from orchestrate.cli.output import result_name
from orchestrate.cli.table import parse_options
from orchestrate.cli.text import format_ranges
from orchestrate.errors import InputError
from orchestrate.model.structure import Structure
from orchestrate.units import with_units

from .commands import ROOT

NAMES = re.findall(
    r"[\w-]+",
    "build simulate shake cosimulate analyse diagnose plan resonance spectra sweep map lyapunov "
    "poincare attractors basin orbit manifold branch border couple capture passage jump-voltages "
    "drive-branch explore report paper",
)
CONVERTED = {  # options in other units or words than the argument's, by their commands
    **dict.fromkeys([("couple", "settle"), ("passage", "settle"), ("jump-voltages", "settle")]),
    ("sweep", "direction"): "up for a range, a list as it stands",
    ("border", "over"): "a text",
    ("border", "bifurcation"): "required in Python",
}


@pytest.fixture(scope="module")
def parsers():
    """The parsers of all commands, with all of their options."""
    actions = cli.make_parser()._actions
    (action,) = (one for one in actions if isinstance(one, argparse._SubParsersAction))
    return action.choices


def options_of_functions(parsers):
    """Command, option and parameter of each option that is an argument of its function."""
    for command, parser in parsers.items():
        if command == "report":  # of stored results; its folder is no argument of the function
            continue
        function = getattr(orchestrate, command.replace("-", "_"), None)
        parameters = inspect.signature(function).parameters if inspect.isfunction(function) else {}
        for action in parser._actions:
            if action.dest in parameters and action.dest not in ("structure", "drive"):
                yield command, action, parameters[action.dest]


def test_every_command_is_there(parsers):
    assert sorted(parsers) == sorted(NAMES)
    assert all("--units" in parser._option_string_actions for parser in parsers.values())


def test_every_default_is_that_of_the_function_and_in_the_help(parsers):
    compared = 0
    for command, action, parameter in options_of_functions(parsers):
        assert action.help, (command, action.dest)
        if parameter.default not in (None, False, inspect.Parameter.empty):
            assert "(default: " in action.help, (command, action.dest)
        if (command, action.dest) in CONVERTED or parameter.default is inspect.Parameter.empty:
            continue
        default = None if action.default in (None, []) else action.default
        assert default == parameter.default, (command, action.dest)
        assert type(default) is type(parameter.default), (command, action.dest)
        compared += 1
    assert compared > 80


def test_every_number_is_read_by_the_grammar(parsers):
    """Python's own ``float`` takes ``1_000`` and digits of any script."""
    plain = {grammar.plain_float, grammar.plain_int}
    for command, parser in parsers.items():
        for action in parser._actions:
            assert action.type not in (float, int), (command, action.dest)
            number = isinstance(action.default, (int, float)) and action.nargs != 0
            assert action.type in plain or not number, (command, action.dest)


def test_a_line_that_is_no_option_is_refused():
    with pytest.raises(ValueError, match="one space"):
        parse_options("--jobs N one space before the help")


@pytest.mark.parametrize("program", ["vibroimpact", "python -m orchestrate"])
def test_help_has_quantities_and_examples_that_can_be_typed(capsys, monkeypatch, parsers, program):
    monkeypatch.setattr(sys, "argv", [f"/bin/{program}"])
    for command in NAMES:
        with pytest.raises(SystemExit) as ended:
            cli.main([command, "--help"])
        assert ended.value.code == 0
        text = capsys.readouterr().out
        assert text.startswith(f"usage: {program} {command}")
        has_structure = "--structure" in parsers[command]._option_string_actions
        for formula in ("eta = Omega/omega", "mu = m2/m1, kappa = k2/k1", "xi = x/(a eta^2)"):
            assert (formula in text) is has_structure
        lines = [line.strip() for line in text.splitlines() if line.startswith(f"  {program} ")]
        assert lines, command
        for line in lines:
            words = shlex.split(line.removeprefix(program).split("   ")[0])
            assert words[0] == command
            assert callable(parsers[command].parse_args(cli.join_negative_values(words[1:])).run)


def test_help_lists_commands_and_shipped_sets(capsys):
    with pytest.raises(SystemExit):
        cli.main(["--help"])
    lines = capsys.readouterr().out.splitlines()
    listed = [line.split()[0] for line in lines if line.startswith(" ") and line.strip()]
    assert {*NAMES, "paper", "quick", "beam"} <= set(listed)


def test_help_takes_no_time_and_loads_nothing_numerical(tmp_path):
    """Time of the processor, so that a busy machine does not count; with compiled modules."""
    others = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment = {**others, "PYTHONPYCACHEPREFIX": str(tmp_path)}
    code = (
        "import sys; from orchestrate import cli; cli.make_parser(['sweep']).format_help();"
        "print(*sys.modules)"
    )
    for _ in range(3):
        begin = os.times()
        command = [sys.executable, "-c", code]
        keywords = {"check": True, "capture_output": True, "text": True, "env": environment}
        done = subprocess.run(command, cwd=ROOT, **keywords)
        end = os.times()
        taken = end.children_user + end.children_system
        taken -= begin.children_user + begin.children_system
        heavy = {"numpy", "xarray", "scipy", "matplotlib", "fmpy", "netCDF4", "loky"}
        assert not set(done.stdout.split()) & heavy
        if taken < 0.3:
            return
    pytest.fail(f"it took {taken:.2f} s")


# -- grammar --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "reader, text, value",
    [
        (grammar.positive_number, "0.5", 0.5),
        (grammar.parse_ends, "1.2:1.65", (1.2, 1.65)),
        (grammar.parse_number_or_ends, "2:1", (2.0, 1.0)),
        (grammar.parse_rates, "1e-4,5e-5", (1e-4, 5e-5)),
        (grammar.parse_orders, "3", 3.0),
        (grammar.parse_orders, "0.5,1", (0.5, 1.0)),
        (grammar.parse_state, "0,0.5,-1,0", (0.0, 0.5, -1.0, 0.0)),
        (grammar.parse_plane_side, "x_rel, 0,0.8,60", ("x_rel", 0.0, 0.8, 60)),
        (grammar.parse_breakpoints, "10:0.5,200:1", ((10.0, 0.5), (200.0, 1.0))),
        (grammar.parse_one_or_more, "1:2:0.5", (1.0, 1.5, 2.0)),
    ],
)
def test_texts_of_options(reader, text, value):
    assert reader("--x", text) == value
    for wrong in (f"{text}_0", "", "abc", "1:2:3:4", "nan,,", "１.２", "٣"):
        with pytest.raises(InputError, match="--x"):
            reader("--x", wrong)


def test_the_default_range_has_7901_values_and_both_ends():
    etas, is_range = grammar.parse_values("--eta", "0.1:8.0:0.001")
    assert is_range and (len(etas), etas[0], etas[-1]) == (7901, 0.1, 8.0)
    assert list(etas) == [float(f"{n / 1000:.3f}") for n in range(100, 8001)]


@given(st.integers(1, 10**7), st.integers(1, 10**5), st.integers(0, 300))
def test_a_range_has_its_decimal_values_exactly(first, step, count):
    def text(n):
        return f"{n // 10000}.{n % 10000:04d}"

    grid = [text(first + k * step) for k in range(count + 1)]
    values, _ = grammar.parse_values("--eta", f"{grid[0]}:{grid[-1]}:{text(step)}")
    assert values == tuple(map(float, grid))


def test_other_names_of_parameters():
    changes = grammar.parse_changes(["zeta=0.7%", "preload=20um", "f1_hz=42"])
    assert changes == {"zeta1": 0.007, "zeta2": 0.007, "clearance": -2e-5, "f1": 42.0}


def motion(**given):
    names = ("eta", "hz", "rpm", "frequency", "amplitude", "g")
    return argparse.Namespace(**{**dict.fromkeys(names), "structure": "beam", **given})


def test_levels_of_the_box_are_a_number_or_several():
    """Held as peak accelerations; where a command does not take several, one is expected."""
    beam = Structure.from_file("beam")
    levels = excitation_by_level(motion(hz="12", g="0.1:2:0.05"), beam)
    assert isinstance(levels["frequency"], float) and len(levels["level"]) == 39
    single = read_excitation(motion(hz="12", g="0.1"), beam)
    assert levels["level"][0] == pytest.approx(single["amplitude"] * single["frequency"] ** 2)
    with pytest.raises(InputError, match="--hz 12:14:1: 3 values; expected one"):
        excitation_by_level(motion(hz="12:14:1", g="0.1,0.2"), beam, one=True)


# -- names and ranges -----------------------------------------------------------------------------

ASKED = {"eta": (0.1, 0.5, 8.0), "direction": "up", "transient": 500, "start": None}
CHANGES = [
    *({"eta": (0.1, 0.6, 8.0)}, {"eta": (0.1, 0.5, 8.0000001)}, {"eta": 0.1}),
    *({"direction": "down"}, {"transient": 501}, {"start": (0.0, 0.0, 0.0, 1e-12)}),
]


def test_another_question_or_structure_has_another_name():
    asked = [(Structure(), ASKED), (Structure(e=0.7 + 1e-15), ASKED)]
    asked += [(Structure(), ASKED | change) for change in CHANGES]
    names = {result_name("sweep", "own/my beam.toml", *one) for one in asked}
    assert len(names) == len(asked)
    assert all(name.startswith("sweep_my beam_") and len(name) == 20 for name in names)


def test_ranges_are_in_display_units():
    from xarray import Dataset

    data = Dataset(coords={"frequency": [6.283185307179586 * number for number in range(10)]})
    flags = [number in (1, 2, 3, 7) for number in range(10)]
    assert format_ranges(data, "frequency", flags) == "1 to 3, 7 Hz"
    short = format_ranges(with_units(data, "rpm"), "frequency", flags, max_ranges=1)
    assert short == "60 to 180 rpm and 1 shorter ranges"


# -- build ----------------------------------------------------------------------------------------


def test_build(capsys, tmp_path, monkeypatch):
    (tmp_path / "folder").write_text("mine")
    code = cli.main(["build", "--folder", str(tmp_path / "folder")])
    assert code == 2 and "expected a folder that can be written" in capsys.readouterr().err
    forms = []

    def build(_, asked, **__):
        forms.extend(asked)
        return [tmp_path / "folder"]

    monkeypatch.setattr("orchestrate.fmu.build", build)
    for made in ("build_libraries", "build_web_kernels"):
        monkeypatch.setattr(f"orchestrate.fmu.{made}", lambda *_: [tmp_path / "folder"])
    assert cli.main(["build"]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'folder'}  0 kB\n" * 3
    assert cli.main(["build", "--sources-only"]) == 0
    assert capsys.readouterr().out.count(" kB\n") == 1 and "fmi3-sources" in forms
    code = cli.main(["build", "--sources-only", "--platforms", "all"])
    assert code == 2 and "--platforms" in capsys.readouterr().err
