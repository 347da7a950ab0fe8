"""The package's own C sources as shared libraries: compiled where missing or out of date.

One is loaded from the cache only where nobody else could have put it there, and its bytes are those
that were compiled, by the digest beside it.
"""

from __future__ import annotations

import ctypes
import logging
from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import Any

from fmu_src.export import c_library as sources
from fmu_src.export.errors import CannotExport
from fmu_src.export.platforms import PLATFORMS, chosen, this_machine, usual

from ..errors import StoreError
from ..files import is_private, made_once, make_private, open_folder, write_whole
from .exported import NOT_PRIVATE, SHIPPED, default_folder, warn_once

log = logging.getLogger(__name__)
FORM = "libraries"
SOURCES = tuple(sorted(Path(__file__).resolve().parents[1].glob("*/*.c")))


def library(source: Path, folder: str | PathLike[str] | None = None) -> Path | None:
    """Return the path of a C source's shared library, compiled if missing; None if it cannot be."""
    platform = this_machine()
    if platform not in PLATFORMS:
        return None
    folders = [Path(folder)] if folder is not None else [default_folder(), SHIPPED]
    token = sources.guid(source)
    paths = [candidate / FORM / sources.file_name(source, platform) for candidate in folders]
    for path in paths:
        if is_trusted(path) and sources.is_current(path, token):
            return path
    path = paths[0]
    try:
        with made_once(path):
            if not (is_trusted(path) and sources.is_current(path, token)):
                compile_library(source, platform, folders[0])
            if is_trusted(path):
                return path
            warn_once(f"{path}: {NOT_PRIVATE}, Python does the same, slower")
            return None
    except (CannotExport, StoreError) as reason:
        log.info("%s is not compiled, Python does the same: %s", source.name, reason)
        return None


def loaded_function(source: Path) -> Any:
    """Load the C function ``run`` of a source's shared library; None without a library."""
    loaded = loaded_library(source)
    return None if loaded is None else loaded.run


def loaded_library(source: Path) -> Any:
    """Load a C source's shared library; None where there is none."""
    path = library(source)
    if path is None:
        return None
    try:
        return ctypes.CDLL(str(path))
    except OSError as reason:  # such as a folder from which nothing may be run
        log.info("%s cannot be loaded, Python does the same: %s", path, reason)
        return None


def is_trusted(path: Path) -> bool:
    """Return whether a library came with the package, or nobody else can have written it."""
    if path.is_relative_to(SHIPPED):
        return True
    return all(part.exists() and is_private(part) for part in trusted_parts(path))


def trusted_parts(path: Path) -> tuple[Path, ...]:
    """Return what decides on what is loaded: a library, its digest, and their own folders."""
    return path, sources.digest_file(path), path.parent, path.parent.parent


def build_libraries(
    folder: str | PathLike[str] | None = None, platforms: Iterable[str] = ()
) -> list[Path]:
    """Compile all C sources of the package for the platforms; return the paths of those made."""
    target, made = default_folder() if folder is None else Path(folder), []
    for source in SOURCES:
        for platform in chosen(platforms) or usual():
            try:
                made.append(compile_library(source, platform, target))
            except CannotExport as reason:
                log.warning("%s left out: %s", sources.file_name(source, platform), reason)
    return made


def compile_library(source: Path, platform: str, folder: Path) -> Path:
    """Compile one C source for one platform into a folder, atomically; return the path."""
    path = folder / FORM / sources.file_name(source, platform)
    log.info("compiling %s", path)
    library = sources.export(source, platform)
    open_folder(path.parent)
    write_whole(path, lambda target: target.write_bytes(library))
    digest = sources.digest(library).encode()
    write_whole(sources.digest_file(path), lambda target: target.write_bytes(digest))
    for part in trusted_parts(path):
        make_private(part)
    return path
