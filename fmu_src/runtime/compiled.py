"""Load the compiled form of the kernel, where one lies next to the source and fits the machine.

Else the source itself runs; both give the same bits. ``VIBROIMPACT_PURE_PYTHON=1`` in the
environment asks for the source. Standard library only, Python 3.9: it travels inside the FMU.
"""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from collections.abc import Sequence
from typing import Any

LIBRARIES = {  # machine: platform and file name
    ("linux", "x86_64"): ("x86_64-linux", "kernel-x86_64-linux.so"),
    ("win32", "amd64"): ("x86_64-windows", "kernel-x86_64-windows.dll"),
}
loaded: dict[
    str, list[Any]
] = {}  # libraries of this process: ctypes makes new classes at every load


def load_compiled_kernel(folder: str, key: str, names: Sequence[str]) -> list[Any] | None:
    """Return the entry points of the library in a folder, if any; ``key`` names its contents."""
    machine = (sys.platform, platform.machine().lower())
    path = os.path.join(folder, LIBRARIES.get(machine, ("", "none"))[1])
    if os.environ.get("VIBROIMPACT_PURE_PYTHON", "0") not in ("", "0"):
        return None
    if key in loaded:
        return loaded[key]
    if not os.path.isfile(path):
        return None
    try:
        library = ctypes.CDLL(path)
        entries = [getattr(library, name) for name in names]
    # another C library, a damaged file: the source runs everywhere
    except (OSError, AttributeError):
        return None
    for entry in entries:
        entry.argtypes = [ctypes.c_void_p, ctypes.c_double]
        entry.restype = ctypes.c_int
    loaded[key] = entries
    return entries
