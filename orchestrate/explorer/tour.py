"""Texts and motions of the guided tour, six steps for a first visitor.

Numbers with a unit stand in braces in the texts, as ``{30 Hz}`` or ``{0.5 g}``, and are
shown in the units of the page.
That a step shows what it says is computed by a test, through the FMU.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal
from typing import Any

from ..model import Structure
from ..units import FACTORS

START = (0.0, 0.0, 0.0, 0.0)
OTHER = (-0.055, -0.041, -2.263, -2.141)  # leads to the second motion at 1.3
OMEGA = 2.0 * math.pi * 40.0  # of the pressed beam, whose other numbers are the paper's, rad/s
PRESSED: dict[str, Any] = {
    "region": (0.25, 1.5),
    "changes": {
        **{"k1": OMEGA**2, "k2": 1.2 * OMEGA**2, "d1": 0.01 * OMEGA, "d2": 0.01 * OMEGA},
        "clearance": -5e-5,
    },
}
QUANTITY = re.compile(r"\{([\d.]+) (Hz|mm|g)\}")  # in a text
KINDS = {"Hz": "frequency", "mm": "length", "g": "acceleration"}
SPELLED = {"um": "µm", "m/s2": "m/s²"}
USUAL = {kind: unit for unit, kind in KINDS.items()}


@dataclass(frozen=True)
class View:
    """A motion shown by the tour: its structure, frequency, start state and diagram range."""

    name: str  # in the link `#tour=NAME`
    label: str  # of its link, where a step has several
    eta: float  # frequency ratio, with the amplitude 1/eta^2 m
    start: tuple[float, ...] = START  # state at phase 0: x1, x2 in m, v1, v2 in m/s
    region: tuple[float, float] = (0.1, 8.0)  # frequency ratios of the diagram
    direction: str = "up"  # of its sweep
    changes: dict[str, float] = field(default_factory=dict)  # parameters that are not the paper's
    # peak acceleration of the box in g, held at all frequencies; 0: the paper's amplitude 1/eta^2 m
    level: float = 0.0

    @property
    def link_query(self) -> str:
        low, high = self.region
        start = ",".join(f"{value:g}" for value in self.start)
        level = {"g": self.level} if self.level else {}
        words = {"from": low, "to": high, "direction": self.direction, **self.changes, **level}
        pairs = [f"{name}={value}" for name, value in words.items()]
        return "&".join([*pairs, f"eta={self.eta}", f"start={start}"])

    @property
    def structure(self) -> Structure:
        return Structure().replace(**self.changes)


@dataclass(frozen=True)
class Step:
    """A step of the tour: its title, its text, and one or two views."""

    title: str
    text: str
    stops: tuple[View, ...]


STEPS = (
    Step(
        "Quiet",
        "A delaminated beam, split along its middle into two halves, is shaken. Well above its "
        "resonance the halves tap each other once in each shaking period, always in the same way. "
        "In the diagram that is one dot: the gap is the same at each period's start. An "
        "undamaged beam would be silent.",
        (View("quiet", "", 1.7),),
    ),
    Step(
        "Rattling",
        "Shaken more slowly, the halves part further and strike three times in each period, with "
        "three different speeds. Still it repeats: one dot. Press Sound to hear the rhythm.",
        (View("rattling", "", 0.7),),
    ),
    Step(
        "Chattering",
        "Very slow shaking: the halves bounce like a ball that is let fall, ever faster and lower, "
        "until they stick together and move as one, the shaded times. Then they part again. Each "
        "period has more than twenty impacts.",
        (View("chattering", "", 0.3),),
    ),
    Step(
        "Two answers",
        "One beam, one frequency, two motions: which one comes depends on how it began. So a test "
        "that sweeps upwards and one that sweeps downwards can disagree: upwards is blue here, "
        "downwards orange.",
        (
            View("two-answers", "from rest", 1.3, START, (1.1, 1.5), "both"),
            View("two-answers-other", "the other, wider one", 1.3, OTHER, (1.1, 1.5), "both"),
        ),
    ),
    Step(
        "Chaos",
        "Nothing is random here, and yet it never repeats: a cloud of dots in the diagram. Two "
        "motions that begin almost alike soon have nothing in common; the exponent, above zero, "
        "says how soon. Listen: no rhythm stays.",
        (View("chaos", "", 2.86),),
    ),
    Step(
        "Pressed shut",
        "Pressed together by {0.05 mm}, the halves stay shut at {30 Hz} and {0.5 g}: no test "
        "at this frequency and level finds the delamination. Nearer to their own frequency, or "
        "shaken harder, they open and knock.",
        (
            View("pressed", "{0.5 g} at {30 Hz}: shut", 0.75, level=0.5, **PRESSED),
            View("pressed-hill", "{0.5 g} at {41 Hz}: open", 1.025, level=0.5, **PRESSED),
            View("pressed-open", "{3 g} at {30 Hz}: open", 0.75, level=3.0, **PRESSED),
        ),
    ),
)


def convert_quantities(text: str, units: Mapping[str, str]) -> str:
    def format_quantity(match: re.Match[str]) -> str:
        number, unit = match.groups()
        sizes = FACTORS[KINDS[unit]]
        word = units[KINDS[unit]]
        scale = sizes[unit] / (OMEGA if word == "eta" else sizes[word])
        value = format(Decimal(f"{float(number) * scale:.4g}"), "f")  # without an exponent
        return f"η = {value}" if word == "eta" else f"{value} {SPELLED.get(word, word)}"

    return QUANTITY.sub(format_quantity, text)


def tour_in_units(units: Mapping[str, str]) -> tuple[Step, ...]:
    steps = []
    for step in STEPS:
        labels = (convert_quantities(stop.label, units) for stop in step.stops)
        stops = (replace(stop, label=label) for stop, label in zip(step.stops, labels, strict=True))
        steps.append(Step(step.title, convert_quantities(step.text, units), tuple(stops)))
    return tuple(steps)


TOUR = tour_in_units(USUAL)
