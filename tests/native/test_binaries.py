"""What is in the binaries: FMI functions and the kernel, nothing else; Windows' one runs alike."""

import os
import re
import shutil
import subprocess
import zipfile
from importlib.util import find_spec

import pytest

from fmu_src.export import compiler
from fmu_src.export.compiler import compile_kernel
from fmu_src.export.errors import CannotExport
from tests import importers

from ..fmu.programs.driver import COMMON, harmonic
from .test_calls import functions_of_header

LIBC = {
    *("calloc", "malloc", "free", "memcpy", "memset", "memcmp", "bcmp", "snprintf", "strtod"),
    *("strtol", "strlen", "strchr", "strcmp", "strcpy", "strncat", "strpbrk"),
}
LOADER = {
    *("__cxa_finalize", "__gmon_start__", "__stack_chk_fail"),
    *("_ITM_deregisterTMCloneTable", "_ITM_registerTMCloneTable"),
}
WINE = next(filter(None, map(shutil.which, ("wine64", "wine", "/usr/lib/wine/wine64"))), None)


needs_objdump = pytest.mark.skipif(not shutil.which("objdump"), reason="objdump is not installed")
# made read-only by the loader, or the compiler's own frame
FIXED = r"\.(data\.rel\.ro|dynamic|got|relro_padding|init_array|fini_array)"


def objdump(option, path):
    done = subprocess.run(["objdump", option, path], capture_output=True, text=True, check=True)
    return done.stdout


class Elf:
    """A library for Linux: names of dynamic symbols, libraries, bytes that stay writable."""

    def __init__(self, path):
        rows = [
            line for line in objdump("-T", path).splitlines() if re.match("[0-9a-f]{16} ", line)
        ]
        self.imports = {row.split()[-1] for row in rows if "*UND*" in row}
        self.exports = {row.split()[-1] for row in rows if "*UND*" not in row}
        self.needed = set(re.findall(r"NEEDED +(\S+)", objdump("-p", path)))
        sections = re.findall(r"^ +\d+ (\S+) +(\w+) .*\n +(.*)$", objdump("-h", path), re.MULTILINE)
        self.writable = sum(
            int(size, 16)
            for name, size, flags in sections
            if "ALLOC" in flags and "READONLY" not in flags and not re.match(FIXED, name)
        )


class Pe:
    """A DLL for 64-bit Windows: exports, and imported names by library."""

    def __init__(self, path):
        text = objdump("-p", path)
        assert "file format pei-x86-64" in text
        table = text.partition("[Ordinal/Name Pointer] Table")[2].partition("\n\n")[0]
        self.exports = set(re.findall(r"^\s+\[.* (\w+)$", table, re.MULTILINE))
        parts = re.findall(r"DLL Name: (\S+)\n.*\n((?:\t.*\n)*)", text)
        self.imports = {
            name: {row.split()[-1] for row in rows.splitlines()} for name, rows in parts
        }


@needs_objdump
def test_linux_binary_exports_fmi_and_imports_libc(fmus, version, tmp_path):
    elf = Elf(importers.unpack_binary(fmus[version], version, tmp_path))
    assert len(elf.exports) > 30
    assert elf.exports == set(functions_of_header(version))
    assert elf.imports <= LIBC | LOADER
    assert elf.needed == {"libc.so.6"}
    assert elf.writable <= 16  # the start-up code of some compilers has a flag and a pointer


@needs_objdump
def test_the_kernel_of_pythonfmus_form_stands_alone(fmus, tmp_path):
    """Nothing outside itself but memset: it runs with every C library."""
    with zipfile.ZipFile(fmus["fmi2-python"]) as archive:
        (name,) = [n for n in archive.namelist() if n.endswith("kernel-x86_64-linux.so")]
        elf = Elf(archive.extract(name, tmp_path))
    assert elf.imports <= {"memset"}
    assert elf.exports == {"initialize", "advance", "coast", "differentiate", "restore"}


@needs_objdump
def test_windows_binary_exports_fmi_and_imports_the_system(fmus, version, tmp_path):
    with zipfile.ZipFile(fmus[version]) as archive:
        if not [name for name in archive.namelist() if name.endswith(".dll")]:
            pytest.skip("this FMU was made without ziglang")
    pe = Pe(importers.unpack_binary(fmus[version], version, tmp_path, windows=True))
    assert pe.exports == set(functions_of_header(version))
    system = r"(?i)kernel32\.dll|api-ms-win-crt-[a-z]+-l1-1-0\.dll|ucrtbase\.dll"
    assert all(re.fullmatch(system, library) for library in pe.imports)
    assert not [name for names in pe.imports.values() for name in names if "fma" in name.lower()]


@pytest.mark.slow
@pytest.mark.skipif(WINE is None, reason="wine is not installed")
def test_windows_binary_has_the_same_bits(fmus, importer_of, version, tmp_path):
    """Slow at the first use of ziglang and wine: both prepare themselves for minutes."""
    command = importers.zig_compiler("x86_64-windows-gnu")
    if not command:
        pytest.skip("the importer for Windows is compiled by ziglang")
    program = importers.compile_importer(version, fmus[version], tmp_path / "importer", command)
    library = importers.unpack_binary(fmus[version], version, tmp_path, windows=True)
    windows = importers.Importer(program, library, version)
    prefix = {**os.environ, "WINEPREFIX": str(tmp_path / "prefix"), "WINEDEBUG": "-all"}
    wine = {"env": prefix, "under": (WINE,), "timeout": 600}
    settings = importers.settings(harmonic(1.13))
    times = [16.0 * k for k in range(257)]
    told = windows.run("simulate", ",".join(COMMON), *settings, times=times, **wine).stdout
    found = importers.read_rows(told)
    assert found == importer_of(version).simulate(COMMON, times, **harmonic(1.13))
    assert found[-1][COMMON.index("impact_count")] > 500
    windows.run("many", 200, 40, 0, **wine)
    windows.run("random", 7, 300, **wine)


@needs_objdump
def test_the_binary_has_no_instruction_beyond_the_baseline(fmus, tmp_path):
    """No fused multiply-add, whose bits would differ, and no AVX, which older processors lack."""
    lines = objdump("-d", importers.unpack_binary(fmus["fmi3"], "fmi3", tmp_path)).splitlines()
    instructions = {line.split("\t")[2].split()[0] for line in lines if line.count("\t") > 1}
    assert {"mulsd", "addsd"} <= instructions
    assert not [name for name in instructions if name.startswith("v") or name == "fld"]


def test_the_compiler_s_first_error_is_one_line():
    with pytest.raises(CannotExport, match="the C compiler failed for") as e:
        compile_kernel("x86_64-linux", b"int kernel_advance(void) { return nothing; }")
    assert "\n" not in str(e.value)


@needs_objdump
@pytest.mark.skipif(find_spec("ziglang") is None, reason="ziglang is not installed")
def test_windows_libraries_need_no_c_library_compiled_first(tmp_path):
    body = (
        b'__declspec(dllexport) int print(char *t, double x) { return snprintf(t, 32, "%g", x); }'
    )
    files = {"one.c": b"#include <stdio.h>\n" + body}
    (tmp_path / "one.dll").write_bytes(compiler.compile_and_link("x86_64-windows", "one", files))
    assert set(Pe(tmp_path / "one.dll").imports) == {"api-ms-win-crt-stdio-l1-1-0.dll"}
