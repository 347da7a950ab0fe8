"""Every test that asks for ``fmu`` runs on each form of the model that is exported."""

import pytest

from .driver import FMUS


@pytest.fixture(scope="session", autouse=True)
def forms(exported):
    """All tests here need the FMUs."""
    return exported


@pytest.fixture(params=FMUS, scope="session")
def fmu(request):
    """Path of an exported FMU."""
    return FMUS[request.param]
