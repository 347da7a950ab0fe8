"""Every test that asks for ``fmu`` runs on each form of the model that is exported."""

from collections import Counter
from pathlib import Path

import pytest

from .driver import FMUS, FORMS

NUMBERS = ("chattering", "energy", "forces", "guarantees", "importers", "motion", "outputs")


@pytest.fixture(scope="session", autouse=True)
def forms(exported):
    return exported


@pytest.fixture(params=FORMS, scope="session")
def fmu(request):
    return FMUS[request.param]


@pytest.fixture(params=FORMS)
def form(request):
    return request.param


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Leave to ``-m slow`` all cases but one form of each, which goes round.

    All forms give the same bits (tests/native/test_bit_identity.py). Where a test is not about
    numbers, its first case runs on every form.
    """
    cases = Counter()
    for item in items:
        names = getattr(item, "callspec", None)
        here = Path(__file__).parent in item.path.parents
        if names is None or "fmu" not in names.params or not here:
            continue
        numbers = item.path.stem.removeprefix("test_") in NUMBERS
        form = names.params["fmu"]
        number = cases[item.path, "" if numbers else item.originalname, form]
        cases[item.path, "" if numbers else item.originalname, form] += 1
        if (number or numbers) and number % len(FORMS) != FORMS.index(form):
            item.add_marker(pytest.mark.slow)
