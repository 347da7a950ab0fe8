"""FMUs unpacked into the temporary folder of the process, and their binaries, loaded once there."""

from __future__ import annotations

import atexit
import copy
import hashlib
import io
import shutil
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any

from ..errors import InputError, StoreError
from ..temporary import process_temporary_folder
from .description import Description

_lock = threading.RLock()
_loaded: dict[tuple[str, str], Any] = {}  # by folder and binary


def unpack_once(description: Description) -> Path:
    """Return the folder with an FMU's unpacked files; unpack it there once per process.

    Raise ``InputError`` if its file has changed since it was described.
    """
    import fmpy

    with _lock:
        try:
            folder = process_temporary_folder() / description.digest[:32]
            if folder.is_dir():
                return folder
            data = description.path.read_bytes()
            if hashlib.sha256(data).hexdigest() != description.digest:
                text = f"FMU {description.path}: it has changed since it was read"
                raise InputError(f"{text}; expected a file that stays")
            partial = folder.with_suffix(".partial")
            try:
                fmpy.extract(io.BytesIO(data), partial)
                return partial.rename(folder)
            finally:  # of what could not be extracted as a whole
                shutil.rmtree(partial, ignore_errors=True)
        except OSError as error:
            text = f"{tempfile.gettempdir()}: FMU cannot be unpacked ({error.strerror or error})"
            raise StoreError(f"{text}; expected a folder with room for it") from None


def new_fmu_object(description: Description, name: str) -> Any:
    """Return FMPy's FMU object for a new, not yet instantiated instance; the binary is cached."""
    from fmpy import fmi2, fmi3

    folder, identifier = str(unpack_once(description)), description.identifier
    key = folder, identifier
    with _lock:
        if key not in _loaded:
            make = fmi3.FMU3Slave if description.is_fmi3 else fmi2.FMU2Slave
            of_file = {"unzipDirectory": folder, "modelIdentifier": identifier}
            _loaded[key] = make(guid=description.guid, **of_file)
            if sys.platform == "win32":  # which deletes no binary that is loaded
                atexit.register(_loaded[key].freeLibrary)
    fmu = copy.copy(_loaded[key])
    fmu.instanceName = name
    return fmu
