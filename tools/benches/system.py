"""Data of a shaken structure: linear modes with contacts, cubic springs and friction."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
LAWS = ("linear", "hunt-crossley", "hertz")  # in the order of integrator.c


@dataclass(frozen=True)
class Contacts:
    """Contacts that push where their gap is closed, and never pull.

    Attributes
    ----------
    rows : ndarray
        (contacts, modes): the gap of each, in m, is ``rows @ q + clearance``.
    clearance : ndarray
        m; negative where the faces are pressed into each other.
    stiffness, damping : ndarray
        Depth d and closing speed d' make the force ``k d + c d'`` (``"linear"``),
        ``k d (1 + c d')`` (``"hunt-crossley"``), or that times ``sqrt(d)`` (``"hertz"``).
    law : str
    longest_impact : float
        s; a contact that lasts longer is no impact, and not counted for the restitution.
    """

    rows: Floats
    clearance: Floats
    stiffness: Floats
    damping: Floats
    law: str = "linear"
    longest_impact: float = 2e-3


@dataclass(frozen=True)
class CubicSprings:
    """Forces ``-stiffness ((x + offset)**3 - offset**3)`` along ``x = rows @ q``.

    Attributes
    ----------
    rows : ndarray
        (springs, modes)
    stiffness : ndarray
        N/m3
    offset : ndarray
        m; away from zero the spring is stiffer to one side than to the other, as that of a beam
        which sags: even orders without any impact.
    """

    rows: Floats
    stiffness: Floats
    offset: Floats


@dataclass(frozen=True)
class Frictions:
    """Dry friction along ``rows @ q``, regularised below a speed.

    Attributes
    ----------
    rows : ndarray
        (frictions, modes)
    force : ndarray
        N, whatever the contacts do.
    coefficient : ndarray
        Times the sum of all contact forces: sliding faces rub as long as they are pressed together.
    speed : ndarray
        m/s: the force is ``F v/sqrt(v**2 + speed**2)``.
    """

    rows: Floats
    force: Floats
    coefficient: Floats
    speed: Floats


def empty_contacts(modes: int) -> Contacts:
    """Return a ``Contacts`` without any contact, for a number of modes."""
    empty = np.zeros(0)
    return Contacts(np.zeros((0, modes)), empty, empty, empty)


def empty_springs(modes: int) -> CubicSprings:
    """Return a ``CubicSprings`` without any spring, for a number of modes."""
    return CubicSprings(np.zeros((0, modes)), np.zeros(0), np.zeros(0))


@dataclass(frozen=True)
class ModalSystem:
    """A linear structure as mass-normalised modes, with its nonlinear forces.

    Attributes
    ----------
    frequency : ndarray
        rad/s, of each mode.
    damping_ratio : ndarray
    participation : ndarray
        ``-participation * a`` is the modal force of the base's acceleration a.
    output_rows : ndarray
        (outputs, modes): absolute acceleration is ``a + output_rows @ q''``.
    contacts : Contacts, optional
    springs : CubicSprings, optional
    frictions : Frictions, optional
    """

    frequency: Floats
    damping_ratio: Floats
    participation: Floats
    output_rows: Floats
    contacts: Contacts | None = None
    springs: CubicSprings | None = None
    frictions: Frictions | None = None

    @property
    def modes(self) -> int:
        """Number of modes."""
        return len(self.frequency)


@dataclass(frozen=True)
class Motion:
    """Result of an integration: accelerations, peaks, gaps, impacts and restitution.

    Attributes
    ----------
    acceleration : ndarray
        (outputs, steps + 1), absolute acceleration, m/s2, at the ends of all steps.
    position, velocity : ndarray
        Of the modes, at the end.
    largest_gap, largest_force : ndarray
        Of each contact, m and N.
    time_open : ndarray
        s.
    impacts : ndarray
        Contacts that were short.
    restitution : ndarray
        Sum of speeds after these over that before them; NaN without any.
    closing_speed : ndarray
        Mean before an impact, m/s; NaN without any.
    spring_peaks : ndarray
        Largest absolute deflection of each cubic spring, m.
    """

    acceleration: Floats
    position: Floats
    velocity: Floats
    largest_gap: Floats
    largest_force: Floats
    time_open: Floats
    impacts: Floats
    restitution: Floats
    closing_speed: Floats
    spring_peaks: Floats = field(default_factory=lambda: np.zeros(0))
