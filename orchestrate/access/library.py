"""Binaries of FMUs, loaded once per process: FMPy takes milliseconds to bind the functions of
one.
"""

from __future__ import annotations

import atexit
import copy
import sys
from typing import Any

from .description import Description
from .unpacked import unpacked

_loaded: dict[tuple[str, str], Any] = {}  # by folder and binary


def loaded(description: Description, name: str) -> Any:
    """Return FMPy's FMU object for one more instance, not instantiated yet.

    Parameters
    ----------
    description : Description
    name : str
        Of the instance.
    """
    key = str(unpacked(description)), description.identifier
    if key not in _loaded:
        _loaded[key] = load(description, key[0])
        if sys.platform == "win32":  # which deletes no binary that is loaded
            atexit.register(_loaded[key].freeLibrary)
    fmu = copy.copy(_loaded[key])
    fmu.instanceName = name
    return fmu


def load(description: Description, folder: str) -> Any:
    """Load an FMU's binary with FMPy; return FMPy's object for its instances."""
    from fmpy import fmi2, fmi3

    make = fmi3.FMU3Slave if description.is_fmi3 else fmi2.FMU2Slave
    return make(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.identifier,
    )
