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
def first(opened, tmp_path, exported):
    """The page that a newcomer opens."""
    opened.open(explore(output=tmp_path / "explorer.html"))
    opened.until(MOVED)
    return opened


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
    first.run(WORDS, "button", "Other motions")
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


def test_a_level_at_which_the_beam_shuts_shows_the_motion_there(opened):
    """It goes on from an open motion, made smaller: its faces touch then, and do not overlap."""
    opened.run(WORDS, "a", "6 Pressed shut")
    opened.until(MOVED)
    for level, sentence in (("1.2", "impacts a period"), ("0.9", "stay closed: no impact")):
        typed(opened, "level", level)
        opened.until(MOVED)
        assert sentence in opened.text("sentence")
        assert f"acceleration of the box, g{level}" in opened.text("numbers")
    typed(opened, "gap-number", "-0.1")  # pressed harder: from closed it stays closed
    opened.until(MOVED)
    assert "stay closed" in opened.text("sentence")
    for gap in ("0.001", "-0.001"):  # open at rest, then pressed: the faces may not overlap
        typed(opened, "gap-number", gap)
        opened.until(MOVED)
        assert "impacts a period" in opened.text("sentence")


def test_from_which_level_on_a_pressed_beam_opens_is_the_closed_forms(opened):
    opened.run(WORDS, "a", "6 Pressed shut")
    opened.until(MOVED)
    opened.until("return explorer.regions.complete && !explorer.regions.quick")
    assert "The halves open only from 36.2 to 47 Hz. A dot at 0" in opened.text("status")
    for hertz in (30.0, 20.0, 55.0):
        typed(opened, "hertz", f"{hertz:g}")
        opened_from(opened, hertz)
    # halves that differ: at the natural frequency of both together their dampers count
    changed = (
        "explorer.change({ ...explorer.structure, m2: 1.5, d2: 60 }, { unit: 'g', value: 1e-3 })"
    )
    opened.run(changed)
    opened.until(MOVED)
    typed(opened, "hertz", "37.3")
    opened_from(opened, 37.3)


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


def test_a_button_leads_to_the_fields_of_ones_own_beam(opened):
    opened.until(MOVED)
    opened.click("own-beam")
    assert opened.get("units", "value") == "own"
    assert opened.run("return document.activeElement.id") == "f1"
    assert opened.run("return document.getElementById('own-note').checkVisibility()")


def test_silence_lets_the_machines_sound_go(opened):
    opened.until(MOVED)
    opened.click("listen")
    opened.until("return explorer.inspector.sound.playing")
    opened.click("listen")
    opened.until("return explorer.inspector.sound.context.state === 'suspended'")
    opened.click("listen")
    opened.until("return explorer.inspector.sound.context.state === 'running'")


def test_a_motion_that_cannot_be_computed_is_not_shown_as_the_one_before(opened):
    opened.until(MOVED)
    before = opened.text("sentence")
    opened.run("explorer.inspect(explorer.eta, [1, -1, 0, 0])")  # the masses overlap
    opened.until("return document.querySelector('main').dataset.motion === 'failed'")
    assert opened.text("sentence").startswith("This motion cannot be computed")
    assert "impacts a period" not in opened.text("numbers")
    opened.run("explorer.inspect(explorer.eta, [0, 0, 0, 0])")
    opened.until(MOVED)
    assert opened.text("sentence") == before
    assert opened.run("return document.querySelector('main').dataset.motion") == "there"


def test_a_motion_that_waits_for_others_is_not_shown_as_the_one_before(opened):
    """At 1.7 of a new diagram the response goes on from those before: it waits for them."""
    opened.until(MOVED)
    waiting, found, state, said = opened.run("""
        explorer.open(1.05, 1.95);
        explorer.choose(1.7);
        const saved = (name) => {
          document.querySelector(`[data-save="${name}"]`).click();
          return document.getElementById("status").textContent;
        };
        const { inspector, waiting } = explorer;
        const said = ["history.png", "frame.svg", "section.csv", "impacts.csv"].map(saved);
        return [waiting, inspector.found, document.querySelector("main").dataset.motion, said];
    """)
    assert (waiting, found, state) == (True, None, "coming")
    assert said == ["nothing to save yet"] * 4
    opened.until(MOVED)
    assert abs(opened.run("return explorer.inspector.choice.point.eta") - 1.7) < 0.01


def test_other_motions_of_a_frequency_are_not_hinted_at_with_another_beam(opened):
    """At 1.3 there are two; the pressed beam at 30 Hz has one."""
    opened.run("explorer.choose(1.3, true)")
    opened.until(MOVED)
    opened.run(WORDS, "button", "Other motions")
    opened.until("return document.getElementById('basins').dataset.complete === 'true'")
    assert opened.text("hint") == "Other motions: see the coloured map."
    opened.run("window.scrollTo(0, 0)")
    opened.run(WORDS, "a", "6 Pressed shut")
    opened.until(MOVED)
    opened.until("return explorer.basin.tried")
    assert opened.run("return document.getElementById('hint').classList.contains('absent')")
