"""The package's own C sources as shared libraries: compiled where missing or out of date.

One is loaded from the cache only where nobody else could have put it there, and its bytes are those
that were compiled, by the digest stored with it.
"""

from __future__ import annotations

import ctypes
import functools
import logging
from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import Any

from fmu_src.export import c_library as sources
from fmu_src.export.errors import CannotExport
from fmu_src.export.platforms import default_platforms, platform_of_this_machine, select_platforms

from ..errors import InputError, StoreError
from ..files import (
    find_or_make,
    forbid_writing_by_others,
    is_written_by_trusted_only,
    make_writable_folder,
    write_atomically,
)
from .exported import NOT_PRIVATE, SHIPPED, default_folder

log = logging.getLogger(__name__)
FORM = "libraries"
SOURCES = tuple(sorted(sources.LOOPS.glob("*.c")))


def find_or_compile_library(source: Path, folder: str | PathLike[str] | None = None) -> Path:
    """Return the path of a C source's shared library, compiled if missing or out of date."""
    platform = platform_of_this_machine()
    folders = [Path(folder)] if folder is not None else [default_folder(), SHIPPED]
    token = sources.library_guid(source)

    def is_usable(path: Path) -> bool:
        return is_trusted(path) and sources.is_current_and_undamaged(path, token)

    try:
        name = sources.library_name(source, platform)
        paths = [candidate / FORM / name for candidate in folders]
        make = functools.partial(compile_library, source, platform, folders[0])
        path = find_or_make(paths, is_usable, make)
        if is_trusted(path):
            return path
        raise InputError(f"{path}: {NOT_PRIVATE}")
    except (CannotExport, StoreError) as reason:
        text = f"{source.name}: no library of it is here, and none can be compiled"
        raise InputError(f"{text}: {reason}") from None


@functools.cache
def load_loop(name: str) -> Any:
    """Return a loop of ``fmu_src/kernels/loops`` as a library, loaded once, compiled if missing."""
    return load_library(sources.LOOPS / f"{name}.c")


def load_library(source: Path) -> Any:
    path = find_or_compile_library(source)
    try:
        return ctypes.CDLL(str(path))
    except OSError as reason:  # such as a folder from which nothing may be run
        raise InputError(f"{path}: cannot be loaded ({reason})") from None


def is_trusted(path: Path) -> bool:
    """Return whether a library came with the package, or nobody else can have written it."""
    if path.is_relative_to(SHIPPED):
        return True
    parts = paths_to_protect(path)
    return all(part.exists() and is_written_by_trusted_only(part) for part in parts)


def paths_to_protect(path: Path) -> tuple[Path, ...]:
    """Return what decides on what is loaded: a library, its digest, and their own folders."""
    return path, sources.digest_path(path), path.parent, path.parent.parent


def build_libraries(
    folder: str | PathLike[str] | None = None, platforms: Iterable[str] = ()
) -> list[Path]:
    """Compile all C sources for platforms; return the files, and warn of what is left out."""
    target, made = default_folder() if folder is None else Path(folder), []
    left: dict[str, list[str]] = {}  # names by the reason
    for source in SOURCES:
        for platform in select_platforms(platforms) or default_platforms():
            try:
                made.append(compile_library(source, platform, target))
            except CannotExport as reason:
                left.setdefault(str(reason), []).append(sources.library_name(source, platform))
    for text, names in left.items():
        log.warning("left out: %s: %s", ", ".join(names), text)
    return made


def compile_library(source: Path, platform: str, folder: Path) -> Path:
    """Compile a C source; write the library and its digest, which only the user can write."""
    path = folder / FORM / sources.library_name(source, platform)
    log.info("compiling %s", path)
    library = sources.compile_loop(source, platform)
    make_writable_folder(path.parent)
    write_atomically(path, lambda target: target.write_bytes(library))
    digest = sources.library_digest(library).encode()
    write_atomically(sources.digest_path(path), lambda target: target.write_bytes(digest))
    for part in paths_to_protect(path):
        forbid_writing_by_others(part)
    return path
