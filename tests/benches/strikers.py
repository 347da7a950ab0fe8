"""Sound beams that something strikes or kinks: a stop, play, a crack, a loose part, a flake."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from orchestrate.constants import TURN

from .lumped import Faces, Halves
from .recipe import (
    Conditions,
    Maker,
    Specimen,
    bonded_specimen,
    draw_halves,
    draw_log_uniform,
)
from .system import ModalSystem


def peak_deflection(own: Halves, level: float) -> float:
    """Return the deflection of the bonded beam at its resonance, m."""
    one = own.bonded_beam()
    return level / (2.0 * one.zeta * (TURN * one.f) ** 2)


def draw_faces(rng: np.random.Generator, low: float, high: float) -> Faces:
    """Draw a contact law with a frequency between two, Hz."""
    return Faces(frequency=draw_log_uniform(rng, low, high), restitution=rng.uniform(0.3, 0.8))


def draw_with_stops(
    rng: np.random.Generator,
    level: float,
    conditions: Conditions,
    *,
    place: tuple[float, float] = (0.15, 0.8),
    frequency: tuple[float, float] = (150.0, 600.0),
    sides: Sequence[float] = (1.0,),
) -> Specimen:
    """Draw a bonded beam that strikes stops at a place, parts of its deflection without them."""
    own, sign = draw_halves(rng), float(rng.choice([-1.0, 1.0]))
    one, faces = own.bonded_beam(), draw_faces(rng, *frequency)
    gap = peak_deflection(own, level) * rng.uniform(*place)
    gaps = gap * rng.uniform(0.8, 1.2, len(sides))
    rows = sign * np.array(sides)[:, np.newaxis] / math.sqrt(one.mass)
    system = replace(own.bonded(), contacts=faces.contacts(rows, gaps, one.mass))
    return bonded_specimen(own, system)


def draw_cracked(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a bonded beam with a breathing crack: 5 to 50 % stiffer to one side."""
    own, sign = draw_halves(rng), float(rng.choice([-1.0, 1.0]))
    one = own.bonded_beam()
    stiffer = one.f * math.sqrt(rng.uniform(0.05, 0.5))
    faces = Faces(law="linear", frequency=stiffer, restitution=0.97)
    row = np.array([[sign / math.sqrt(one.mass)]])
    system = replace(own.bonded(), contacts=faces.contacts(row, np.zeros(1), one.mass))
    return bonded_specimen(own, system)


def draw_with_part(
    rng: np.random.Generator, level: float, conditions: Conditions, *, loose: bool
) -> Specimen:
    """Draw a bonded beam with a loose part that rattles in its seat, or with a sprung flake."""
    own = draw_halves(rng)
    one, faces = own.bonded_beam(), draw_faces(rng, 400.0, 1000.0)
    mass = one.mass * draw_log_uniform(rng, 0.003, 0.03 if loose else 0.01)
    roots = np.sqrt([one.mass, mass])
    sides = [[-1.0, 1.0], [1.0, -1.0]] if loose else [[-1.0, 1.0]]
    play = 0.5 * peak_deflection(own, level) * rng.uniform(0.02, 0.5) if loose else 0.0
    f = rng.uniform(3.0, 8.0) if loose else one.f * rng.uniform(0.5, 1.3)
    system = ModalSystem(
        frequency=TURN * np.array([one.f, f]),
        damping_ratio=np.array([one.zeta, 0.02]),
        participation=roots,
        output_rows=np.array([[1.0, 0.0], [1.0, 0.0]]) / roots,
        contacts=faces.contacts(
            np.array(sides) / roots, np.full(len(sides), play), one.mass * mass / (one.mass + mass)
        ),
    )
    return bonded_specimen(own, system)


STRIKERS: dict[str, Maker] = {
    "stop": draw_with_stops,
    "graze": partial(draw_with_stops, place=(0.8, 0.97)),
    "stiff stop": partial(draw_with_stops, frequency=(800.0, 1500.0)),
    "play": partial(draw_with_stops, frequency=(200.0, 1000.0), sides=(1.0, -1.0)),
    "crack": draw_cracked,
    "loose part": partial(draw_with_part, loose=True),
    "flake": partial(draw_with_part, loose=False),
}
