"""Bifurcations followed over two parameters: an orbit's equations with those of its bifurcation.

Folds, period doublings and Neimark-Sacker bifurcations are where the orbit's matrix with a
multiplier ``turn`` is singular: its bordered system tells how nearly (Govaerts, Numerical Methods
for Bifurcations of Dynamical Equilibria, 2000, chapter 4), and needs no determinant. Grazings are
equations of their own.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .bifurcations import FLIP, FOLD, GRAZING, KINDS, TORUS, TOUCHING, Look
from .closed_form import Floats
from .continuation import oriented_by
from .families import Family, difference
from .impact_sequence import CLOSING, Ring
from .turning_points import GAP, measured, nearest, turning_points

TURNS = {FOLD: 1.0, FLIP: -1.0}
STEP = 1e-6  # of an unknown, over its scale, for differences


@dataclass
class Border:
    """A bifurcation over two parameters.

    Its unknowns are those of the nodes, the two parameters, and what the kind adds.

    Attributes
    ----------
    family : Family
        Of two parameters.
    kind : int
    place : int
        The node that grazes, or the segment that touches.
    extra : ndarray
        What the kind adds, at the start: the multiplier's angle, or the phase of touching.
    """

    family: Family
    kind: int
    place: int
    extra: Floats
    scale: Floats = field(init=False)
    columns: NDArray[np.complex128] = field(init=False)
    rows: NDArray[np.complex128] = field(init=False)

    def __post_init__(self) -> None:
        self.scale = np.append(self.family.scale, np.ones(len(self.extra)))

    @classmethod
    def of(cls, family: Family, look: Look, kind: int) -> Border:
        """From a bifurcation found on a branch.

        Raises
        ------
        InputError
            Where bifurcations of that kind are not followed.
        """
        place, extra = -1, np.zeros(0)
        if kind == TORUS:
            which = np.abs(np.abs(look.pairs) - 1.0).argmin()
            extra = np.array([np.angle(look.pairs[which])])
        elif kind == GRAZING:
            released = look.ring.sequence.releases
            place = int(np.where(released, np.inf, look.ring.nodes[:, CLOSING]).argmin())
        elif kind == TOUCHING:
            _, place, phase = nearest(look.ring, turning_points(look.ring))
            extra = np.array([phase])
        elif kind not in TURNS:
            expected = ", ".join(KINDS[known] for known in (*TURNS, TORUS, GRAZING, TOUCHING))
            raise InputError(f"bifurcation: {KINDS[kind]}; expected one of {expected}")
        return cls(family, kind, place, extra)

    @property
    def accuracy(self) -> float:
        """What a root may leave of the orbit's equations, and of the bifurcation's."""
        return self.family.accuracy

    @property
    def parameters(self) -> int:
        """Number of the first parameter among the unknowns."""
        return self.family.size

    def turn(self, unknowns: Floats) -> complex:
        """The multiplier on the unit circle."""
        if self.kind == TORUS:
            return complex(np.exp(1j * unknowns[-1]))
        return TURNS[self.kind]

    def ring(self, unknowns: Floats) -> Ring:
        """The orbit."""
        return self.family.ring(unknowns[: self.family.size + 2])

    def lean(self, unknowns: Floats) -> None:
        """Border the matrix with the vectors that it all but maps to zero here."""
        if self.kind in (*TURNS, TORUS):
            left, _, right = np.linalg.svd(self.matrix(unknowns))
            self.columns, self.rows = in_phase(left[:, -1]), in_phase(right[-1].conj())

    def matrix(self, unknowns: Floats) -> NDArray[np.complex128]:
        """What is singular at the bifurcation."""
        found = self.ring(unknowns).jacobian(self.turn(unknowns)) * self.scale[: self.family.size]
        return np.asarray(found, dtype=complex)

    def condition(self, unknowns: Floats) -> Floats:
        """The bifurcation's own equations."""
        if self.kind == GRAZING:
            return self.ring(unknowns).nodes[self.place, CLOSING : CLOSING + 1]
        if self.kind == TOUCHING:
            which = np.array([self.place]), np.array([GAP])
            rate, _, gap = measured(self.ring(unknowns), *which, unknowns[-1:])
            return np.append(gap, rate)
        size = self.family.size
        bordered = np.zeros((size + 1, size + 1), dtype=complex)
        bordered[:size, :size] = self.matrix(unknowns)
        bordered[:size, size], bordered[size, :size] = self.columns, self.rows.conj()
        defect = np.linalg.solve(bordered, np.eye(size + 1)[-1])[-1]
        return (
            np.array([defect.real, defect.imag]) if self.kind == TORUS else np.array([defect.real])
        )

    def residual(self, unknowns: Floats) -> Floats:
        """What is left of all equations."""
        orbit = self.family.residual(unknowns[: self.family.size + 2])
        return np.append(orbit, self.condition(unknowns))

    def jacobian(self, unknowns: Floats, at_root: bool = False) -> Floats:
        """Its derivative; that of the bifurcation's own equations by differences."""
        orbit = self.family.jacobian(unknowns[: self.family.size + 2])
        blank = np.zeros((len(orbit), len(self.extra)))
        spans = [(-np.inf, np.inf)] * self.family.size
        limits = [*spans, *self.family.setting.limits, *[(-np.inf, np.inf)] * len(self.extra)]
        own = [
            difference(self.condition, unknowns, i, *limit, step=STEP * scale)
            for i, (limit, scale) in enumerate(zip(limits, self.scale, strict=True))
        ]
        return np.vstack([np.hstack([orbit, blank]), np.array(own).T])

    def no_motion(self, unknowns: Floats, tolerance: float = 1e-9) -> str:
        """Why a root is no bifurcation of a motion; empty where it is one."""
        ring = self.ring(unknowns)
        closing = np.where(ring.sequence.releases, np.inf, ring.nodes[:, CLOSING])
        if self.kind == GRAZING:
            closing[self.place] = np.inf
        if (closing <= 0.0).any():
            return "another impact grazes"
        if (ring.durations <= 0.0).any():
            return "impacts change their order"
        if nearest(ring, turning_points(ring))[0] < -tolerance:
            return "a flight grazes" if self.kind != TOUCHING else "another flight grazes"
        if self.kind == TORUS and not 0.0 < unknowns[-1] < np.pi:
            return "a resonance 1:1 or 1:2"
        return ""


def in_phase(vector: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """A singular vector with a large component real and positive, as on any other processor."""
    first = vector[oriented_by(vector)]
    return np.asarray(vector * (first.conjugate() / abs(first)), dtype=complex)
