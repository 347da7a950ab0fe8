"""The forms and the models there are; export one of them, or tell its GUID."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

PYTHON_FORM = "fmi2-python"
FORMS = (PYTHON_FORM, "fmi2", "fmi3")
PLAIN_FORMS = ("fmi2-plain", "fmi3-plain")


def source_forms_of(forms: Iterable[str]) -> tuple[str, ...]:
    """Return the source forms, for targets that compile C, of some native forms."""
    return tuple(f"{form}-sources" for form in forms if form != PYTHON_FORM)


ALL_FORMS = FORMS + PLAIN_FORMS + source_forms_of(FORMS + PLAIN_FORMS)
MODELS = {  # the folder of each model below fmu_src/models
    "TwoMassImpactOscillator": "oscillator",
    "MotorShaker": "motor_shaker",
    "ElectrodynamicShaker": "electrodynamic_shaker",
}


def export(name: str, form: str, build: Path, platforms: tuple[str, ...] | None = None) -> Path:
    """Write ``build/FORM/NAME.fmu``, whole or not at all; return its path."""
    from . import native_form, pythonfmu_form

    if form == PYTHON_FORM:
        return pythonfmu_form.export(MODELS[name], Path(build) / form)
    return native_form.export(MODELS[name], form, Path(build) / form, platforms)


def fmu_guid(name: str, form: str) -> str:
    """Return the GUID of an FMU of the present sources, in braces, without compiling anything."""
    from . import native_form, pythonfmu_form

    if form == PYTHON_FORM:
        return pythonfmu_form.pythonfmu_guid(MODELS[name])
    return native_form.native_fmu_guid(MODELS[name], form)
