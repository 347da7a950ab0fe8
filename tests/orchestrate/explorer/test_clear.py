"""The page is clear to someone who sees it first: what it says is true, and nothing jumps."""

import json

import numpy as np
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


def test_reset_of_a_link_is_what_the_link_shows(browser, page):
    browser.open(page, "#tour=pressed")
    browser.until(READY)
    before = json.loads(browser.run(SEEN))
    browser.run("explorer.choose(1.02)")
    browser.run("document.getElementById('reset').click()")
    browser.until(READY)
    assert json.loads(browser.run(SEEN)) == before


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


def test_a_hint_comes_by_itself(browser):
    browser.run("explorer.choose(1.3, true)")
    browser.until(READY)
    browser.until("return !document.getElementById('hint').classList.contains('absent')")
    assert browser.run("return explorer.basin.few.length") == 2  # of a few starts alone
    assert browser.text("hint") == "There is another motion at this frequency."


def test_where_all_of_a_few_starts_lead_to_one_motion_nothing_hints_at_another(browser):
    browser.run("explorer.choose(1.7, true)")
    browser.until(READY)
    browser.until("return explorer.basin.tried")
    assert browser.run("return explorer.basin.few.length") == 1
    assert browser.run("return explorer.basin.hint(true)") == ""  # whatever the sweeps suggest
    browser.run("explorer.basin.tried = false")
    assert (
        browser.run("return explorer.basin.hint(true)")
        == "There may be another motion at this frequency."
    )


def test_pressed_halves_that_are_shut_are_drawn_as_one_and_shading_has_a_legend(browser, page):
    browser.open(page, "#tour=pressed")
    browser.until(READY)
    drawn = """
    const kept = {};
    const { pictures } = explorer.inspector;
    const old = pictures.show;
    pictures.show = (name, chart, words) => { kept[name] = chart; old(name, chart, words); };
    explorer.inspector.drawMotion();
    pictures.show = old;
    const { series, y, spans } = kept.history;
    const [one, two] = series.filter(({ label }) => label?.startsWith("half"));
    const far = one.y.reduce((most, value, i) => Math.max(most, Math.abs(value - two.y[i])), 0);
    const size = one.y.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
    return [far / size, y.label, spans.length];
    """
    assert "The halves open only from 36.2 to 47 Hz" in browser.text("status")
    far, label, spans = browser.run(drawn)
    assert far < 1e-9 and label == "displacement from rest, mm" and spans == 1
    browser.run("document.querySelector(\"[data-save='history.svg']\").click()")
    assert "stuck together" in browser.download("history*.svg").read_text()


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


def test_in_a_cloud_an_exponent_goes_on_until_its_sign_is_known(browser):
    """After 400 periods at 3.05 it is 0.004 with an error of 0.015."""
    browser.run("explorer.choose(3.05, true, [0, 0, 0, 0])")
    browser.until(READY)
    assert browser.text("sentence").startswith("Chaos: never repeats")


@pytest.mark.parametrize("eta", [2.9, 1.7, 3.05])
def test_the_error_of_the_exponent_covers_the_careful_one(browser, eta):
    browser.run("explorer.choose(arguments[0], true)", eta)
    browser.until(READY)
    found = browser.run("return explorer.inspector.exponent")
    careful = orchestrate.lyapunov(orchestrate.Structure(), eta=eta, progress=False)
    assert abs(found["value"] - careful.exponent.item()) < found["error"] < abs(found["value"])


def test_a_mean_place_makes_no_line_in_the_spectrum(browser, page):
    """The halves that are pressed shut stand beside their springs' own lengths and move as one."""
    browser.open(page, "#tour=pressed")
    browser.until(READY)
    delaminated, bonded = (
        browser.numbers(f"explorer.inspector.spectra.{name}.amplitude")
        for name in ("delaminated", "bonded")
    )
    assert browser.run("return Math.abs(explorer.inspector.found.motion.states[0])") > 1e-6
    slow = slice(0, 32)  # below half of the shaking frequency
    assert delaminated[slow].max() < 1e-7 * delaminated.max()
    assert np.abs(delaminated - bonded).max() < 1e-3 * bonded.max()


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


def test_only_the_sweep_that_the_page_came_with_is_said_to_be_one(browser):
    browser.until(READY)
    browser.run("document.querySelector(\"[data-save='diagram.svg']\").click()")
    assert "sweep by" in browser.download("diagram_eta0.7.svg").read_text()
    browser.run("explorer.open(1.1, 1.3); explorer.choose(1.25, true)")
    browser.until(READY)
    for name in ("diagram", "history"):
        browser.run(f"document.querySelector(\"[data-save='{name}.svg']\").click()")
        text = browser.download(f"{name}_eta1.25.svg").read_text()
        assert "kernel {" in text and "sweep by" not in text
