"""Compile and run C programs that call a native FMU, once per process."""

from __future__ import annotations

import functools
import subprocess
import tempfile
from pathlib import Path

from orchestrate.access import describe
from orchestrate.access.unpacked import unpacked
from tools import importers

NATIVE = Path(__file__).parent / "native"
OPTIONS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-fcx-limited-range")


@functools.cache
def compile_program(fmu: Path, name: str) -> Path:
    """Compile ``native/NAME.c`` against an FMI 3.0 FMU; return the program's path."""
    folder = temporary_folder() / describe(fmu).digest[:16] / name
    return importers.compile_against(fmu, folder, [NATIVE / f"{name}.c"], OPTIONS)


@functools.cache
def temporary_folder() -> Path:
    """Return a temporary folder that is removed when the process ends."""
    holder = tempfile.TemporaryDirectory(prefix="vibroimpact-campaign-")
    _kept.append(holder)
    return Path(holder.name)


_kept: list[tempfile.TemporaryDirectory[str]] = []


def unpack_library(fmu: Path) -> Path:
    """Unpack the FMU's binary for this machine; return its path."""
    description = describe(fmu)
    return unpacked(description) / "binaries" / "x86_64-linux" / f"{description.identifier}.so"


def run_program(fmu: Path, name: str, *arguments: object, success: bool = True) -> str:
    """Run a compiled program on an FMU; return what it prints."""
    command = [str(compile_program(fmu, name)), str(unpack_library(fmu)), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    if success and done.returncode:
        raise RuntimeError(f"{name}: exit code {done.returncode}: {done.stderr[-2000:]}")
    return done.stdout
