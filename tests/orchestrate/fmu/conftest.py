"""The FMUs of the present sources, in all forms that can be had here."""

from pathlib import Path

import pytest

from orchestrate.fmu import FORMS, OSCILLATOR, find_or_export


@pytest.fixture(scope="session")
def oscillator_in():
    """The oscillator's FMU of a form; native ones cannot be made everywhere."""

    def fmu(form: str) -> Path:
        path = find_or_export(OSCILLATOR, form).path
        return path if path.parent.name == form else pytest.skip(f"no {form} FMU here")

    return fmu


@pytest.fixture(params=FORMS)
def any_fmu(request, oscillator_in):
    return oscillator_in(request.param)


@pytest.fixture
def python_fmu(oscillator_in):
    return oscillator_in("fmi2-python")


@pytest.fixture
def event_fmu(oscillator_in):
    return oscillator_in("fmi3")


@pytest.fixture(scope="session", autouse=True)
def _all_forms_there(exported):
    """Nothing is exported where a test has put another folder in the place of the usual one."""
