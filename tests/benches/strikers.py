"""Sound beams that something strikes or kinks: stops, play, cracks, parts, bearings, fixtures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.linalg import eigh

from orchestrate.constants import TURN

from .lumped import Clamp, Faces, Halves, in_rattling_clamp
from .recipe import Conditions, Maker, Specimen, bonded_specimen, draw_halves, draw_log_uniform
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


def draw_with_washer(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a bonded beam with a spring washer, pressed on it by less than lifts it at resonance."""
    own = draw_halves(rng)
    one, faces = own.bonded_beam(), draw_faces(rng, 600.0, 1500.0)
    masses = one.mass * np.array([1.0, draw_log_uniform(rng, 0.001, 0.01)])
    turns = TURN * np.array([one.f, rng.uniform(150.0, 400.0)])
    spring, between = (masses * turns**2)[1], np.array([[1.0, -1.0], [-1.0, 1.0]])
    stiffness = np.diag([masses[0] * turns[0] ** 2, 0.0]) + spring * between
    squares, shapes = eigh(stiffness, np.diag(masses))
    lifts = level / (2.0 * one.zeta) / turns[1] ** 2  # m, by the washer's inertia
    gap, play = shapes[1] - shapes[0], -lifts * rng.uniform(0.2, 0.9)
    system = ModalSystem(
        frequency=np.sqrt(squares),
        damping_ratio=np.array([one.zeta, 0.02]),
        participation=shapes.T @ masses,
        output_rows=np.array([shapes[0], shapes[0]]),
        contacts=faces.contacts(gap[np.newaxis], np.array([play]), masses[1]),
    )
    return bonded_specimen(own, system)


def draw_in_bearing(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a bonded beam whose root has a little play in a hard, hardly centred bearing."""
    own = draw_halves(rng)
    balls = Faces(
        law="hertz",
        frequency=draw_log_uniform(rng, 600.0, 1500.0),
        restitution=rng.uniform(0.5, 0.9),
    )
    clamp = Clamp(
        faces=balls,
        play=draw_log_uniform(rng, 5e-6, 5e-5),
        mass=rng.uniform(0.05, 0.3),
        centring=draw_log_uniform(rng, 0.1, 1.0),
    )
    return bonded_specimen(own, in_rattling_clamp(own.bonded(), own.bonded_beam().mass, clamp))


def draw_on_fixture(rng: np.random.Generator, level: float, conditions: Conditions) -> Specimen:
    """Draw a bonded beam on a fixture whose own mode is 1.1 to 3 times the beam's frequency."""
    own, mass = draw_halves(rng), rng.uniform(0.3, 3.0)
    stiffness = (1.0 + mass) * draw_log_uniform(rng, 1.1, 3.0) ** 2
    fixture = Clamp(faces=Faces(), mass=mass, centring=stiffness)
    system = in_rattling_clamp(own.bonded(), own.bonded_beam().mass, fixture)
    return bonded_specimen(own, replace(system, contacts=None))


STRIKERS: dict[str, Maker] = {
    "stop": draw_with_stops,
    "graze": partial(draw_with_stops, place=(0.8, 0.97)),
    "stiff stop": partial(draw_with_stops, frequency=(800.0, 1500.0)),
    "play": partial(draw_with_stops, frequency=(200.0, 1000.0), sides=(1.0, -1.0)),
    "crack": draw_cracked,
    "loose part": partial(draw_with_part, loose=True),
    "flake": partial(draw_with_part, loose=False),
    "washer": draw_with_washer,
    "bearing": draw_in_bearing,
    "fixture": draw_on_fixture,
}
