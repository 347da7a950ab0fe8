"""What a newcomer meets: a level that is the closed form's, a motion that cannot be computed."""

import numpy as np
import pytest

import orchestrate

from .conftest import typed

MOVED = "return explorer.inspector.found && explorer.inspector.exponent !== undefined"
WORDS = """
const [tag, text] = arguments;
const seen = [...document.querySelectorAll(tag)].filter((one) => one.checkVisibility());
seen.find((one) => one.textContent.trim() === text).click();
"""


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
