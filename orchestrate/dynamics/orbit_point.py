"""Points of an orbit branch: a periodic orbit with the test functions of its bifurcations."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .bifurcations import Kind
from .closed_form import Floats
from .continuation import Root
from .families import Family
from .periodic_orbit import CLOSING, POSITION, VELOCITY, PeriodicOrbit
from .turning_points import nearest_miss, turning_points, weakest_force

CONTACT_KINDS = (Kind.CONTACT_LOST, Kind.CONTACT_BEGUN)
STICK_TOLERANCE = 1e-10  # of (17), over a eta^2: an impact so near to sticking may do either


@dataclass(frozen=True)
class OrbitPoint:
    """One point of an orbit branch: the root, its orbit, multipliers and test functions."""

    family: Family  # whose equations it solves
    root: Root

    @cached_property
    def orbit(self) -> PeriodicOrbit:
        """Return the periodic orbit of this point of a branch."""
        return self.family.orbit(self.root.unknowns)

    @property
    def values(self) -> Floats:
        """Return the values of the continuation parameters at this point."""
        return self.root.unknowns[self.family.size :]

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        """Return the orbit's Floquet multipliers, the largest first."""
        return self.orbit.multipliers()

    @cached_property
    def pairs(self) -> NDArray[np.complex128]:
        """Return one multiplier of each complex-conjugate pair, the one with imaginary part > 0."""
        return self.multipliers[self.multipliers.imag > 0.0]

    @cached_property
    def nearest_miss(self) -> float:
        """Return the smallest gap minimum in flight without an impact: 0 at touching."""
        return nearest_miss(self.orbit, turning_points(self.orbit))[0]

    @cached_property
    def sticking_margins(self) -> Floats:
        """Return each impact's margin in the sticking condition (17): negative where it sticks."""
        orbit, form = self.orbit, self.orbit.form
        nodes = orbit.nodes
        force = form.force(nodes[:, POSITION], nodes[:, VELOCITY])
        margins = 2.0 * form.parting(nodes[:, CLOSING]) + form.gamma * force
        return np.where(force < 0.0, margins, np.inf)

    @property
    def wrong_contact(self) -> bool:
        """Return whether an impact sticks, or not, against the sticking condition (17)."""
        # where (17) is all but met either will do: rounding must not say how an orbit goes on
        if not self.orbit.count:
            return False
        return min(self.contact_margin(kind) for kind in CONTACT_KINDS) <= -STICK_TOLERANCE

    def contact_margin(self, kind: Kind) -> float:
        """Return the margin to losing or gaining a permanent contact: negative beyond it."""
        orbit = self.orbit
        margins = np.minimum(self.sticking_margins, 1.0)
        if kind == Kind.CONTACT_LOST:
            return float(np.minimum(-margins, orbit.durations)[orbit.contact].min(initial=1.0))
        return float(margins[~(orbit.contact | orbit.sequence.releases)].min(initial=1.0))

    def test(self, kind: Kind) -> float:
        """Return the test function of a bifurcation kind: it changes sign at the bifurcation."""
        # products are scaled: multipliers are infinite where an impact grazes
        if kind == Kind.FOLD:
            return float(self.root.tangent[self.family.size])
        if kind == Kind.FLIP:
            values = self.multipliers
            return float(np.prod((1.0 + values) / (1.0 + np.abs(values))).real)
        if kind == Kind.TORUS:
            products = np.multiply.outer(self.multipliers, self.multipliers)[np.triu_indices(4, 1)]
            return float(np.prod((1.0 - products) / (1.0 + np.abs(products))).real)
        if kind == Kind.GRAZING:
            closing = self.orbit.nodes[~self.orbit.sequence.releases, CLOSING]
            return float(closing.min(initial=np.inf))
        if kind == Kind.TOUCHING:
            return self.nearest_miss
        if kind == Kind.EARLIER_RELEASE:
            return weakest_force(self.orbit)[0]
        return self.contact_margin(kind)

    def zero_is_bifurcation(self, kind: Kind) -> bool:
        """Return whether this zero of a kind's test function is a true bifurcation."""
        # the product of two real multipliers may be 1 as well as that of a pair on the unit circle
        if kind != Kind.TORUS:
            return True
        return bool((np.abs(np.abs(self.pairs) - 1.0) < 1e-6).any())

    def reversed(self) -> OrbitPoint:
        """Return the same point with its tangent reversed, to continue the other way."""
        return OrbitPoint(self.family, self.root.reversed())
