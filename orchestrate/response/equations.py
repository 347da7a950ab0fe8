"""Accelerations from the state by (6); in permanent contact those of both masses as one.

In space a mass feels springs, dampers and the other mass; relative to the box minus the box's
acceleration, ``a Omega^2 sin(phase)``, comes to it.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..access import gap_between
from ..structures import Structure

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


class Rates(NamedTuple):
    """Stiffness and damping over mass, 1/s2 and 1/s: of mass 1, of mass 2, of both as one.

    Attributes
    ----------
    stiffness, damping : ndarray, shape (3, n)
        A column a structure; of shape (2, ...) where it is what each mass feels.
    push : ndarray, shape (2, n), optional
        Acceleration of each mass in contact by the other one's spring, which a clearance loads
        where the mass itself is at 0, m/s2; None where there is no clearance.
    """

    stiffness: Floats
    damping: Floats
    push: Floats | None = None

    @classmethod
    def from_structures(cls, structures: Iterable[Structure]) -> Rates:
        """Return the rates of n structures."""
        rows = [(s.m1, s.m2, s.k1, s.k2, s.d1, s.d2, s.gap_offset) for s in structures]
        m1, m2, k1, k2, d1, d2, offset = np.array(rows).T
        both = m1 + m2
        stiffness = [k1 / m1, k2 / m2, (k1 + k2) / both]
        damping = [d1 / m1, d2 / m2, (d1 + d2) / both]
        push = np.array([k2 / both, -k1 / both]) * offset if offset.any() else None
        return cls(np.array(stiffness), np.array(damping), push)

    def effective(self, touching: Flags) -> Rates:
        """Return the rates that act on each mass: its own, or those of both while they touch.

        Parameters
        ----------
        touching : ndarray of bool, shape (n, ...)
        """

        def columns(rates: Floats) -> Floats:
            return rates.reshape(*rates.shape, *(1,) * (touching.ndim - 1))

        def chosen(rates: Floats) -> Floats:
            each = columns(rates)
            return np.where(touching, each[2:], each[:2])

        push = None if self.push is None else np.where(touching, columns(self.push), 0.0)
        return Rates(chosen(self.stiffness), chosen(self.damping), push)

    def in_flight(self, indices: NDArray[np.intp]) -> Rates:
        """Return stiffness and damping in flight of the structures at these indices."""
        return Rates(self.stiffness[:2, indices], self.damping[:2, indices])

    def acceleration(self, x: Floats, v: Floats) -> Floats:
        """Return each mass's acceleration in space by the rates that act on it, shape (2, ...)."""
        restoring = self.restoring_acceleration(x, v)
        return restoring if self.push is None else restoring + self.push

    def restoring_acceleration(self, x: Floats, v: Floats) -> Floats:
        """Return ``-(k x + d v)/m`` of each mass, by the rates that act on it; shape (2, ...)."""
        acceleration: Floats = -(self.stiffness * x + self.damping * v)
        return acceleration


def in_touch(states: Floats, gap_offset: ArrayLike = 0.0) -> Flags:
    """Return whether states are of permanent contact: the same velocity and no gap.

    Parameters
    ----------
    states : ndarray, shape (..., 4)
        x1, x2, v1, v2.
    gap_offset : array_like
        The gap between unloaded springs, as by :func:`.access.gap_between`.
    """
    together = gap_between(states, gap_offset) == 0.0
    touching: Flags = together & (states[..., 2] == states[..., 3])
    return touching


def absolute_accelerations(
    states: Floats, structure: Structure, touching: Flags | None = None
) -> Floats:
    """Return accelerations in space: what an accelerometer on a mass reads between impacts.

    Parameters
    ----------
    states : ndarray, shape (n, 4)
        x1, x2 in m and v1, v2 in m/s, relative to the box.
    structure : Structure
    touching : ndarray of bool, shape (n,), optional
        Whether there is permanent contact; by default as :func:`in_touch` finds it.

    Returns
    -------
    ndarray, shape (n, 2)
        m/s2; in permanent contact, and of a bonded structure, with the contact force.

    Examples
    --------
    >>> from orchestrate.structures import Structure
    >>> absolute_accelerations(np.array([[-1.0, 1.0, 0.0, 0.0]]), Structure(d1=0.0, d2=0.0))
    array([[ 1. , -1.2]])
    """
    together = in_touch(states, structure.gap_offset) if touching is None else touching
    felt = Rates.from_structures([structure]).effective(together[None])
    columns = states.T[:, None, :]
    return felt.acceleration(columns[:2], columns[2:])[:, 0].T
