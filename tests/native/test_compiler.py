"""The way from C to an object file: where a new ziglang breaks it, these tests say so."""

import shutil
import subprocess
from importlib.util import find_spec

import pytest

from fmu_src.export import compiler
from fmu_src.export.compiler import kernel_object
from fmu_src.export.errors import CannotExport
from fmu_src.export.source_code import kernel_source

from .conftest import cannot
from .object_files import Pe

WINDOWS = b"""
__declspec(dllexport) int print(char *text, double value) {
    return snprintf(text, 32, "%.17g", value);
}
"""


@pytest.fixture(scope="module")
def kernel():
    """The oscillator's object file for Linux; nothing of the FMUs' own build."""
    try:
        return kernel_object("x86_64-linux", kernel_source("oscillator"))
    except CannotExport as reason:
        return cannot(reason)  # a failure, not a skip, where ziglang is there


@pytest.mark.skipif(shutil.which("objdump") is None, reason="objdump is not installed")
def test_kernel_has_no_instruction_beyond_the_baseline(kernel, tmp_path):
    """No fused multiply-add, whose bits would differ, and no AVX, which older processors lack;
    nothing is called but what the linker has.
    """
    (tmp_path / "kernel.o").write_bytes(kernel)
    code = subprocess.run(
        ["objdump", "-d", "--no-show-raw-insn", "kernel.o"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    instructions = {
        line.split("\t")[1].split()[0] for line in code.splitlines() if line.count("\t") > 0
    }
    assert {"mulsd", "addsd"} <= instructions
    assert not [name for name in instructions if name.startswith("v") or name == "fld"]
    symbols = subprocess.run(
        ["objdump", "-t", "kernel.o"], cwd=tmp_path, capture_output=True, text=True, check=True
    ).stdout
    assert {line.split()[-1] for line in symbols.splitlines() if "*UND*" in line} <= {"memset"}


def test_the_compiler_s_first_error_is_one_line():
    with pytest.raises(
        CannotExport, match="the C compiler failed for x86_64-.*error:.*nothing"
    ) as e:
        kernel_object("x86_64-linux", b"int kernel_advance(void) { return nothing; }")
    assert "\n" not in str(e.value)


@pytest.mark.skipif(find_spec("ziglang") is None, reason="ziglang is not installed")
def test_windows_libraries_need_no_c_library_compiled_first():
    """A minute of a fresh machine: what they import is the system's own."""
    files = {"one.c": b"#include <stdio.h>\n" + WINDOWS}
    library = compiler.link("x86_64-windows", "one", files)
    assert set(Pe(library).imports) == {"api-ms-win-crt-stdio-l1-1-0.dll"}
