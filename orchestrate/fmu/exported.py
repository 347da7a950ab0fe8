"""The FMUs of the present sources: found, or exported where missing or out of date."""

from __future__ import annotations

import functools
import logging
import os
from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from fmu_src.export import forms as sources
from fmu_src.export.errors import CannotExport
from fmu_src.export.platforms import select_platforms

from ..errors import InputError, StoreError
from ..files import (
    find_or_make,
    forbid_writing_by_others,
    is_written_by_trusted_only,
    make_writable_folder,
    write_atomically,
)
from ..version import __version__
from .description import Description, describe, describe_runnable

log = logging.getLogger(__name__)

FORMS: tuple[str, ...] = sources.FORMS
PLAIN_FORMS: tuple[str, ...] = sources.PLAIN_FORMS
source_forms_of = sources.source_forms_of
MODELS: tuple[str, ...] = tuple(sources.MODELS)
WITHOUT_COMPILER = sources.PYTHON_FORM
SHIPPED = Path(__file__).parent / "fmus"
NOT_PRIVATE = (
    "others can write it or its folder, or it is somebody else's: expected a folder that only you "
    "can write, or another build_folder; it is not loaded"
)
CLONE = Path(__file__).resolve().parents[2]
current_guid = functools.cache(sources.fmu_guid)


def build(
    folder: str | PathLike[str] | None = None,
    forms: Iterable[str] = FORMS,
    names: Iterable[str] = MODELS,
    platforms: Iterable[str] = (),
) -> list[Path]:
    """Export FMUs of models, in forms (FMI versions), for platforms; return the files' paths.

    Those that cannot be made are warned of; if none can, ``InputError``.
    """
    forms = tuple(forms)
    pairs = [(form, name) for name in names for form in forms]
    target = default_folder() if folder is None else Path(folder)
    written, reasons = [], []
    try:
        chosen = select_platforms(platforms)
    except CannotExport as reason:
        raise InputError(str(reason)) from None
    for form, name in pairs:
        try:
            written.append(export(name, form, target, chosen))
        except CannotExport as reason:
            reasons.append(f"{form}/{name}.fmu cannot be made: {reason}")
    if reasons and not written:
        raise InputError(reasons[0])
    for line in reasons:
        log.warning("%s", line)
    return written


def export(
    name: str, form: str, folder: Path, platforms: tuple[str, ...] = (), level: int = logging.INFO
) -> Path:
    """Export an FMU to ``folder/form/name.fmu``, which only the user can write if it is default."""
    require_known(name, form)
    make_writable_folder(folder)
    log_once(f"exporting FMUs to {folder}, this once: compiling takes some seconds a model", level)
    log.info("exporting %s", folder / form / f"{name}.fmu")
    try:
        path = export_or_copy(name, form, folder, platforms)
        if folder == default_folder():
            forbid_writing_by_others(path)
            forbid_writing_by_others(path.parent)
        return path
    except OSError as error:
        reason = error.strerror or error
        raise StoreError(f"{folder}: {reason}; expected a folder that can be written") from None


def export_or_copy(name: str, form: str, folder: Path, platforms: tuple[str, ...]) -> Path:
    """Export an FMU, or copy the one that the package came with if none can be exported here."""
    try:
        return sources.export(name, form, folder, platforms or None)
    except CannotExport:
        if platforms or not is_current_and_trusted(form, name, SHIPPED):
            raise
    path = folder / form / f"{name}.fmu"
    log.info("%s is copied from the installed package", path)
    path.parent.mkdir(parents=True, exist_ok=True)
    shipped = (SHIPPED / form / path.name).read_bytes()
    return write_atomically(path, lambda target: target.write_bytes(shipped))


def require_known(name: str, form: str) -> None:
    if name not in MODELS:
        raise InputError(f"model {name}: expected one of {', '.join(MODELS)}")
    if form not in sources.ALL_FORMS:
        raise InputError(f"form {form}: expected one of {', '.join(sources.ALL_FORMS)}")


def is_current_and_trusted(form: str, name: str, folder: str | PathLike[str]) -> bool:
    """Whether an FMU is of the present sources; others may not write to the default folder."""
    path = Path(folder) / form / f"{name}.fmu"
    try:
        current = path.is_file() and describe(path, name).guid == current_guid(name, form)
    except InputError:  # damaged: to be made again
        return False
    if not current or Path(folder) != default_folder():
        return current  # another folder was named, and so trusted
    if is_written_by_trusted_only(path) and is_written_by_trusted_only(path.parent):
        return True
    log_once(f"{path}: {NOT_PRIVATE}")
    return False


def default_folder() -> Path:
    """Return the folder of exported FMUs: ``build/`` of a clone, else the user's cache folder."""
    project = CLONE / "pyproject.toml"
    is_clone = project.is_file() and 'name = "vibroimpact"' in project.read_text(encoding="utf-8")
    if is_clone and os.access(CLONE, os.W_OK):
        return CLONE / "build"
    from platformdirs import user_cache_path

    return user_cache_path("vibroimpact", appauthor=False) / "fmus" / __version__


def find_or_export(
    model: str,
    form: str = "fmi3",
    folder: str | PathLike[str] | None = None,
    fmu: str | PathLike[str] | None = None,
    level: int = logging.INFO,
) -> Description:
    """Return a model's current FMU: the user's ``fmu``, one that is there, or one exported now."""
    require_known(model, form)
    if fmu is not None:
        return describe_runnable(fmu, model)
    folders = [Path(folder)] if folder is not None else [default_folder(), SHIPPED]
    reasons: list[CannotExport] = []

    def is_usable(path: Path) -> bool:
        return is_current_and_trusted(path.parent.name, model, path.parents[1])

    for candidate in dict.fromkeys((form, WITHOUT_COMPILER)):
        if candidate != form:
            text = f"no {form} FMU here, {candidate} serves instead, without events"
            log_once(f"{text}: {reasons[0]}")
        paths = [base / candidate / f"{model}.fmu" for base in folders]
        make = functools.partial(export, model, candidate, folders[0], level=level)
        try:
            return describe(find_or_make(paths, is_usable, make), model)
        except CannotExport as reason:
            reasons.append(reason)
    text = f"FMU {model}: none matches the current sources, and none can be built here"
    raise InputError(f"{text}: {reasons[0]}, or an FMU of your own")


@functools.cache
def log_once(line: str, level: int = logging.WARNING) -> None:
    log.log(level, "%s", line)


def make_fmu_finder(running: Mapping[str, Any]) -> Callable[[str], Description]:
    """Return a function from model name to FMU description, made of a question's keywords."""
    user_fmu, folder = running.get("fmu"), running.get("build_folder")
    level = logging.WARNING if running.get("progress", True) else logging.INFO
    if isinstance(user_fmu, Mapping):
        for name in user_fmu:
            require_known(name, "fmi3")

    def find_model(model: str) -> Description:
        path = user_fmu.get(model) if isinstance(user_fmu, Mapping) else user_fmu
        return find_or_export(model, folder=folder, fmu=path, level=level)

    return find_model
