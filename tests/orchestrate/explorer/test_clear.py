"""The page is clear to someone who sees it first: what it says is true, and nothing jumps."""

import json

import pytest

import orchestrate

from ...sparing import ordinary
from .conftest import typed

READY = (
    "return explorer.regions.complete && !explorer.regions.quick && explorer.inspector.found"
    " && explorer.inspector.exponent !== undefined"
)
SEEN = """
const values = [...document.querySelectorAll("input, select")].map(({ id, type, value, checked }) =>
  [id, type === "checkbox" ? checked : value]);
const texts = ["sentence", "numbers", "status", "tour", "command", "motion-command",
  "record-status", "section-count", "basins", "drive-status"].map((id) =>
  [id, document.getElementById(id).textContent, document.getElementById(id).hidden]);
const { diagram } = explorer.regions;
const open = [...document.querySelectorAll("#tour p")].map((text) => text.hidden);
return JSON.stringify([values, texts, diagram.points.length, diagram.low, diagram.high, open,
  location.hash, explorer.inspector.periods, explorer.inspector.animation.speed]);
"""


def test_reset_brings_back_the_page_as_it_was_opened(browser):
    browser.until(READY)
    before = json.loads(browser.run(SEEN))
    typed(browser, "pitch", "9")
    typed(browser, "periods", "3")
    browser.run(
        "for (const [id, value] of [['units', 'own'], ['direction', 'both'], ['speed', '2']]) {"
        "  const at = document.getElementById(id); at.value = value;"
        "  at.dispatchEvent(new Event('input')); at.dispatchEvent(new Event('change')); }"
        "document.getElementById('beside').click();"
    )
    typed(browser, "f1", "42")
    browser.run("explorer.open(1.1, 1.3); explorer.choose(1.23456)")
    browser.until(READY)
    browser.run("document.querySelector('#tour a').click()")
    browser.until(READY)
    browser.run(
        "explorer.change({ ...explorer.structure, e: 0.6 })"
    )  # the diagram is still to come
    browser.run("document.getElementById('reset').click()")
    browser.until(READY)
    after = json.loads(browser.run(SEEN))
    for was, now in zip(before, after, strict=True):
        assert now == was


def hinted(browser):
    return browser.run(
        "return document.getElementById('hint').checkVisibility({ checkVisibilityCSS: true })"
    )


@pytest.mark.parametrize(("eta", "others"), [(1.3, True), (1.7, False)])
def test_where_another_motion_is_known_the_page_says_so(browser, eta, others):
    browser.run("explorer.choose(arguments[0], true)", eta)
    browser.until(READY)
    browser.until("return explorer.basin.few.length")
    browser.run("document.getElementById('others').click()")
    browser.until("return document.getElementById('basins').dataset.complete === 'true'")
    rows = browser.run(
        "return [...document.querySelectorAll('#basins li')].map((row) => row.innerText)"
    )
    assert len(rows) == 1 + others
    words = (
        "Other motions: see the coloured map." if others else "No other motion from 4096 starts."
    )
    assert hinted(browser) and browser.text("hint") == words
    assert sum("shown now" in row for row in rows) == 1
    if others:
        now = browser.run("return document.querySelector('#basins .now').parentElement.textContent")
        browser.run("document.querySelector('#basins button').click()")
        browser.until(READY)
        marked = "return document.querySelector('#basins .now').parentElement.textContent"
        assert browser.run(marked) != now and hinted(browser)


EXPONENTS = {  # of a motion that has not repeated: value and error, headline, label
    "chaos": (0.05, 0.01, "Chaos: never repeats", "chaotic"),
    "converging": (-0.05, 0.01, "Has not repeated within 50 periods, but converges", "converges"),
    "undecided": (-0.00103, 0.002, "Nearly repeats, or is still settling", "undecided"),
    "undecided above zero": (0.009, 0.01, "Nearly repeats, or is still settling", "undecided"),
}


@pytest.mark.parametrize("name", ordinary(EXPONENTS, ["chaos", "undecided above zero"]))
def test_an_exponent_within_its_error_decides_nothing(browser, name):
    value, error, headline, label = EXPONENTS[name]
    browser.run("explorer.choose(2.9, true)")
    browser.until(READY)
    assert browser.run("return explorer.inspector.found.response.multiplicity") == 0
    browser.run(
        "const [value, error] = arguments;"
        "explorer.inspector.takeSpectra({ exponent: { value, error } })",
        value,
        error,
    )
    assert browser.text("sentence").startswith(headline)
    assert label in browser.text("exponent")
    undecided = name.startswith("undecided")
    for text in (browser.text("sentence"), browser.text("exponent")):
        assert ("undecided here" in text) == undecided
    assert "undecided here" in browser.text("help-exponent")


@pytest.mark.parametrize("eta", [2.9, 1.7, 3.05])
def test_the_error_of_the_exponent_covers_the_careful_one(browser, eta):
    browser.run("explorer.choose(arguments[0], true)", eta)
    browser.until(READY)
    found = browser.run("return explorer.inspector.exponent")
    careful = orchestrate.lyapunov(orchestrate.Structure(), eta=eta, progress=False)
    assert abs(found["value"] - careful.exponent.item()) < found["error"] < abs(found["value"])


LOUD = (
    "return Boolean(explorer.inspector.sound.source?.buffer.getChannelData(0)"
    ".some((value) => value !== 0))"
)


def test_halves_that_stay_shut_are_silent_until_they_knock_again(browser, page):
    browser.open(page, "#tour=pressed")
    browser.until(READY)
    browser.run("document.getElementById('listen').click()")
    browser.until("return document.getElementById('listen-word').textContent === 'Stop sound'")
    browser.until(READY)
    assert not browser.run(LOUD)
    browser.run("document.querySelector('a[href=\"#tour=pressed-open\"]').click()")
    browser.until(LOUD)
