"""A page made of a sweep, and one browser for all tests of it.

It closes after this package: an animated page left open takes time from all other tests.
"""

import shutil

import numpy as np
import pytest

import orchestrate
from orchestrate.explorer.page import explore

from .browser import Browser

READY = "return explorer.regions.complete && !explorer.regions.quick && explorer.inspector.found"
ETAS = np.round(np.linspace(0.1, 8.0, 61), 4)  # periodic, irregular, with permanent contact


@pytest.fixture(scope="session")
def swept(exported):
    return orchestrate.sweep(orchestrate.Structure(), eta=ETAS, direction="up", progress=False)


@pytest.fixture(scope="session")
def page(swept, tmp_path_factory):
    return explore(swept, output=tmp_path_factory.mktemp("explorer") / "explorer.html")


@pytest.fixture(scope="package")
def chromium():
    pytest.importorskip("selenium", reason="selenium drives the browser")
    programs = shutil.which("chromium"), shutil.which("chromedriver")
    if None in programs:
        pytest.skip("no chromium with chromedriver here: the page is not tried in a browser")
    browser = Browser(*programs)
    yield browser
    browser.driver.quit()


@pytest.fixture
def browser(chromium, page):
    """The page browser anew; afterwards the console must be empty."""
    chromium.open(page)
    yield chromium
    assert chromium.console() == []


def typed(browser, name, text):
    """Type into an input as a hand does, letter by letter, and leave it."""
    browser.run("const at = document.getElementById(arguments[0]); at.focus(); at.select()", name)
    browser.keys(*text)
    browser.keys(*browser.leave)
