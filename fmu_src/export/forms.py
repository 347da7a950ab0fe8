"""The forms and the models there are, and the two questions about each: export it, and its GUID."""

from __future__ import annotations

from pathlib import Path

from . import native_form, pythonfmu_form

PYTHON_FORM = "fmi2-python"
FORMS = (PYTHON_FORM, "fmi2", "fmi3")
MODELS = {  # the folder of each model below fmu_src/models
    "TwoMassImpactOscillator": "oscillator",
    "MotorShaker": "motor_shaker",
}


def export(name: str, form: str, build: Path) -> Path:
    """Write ``build/FORM/NAME.fmu``, whole or not at all.

    Parameters
    ----------
    name : str
        Of :data:`MODELS`.
    form : str
        Of :data:`FORMS`.
    build : Path
        The build folder; made where it is missing.

    Returns
    -------
    Path
        The FMU.

    Raises
    ------
    CannotExport
        Where a package or a compiler is missing, as one line.
    OSError
        Where the folder cannot be written.
    """
    if form == PYTHON_FORM:
        return pythonfmu_form.export(MODELS[name], Path(build) / form)
    return native_form.export(MODELS[name], form, Path(build) / form)


def guid(name: str, form: str) -> str:
    """The GUID (FMI 3.0: instantiation token) that an FMU of the present sources bears.

    Parameters
    ----------
    name : str
        Of :data:`MODELS`.
    form : str
        Of :data:`FORMS`.

    Returns
    -------
    str
        In braces. It needs neither a compiler nor pythonfmu.
    """
    if form == PYTHON_FORM:
        return pythonfmu_form.guid(MODELS[name])
    return native_form.guid(MODELS[name], form)
