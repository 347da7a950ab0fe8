"""Binaries of FMUs, loaded once per process by FMPy and cached (binding takes milliseconds)."""

from __future__ import annotations

import atexit
import copy
import sys
import threading
from typing import Any

from .description import Description
from .unpacked import unpacked

_lock = threading.Lock()
_loaded: dict[tuple[str, str], Any] = {}  # by folder and binary


def loaded(description: Description, name: str) -> Any:
    """Return FMPy's FMU object for a new, not yet instantiated instance; the binary is cached."""
    key = str(unpacked(description)), description.identifier
    with _lock:
        if key not in _loaded:
            _loaded[key] = load(description, key[0])
            if sys.platform == "win32":  # which deletes no binary that is loaded
                atexit.register(_loaded[key].freeLibrary)
    fmu = copy.copy(_loaded[key])
    fmu.instanceName = name
    return fmu


def load(description: Description, folder: str) -> Any:
    from fmpy import fmi2, fmi3

    make = fmi3.FMU3Slave if description.is_fmi3 else fmi2.FMU2Slave
    return make(
        guid=description.guid, unzipDirectory=folder, modelIdentifier=description.identifier
    )
