"""Data of a shaken structure: linear modes with contacts, cubic springs and friction."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
LAWS = ("linear", "hunt-crossley", "hertz")  # in the order of integrator.c


@dataclass(frozen=True)
class Contacts:
    """Contacts that push where their gap is closed, and never pull."""

    rows: Floats  # (contacts, modes): the gap of each, in m, is `rows @ q + clearance`
    clearance: Floats  # m; negative where the faces are pressed into each other
    # depth d and closing speed d' make the force `k d + c d'` (`"linear"`), `k d (1 + c d')`
    # (`"hunt-crossley"`), or that times `sqrt(d)` (`"hertz"`)
    stiffness: Floats
    damping: Floats
    law: str = "linear"
    # s; a contact that lasts longer is no impact, and not counted for the restitution
    longest_impact: float = 2e-3


@dataclass(frozen=True)
class CubicSprings:
    """Forces ``-stiffness ((x + offset)**3 - offset**3)`` along ``x = rows @ q``."""

    rows: Floats  # (springs, modes)
    stiffness: Floats  # N/m3
    # m; away from zero the spring is stiffer to one side than to the other, as that of a beam which
    # sags: even orders without any impact
    offset: Floats


@dataclass(frozen=True)
class Frictions:
    """Dry friction along ``rows @ q``, regularised below a speed."""

    rows: Floats  # (frictions, modes)
    force: Floats  # N, whatever the contacts do
    # times the sum of all contact forces: sliding faces rub as long as they are pressed together
    coefficient: Floats
    speed: Floats  # m/s: the force is `F v/sqrt(v**2 + speed**2)`


def empty_contacts(modes: int) -> Contacts:
    """Return a ``Contacts`` without any contact, for a number of modes."""
    empty = np.zeros(0)
    return Contacts(np.zeros((0, modes)), empty, empty, empty)


def empty_springs(modes: int) -> CubicSprings:
    """Return a ``CubicSprings`` without any spring, for a number of modes."""
    return CubicSprings(np.zeros((0, modes)), np.zeros(0), np.zeros(0))


@dataclass(frozen=True)
class ModalSystem:
    """A linear structure as mass-normalised modes, with its nonlinear forces."""

    frequency: Floats  # rad/s, of each mode
    damping_ratio: Floats
    participation: Floats  # `-participation * a` is the modal force of the base's acceleration a
    output_rows: Floats  # (outputs, modes): absolute acceleration is `a + output_rows @ q''`
    contacts: Contacts | None = None
    springs: CubicSprings | None = None
    frictions: Frictions | None = None

    @property
    def modes(self) -> int:
        """Number of modes."""
        return len(self.frequency)


@dataclass(frozen=True)
class Motion:
    """Result of an integration: accelerations, peaks, gaps, impacts and restitution."""

    # (outputs, steps + 1), absolute acceleration, m/s2, at the ends of all steps
    acceleration: Floats
    # of the modes, at the end
    position: Floats
    velocity: Floats
    # of each contact, m and N
    largest_gap: Floats
    largest_force: Floats
    time_open: Floats  # s
    impacts: Floats  # contacts that were short
    restitution: Floats  # sum of speeds after these over that before them; NaN without any
    closing_speed: Floats  # mean before an impact, m/s; NaN without any
    # largest absolute deflection of each cubic spring, m
    spring_peaks: Floats = field(default_factory=lambda: np.zeros(0))
