"""A page made of a sweep, and one browser of each kind for all tests of it.

The browsers close after this package: an animated page left open takes time from all other tests.
"""

import shutil

import numpy as np
import pytest

import orchestrate
from orchestrate.explorer.page import explore

from .chromium import Chromium
from .firefox import Firefox
from .webkit import WebKit, programs

SLOW = pytest.mark.slow
ETAS = np.round(np.linspace(0.1, 8.0, 211), 4)  # periodic, irregular, with permanent contact


@pytest.fixture(scope="session")
def swept(exported):
    return orchestrate.sweep(orchestrate.Structure(), eta=ETAS, direction="up", progress=False)


@pytest.fixture(scope="session")
def page(swept, tmp_path_factory):
    return explore(swept, output=tmp_path_factory.mktemp("explorer") / "explorer.html")


@pytest.fixture(scope="package")
def chromium(tmp_path_factory):
    pytest.importorskip("selenium", reason="selenium drives the browser")
    programs = shutil.which("chromium"), shutil.which("chromedriver")
    if None in programs:
        pytest.skip("no chromium with chromedriver here: the page is not tried in a browser")
    browser = Chromium(*programs, tmp_path_factory.mktemp("downloads"))
    yield browser
    browser.quit()


@pytest.fixture(scope="package")
def firefox(tmp_path_factory):
    pytest.importorskip("websocket", reason="websocket-client talks to Firefox")
    program = shutil.which("firefox-esr") or shutil.which("firefox")
    if not program:
        pytest.skip("no firefox here: the page is not tried in it")
    folders = (tmp_path_factory.mktemp(name) for name in ("profile", "downloads"))
    browser = Firefox(program, *folders)
    yield browser
    browser.quit()


@pytest.fixture(scope="package")
def webkit(tmp_path_factory):
    pytest.importorskip("selenium", reason="selenium drives the browser")
    if None in programs():
        pytest.skip("no webkit2gtk-driver with xvfb here: the page is not tried in WebKit")
    browser = WebKit(*programs(), tmp_path_factory.mktemp("downloads"))
    yield browser
    browser.quit()


@pytest.fixture(scope="package", params=["chromium", pytest.param("firefox", marks=SLOW)])
def window(request):
    """Each browser, the second in the slow tests."""
    return request.getfixturevalue(request.param)


@pytest.fixture
def browser(window, page):
    """A browser with the page opened anew; afterwards its console must be empty."""
    window.open(page)
    yield window
    assert window.console() == []


@pytest.fixture(
    params=["chromium", *(pytest.param(one, marks=SLOW) for one in ("firefox", "webkit"))]
)
def everywhere(request, page):
    """The page opened anew in each of three browsers."""
    browser = request.getfixturevalue(request.param)
    browser.open(page)
    yield browser
    assert browser.console() == []


@pytest.fixture
def opened(chromium, page):
    """The same, in Chromium only."""
    chromium.open(page)
    yield chromium
    assert chromium.console() == []


def typed(browser, name, text):
    """Type into an input as a hand does, letter by letter, and leave it."""
    browser.run("const at = document.getElementById(arguments[0]); at.focus(); at.select()", name)
    browser.keys(*text)
    browser.keys(*browser.leave)
