"""Export the FMUs, and know whether an exported one is up to date."""

from pathlib import Path

from fmu_src.export import native_form, pythonfmu_form
from fmu_src.oscillator.model import MODEL as OSCILLATOR

from .errors import UserError

FORMS = {"fmi2-python": pythonfmu_form.export, "fmi2": native_form.export_fmi2, "fmi3": native_form.export_fmi3}
MODELS = {"TwoMassImpactOscillator": (OSCILLATOR, "vibroimpact", "oscillator")}
PREFERENCE = ("fmi2-python",)  # the form taken where the user names none, best first


def build(folder, forms=tuple(FORMS)):
    """Export all models in the given forms.

    Parameters
    ----------
    folder : Path
        The build folder.
    forms : sequence of str
        Of ``FORMS``.

    Returns
    -------
    list of Path
        The FMUs written.
    """
    try:
        return [FORMS[form](*model, Path(folder) / form) for form in forms for model in MODELS.values()]
    except OSError as error:
        raise UserError(f"{folder}: cannot be written ({error.strerror or error}); allowed is a writable folder") from None


def default_fmu(name, folder):
    """Path of a model's FMU, exported first where there is none or its sources have changed."""
    from .fmu import describe

    form = PREFERENCE[0]
    path = Path(folder) / form / f"{name}.fmu"
    if not path.is_file() or describe(path).guid != pythonfmu_form.guid(*MODELS[name][1:]):
        print(f"exporting {path} ...", flush=True)
        build(folder, [form])
    return path
