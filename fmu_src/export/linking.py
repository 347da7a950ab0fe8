"""From object files and C sources to shared libraries, for each platform an FMU has a binary for.

The compiler is the one of the PyPI package ziglang, which compiles for every platform on every
machine and gives the same bytes everywhere; where that is missing, the machine's own compiler
serves its own platform.
"""

import functools
import importlib.util
import logging
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

log = logging.getLogger(__name__)


class NoCompiler(Exception):
    """Why no binary can be made here, as one line."""


@functools.cache
def say_once(line):
    """Warn, however many FMUs the line is about."""
    log.warning("%s", line)


def say_pure_python(reason):
    """Say, once, what is left where no binary can be made."""
    say_once(
        f"no binary can be made here, so there will be no native FMU, and the pythonfmu FMU runs in pure Python: {reason}"
    )


@dataclass(frozen=True)
class Platform:
    """A platform with binaries.

    Attributes
    ----------
    triple, mangling : str
        LLVM's target triple and symbol mangling.
    zig_target : str
        With the oldest C library it is to run on.
    suffix : str
        Of a shared library.
    fmi2, fmi3 : str
        Folder below ``binaries/``.
    """

    triple: str
    mangling: str
    zig_target: str
    suffix: str
    fmi2: str
    fmi3: str


PLATFORMS = {
    "x86_64-linux": Platform(
        "x86_64-unknown-linux-gnu", "e", "x86_64-linux-gnu.2.17", ".so", "linux64", "x86_64-linux"
    ),
    "x86_64-windows": Platform(
        "x86_64-pc-windows-gnu", "w", "x86_64-windows-gnu", ".dll", "win64", "x86_64-windows"
    ),
}
FLAGS = (
    "-shared",
    "-s",
    "-O2",
    "-fvisibility=hidden",
    "-ffp-contract=off",
    "-g0",
    "-Wall",
    "-Wextra",
)


def compiler(name):
    """Command of a C compiler for a platform.

    Raises
    ------
    NoCompiler
    """
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc", "-target", PLATFORMS[name].zig_target]
    own = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if own and name == "x86_64-linux" and sys.platform == "linux":
        return [own]
    raise NoCompiler(
        f"no C compiler for {name}: allowed is the PyPI package ziglang, or cc, gcc or clang for the machine's own platform"
    )


def link(name, files):
    """A shared library, as bytes.

    Parameters
    ----------
    name : str
        Platform.
    files : dict of str to bytes
        Sources, headers and object files by file name.

    Returns
    -------
    bytes
    """
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as folder:
        for file, content in files.items():
            (Path(folder) / file).write_bytes(content)
        units = [file for file in files if file.endswith((".c", ".o"))]
        target = f"library{PLATFORMS[name].suffix}"
        command = [*compiler(name), *FLAGS, "-o", target, *units]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            lines = (
                [line for line in done.stderr.splitlines() if "error" in line]
                or done.stderr.splitlines()
                or ["no reason given"]
            )
            raise NoCompiler(f"the C compiler failed for {name}: {lines[0]}")
        return (Path(folder) / target).read_bytes()


def link_all(objects, files):
    """The same library for every platform this machine can link for; the others are left out, and
    said to be.

    Parameters
    ----------
    objects : dict of str to bytes
        The compiled kernel by platform.
    files : dict of str to bytes
        Sources and headers.

    Returns
    -------
    dict of str to bytes
        Library by platform.

    Raises
    ------
    NoCompiler
        Where there is no library at all.
    """
    made, reasons = {}, []
    for name in PLATFORMS:
        try:
            made[name] = link(name, {**files, "kernel.o": objects[name]})
        except NoCompiler as error:
            reasons.append(error)
    if not made:
        raise reasons[0]
    for reason in reasons:
        say_once(f"the FMUs will have binaries for {', '.join(made)} alone: {reason}")
    return made
