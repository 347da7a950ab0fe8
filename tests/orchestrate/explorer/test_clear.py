"""The page is clear to someone who sees it first: what it says is true, and nothing jumps."""

import json

import pytest

from .conftest import typed

READY = (
    "return explorer.regions.complete && !explorer.regions.quick && explorer.inspector.found"
    " && explorer.inspector.exponent !== undefined"
)
SEEN = """
const values = [...document.querySelectorAll("input, select")].map(({ id, type, value, checked }) =>
  [id, type === "checkbox" ? checked : value]);
const texts = ["sentence", "numbers", "status", "tour", "command", "motion-command",
  "section-count", "basins", "drive-status"].map((id) =>
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
