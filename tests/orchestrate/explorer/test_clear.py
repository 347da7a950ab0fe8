"""The page is clear to someone who sees it first: what it says is true, and nothing jumps."""

import json

import pytest

import orchestrate

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


@pytest.mark.slow
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


EXPONENTS = {  # of a motion that has not repeated: value and error, headline, label
    "chaos": (0.05, 0.01, "Chaos: never repeats", "chaotic"),
    "converging": (-0.05, 0.01, "Has not repeated within 50 periods, but converges", "converges"),
    "undecided": (-0.00103, 0.002, "Nearly repeats, or is still settling", "undecided"),
    "undecided above zero": (0.009, 0.01, "Nearly repeats, or is still settling", "undecided"),
}


@pytest.mark.slow
def test_an_exponent_has_an_error_that_decides(browser):
    """It covers the careful exponent, and an exponent within it decides nothing."""
    for eta in (1.7, 3.05, 2.9):
        browser.run("explorer.inspect(arguments[0], [0, 0, 0, 0])", eta)
        browser.until(READY)
        found = browser.run("return explorer.inspector.exponent")
        careful = orchestrate.lyapunov(orchestrate.Structure(), eta=eta, progress=False)
        assert abs(found["value"] - careful.exponent.item()) < found["error"] < abs(found["value"])
    assert browser.run("return explorer.inspector.found.response.multiplicity") == 0
    for name, (value, error, headline, label) in EXPONENTS.items():
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
