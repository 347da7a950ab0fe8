"""Where the FMUs are, and programs on them in a fresh process: the modules below ``programs/``.

Tests that need no process of their own open FMUs in this one, by :mod:`.programs.driver`.
"""

from pathlib import Path

from ..exports import BUILD
from ..fresh import run_fresh

PROGRAMS = Path(__file__).with_name("programs")
FORMS = ("fmi2-python", "fmi2", "fmi3")
VERSIONS = FORMS[1:]  # of FMI; the native forms are called so
OSCILLATOR = "TwoMassImpactOscillator"
DRIVES = ("MotorShaker", "ElectrodynamicShaker")
MODELS = (OSCILLATOR, *DRIVES)
PAIRS = [(version, model) for version in VERSIONS for model in MODELS]
FMUS = {form: BUILD / form / f"{OSCILLATOR}.fmu" for form in FORMS}


def path_of(model, form):
    return BUILD / form / f"{model}.fmu"


def run(program, fmu, *arguments, **options):
    """What a program returns for an FMU; options are those of :func:`..fresh.run_fresh`."""
    return run_fresh(PROGRAMS, program, fmu, *arguments, **options)[0]
