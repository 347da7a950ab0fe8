"""The way from C to an object file: where a new ziglang breaks it, these tests say so."""

from importlib.util import find_spec

import pytest

from fmu_src.export import compiler
from fmu_src.export.compiler import kernel_object
from fmu_src.export.errors import CannotExport
from tests import importers

from .object_files import Pe, needs_objdump, objdump

WINDOWS = b"""
__declspec(dllexport) int print(char *text, double value) {
    return snprintf(text, 32, "%.17g", value);
}
"""


@needs_objdump
def test_the_binary_has_no_instruction_beyond_the_baseline(fmus, tmp_path):
    """No fused multiply-add, whose bits would differ, and no AVX, which older processors lack."""
    lines = objdump("-d", importers.unpack_binary(fmus["fmi3"], "fmi3", tmp_path)).splitlines()
    instructions = {line.split("\t")[2].split()[0] for line in lines if line.count("\t") > 1}
    assert {"mulsd", "addsd"} <= instructions
    assert not [name for name in instructions if name.startswith("v") or name == "fld"]


def test_the_compiler_s_first_error_is_one_line():
    with pytest.raises(CannotExport, match="the C compiler failed for") as e:
        kernel_object("x86_64-linux", b"int kernel_advance(void) { return nothing; }")
    assert "\n" not in str(e.value)


@needs_objdump
@pytest.mark.skipif(find_spec("ziglang") is None, reason="ziglang is not installed")
def test_windows_libraries_need_no_c_library_compiled_first(tmp_path):
    """A minute of a fresh machine: what they import is the system's own."""
    files = {"one.c": b"#include <stdio.h>\n" + WINDOWS}
    (tmp_path / "one.dll").write_bytes(compiler.link("x86_64-windows", "one", files))
    assert set(Pe(tmp_path / "one.dll").imports) == {"api-ms-win-crt-stdio-l1-1-0.dll"}
