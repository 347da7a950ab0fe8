"""Create and remove the temporary folder of a process, which holds unpacked FMUs.

It is removed at the end of the process, a worker's too; where that was killed, at the start of
another one, which knows it by its lock that nobody holds.
"""

from __future__ import annotations

import atexit
import os
import tempfile
from multiprocessing.util import Finalize
from pathlib import Path

from .files import LockedFolder, check_path_encoding, remove_unlocked_folders

PREFIX = "vibroimpact-unpacked-"
_folders: dict[int, LockedFolder] = {}  # by process: a forked child makes its own


def process_temporary_folder() -> Path:
    folder = _folders.get(os.getpid())
    if folder is None or not folder.path.is_dir():
        check_path_encoding(tempfile.gettempdir())
        remove_folders_of_ended_processes()
        folder = _folders[os.getpid()] = LockedFolder(Path(tempfile.gettempdir()), PREFIX)
        atexit.register(remove_process_temporary_folder)
        # processes of multiprocessing, such as Dask's workers, know nothing of atexit
        Finalize(None, remove_process_temporary_folder, exitpriority=0)
    return folder.path


def remove_process_temporary_folder() -> None:
    """Delete the temporary folder of this process, if it has one (a fork's parent's is not)."""
    if folder := _folders.pop(os.getpid(), None):
        folder.remove()


def remove_folders_of_ended_processes() -> None:
    """Delete this user's temporary folders whose processes have ended."""
    remove_unlocked_folders(Path(tempfile.gettempdir()), f"{PREFIX}*")
