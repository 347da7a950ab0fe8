"""An FMU's C sources in a folder, and compilers for them."""

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
    """Return the FMU's ``sources/`` below a folder."""
    with zipfile.ZipFile(fmu) as archive:
        inside = [name for name in archive.namelist() if name.startswith("sources/")]
        archive.extractall(folder, inside)
    return folder / "sources"


def c_files(sources: Path) -> list[Path]:
    """Return the paths of the C files that are compiled."""
    return sorted(sources.glob("*.c"))


def missing(*programs: str) -> list[str]:
    """Return those of some programs that this machine does not have."""
    return [program for program in programs if shutil.which(program) is None]


def run(*command: str | PathLike[str], cwd: Path | None = None, timeout: float = 600.0) -> str:
    """Return what a command prints.

    Raises
    ------
    RuntimeError
        Where it fails, with what it said.
    """
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=timeout)
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, command))}: {done.stdout}{done.stderr}")
    return done.stdout


def version_of(compiler: str) -> str:
    """Name and version of a compiler, as it tells them."""
    return run(compiler, "--version").splitlines()[0]


def build(sources: Path, programs: Sequence[str], target: Path, compiler: str, *flags: str) -> Path:
    """Return the sources and C files of this folder as one program."""
    own = [HERE / program for program in programs]
    run(compiler, *flags, f"-I{sources}", *c_files(sources), *own, "-lm", "-o", target)
    return target
