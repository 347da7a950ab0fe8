"""Machines that lack a tool: what can be made is made, and one line says what could not."""

import os
import subprocess
import sys
import zipfile

import pytest
from fmpy.validation import validate_fmu

from orchestrate.build import build

from ..fresh import ROOT
from . import importers
from .slave import COMMON, harmonic
from .test_bit_identity import run

ONE = ("TwoMassImpactOscillator",)  # the model whose kernel the fixture has compiled


def forms(paths):
    return [path.parent.name for path in paths]


def binaries(fmu):
    with zipfile.ZipFile(fmu) as archive:
        return {name.split("/")[1] for name in archive.namelist() if name.startswith("binaries/")}


def same_run(fmu, other, tmp_path):
    """Whether two FMUs go the same way; and the files of a compiled kernel in the first one's
    process.
    """
    found, expected = (
        run(fmu, tmp_path / "a", 512.0, 8, harmonic(1.13)),
        run(other, tmp_path / "b", 512.0, 8, harmonic(1.13)),
    )
    return found["rows"] == expected["rows"], [
        path for path in found["mapped"] if "kernel-" in path
    ]


def test_without_a_compiler_there_is_the_pythonfmu_fmu_and_one_line(fmus, hide, tmp_path, caplog):
    hide("ziglang", "own")
    made = build(tmp_path / "build", names=ONE)
    assert forms(made) == ["fmi2-python"]
    (line,) = caplog.messages
    assert (
        "no C compiler" in line and "ziglang" in line and "pure Python" in line and "\n" not in line
    )
    assert validate_fmu(str(made[0])) == []
    assert same_run(made[0], fmus["fmi2"], tmp_path) == (True, [])


def test_without_ziglang_the_own_compiler_makes_fmus_for_its_platform(
    fmus, hide, importer_of, tmp_path, caplog
):
    hide("ziglang")
    if importers.own_compiler() is None:
        pytest.skip("the machine has no C compiler of its own")
    made = build(tmp_path / "build", names=ONE)
    assert forms(made) == ["fmi2-python", "fmi2", "fmi3"]
    (line,) = caplog.messages
    assert "for x86_64-linux alone" in line and "ziglang" in line
    assert [binaries(path) - {"win64", "linux64"} for path in made[:2]] == [set(), set()]
    assert binaries(made[1]) == {"linux64"}
    assert binaries(made[2]) == {"x86_64-linux"}
    same, compiled = same_run(made[0], fmus["fmi2"], tmp_path)
    assert same and compiled
    times = [64.0 * k for k in range(65)]
    for path in made[1:]:
        assert validate_fmu(str(path)) == []
        version = path.parent.name
        own = importers.Importer(
            importer_of(version).program, importers.binary(path, version, tmp_path), version
        )
        assert own.simulate(COMMON, times, **harmonic(1.13)) == importer_of(version).simulate(
            COMMON, times, **harmonic(1.13)
        )
        assert "FAILURES 0" in own.run("hostile").stdout


def test_without_a_compiler_of_its_own_the_machine_makes_the_same_bytes(
    fmus, hide, tmp_path, caplog
):
    hide("own")
    made = build(tmp_path, ["fmi2", "fmi3"], ONE)
    assert [path.read_bytes() for path in made] == [
        fmus[form].read_bytes() for form in ("fmi2", "fmi3")
    ]
    assert not caplog.messages


def test_without_numba_the_command_line_says_one_line(tmp_path):
    """From the command line to the exit code."""
    (tmp_path / "numba.py").write_text("raise ModuleNotFoundError(\"No module named 'numba'\")\n")
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    command = [sys.executable, "-m", "orchestrate", "build", "--folder", str(tmp_path / "build")]
    done = subprocess.run(
        command,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0
    (line,) = done.stderr.splitlines()
    assert line.endswith("pure Python: No module named 'numba'")
    made = done.stdout.splitlines()
    assert len(made) == 2 and all("fmi2-python" in line for line in made)
