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
    """Return the folder with an FMU's unpacked files; unpack it there once per process."""
    with _lock:
        try:
            folder = process_temporary_folder() / description.digest[:32]
            if not folder.is_dir():
                extract_atomically(read_unchanged_bytes(description), folder)
        except OSError as error:
            text = f"{tempfile.gettempdir()}: FMU cannot be unpacked ({error.strerror or error})"
            raise StoreError(f"{text}; expected a folder with room for it") from None
        return folder


def read_unchanged_bytes(description: Description) -> bytes:
    """Return an FMU file's bytes; raise ``InputError`` if it changed since it was described."""
    data = description.path.read_bytes()
    if hashlib.sha256(data).hexdigest() != description.digest:
        text = f"FMU {description.path}: it has changed since it was read"
        raise InputError(f"{text}; expected a file that stays")
    return data


def extract_atomically(data: bytes, folder: Path) -> None:
    """Extract the bytes of an FMU's zip to a folder, atomically (a partial folder is renamed)."""
    import fmpy

    partial = folder.with_suffix(".partial")
    try:
        fmpy.extract(io.BytesIO(data), partial)
        partial.rename(folder)
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        raise


def new_fmu_object(description: Description, name: str) -> Any:
    """Return FMPy's FMU object for a new, not yet instantiated instance; the binary is cached."""
    key = str(unpack_once(description)), description.identifier
    with _lock:
        if key not in _loaded:
            _loaded[key] = load_binary(description, key[0])
            if sys.platform == "win32":  # which deletes no binary that is loaded
                atexit.register(_loaded[key].freeLibrary)
    fmu = copy.copy(_loaded[key])
    fmu.instanceName = name
    return fmu


def load_binary(description: Description, folder: str) -> Any:
    """Load the binary of an unpacked FMU; return FMPy's object of it."""
    from fmpy import fmi2, fmi3

    make = fmi3.FMU3Slave if description.is_fmi3 else fmi2.FMU2Slave
    return make(
        guid=description.guid, unzipDirectory=folder, modelIdentifier=description.identifier
    )
