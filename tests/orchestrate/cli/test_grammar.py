"""Options from the functions' signatures, examples that can be typed, help at once, texts."""

from __future__ import annotations

import inspect
import os
import shlex
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

import orchestrate
from orchestrate import cli
from orchestrate.cli import grammar
from orchestrate.cli.answer import FunctionCommand
from orchestrate.cli.output import result_file_stem
from orchestrate.errors import InputError
from orchestrate.model.structure import Structure
from tests import ROOT

CONVERTED = {"settle", "direction", "over", "bifurcation"}  # options in other units or words


def test_every_default_is_that_of_the_function_and_in_the_help():
    compared = 0
    for command, found in cli.COMMANDS.items():
        assert found().name() == command  # nothing of it is left abstract
        if issubclass(found, FunctionCommand):  # of every result something is printed
            methods = [
                (one.summary_lines, one.all_summary_lines) for one in (found, FunctionCommand)
            ]
            assert found.shows or methods[0] != methods[1], command
        function = getattr(orchestrate, found.calls, None)
        parameters = inspect.signature(function).parameters if inspect.isfunction(function) else {}
        texts = [option.help for option in found.options().values()]
        assert len(set(texts)) == len(texts) and all(texts), command
        for name, option in found.options().items():
            if name not in parameters or name in ("structure", "drive", *CONVERTED):
                continue
            usual = parameters[name].default
            if usual not in (None, False, inspect.Parameter.empty):
                assert "(default: " in option.help, (command, name)
                assert (option.default, type(option.default)) == (usual, type(usual))
                compared += 1
    assert compared > 40


def test_an_attribute_that_is_annotated_bool_is_one():
    assert cli.COMMANDS["build"]().plain is cli.COMMANDS["sweep"]().debug is False
    assert cli.COMMANDS["analyse"]().resample is None  # of a function: what a setup file says


@pytest.mark.parametrize("program", ["vibroimpact", "python -m orchestrate"])
def test_help_has_quantities_and_examples_that_can_be_typed(capsys, monkeypatch, program):
    monkeypatch.setattr(sys, "argv", [f"/bin/{program}"])
    assert cli.main(["--help"]) == 0
    assert {*cli.COMMANDS, "paper", "quick", "beam"} <= set(capsys.readouterr().out.split())
    assert cli.main(["sweep", "--help"]) == 0
    text = capsys.readouterr().out
    assert text.startswith(f"Usage: {program} sweep") and cli.help_epilogue("sweep") in text
    for command, found in cli.COMMANDS.items() if program == "vibroimpact" else ():
        text = cli.help_epilogue(command)
        assert ("mu = m2/m1, kappa = k2/k1" in text) is ("--structure" in found.flags())
        lines = [line.strip() for line in text.splitlines() if line.startswith(f"  {program} ")]
        assert lines, command
        for line in lines:
            words = shlex.split(line.removeprefix(program).split("   ")[0])
            assert isinstance(cli.parse_arguments(words), found)


@pytest.mark.parametrize(
    ("command", "seconds", "encoding"), [("", 0.5, "ascii"), ("couple", 0.8, "cp1251")]
)
def test_help_takes_no_time_whatever_the_encoding(command, seconds, encoding):
    """Time of the processor, so that a busy machine does not count; with compiled modules."""
    others = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    keywords = {"check": True, "capture_output": True, "cwd": ROOT}
    for _ in range(4):
        begin = os.times()
        words = [sys.executable, "-m", "orchestrate", *command.split(), "--help"]
        done = subprocess.run(words, env={**others, "PYTHONIOENCODING": encoding}, **keywords)
        end = os.times()
        taken = end.children_user + end.children_system
        taken -= begin.children_user + begin.children_system
        assert "--" in done.stdout.decode(encoding) and done.stderr == b""
        if taken < seconds:
            return
    pytest.fail(f"it took {taken:.2f} s")


def of_quantity(name):
    return lambda option, text: grammar.parse_number(option, text, name)


