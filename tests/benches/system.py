"""Data of a shaken structure: linear modes with contacts, cubic springs and friction."""

from __future__ import annotations

from dataclasses import dataclass

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


@dataclass(frozen=True)
class ModalSystem:
    """A linear structure as mass-normalised modes, with its nonlinear forces."""

    frequency: Floats  # rad/s, of each mode
    damping_ratio: Floats
    participation: Floats  # `-participation * a` is the modal force of the base's acceleration a
    output_rows: Floats  # (outputs, modes): absolute acceleration is `a + output_rows @ q''`
    contacts: Contacts = None  # type: ignore[assignment]  # None: without any
    springs: CubicSprings = None  # type: ignore[assignment]
    frictions: Frictions = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        rows, empty = np.zeros((0, self.modes)), np.zeros(0)
        for name, kind in (("contacts", Contacts), ("frictions", Frictions)):
            if getattr(self, name) is None:
                object.__setattr__(self, name, kind(rows, empty, empty, empty))
        if self.springs is None:
            object.__setattr__(self, "springs", CubicSprings(rows, empty, empty))

    @property
    def modes(self) -> int:
        """Number of modes."""
        return len(self.frequency)


@dataclass(frozen=True)
class Motion:
    """Result of an integration: accelerations, the state at the end, gaps and forces."""

    # (outputs, steps + 1), absolute acceleration, m/s2, at the ends of all steps
    acceleration: Floats
    # of the modes, at the end
    position: Floats
    velocity: Floats
    # of each contact, m and N
    largest_gap: Floats
    largest_force: Floats
