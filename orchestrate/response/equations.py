"""Accelerations of both masses from their states by the equations of motion (6).

Springs, dampers and the other mass make a mass's absolute acceleration. That relative to the box is
the same minus the box's acceleration, which adds ``a Omega^2 sin(phase)``.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmu import gap_between
from ..model import Structure

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


class MotionCoefficients(NamedTuple):
    """Coefficients k/m and d/m of the equations of motion: mass 1, mass 2, both as one."""

    # A column a structure; of shape (2, ...) where it is what each mass feels
    stiffness: Floats
    damping: Floats
    # acceleration of each mass in contact by the other one's spring, which a clearance loads where
    # the mass itself is at 0, m/s2; None where there is no clearance
    push: Floats | None = None

    @classmethod
    def from_structures(cls, structures: Iterable[Structure]) -> MotionCoefficients:
        """Return the coefficients of n structures, as arrays with a column each."""
        rows = [(s.m1, s.m2, s.k1, s.k2, s.d1, s.d2, s.gap_offset) for s in structures]
        m1, m2, k1, k2, d1, d2, offset = np.array(rows).T
        both = m1 + m2
        stiffness = [k1 / m1, k2 / m2, (k1 + k2) / both]
        damping = [d1 / m1, d2 / m2, (d1 + d2) / both]
        push = np.array([k2 / both, -k1 / both]) * offset if offset.any() else None
        return cls(np.array(stiffness), np.array(damping), push)

    def effective(self, touching: Flags) -> MotionCoefficients:
        """Return each mass's acting coefficients: its own, or those of both in contact."""

        def columns(rates: Floats) -> Floats:
            return rates.reshape(*rates.shape, *(1,) * (touching.ndim - 1))

        def chosen(rates: Floats) -> Floats:
            each = columns(rates)
            return np.where(touching, each[2:], each[:2])

        push = None if self.push is None else np.where(touching, columns(self.push), 0.0)
        return MotionCoefficients(chosen(self.stiffness), chosen(self.damping), push)

    def in_flight(self, indices: NDArray[np.intp]) -> MotionCoefficients:
        """Return the coefficients in flight of the structures at given indices."""
        return MotionCoefficients(self.stiffness[:2, indices], self.damping[:2, indices])

    def acceleration(self, x: Floats, v: Floats) -> Floats:
        """Return both masses' absolute accelerations from x and v, shape (2, ...)."""
        restoring = self.restoring_acceleration(x, v)
        return restoring if self.push is None else restoring + self.push

    def restoring_acceleration(self, x: Floats, v: Floats) -> Floats:
        """Return ``-(k x + d v)/m`` of each mass, shape (2, ...)."""
        acceleration: Floats = -(self.stiffness * x + self.damping * v)
        return acceleration


def in_touch(states: Floats, gap_offset: ArrayLike = 0.0) -> Flags:
    """Return, for each state, whether it is permanent contact: no gap and equal velocities."""
    together = gap_between(states, gap_offset) == 0.0
    touching: Flags = together & (states[..., 2] == states[..., 3])
    return touching


def absolute_accelerations(
    states: Floats, structure: Structure, touching: Flags | None = None
) -> Floats:
    """Return both masses' absolute accelerations, as accelerometers read between impacts."""
    together = in_touch(states, structure.gap_offset) if touching is None else touching
    felt = MotionCoefficients.from_structures([structure]).effective(together[None])
    columns = states.T[:, None, :]
    return felt.acceleration(columns[:2], columns[2:])[:, 0].T
