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

from .files import HeldFolder, check_path_encoding, remove_unheld

PREFIX = "vibroimpact-unpacked-"
_folders: dict[int, HeldFolder] = {}  # by process: a forked child makes its own


def process_folder() -> Path:
    folder = _folders.get(os.getpid())
    if folder is None or not folder.path.is_dir():
        check_path_encoding(tempfile.gettempdir())
        remove_leftovers()
        folder = _folders[os.getpid()] = HeldFolder(Path(tempfile.gettempdir()), PREFIX)
        atexit.register(remove_process_folder)
        # processes of multiprocessing, such as Dask's workers, know nothing of atexit
        Finalize(None, remove_process_folder, exitpriority=0)
    return folder.path


def remove_process_folder() -> None:
    """Delete the temporary folder of this process, if it has one (a fork's parent's is not)."""
    if folder := _folders.pop(os.getpid(), None):
        folder.remove()


def remove_leftovers() -> None:
    """Delete this user's temporary folders whose processes have ended."""
    remove_unheld(Path(tempfile.gettempdir()), f"{PREFIX}*")
