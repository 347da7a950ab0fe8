"""Write files atomically, lock them, read them with a size limit, make folders."""

from __future__ import annotations

import errno
import logging
import os
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from .errors import InputError, StoreError

log = logging.getLogger(__name__)
GUARD = ".lock"  # file in a temporary folder that its process has locked
TEMPORARY = ".tmp"  # end of the names of folders in which files are written


class HeldLock:
    """Lock on a file: held until it is released or its process ends, however that ends."""

    def __init__(self, path: Path) -> None:
        """Take the lock; raise ``BlockingIOError`` where another has it, else ``OSError``."""
        from filelock import FileLock, Timeout  # slow to import

        self.path, self._lock = path, FileLock(path)
        try:
            self._lock.acquire(timeout=0.0)
        except Timeout:
            raise BlockingIOError(errno.EAGAIN, "another process holds it", str(path)) from None
        except NotImplementedError as error:  # of a disk without locks
            raise OSError(errno.ENOLCK, str(error), str(path)) from None

    def release(self) -> None:
        """Remove the file and release the lock, in the order that the system permits."""
        if not self._lock.is_locked:
            return
        try:
            # before it is released: whoever has opened this file then finds that it is no lock
            self.path.unlink(missing_ok=True)
        except OSError:
            # Windows removes no open file: so none that another process has locked meanwhile
            self._lock.release()
            with suppress(OSError):
                self.path.unlink(missing_ok=True)
        finally:
            self._lock.release()


class LockedFolder:
    """Temporary folder of a process, which holds a lock in it as long as it uses the folder.

    So it is known from any process, container or host whether what is in it is still needed.
    """

    def __init__(self, parent: Path, prefix: str, suffix: str = "") -> None:
        self._lock: HeldLock | None = None
        while True:
            self.path = Path(tempfile.mkdtemp(suffix, prefix, parent))
            try:
                self._lock = HeldLock(self.path / GUARD)
            except (BlockingIOError, FileNotFoundError):  # taken for one that is no longer needed
                continue
            except OSError as error:  # a disk without locks: nobody removes it but this process
                log.info("%s: made without a lock (%s)", self.path, error)
            return

    def remove(self) -> None:
        remove_locked_folder(self.path, self._lock)


def remove_locked_folder(folder: Path, lock: HeldLock | None) -> None:
    """Delete a temporary folder whose lock this process holds, and release the lock."""
    shutil.rmtree(folder, ignore_errors=True)
    if lock is not None:
        lock.release()
    shutil.rmtree(folder, ignore_errors=True)  # Windows had left the lock's file, which was open


def remove_unlocked_folders(parent: Path, pattern: str) -> None:
    """Delete this user's temporary folders of a pattern whose locks nobody holds."""
    for folder in parent.glob(pattern):
        with suppress(OSError):
            is_ours = sys.platform == "win32" or folder.lstat().st_uid == os.getuid()
            if is_ours and not folder.is_symlink() and (folder / GUARD).is_file():
                remove_locked_folder(folder, HeldLock(folder / GUARD))


def is_written_by_trusted_only(path: Path) -> bool:
    """Return whether all who can write a path could change this program as well."""
    if sys.platform == "win32":  # where its permissions are not known
        return True
    users, groups, there = *trusted_owners(), path.stat()
    shared = there.st_gid not in groups and there.st_mode & stat.S_IWGRP
    return there.st_uid in users and not shared and not there.st_mode & stat.S_IWOTH


def trusted_owners() -> tuple[set[int], set[int]]:
    """Return the users and the groups that can change this program, by its files or as root."""
    program = Path(__file__).stat()
    groups = {program.st_gid} if program.st_mode & stat.S_IWGRP else set[int]()
    return {os.getuid(), 0, program.st_uid}, groups


def forbid_writing_by_others(path: Path) -> None:
    """Take the permission to write a path from others, where it is this user's."""
    with suppress(OSError):
        path.chmod(stat.S_IMODE(path.stat().st_mode) & ~(stat.S_IWGRP | stat.S_IWOTH))


def write_atomically(path: str | os.PathLike[str], write: Callable[[Path], object]) -> Path:
    """Write a file atomically: ``write`` fills one in a temporary folder, which is moved."""
    path = Path(path)
    try:
        remove_unlocked_folders(path.parent, f"{escape_glob(path.name)}.*{TEMPORARY}")
        folder = LockedFolder(path.parent, f"{path.name}.", TEMPORARY)
        try:
            write(folder.path / path.name)
            (folder.path / path.name).replace(path)
        finally:
            folder.remove()
    except (OSError, RuntimeError) as error:  # the NetCDF library says RuntimeError at a full disk
        reason = format_write_error(error, path.parent)
        raise StoreError(f"{path}: cannot be written ({reason})") from error
    return path


@contextmanager
def creation_lock(path: Path) -> Iterator[None]:
    """Return a lock for a ``with`` block, in which only one process makes a file at a time."""
    make_writable_folder(path.parent)
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


def find_or_make(
    paths: Sequence[Path], is_usable: Callable[[Path], bool], make: Callable[[], object]
) -> Path:
    """Return the first path that is usable; else the first one, made by one process at a time."""
    if (found := next(filter(is_usable, paths), None)) is not None:
        return found
    with creation_lock(paths[0]):
        if not is_usable(paths[0]):  # another process may just have made it
            make()
    return paths[0]


def read_text(path: str | os.PathLike[str], max_bytes: int) -> str:
    """Return a regular file's text; raise for devices, pipes and over ``max_bytes`` bytes."""
    path = Path(path)
    if not stat.S_ISREG(path.stat().st_mode):
        raise ValueError("no ordinary file")
    with path.open("rb") as file:
        data = file.read(max_bytes + 1)
    if len(data) > max_bytes:
        raise ValueError(f"{max(path.stat().st_size, len(data))} bytes, at most {max_bytes}")
    return data.decode("utf-8")


def check_path_encoding(path: str | os.PathLike[str]) -> None:
    """Raise ``InputError`` unless a path can be encoded as UTF-8, as NetCDF and HDF5 need."""
    try:
        str(Path(path).absolute()).encode("utf-8")
    except UnicodeEncodeError:
        raise InputError(f"{path}: a path that is not UTF-8; expected one that is") from None


def format_read_error(error: BaseException) -> str:
    """Return why a file cannot be read: it does not exist, or the system's or a reader's reason."""
    missing = isinstance(error, FileNotFoundError)
    return "no such file" if missing else str(getattr(error, "strerror", None) or error)


def format_write_error(error: BaseException, folder: Path) -> str:
    """Return why a file could not be written: the error's text and the disk's free bytes."""
    text = getattr(error, "strerror", None) or (str(error).splitlines() or [""])[0]
    try:
        return f"{text}, {shutil.disk_usage(folder).free} bytes free on the disk"
    except OSError:
        return str(text)


def escape_glob(name: str) -> str:
    """Return a file name with the characters ``[]*?`` escaped for use in ``glob``."""
    return "".join(f"[{letter}]" if letter in "[]*?" else letter for letter in name)


def make_writable_folder(folder: str | os.PathLike[str]) -> Path:
    """Create a folder if it is missing and return it; raise unless it is writable."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        reason = error.strerror or error
        raise StoreError(f"{folder}: {reason}; expected a folder that can be written") from None
    return folder
