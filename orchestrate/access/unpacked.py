"""Where FMUs are unpacked: a temporary folder of the process.

It is removed at the end of the process; where that was killed, at the start of another one.
"""

from __future__ import annotations

import atexit
import contextlib
import hashlib
import io
import os
import re
import shutil
import sys
import tempfile
import threading
from pathlib import Path

from ..errors import InputError, StoreError
from ..files import alive, check_name
from .description import Description

PREFIX = "vibroimpact-fmu-"  # by which the supervisor of a command knows them too
_lock = threading.RLock()
_folders: dict[int, Path] = {}  # by process: a forked child makes its own


def unpacked(description: Description) -> Path:
    """The folder with an FMU's files; unpacked once in a process.

    Raises
    ------
    InputError
        Where the file is not the one described any more.
    StoreError
        Where there is no room for it.
    """
    with _lock:
        try:
            folder = process_folder() / description.digest[:32]
            if not folder.is_dir():
                unpack(described_bytes(description), folder)
        except OSError as error:
            text = f"{tempfile.gettempdir()}: FMU cannot be unpacked ({error.strerror or error})"
            raise StoreError(f"{text}; expected a folder with room for it") from None
        return folder


def described_bytes(description: Description) -> bytes:
    """The FMU file, which has to be the one that was described."""
    data = description.path.read_bytes()
    if hashlib.sha256(data).hexdigest() != description.digest:
        text = f"FMU {description.path}: it has changed since it was read"
        raise InputError(f"{text}; expected a file that stays")
    return data


def unpack(data: bytes, folder: Path) -> None:
    """Unpack whole or not at all."""
    import fmpy

    partial = folder.with_suffix(".partial")
    try:
        fmpy.extract(io.BytesIO(data), partial)
        partial.rename(folder)
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        raise


def process_folder() -> Path:
    """The folder of this process, made at the first call."""
    pid = os.getpid()
    folder = _folders.get(pid)
    if folder is None or not folder.is_dir():
        check_name(tempfile.gettempdir())
        remove_leftovers()
        folder = _folders[pid] = Path(tempfile.mkdtemp(prefix=f"{PREFIX}{pid}-"))
        atexit.register(remove, folder, pid)
    return folder


def remove(folder: Path, pid: int) -> None:
    """Remove a folder at the end of the process that made it, not of one forked from it."""
    if os.getpid() == pid:
        shutil.rmtree(folder, ignore_errors=True)


def remove_leftovers() -> None:
    """Remove this user's folders whose processes are gone: killed ones do not clean up."""
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        match = re.match(rf"{PREFIX}(\d+)-", folder.name)
        with contextlib.suppress(OSError):
            if match and is_mine(folder) and not alive(int(match[1])):
                shutil.rmtree(folder, ignore_errors=True)


def is_mine(folder: Path) -> bool:
    """Whether it is a folder, not a link to one, and this user's."""
    return (
        folder.is_dir()
        and not folder.is_symlink()
        and (sys.platform == "win32" or folder.lstat().st_uid == os.getuid())
    )
