"""Every test that asks for ``fmu`` runs on each form of the model that is exported."""

from collections import Counter
from pathlib import Path

import pytest

from ..exports import once
from .copies import export_copy
from .driver import FMUS
from .programs.driver import free_all

FORMS = list(FMUS)


@pytest.fixture(scope="session", autouse=True)
def forms(exported):
    """All tests here need the FMUs."""
    return exported


@pytest.fixture(scope="session")
def changed(tmp_path_factory):
    """An FMU of sources whose coefficient of restitution starts as another one."""
    change = ("models/oscillator/variables.py", '"e", "1", 0.7', '"e", "1", 0.25')
    surroundings = {"PYTHONHASHSEED": "1", "TZ": "Asia/Tokyo", "LC_ALL": "C"}
    folder = tmp_path_factory.mktemp("changed")
    return once(tmp_path_factory, "changed", lambda: export_copy(folder, [change], **surroundings))


@pytest.fixture(autouse=True)
def instances():
    """No instance outlives its test."""
    yield
    free_all()


@pytest.fixture(params=FORMS, scope="session")
def fmu(request):
    """Path of an exported FMU."""
    return FMUS[request.param]


@pytest.fixture(params=FORMS)
def form(request):
    """Name of a form, for tests on several models."""
    return request.param


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Leave to ``-m slow`` all but the first case of a test on every form, and others on one form.

    All forms give the same bits (tests/native/test_bit_identity.py), so each case is proved by one
    of them; which one goes round.
    """
    cases = Counter()
    for item in items:
        names = getattr(item, "callspec", None)
        if (
            names is None
            or "fmu" not in names.params
            or Path(__file__).parent not in item.path.parents
        ):
            continue
        form = names.params["fmu"]
        number = cases[item.path, item.originalname, form]
        cases[item.path, item.originalname, form] += 1
        if number and number % len(FORMS) != FORMS.index(form):
            item.add_marker(pytest.mark.slow)
