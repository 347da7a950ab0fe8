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


def test_quiet_rattling_and_chattering_are_what_their_names_say():
    (quiet, soft, _), (loud, hard, _) = (settled(name) for name in ("quiet", "rattling"))
    for swept, name, impacts in ((quiet, "quiet", 1.0), (loud, "rattling", 3.0)):
        assert (float(swept.impacts_per_period), float(swept.multiplicity)) == (impacts, 1.0)
        assert settled(name)[2] == "repeated"
    assert soft.impact_velocity.max() < hard.impact_velocity.max()
    speeds = np.sort(hard.impact_velocity.values[:3])
    assert np.diff(speeds).min() > 0.1 * speeds.max() and not loud.permanent_contact
    assert float(loud.xi_rel_max) > 2.0 * float(quiet.xi_rel_max)
    swept, motion, _ = settled("chattering")
    assert float(swept.impacts_per_period) > 20.0 and bool(swept.permanent_contact)
    assert 0 < int(motion.in_contact.sum()) < motion.sizes["time"]


def test_two_answers_are_two_periodic_motions_of_one_beam_at_one_frequency():
    first, other = (settled(name)[0] for name in ("two-answers", "two-answers-other"))
    stops = [STOPS[name] for name in ("two-answers", "two-answers-other")]
    assert stops[0].eta == stops[1].eta and stops[0].structure == stops[1].structure
    assert float(first.multiplicity) == float(other.multiplicity) == 2.0
    assert float(other.xi_rel_max) > 1.5 * float(first.xi_rel_max)
    low, high = stops[0].region
    etas = np.round(np.arange(low, high, 0.01), 4)
    both = orchestrate.sweep(stops[0].structure, eta=etas, direction="both", progress=False)
    up, down = (both.xi_rel_max.sel(direction=word) for word in ("up", "down"))
    assert float(abs(up - down).max()) > 0.1  # its diagram shows two colours


def test_chaos_has_a_positive_exponent_that_lasts():
    """Not so at 2.9: after thousands of periods responses are on a stable orbit of 14."""
    stop = STOPS["chaos"]
    more = {"transient": 60_000, "progress": False}
    found = orchestrate.lyapunov(stop.structure, eta=stop.eta, **more)
    assert found.exponent.item() > 5.0 * found.standard_error.item() > 0.0
    assert settled("chaos")[2] == "irregular"


def test_a_pressed_delamination_stays_shut_below_a_level_and_knocks_above_it():
    below, above = (settled(name) for name in ("pressed", "pressed-open"))
    stops = [STOPS[name] for name in ("pressed", "pressed-open")]
    assert stops[0].structure == stops[1].structure and stops[0].level < stops[1].level
    assert stops[0].structure.clearance < 0.0 < stops[0].structure.preload
    swept, motion, _ = below
    assert float(swept.impacts_per_period) == float(swept.xi_rel_max) == 0.0
    assert motion.in_contact.all() and motion.sizes["impact"] == 0
    assert float(motion.contact_force.min()) > 0.0
    swept, motion, _ = above
    assert float(swept.impacts_per_period) > 1.0 and float(motion.x_rel.max()) > 1e-4
    swept, motion, _ = settled("pressed-hill")
    assert STOPS["pressed-hill"].level == stops[0].level
    assert float(swept.impacts_per_period) > 1.0 and float(motion.x_rel.max()) > 1e-4


TEXTS = (
    "return [...document.querySelectorAll('#tour p')].filter((p) => !p.hidden)"
    ".map((p) => p.innerText)"
)


CLOSE = (
    "[...document.querySelectorAll('[data-close]')].find((one) => one.checkVisibility()).click()"
)


def test_each_stop_is_a_link_that_opens_its_motion(browser):
    for name, stop in STOPS.items():
        browser.run(f"document.querySelector('#tour a[href=\"#tour={name}\"]').click()")
        browser.until(f"return location.hash.startsWith('#tour={name}&')")
        assert browser.chosen() == pytest.approx(stop.eta, rel=1e-8)
        assert browser.run("return explorer.inspector.choice.start") == list(stop.start)
        (step,) = [step for step in TOUR if stop in step.stops]
        (text,) = browser.run(TEXTS)
        assert text.startswith(step.text)
    ready = "return explorer.regions.complete && !explorer.regions.quick"
    for name, opening in (("pressed", "only from 36.2 to 47 Hz"), ("pressed-open", "at every")):
        browser.run(f"document.querySelector('#tour a[href=\"#tour={name}\"]').click()")
        browser.until(ready)
        assert f"The halves open {opening}" in browser.text("status")
    browser.mouse("diagram", (0.4, 0.4))  # its text and links stay until it is closed
    assert "tour" not in browser.run("return location.hash")
    assert browser.run(TEXTS)[0].startswith(step.text)
    browser.run(CLOSE)
    (text,) = browser.run(TEXTS)
    assert not text.startswith(step.text)
    assert not browser.run("return document.querySelectorAll('#tour a[aria-current]').length")
