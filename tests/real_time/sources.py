"""Unpack and compile an FMU's C sources for real-time targets."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from collections.abc import Sequence
from os import PathLike
from pathlib import Path

HERE = Path(__file__).parent
BITS = ("-std=c99", "-ffp-contract=off")
CORTEX_M7 = ("-mcpu=cortex-m7", "-mthumb", "-mfpu=fpv5-d16", "-mfloat-abi=hard")


def unpack(fmu: str | PathLike[str], folder: Path) -> Path:
    """Unpack the FMU's ``sources/`` into a folder; return the path."""
    with zipfile.ZipFile(fmu) as archive:
        inside = [name for name in archive.namelist() if name.startswith("sources/")]
        archive.extractall(folder, inside)
    return folder / "sources"


def c_files(sources: Path) -> list[Path]:
    return sorted(sources.glob("*.c"))


def missing_programs(*programs: str) -> list[str]:
    """Return those of some programs that this machine does not have."""
    return [program for program in programs if shutil.which(program) is None]


def run_command(
    *command: str | PathLike[str], cwd: Path | None = None, timeout: float = 600.0
) -> str:
    """Run a command in a folder; return what it prints."""
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=timeout)
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, command))}: {done.stdout}{done.stderr}")
    return done.stdout


def compile_program(
    sources: Path, programs: Sequence[str], target: Path, compiler: str, *flags: str
) -> Path:
    """Compile an FMU's sources and C files of this folder into a program; return its path."""
    own = [HERE / program for program in programs]
    run_command(compiler, *flags, f"-I{sources}", *c_files(sources), *own, "-lm", "-o", target)
    return target
