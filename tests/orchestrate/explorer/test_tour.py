"""The guided tour shows what it says: each of its motions is computed through the FMU."""

import functools

import numpy as np
import pytest

import orchestrate
from orchestrate.constants import GRAVITY
from orchestrate.explorer.tour import TOUR
from orchestrate.flags import flag_words

STOPS = {stop.name: stop for step in TOUR for stop in step.stops}


@functools.cache
def settled(name):
    """The response that a stop of the tour leads to, and its impacts over ten periods."""
    stop = STOPS[name]
    shaken = {"eta": stop.eta}
    if stop.level:
        frequency = stop.eta * stop.structure.omega
        shaken = {"frequency": frequency, "amplitude": stop.level * GRAVITY / frequency**2}
    asked = {"start": stop.start, "progress": False}
    motion = orchestrate.simulate(stop.structure, **shaken, **asked, transient=700, periods=10)
    shaken = {name: [value] for name, value in shaken.items()}
    swept = orchestrate.sweep(stop.structure, **shaken, **asked, direction="given").squeeze()
    decided = flag_words(swept.multiplicity_decided.attrs)[int(swept.multiplicity_decided)]
    return swept, motion, decided


MOTIONS = {  # impacts a period at least, periods of the response, whose gap its own is larger than
    "quiet": (1.0, 1.0, None),
    "rattling": (3.0, 1.0, "quiet"),
    "chattering": (20.0, None, None),
    "two-answers": (0.0, 2.0, None),
    "two-answers-other": (0.0, 2.0, "two-answers"),
    "pressed": (0.0, None, None),
    "pressed-open": (1.0, None, "pressed"),
    "pressed-hill": (1.0, None, "pressed"),
    "chaos": (0.0, 0.0, None),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_each_stop_is_what_it_says(name):
    least, periods, smaller = MOTIONS[name]
    swept, motion, decided = settled(name)
    assert swept.impacts_per_period >= least and periods in (None, float(swept.multiplicity))
    assert decided == ("irregular" if name == "chaos" else "repeated") or periods is None
    if smaller:
        assert float(swept.xi_rel_max) > 1.5 * float(settled(smaller)[0].xi_rel_max)
        assert STOPS[smaller].structure == STOPS[name].structure
    shut = name == "pressed"
    assert bool(motion.in_contact.all()) == shut == (motion.sizes["impact"] == 0)
    assert name == "chaos" or bool(swept.permanent_contact) == (name in ("chattering", "pressed"))


def test_the_diagram_of_two_answers_shows_two_colours():
    stop, (low, high) = STOPS["two-answers"], STOPS["two-answers"].region
    etas = np.round(np.arange(low, high, 0.01), 4)
    both = orchestrate.sweep(stop.structure, eta=etas, direction="both", progress=False)
    assert float(abs(both.xi_rel_max.diff("direction")).max()) > 0.1


def test_chaos_has_a_positive_exponent_that_lasts():
    """Not so at 2.9: after thousands of periods responses are on a stable orbit of 14."""
    stop = STOPS["chaos"]
    more = {"transient": 60_000, "progress": False}
    found = orchestrate.lyapunov(stop.structure, eta=stop.eta, **more)
    assert found.exponent.item() > 5.0 * found.standard_error.item() > 0.0


TEXT = """
const shown = [...document.querySelectorAll("#tour p")].filter((p) => !p.hidden);
return shown.length === 1 ? shown[0].innerText : "";
"""
CLOSE = "document.querySelector('#tour p:not([hidden]) [data-close]').click()"


def test_each_stop_is_a_link_that_opens_its_motion(browser):
    for name, stop in STOPS.items():
        browser.run(f"document.querySelector('#tour a[href=\"#tour={name}\"]').click()")
        browser.until(f"return location.hash.startsWith('#tour={name}&')")
        assert browser.chosen() == pytest.approx(stop.eta, rel=1e-8)
        assert browser.run("return explorer.inspector.choice.start") == list(stop.start)
        (step,) = [step for step in TOUR if stop in step.stops]
        assert browser.run(TEXT).startswith(step.text)
    ready = "return explorer.regions.complete && !explorer.regions.quick"
    for name, opening in (("pressed", "only from 36.2 to 47 Hz"), ("pressed-open", "at every")):
        browser.run(f"document.querySelector('#tour a[href=\"#tour={name}\"]').click()")
        browser.until(ready)
        assert f"The halves open {opening}" in browser.text("status")
    browser.mouse("diagram", (0.4, 0.4))  # its text and links stay until it is closed
    assert "tour" not in browser.run("return location.hash")
    assert browser.run(TEXT).startswith(step.text)
    browser.run(CLOSE)
    text = browser.run(TEXT)
    assert text and not text.startswith(step.text)
    assert not browser.run("return document.querySelectorAll('#tour a[aria-current]').length")
