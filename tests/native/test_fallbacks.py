"""Machines that lack a tool: what can be made is made, and one line says what could not."""

import zipfile

import pytest
from fmpy.validation import validate_fmu

from fmu_src.export.errors import CannotExport
from fmu_src.export.forms import FORMS, export
from tests import importers

from ..fmu.driver import OSCILLATOR
from ..fmu.programs.driver import COMMON, harmonic
from .test_bit_identity import run


def build(folder):
    """The FMUs that can be made, by form, and why the others cannot."""
    made, reasons = {}, {}
    for form in FORMS:
        try:
            made[form] = export(OSCILLATOR, form, folder)
        except CannotExport as reason:
            reasons[form] = str(reason)
    return made, reasons


def binaries(fmu):
    with zipfile.ZipFile(fmu) as archive:
        return {name.split("/")[1] for name in archive.namelist() if name.startswith("binaries/")}


def same_run(fmu, other, tmp_path):
    """Whether two FMUs go the same way; files of a compiled kernel in the first one's process."""
    found = run(fmu, tmp_path / "a", 64.0, 4, harmonic(1.13))
    expected = run(other, tmp_path / "b", 64.0, 4, harmonic(1.13))
    compiled = [path for path in found["mapped"] if "kernel-" in path]
    return found["rows"] == expected["rows"], compiled


def test_without_a_compiler_there_is_the_pythonfmu_fmu_and_one_line(fmus, hide, tmp_path, caplog):
    hide("ziglang", "own")
    made, reasons = build(tmp_path / "build")
    assert list(made) == ["fmi2-python"]
    for line in (*reasons.values(), *caplog.messages):
        assert "no C compiler" in line and 'pip install -e ".[build]"' in line
        assert "\n" not in line
    (line,) = caplog.messages
    assert "pure Python" in line
    assert validate_fmu(str(made["fmi2-python"])) == []
    assert same_run(made["fmi2-python"], fmus["fmi2"], tmp_path) == (True, [])


@pytest.mark.slow  # compiles for 4 s
def test_without_ziglang_the_own_compiler_makes_fmus_for_its_platform(
    fmus, hide, importer_of, tmp_path, caplog
):
    hide("ziglang")
    if not importers.own_compiler_command():
        pytest.skip("the machine has no C compiler of its own")
    made, reasons = build(tmp_path / "build")
    assert set(made) == set(FORMS) and not reasons
    (line,) = caplog.messages
    assert "only for x86_64-linux" in line and "ziglang" in line
    assert binaries(made["fmi2-python"]) <= {"win64", "linux64"}
    assert binaries(made["fmi2"]) == {"linux64"}
    assert binaries(made["fmi3"]) == {"x86_64-linux"}
    same, compiled = same_run(made["fmi2-python"], fmus["fmi2"], tmp_path)
    assert same and compiled
    times = [64.0 * k for k in range(65)]
    assert validate_fmu(str(made["fmi3"])) == []
    binary = importers.unpack_binary(made["fmi3"], "fmi3", tmp_path)
    own = importers.Importer(importer_of("fmi3").program, binary, "fmi3")
    expected = importer_of("fmi3").simulate(COMMON, times, **harmonic(1.13))
    assert own.simulate(COMMON, times, **harmonic(1.13)) == expected
