"""Create and remove the temporary folder of a process, which holds unpacked FMUs.

It is removed at the end of the process, a worker's too; where that was killed, at the start of
another one.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import re
import shutil
import sys
import tempfile
from multiprocessing.util import Finalize
from pathlib import Path

from .files import check_path_encoding, is_process_alive

PREFIX = "vibroimpact-fmu-"
_folders: dict[int, Path] = {}  # by process: a forked child makes its own


def process_folder() -> Path:
    """Return the path of this process's temporary folder; create it at the first call."""
    pid = os.getpid()
    folder = _folders.get(pid)
    if folder is None or not folder.is_dir():
        check_path_encoding(tempfile.gettempdir())
        remove_leftovers()
        folder = _folders[pid] = Path(tempfile.mkdtemp(prefix=f"{PREFIX}{pid}-"))
        atexit.register(remove_process_folder)
        # processes of multiprocessing, such as Dask's workers, know nothing of atexit
        Finalize(None, remove_process_folder, exitpriority=0)
    return folder


def remove_process_folder() -> None:
    """Delete the temporary folder of this process, if it has one (a fork's parent's is not)."""
    if folder := _folders.get(os.getpid()):
        shutil.rmtree(folder, ignore_errors=True)


def remove_leftovers() -> None:
    """Delete this user's temporary folders whose processes no longer run."""
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        match = re.match(rf"{PREFIX}(\d+)-", folder.name)
        with contextlib.suppress(OSError):
            if match and is_own_folder(folder) and not is_process_alive(int(match[1])):
                shutil.rmtree(folder, ignore_errors=True)


def is_own_folder(folder: Path) -> bool:
    """Return whether a path is a real folder (no link) that belongs to the current user."""
    return (
        folder.is_dir()
        and not folder.is_symlink()
        and (sys.platform == "win32" or folder.lstat().st_uid == os.getuid())
    )
