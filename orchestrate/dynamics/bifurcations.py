"""What can happen to an orbit along a branch: functions that change their sign where it does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .closed_form import Floats
from .continuation import NoConvergenceError, Root, Walk
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
UNDECIDED = 1e-10  # of (17), over a eta^2: an impact that is so near to sticking may do either
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
        """Whether an impact sticks that should not, or the reverse, or a contact is over.

        Where (17) is all but met either will do: an orbit that has just got or lost an impact
        meets it to rounding, and rounding must not say how it goes on.
        """
        if not self.ring.count:
            return False
        return min(self.contact_test(kind) for kind in CONTACT) <= -UNDECIDED

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

    def happens(self, kind: int) -> bool:
        """Whether it is the bifurcation: the product of two real multipliers may be 1 as well."""
        if kind != TORUS:
            return True
        return bool((np.abs(np.abs(self.pairs) - 1.0) < ON_CIRCLE).any())


@dataclass
class Step:
    """A step along a branch, between two orbits of one sequence.

    Attributes
    ----------
    walk : Walk
        That stands at the step's begin.
    before, after : Look
        The orbits at its ends.
    length : float
    rates : dict
        How fast each test changed in the step before, where there was one.
    """

    walk: Walk[Family]
    before: Look
    after: Look
    length: float
    rates: Mapping[int, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.seen = {0.0: self.before, self.length: self.after}

    def look(self, place: float) -> Look:
        """The orbit so far into the step."""
        if place not in self.seen:
            self.seen[place] = Look(self.walk.curve, self.walk.at(place))
        return self.seen[place]

    def test(self, place: float, kind: int) -> float:
        """What changes its sign at a bifurcation of a kind."""
        value = self.look(place).test(kind)
        return value if np.isfinite(value) else 1.0

    def crossings(self) -> list[tuple[int, float, float]]:
        """Kinds of the bifurcations in the step, each with two places that it lies between."""
        found = []
        for kind in SIGNS:
            if self.before.test(kind) * self.after.test(kind) < 0.0:
                found.append((kind, 0.0, self.length))
            elif self.turns_back(kind):
                middle = self.lowest(kind)
                if self.before.test(kind) * self.test(middle, kind) < 0.0:
                    found += [(kind, 0.0, middle), (kind, middle, self.length)]
        return found

    def turns_back(self, kind: int) -> bool:
        """Whether two bifurcations of a kind are possible: the test falls first and rises after.

        Looked at where it could have come to zero twice as fast as it changed in the step before.
        """
        value = self.before.test(kind)
        reach = 2.0 * abs(self.rates.get(kind, np.inf)) * self.length
        if self.length <= ACCURACY or not abs(value) < reach:
            return False
        sign = np.sign(value)
        falls, rises = (sign * self.slope(end, kind) for end in (0.0, self.length))
        return bool(falls < 0.0 < rises)

    def rate(self, kind: int) -> float:
        """How fast a test changes on average; unbounded where it is not known."""
        change = self.after.test(kind) - self.before.test(kind)
        return change / self.length if np.isfinite(change) and self.length else np.inf

    def slope(self, place: float, kind: int, small: float = 1e-3) -> float:
        """How fast a test changes at an end of the step; 0 where it is not known."""
        near = place + (small if place == 0.0 else -small) * self.length
        try:
            change = self.look(near).test(kind) - self.look(place).test(kind)
        except NoConvergenceError:
            return 0.0
        return change / (near - place) if np.isfinite(change) else 0.0

    def lowest(self, kind: int) -> float:
        """Where the test is nearest to changing its sign, or beyond."""
        from scipy.optimize import minimize_scalar

        sign = np.sign(self.before.test(kind))
        options = {"xatol": 1e-6 * self.length}
        found = minimize_scalar(
            lambda place: sign * self.test(float(place), kind),
            bounds=(0.0, self.length),
            method="bounded",
            options=options,
        )
        return float(found.x)

    def locate(self, kind: int, low: float, high: float, level: float = 0.0) -> tuple[float, Look]:
        """Where a test is 0, or at a level, by Brent's method along the branch, and the orbit."""
        from scipy.optimize import brentq

        def above(place: float) -> float:
            return self.test(place, kind) - level

        place = float(brentq(above, low, high, xtol=ACCURACY, rtol=1e-14))
        return place, self.look(place)
