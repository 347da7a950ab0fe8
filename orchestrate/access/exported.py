"""The FMUs of the present sources: exported where they are missing or out of date, and found."""

from __future__ import annotations

import functools
import logging
import os
from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from ..errors import InputError, StoreError
from ..version import __version__
from .description import Description, describe
from .models import OSCILLATOR, SHAKER

log = logging.getLogger(__name__)

FORMS = ("fmi2-python", "fmi2", "fmi3")
WITHOUT_COMPILER = "fmi2-python"
MODELS = {OSCILLATOR: ("oscillator", "oscillator"), SHAKER: ("shaker", "motor_shaker")}
SHIPPED = Path(__file__).parent / "fmus"
CLONE = Path(__file__).resolve().parents[2]


class CannotExport(Exception):
    """Why an FMU cannot be made here, as one line."""


def build(
    folder: str | PathLike[str] | None = None,
    forms: Iterable[str] = FORMS,
    names: Iterable[str] = tuple(MODELS),
) -> list[Path]:
    """Export models in the given forms.

    Parameters
    ----------
    folder : path-like, optional
        The build folder; :func:`default_folder` where none is given.
    forms : iterable of str
        Of ``FORMS``. Native ones are left out, and said to be, where there is no compiler.
    names : iterable of str
        Of ``MODELS``.

    Returns
    -------
    list of Path
        The FMUs written.

    Raises
    ------
    InputError
        Where a name is unknown, or none of the FMUs can be made here.
    StoreError
        Where the folder cannot be written.
    """
    target = default_folder() if folder is None else Path(folder)
    written, reasons = [], []
    for form in forms:
        for name in names:
            try:
                written.append(export(name, form, target))
            except CannotExport as reason:
                reasons.append(f"{form}/{name}.fmu: {reason}")
    if reasons and not written:
        raise InputError(f"{reasons[0]}; expected an installation of vibroimpact[build]")
    for line in reasons:
        log.warning("%s", line)
    return written


def refresh(folder: str | PathLike[str] | None = None, forms: Iterable[str] = FORMS) -> list[Path]:
    """Export what is missing or out of date; returns what was written."""
    target = default_folder() if folder is None else Path(folder)
    written = []
    for form in forms:
        stale = [name for name in MODELS if not up_to_date(form, name, target)]
        written += build(target, [form], stale)
    return written


def export(name: str, form: str, folder: Path) -> Path:
    """Export one model in one form to ``folder/FORM/NAME.fmu``.

    Raises
    ------
    CannotExport
        Where a package or a compiler is missing.
    StoreError
        Where the folder cannot be written.
    """
    check(name, form)
    path = folder / form / f"{name}.fmu"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        log.info("exporting %s (a model's first export compiles a C library: up to a minute)", path)
        return Path(exporter(form)[0](model_of(name), *MODELS[name], folder / form))
    except OSError as error:
        reason = error.strerror or error
        raise StoreError(f"{folder}: {reason}; expected a folder that can be written") from None
    except Exception as error:
        if not is_reason(error):
            raise
        raise CannotExport(str(error)) from None


def is_reason(error: Exception) -> bool:
    """Whether an exporter failed for want of something, not by a defect."""
    from fmu_src.export.linking import NoCompiler

    return isinstance(error, ImportError | NoCompiler)


def exporter(form: str) -> tuple[Callable[..., Path], Callable[[str, str], str]]:
    """What writes an FMU of a form, and what tells the GUID it would bear."""
    if form == WITHOUT_COMPILER:
        from fmu_src.export import pythonfmu_form

        return pythonfmu_form.export, pythonfmu_form.guid
    from fmu_src.export import native_form

    return (
        functools.partial(native_form.export, version=form),
        functools.partial(native_form.guid, version=form),
    )


def model_of(name: str) -> Any:
    """The model as the exporters see it."""
    from importlib import import_module

    return import_module(f"fmu_src.models.{MODELS[name][1]}.model").MODEL


