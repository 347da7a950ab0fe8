"""What can happen to an orbit along a branch: functions that change their sign where it does."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .closed_form import Floats
from .continuation import Root, Walk
from .families import Family
from .impact_sequence import CLOSING, POSITION, VELOCITY, Ring
from .turning_points import nearest, turning_points, weakest_force

FOLD, FLIP, TORUS, GRAZING, TOUCHING, CONTACT_LOST, CONTACT_BEGUN, RELEASE = range(8)
KINDS = {
    FOLD: "fold",
    FLIP: "period doubling",
    TORUS: "Neimark-Sacker",
    GRAZING: "grazing of an impact",
    TOUCHING: "grazing of a flight",
    CONTACT_LOST: "loss of permanent contact",
    CONTACT_BEGUN: "begin of permanent contact",
    RELEASE: "earlier release",
}
CONTACT = (CONTACT_LOST, CONTACT_BEGUN)
ENDS = (GRAZING, TOUCHING, RELEASE)  # beyond them the sequence of impacts is another one
SIGNS = (FOLD, FLIP, TORUS, GRAZING, TOUCHING, RELEASE)  # told by a sign on every branch
ON_CIRCLE = 1e-6
ACCURACY = 1e-14  # of a place along the branch, in unknowns over their scale


@dataclass(frozen=True)
class Look:
    """An orbit on a branch, with what tells its bifurcations.

    Attributes
    ----------
    family : Family
    root : Root
    """

    family: Family
    root: Root

    @cached_property
    def ring(self) -> Ring:
        """The orbit."""
        return self.family.ring(self.root.unknowns)

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers, the largest first."""
        return self.ring.multipliers()

    @cached_property
    def pairs(self) -> NDArray[np.complex128]:
        """Complex multipliers, one of each pair."""
        return self.multipliers[self.multipliers.imag > 0.0]

    @cached_property
    def clearance(self) -> float:
        """Smallest gap at which the masses turn away from each other without an impact."""
        return nearest(self.ring, turning_points(self.ring))[0]

    @cached_property
    def sticking(self) -> Floats:
        """For each impact, by how much it misses (17): negative where it would stick.

        Only where the contact force is a pressing one, else infinite.
        """
        ring, form = self.ring, self.ring.form
        nodes = ring.nodes
        force = form.force(nodes[:, POSITION], nodes[:, VELOCITY])
        missing = 2.0 * form.e * nodes[:, CLOSING] + form.gamma * force
        return np.where(force < 0.0, missing, np.inf)

    @property
    def wrong_contact(self) -> bool:
        """Whether an impact sticks that should not, or the reverse, or a contact is over."""
        return self.ring.count > 0 and min(self.contact_test(kind) for kind in CONTACT) <= 0.0

    def test(self, kind: int) -> float:
        """The function whose sign changes at a bifurcation of a kind."""
        if kind == FOLD:
            return float(self.root.tangent[self.family.size])
        if kind == FLIP:
            found = self.multipliers
            return float(np.prod((1.0 + found) / (1.0 + np.abs(found))).real)
        if kind == TORUS:
            products = np.multiply.outer(self.multipliers, self.multipliers)[np.triu_indices(4, 1)]
            return float(np.prod((1.0 - products) / (1.0 + np.abs(products))).real)
        if kind == GRAZING:
            closing = self.ring.nodes[~self.ring.sequence.releases, CLOSING]
            return float(closing.min(initial=np.inf))
        if kind == TOUCHING:
            return self.clearance
        return self.contact_test(kind) if kind in CONTACT else weakest_force(self.ring)

    def contact_test(self, kind: int) -> float:
        """By how much chattering still ends in contact (17), or still does not; negative beyond."""
        ring = self.ring
        missing = np.minimum(self.sticking, 1.0)
        if kind == CONTACT_LOST:
            held = np.minimum(-missing, ring.durations)[ring.contact]
            return float(held.min(initial=1.0))
        return float(missing[~(ring.contact | ring.sequence.releases)].min(initial=1.0))

    def changed(self, before: Look) -> list[int]:
        """Kinds of the bifurcations between an orbit and this one."""
        return [kind for kind in SIGNS if before.test(kind) * self.test(kind) < 0.0]

    def happens(self, kind: int) -> bool:
        """Whether it is the bifurcation: the product of two real multipliers may be 1 as well."""
        if kind != TORUS:
            return True
        return bool((np.abs(np.abs(self.pairs) - 1.0) < ON_CIRCLE).any())


def locate(
    walk: Walk[Family], before: Look, after: Look, length: float, kind: int
) -> tuple[float, Look]:
    """Where between two orbits a bifurcation lies, by Brent's method along the branch.

    Returns
    -------
    length : float
        Of the step to it.
    look : Look
        The orbit there.
    """
    from scipy.optimize import brentq

    seen = {0.0: before, length: after}

    def test(place: float) -> float:
        if place not in seen:
            seen[place] = Look(before.family, walk.at(place))
        value = seen[place].test(kind)
        return value if np.isfinite(value) else 1.0

    place = float(brentq(test, 0.0, length, xtol=ACCURACY, rtol=1e-14))
    test(place)
    return place, seen[place]
