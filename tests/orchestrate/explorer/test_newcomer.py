"""Six tasks of a newcomer, by what the page shows alone: mouse, keys and what is written there."""

import numpy as np
import pytest

import orchestrate
from orchestrate.explorer.page import explore

from .conftest import typed

MOVED = "return explorer.inspector.found && explorer.inspector.exponent !== undefined"
WORDS = """
const [tag, text] = arguments;
const seen = [...document.querySelectorAll(tag)].filter((one) => one.checkVisibility());
seen.find((one) => one.textContent.trim() === text).click();
"""
CHOICE = """
const option = [...document.querySelectorAll("option")].find((one) => one.text === arguments[0]);
option.selected = true;
option.parentElement.dispatchEvent(new Event("change"));
"""


@pytest.fixture
def first(browser, tmp_path, exported):
    """The page that a newcomer opens."""
    browser.open(explore(output=tmp_path / "explorer.html"))
    browser.until(MOVED)
    return browser


@pytest.mark.slow
def test_six_tasks_are_done_by_the_page_alone(first):
    # a frequency where it is chaotic: "A cloud: chaos."
    first.mouse("diagram", (0.395, 0.5))
    first.until(MOVED)
    assert first.text("sentence").startswith("Chaos: never repeats")
    # hear it
    first.run(WORDS, "button", "Sound (S)")
    first.until("return explorer.inspector.sound.playing")
    # the same picture for a beam of 42 and 55 Hz
    first.run(CHOICE, "your own: Hz, mm, g")
    typed(first, "f1", "42")
    typed(first, "f2", "55")
    first.until("return explorer.regions.complete && !explorer.regions.quick")
    label = first.get("diagram", "aria-label")
    assert "frequency in Hz from 4" in label
    # a second motion at 1.3
    first.run(WORDS, "button", "Reset the whole page")
    typed(first, "eta-number", "1.3")
    first.until(MOVED)
    first.run(WORDS, "button", "Try many starts")
    first.until("return document.getElementById('basins').dataset.complete === 'true'")
    assert first.run("return document.querySelectorAll('#basins li').length") == 2
    before = first.text("sentence")
    assert first.run("return document.querySelectorAll('#basins .now').length") == 1
    first.run("document.querySelector('#basins button').click()")
    first.until(MOVED)
    assert first.text("sentence") != before
    # save what is seen
    first.run("document.querySelector('[aria-label=\"save diagram as PNG\"]').click()")
    assert first.download("diagram_eta1.3.png").read_bytes().startswith(b"\x89PNG")
    # what a pressed delamination does
    first.run(WORDS, "a", "6 Pressed shut")
    first.until(MOVED)
    assert first.text("sentence").startswith("The halves stay closed: no impact.")
    first.run(WORDS, "a", "3 g at 30 Hz: open")
    first.until("return document.getElementById('sentence').textContent.includes('4 impacts')")


def test_on_a_telephone_the_diagram_and_the_fields_of_one_s_own_beam_are_seen(first):
    place = "return document.getElementById(arguments[0]).getBoundingClientRect().top"
    screen = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
    first.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
    try:
        assert first.run(place, "diagram") < 720
        first.run(WORDS, "button", "your own beam")
        assert 0 < first.run(place, "f1") < 800
    finally:
        first.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


BOTTOMS = """
const bottom = (at) => at.getBoundingClientRect().bottom + scrollY;
const last = (name) => Math.max(...[...document.querySelectorAll(`${name} figure`)].map(bottom));
return [last(".side"), last(".motion"), document.getElementById("basin-figure").offsetHeight];
"""


def test_on_a_desktop_both_columns_are_filled_and_no_panel_is_empty(first):
    screen = {"width": 1440, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    first.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
    try:
        side, main, panel = first.run(BOTTOMS)
    finally:
        first.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    assert 0.8 * main < side < 1.2 * main and panel < 200


@pytest.mark.slow
def test_a_map_of_one_colour_is_not_shown(first):
    for eta, hidden, words in (("0.7", True, "No other motion"), ("1.3", False, "Other motions")):
        typed(first, "eta-number", eta)
        first.until(MOVED)
        first.run(WORDS, "button", "Try many starts")
        first.until("return document.getElementById('basins').dataset.complete === 'true'")
        assert first.get("basin-map", "hidden") in ((None, False), ("", True))[hidden]
        assert first.text("hint").startswith(words)


@pytest.mark.slow
def test_from_which_level_on_a_pressed_beam_opens_is_the_closed_forms(browser):
    browser.run(WORDS, "a", "6 Pressed shut")
    browser.until(MOVED)
    browser.until("return explorer.regions.complete && !explorer.regions.quick")
    assert "The halves open only from 36.2 to 47 Hz. A dot at 0" in browser.text("status")
    typed(browser, "hertz", "30")
    opened_from(browser, 30.0)
    # halves that differ: at the natural frequency of both together their dampers count
    changed = (
        "explorer.change({ ...explorer.structure, m2: 1.5, d2: 60 }, { unit: 'g', value: 1e-3 })"
    )
    browser.run(changed)
    browser.until(MOVED)
    typed(browser, "hertz", "37.3")
    opened_from(browser, 37.3)


def opened_from(page, hertz):
    """The page's sentence has the level of `contact_threshold`."""
    page.until(MOVED)
    given = page.run("return explorer.structure")
    parts = {name: given[name] for name in ("m1", "m2", "k1", "k2", "d1", "d2", "clearance", "e")}
    found = orchestrate.contact_threshold(
        orchestrate.Structure(**parts), frequency=[2.0 * np.pi * hertz]
    )
    level = float(found.threshold_acceleration[0]) / 9.80665
    assert f"At this frequency they open from {level:.4g} g on." in page.text("sentence")


@pytest.mark.slow
def test_a_motion_that_cannot_be_computed_is_not_shown_as_the_one_before(browser):
    browser.until(MOVED)
    before = browser.text("sentence")
    browser.run("explorer.inspect(explorer.eta, [1, -1, 0, 0])")  # the masses overlap
    browser.until("return document.querySelector('main').dataset.motion === 'failed'")
    assert browser.text("sentence").startswith("This motion cannot be computed")
    assert "impacts a period" not in browser.text("numbers")
    browser.run("explorer.inspect(explorer.eta, [0, 0, 0, 0])")
    browser.until(MOVED)
    assert browser.text("sentence") == before
    assert browser.run("return document.querySelector('main').dataset.motion") == "there"