@functools.cache
def guid(form: str, name: str) -> str:
    """The GUID of an FMU of the present sources.

    Raises
    ------
    CannotExport
        Where a package that decides it is missing.
    """
    check(name, form)
    try:
        return exporter(form)[1](*MODELS[name])
    except ImportError as error:
        raise CannotExport(str(error)) from None


def check(name: str, form: str) -> None:
    """Whether there is such a model and such a form."""
    if name not in MODELS:
        raise InputError(f"model {name}: expected one of {', '.join(MODELS)}")
    if form not in FORMS:
        raise InputError(f"form {form}: expected one of {', '.join(FORMS)}")


def up_to_date(form: str, name: str, folder: str | PathLike[str]) -> bool:
    """Whether a model's FMU of a form is there and made of the present sources."""
    path = Path(folder) / form / f"{name}.fmu"
    try:
        return path.is_file() and describe(path, name).guid == guid(form, name)
    except (InputError, CannotExport):  # damaged, or nobody can tell: to be made anew
        return False


def default_folder() -> Path:
    """Where FMUs are exported to: ``build/`` of a clone, else the user's cache folder."""
    if is_clone(CLONE) and os.access(CLONE, os.W_OK):
        return CLONE / "build"
    from platformdirs import user_cache_path

    return user_cache_path("vibroimpact", appauthor=False) / "fmus" / __version__


def is_clone(root: Path) -> bool:
    """Whether the package lies in a clone of its repository, not in an installation."""
    project = root / "pyproject.toml"
    return project.is_file() and 'name = "vibroimpact"' in project.read_text(encoding="utf-8")


def find(
    model: str,
    form: str = "fmi3",
    folder: str | PathLike[str] | None = None,
    fmu: str | PathLike[str] | None = None,
) -> Description:
    """A model's FMU, exported first where there is none of the present sources.

    Parameters
    ----------
    model : str
        Of ``MODELS``.
    form : str
        Of ``FORMS``; where no native FMU can be made here, the one by pythonfmu serves instead.
    folder : path-like, optional
        Build folder to look in and to export to. By default that of a clone; without a clone, the
        FMUs that came with the package, and the user's cache folder.
    fmu : path-like, optional
        The user's own FMU, taken as it is.

    Returns
    -------
    Description

    Raises
    ------
    InputError
        Where ``fmu`` is not of that model, or none can be made here.

    Examples
    --------
    >>> find("TwoMassImpactOscillator").fmi_version
    '3.0'
    """
    check(model, form)
    if fmu is not None:
        return describe(fmu, model)
    places = [Path(folder)] if folder is not None else [default_folder(), SHIPPED]
    reasons = []
    for wanted in dict.fromkeys((form, WITHOUT_COMPILER)):
        for place in places:
            if up_to_date(wanted, model, place):
                return describe(place / wanted / f"{model}.fmu", model)
        try:
            return describe(export(model, wanted, places[0]), model)
        except CannotExport as reason:
            reasons.append(str(reason))
    text = f"FMU {model}: there is none of the present sources, and none can be made ({reasons[0]})"
    raise InputError(f"{text}; expected an installation of vibroimpact[build], or an own FMU")


def finder(running: Mapping[str, Any]) -> Callable[[str], Description]:
    """:func:`find` as a question's keywords have it.

    Parameters
    ----------
    running : mapping
        ``fmu``: the user's own FMU, or a mapping of model names to them. ``build_folder``: as
        ``folder`` of :func:`find`.

    Returns
    -------
    callable
        Model name to :class:`.description.Description`.
    """
    own, folder = running.get("fmu"), running.get("build_folder")
    if isinstance(own, Mapping):
        for name in own:
            check(name, "fmi3")

    def found(model: str) -> Description:
        path = own.get(model) if isinstance(own, Mapping) else own
        return find(model, folder=folder, fmu=path)

    return found
