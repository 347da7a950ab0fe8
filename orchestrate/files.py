"""Write files atomically, lock them, read them with a size limit, make folders."""

from __future__ import annotations

import logging
import os
import shutil
import stat
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import InputError, StoreError

log = logging.getLogger(__name__)
PROBE = ".writable"


def write_whole(path: str | os.PathLike[str], write: Callable[[Path], object]) -> Path:
    """Write a file atomically: ``write`` fills a temporary file, which is then renamed."""
    path = Path(path)
    remove_dead_temporaries(path)
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    try:
        write(temporary)
        temporary.replace(path)
    except (OSError, RuntimeError) as error:  # the NetCDF library says RuntimeError at a full disk
        raise StoreError(
            f"{path}: cannot be written ({format_write_error(error, path.parent)})"
        ) from error
    finally:
        temporary.unlink(missing_ok=True)
    return path


@contextmanager
def made_once(path: Path) -> Iterator[None]:
    """Hold a file lock in a ``with`` block, so that only one process makes a file at a time."""
    open_folder(path.parent)
    from filelock import FileLock, Timeout  # brings asyncio: describing a structure is to be quick

    lock = FileLock(path.with_name(f".{path.name}.lock"))
    try:
        lock.acquire(timeout=0.0)
    except Timeout:
        log.info("%s: another process makes it, this one waits", path)
        lock.acquire()
    except (NotImplementedError, OSError) as error:  # of a disk without locks
        log.info("%s: made without a lock (%s)", path, error)
    try:
        yield
    finally:
        lock.release()


def read_text(path: str | os.PathLike[str], most: int) -> str:
    """Return a regular file's text; raise for devices, pipes and over ``most`` bytes."""
    path = Path(path)
    if not stat.S_ISREG(path.stat().st_mode):
        raise ValueError("no ordinary file")
    with path.open("rb") as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise ValueError(f"{max(path.stat().st_size, len(data))} bytes, at most {most}")
    return data.decode("utf-8")


def check_path_encoding(path: str | os.PathLike[str]) -> None:
    """Raise ``InputError`` unless a path can be encoded as UTF-8, as NetCDF and HDF5 need."""
    try:
        str(Path(path).absolute()).encode("utf-8")
    except UnicodeEncodeError:
        raise InputError(f"{path}: a path that is not UTF-8; expected one that is") from None


def reason(error: BaseException) -> str:
    """Return why a file cannot be read: that there is none, or the system's or a reader's word."""
    missing = isinstance(error, FileNotFoundError)
    return "no such file" if missing else str(getattr(error, "strerror", None) or error)


def format_write_error(error: BaseException, folder: Path) -> str:
    """Return why a file could not be written: the error's text and the disk's free bytes."""
    text = getattr(error, "strerror", None) or (str(error).splitlines() or [""])[0]
    try:
        return f"{text}, {shutil.disk_usage(folder).free} bytes free on the disk"
    except OSError:
        return str(text)


def remove_dead_temporaries(path: Path) -> None:
    """Delete a path's temporary files of ``write_whole`` whose processes no longer run."""
    for left in path.parent.glob(f"{escape_glob(path.name)}.*.tmp"):
        number = left.name.removesuffix(".tmp").rpartition(".")[2]
        if number.isdigit() and not is_process_alive(int(number)):
            left.unlink(missing_ok=True)


def escape_glob(name: str) -> str:
    """Return a file name with the characters ``[]*?`` escaped for use in ``glob``."""
    return "".join(f"[{letter}]" if letter in "[]*?" else letter for letter in name)


def is_process_alive(pid: int) -> bool:
    """Return whether a process id runs on this machine; True where that cannot be asked."""
    if sys.platform == "win32":  # there the question would end it
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:  # somebody else's
        return True
    return True


def open_folder(folder: str | os.PathLike[str]) -> Path:
    """Create a folder if it is missing and return it; raise unless it is writable."""
    folder = Path(folder)
    probe = folder / f"{PROBE}.{os.getpid()}.tmp"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        remove_dead_temporaries(folder / PROBE)
        probe.write_bytes(b"")
        probe.unlink(missing_ok=True)  # another thread may have been quicker
    except OSError as error:
        raise StoreError(
            f"{folder}: {error.strerror or error}; expected a folder that can be written"
        ) from None
    return folder
