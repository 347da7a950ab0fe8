"""Export the FMUs, and know whether an exported one is up to date."""

import functools
from pathlib import Path

from fmu_src.export import native_form, pythonfmu_form
from fmu_src.export.linking import NoCompiler, say_pure_python
from fmu_src.models.motor_shaker.model import MODEL as SHAKER
from fmu_src.models.oscillator.model import MODEL as OSCILLATOR

from .errors import InputError
from .fmu import describe

FORMS: dict = {"fmi2-python": pythonfmu_form.export, "fmi2": native_form.export_fmi2, "fmi3": native_form.export_fmi3}
MODELS: dict = {
    "TwoMassImpactOscillator": (OSCILLATOR, "oscillator", "oscillator"),
    "MotorShaker": (SHAKER, "shaker", "motor_shaker"),
}
GUIDS: dict = {
    "fmi2-python": pythonfmu_form.guid,
    "fmi2": functools.partial(native_form.guid, version="fmi2"),
    "fmi3": functools.partial(native_form.guid, version="fmi3"),
}
PREFERENCE = ("fmi2", "fmi2-python")  # the form taken where the user names none, best first


def build(folder, forms=tuple(FORMS), names=tuple(MODELS)):
    """Export models in the given forms.

    Parameters
    ----------
    folder : Path
        The build folder.
    forms : sequence of str
        Of ``FORMS``.
    names : sequence of str
        Of ``MODELS``.

    Returns
    -------
    list of Path
        The FMUs written.
    """
    written = []
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: {error.strerror or error}; allowed is a folder that can be written") from None
    for form in forms:
        for name in names:
            try:
                written.append(FORMS[form](*MODELS[name], Path(folder) / form))
            except NoCompiler as reason:
                say_pure_python(reason)
            except OSError as error:
                raise InputError(f"{folder}: cannot be written ({error.strerror or error}); allowed is a writable folder") from None
    return written


def up_to_date(form, name, folder):
    """Whether a model's FMU of a form is there and made of the present sources."""
    path = Path(folder) / form / f"{name}.fmu"
    try:
        return path.is_file() and describe(path).guid == GUIDS[form](*MODELS[name][1:])
    except InputError:  # damaged: to be made anew
        return False


def refresh(folder, forms=tuple(FORMS)):
    """Export what is missing or out of date."""
    written = []
    for form in forms:
        stale = [name for name in MODELS if not up_to_date(form, name, folder)]
        written += build(folder, [form], stale)
    return written


def default_fmu(name, folder):
    """Path of a model's FMU, exported first where there is none or its sources have changed."""
    for form in PREFERENCE:
        path = Path(folder) / form / f"{name}.fmu"
        if up_to_date(form, name, folder):
            return path
        print(f"exporting {path} ...", flush=True)
        if build(folder, [form], [name]):
            return path
    raise AssertionError("the last form needs no compiler")