READ = [
    (grammar.parse_positive_number, "0.5", 0.5),
    (grammar.parse_ends, "1.2:1.65", (1.2, 1.65)),
    (grammar.parse_number_or_ends, "2:1", (2.0, 1.0)),
    (grammar.parse_rates, "1e-4,5e-5", (1e-4, 5e-5)),
    (grammar.parse_orders, "3", 3.0),
    (grammar.parse_orders, "0.5,1", (0.5, 1.0)),
    (grammar.parse_state, "0,0.5,-1,0", (0.0, 0.5, -1.0, 0.0)),
    (grammar.parse_state, "0,2um,3mm/s,0", (0.0, 2e-6, 3e-3, 0.0)),
    (grammar.parse_plane_side, "x_rel, 0,0.8,60", ("x_rel", 0.0, 0.8, 60)),
    (grammar.parse_breakpoints, "10:0.5,200:1", ((10.0, 0.5), (200.0, 1.0))),
    (grammar.parse_density, "1:3", ((1.0, 3.0),)),
    (grammar.parse_density, "10:2g2/Hz", ((10.0, 2.0 * 9.80665**2),)),
    (grammar.parse_one_or_more, "1:2:0.5", (1.0, 1.5, 2.0)),
    (grammar.parse_sensor, "9:20", (9.0, 20.0)),
    (of_quantity("box_acceleration"), "-1g", -9.80665),
    (of_quantity("noise"), "30ug/sqrt(Hz)", pytest.approx(30e-6 * 9.80665)),
    (of_quantity("amplitude"), "20um", 20e-6),
    (of_quantity("box_acceleration"), "2.5", 2.5),
    (grammar.parse_values, "5000000:5000001:0.5", (5e6, 5000000.5, 5000001.0)),
]


@pytest.mark.parametrize("reader, text, value", READ)
def test_texts_of_options(reader, text, value):
    assert reader("--x", text) == value
    for wrong in (f"{text}_0", "", "abc", "1:2:3:4", "nan,,", "１.２", "٣"):
        with pytest.raises(InputError, match="--x"):
            reader("--x", wrong)


@given(st.integers(1, 10**7), st.integers(1, 10**5), st.integers(0, 300))
def test_a_range_has_its_decimal_values_exactly(first, step, count):
    def text(n):
        return f"{n // 10000}.{n % 10000:04d}"

    grid = [text(first + k * step) for k in range(count + 1)]
    values = grammar.parse_values("--eta", f"{grid[0]}:{grid[-1]}:{text(step)}")
    assert values == tuple(map(float, grid))
    assert grammar.parse_over_values("clearance", "0:20um:0.01mm") == (0.0, 1e-5, 2e-5)


def test_other_names_and_units_of_parameters():
    """To the bit as without; an option's own unit may stand behind its numbers."""
    changes = grammar.parse_changes(["zeta=0.7%", "preload=20um", "f1_hz=42 Hz", "m2=150g"])
    expected = {"zeta1": 0.007, "zeta2": 0.007, "clearance": -2e-5, "f1": 42.0, "m2": 0.15}
    assert changes == expected
    assert grammar.parse_changes(["f=12", "wall=true"]) == {"f1": 12.0, "wall": True}
    beam, sweep = Structure.from_file("beam"), cli.COMMANDS["sweep"]
    levels = sweep(hz="12", g="0.1:2:0.05").read_excitation(beam, by_level=True)
    assert isinstance(levels["frequency"], float) and len(levels["level"]) == 39
    single = sweep(hz="12", g="0.1").read_excitation(beam)
    assert levels["level"][0] == pytest.approx(single["amplitude"] * single["frequency"] ** 2)
    own = sweep(hz="12Hz", g="0.1 g:2g:0.05g").read_excitation(beam, by_level=True)
    assert own["frequency"] == levels["frequency"] and own["level"] == levels["level"]
    with pytest.raises(InputError, match="--hz 12g: not numbers"):
        sweep(hz="12g", g="0.1").read_excitation(beam, by_level=True)


ASKED = {"eta": (0.1, 0.5, 8.0), "direction": "up", "transient": 500, "start": None}
CHANGES = [
    *({"eta": (0.1, 0.6, 8.0)}, {"eta": (0.1, 0.5, 8.0000001)}, {"eta": 0.1}),
    *({"direction": "down"}, {"transient": 501}, {"start": (0.0, 0.0, 0.0, 1e-12)}),
]


def test_another_question_or_structure_has_another_name():
    asked = [(Structure(), ASKED), (Structure(e=0.7 + 1e-15), ASKED)]
    asked += [(Structure(), ASKED | change) for change in CHANGES]
    names = {result_file_stem("sweep", ["own/my beam.toml"], *one) for one in asked}
    assert len(names) == len(asked)
    assert all(name.startswith("sweep_my beam_") and len(name) == 20 for name in names)


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
