"""From object files and C sources to shared libraries, for each platform an FMU has a binary for.

The compiler is the one of the PyPI package ziglang, which compiles for every platform on every
machine and gives the same bytes everywhere; where that is missing, the machine's own compiler
serves its own platform.
"""

from __future__ import annotations

import functools
import importlib.util
import logging
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from .errors import EXTRA, CannotExport
from .platforms import PLATFORMS, this_machine

log = logging.getLogger(__name__)
FLAGS = (
    *("-shared", "-s", "-O2", "-g0", "-fvisibility=hidden", "-ffp-contract=off"),
    *("-Wall", "-Wextra"),
)


@functools.cache
def say_once(line: str) -> None:
    """Warn, however many FMUs the line is about."""
    log.warning("%s", line)


def compiler(name: str) -> list[str]:
    """Command of a C compiler for a platform.

    Raises
    ------
    CannotExport
    """
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc", "-target", PLATFORMS[name].zig_target]
    own = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if own and name == this_machine():
        return [own]
    raise CannotExport(
        f"no C compiler for {name}: expected {EXTRA} (ziglang), or, for the machine's own "
        "platform, cc, gcc or clang"
    )


def link(name: str, title: str, files: Mapping[str, bytes]) -> bytes:
    """A shared library.

    Parameters
    ----------
    name : str
        Platform.
    title : str
        The library's own name, which dylibs and DLLs bear inside.
    files : mapping of str to bytes
        Sources, headers and object files by file name.

    Raises
    ------
    CannotExport
        Where there is no compiler, or it fails.
    """
    target = f"{title}{PLATFORMS[name].suffix}"
    units = [file for file in files if file.endswith((".c", ".o"))]
    command = [*compiler(name), *FLAGS, "-o", target, *units]
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as scratch:
        folder = Path(scratch)
        for file, content in files.items():
            (folder / file).write_bytes(content)
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            told = done.stderr.splitlines()
            lines = [line for line in told if "error" in line] or told or ["no reason given"]
            raise CannotExport(f"the C compiler failed for {name}: {lines[0]}")
        return (folder / target).read_bytes()


def link_all(
    objects: Mapping[str, bytes], title: str, files: Mapping[str, bytes]
) -> dict[str, bytes]:
    """The same library for every platform this machine can link for; what is left out is said.

    Parameters
    ----------
    objects : mapping of str to bytes
        The compiled kernel by platform.
    title : str
        The library's own name.
    files : mapping of str to bytes
        Sources and headers.

    Returns
    -------
    dict of str to bytes
        Library by platform.

    Raises
    ------
    CannotExport
        Where there is no library at all.
    """
    made, reasons = {}, []
    for name in objects:
        try:
            made[name] = link(name, title, {**files, "kernel.o": objects[name]})
        except CannotExport as reason:
            reasons.append(reason)
    if not made:
        raise reasons[0]
    for left_out in reasons:
        say_once(f"the FMUs will have binaries for {', '.join(made)} alone: {left_out}")
    return made
