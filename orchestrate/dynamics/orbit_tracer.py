"""Branches of periodic orbits: their points with test functions, and how they are traced."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .bifurcation_kinds import KINDS, Kind
from .closed_form import Floats
from .continuation import NoConvergenceError, Root
from .families import Family
from .orbit_search import least_periods, solve_orbit
from .periodic_orbit import (
    CLOSING,
    IMPACT,
    POSITION,
    STICK,
    ImpactSequence,
    PeriodicOrbit,
    kind_at_same_end,
)
from .tracer import NO_CONVERGENCE, Bifurcation, BranchSegment, BranchStep, BranchTracer
from .turning_points import nearest_miss, weakest_force

STICK_TOLERANCE = 1e-10  # of (17), over a eta^2: an impact so near to sticking may do either


@dataclass(frozen=True)
class OrbitPoint:
    """One point of an orbit branch: the root, its orbit, multipliers and test functions."""

    family: Family  # whose equations it solves
    root: Root

    @cached_property
    def orbit(self) -> PeriodicOrbit:
        return self.family.orbit(self.root.unknowns)

    @property
    def values(self) -> Floats:
        return self.root.unknowns[self.family.node_unknowns :]

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        return self.orbit.multipliers()

    @cached_property
    def upper_multipliers(self) -> NDArray[np.complex128]:
        """Return one multiplier of each complex-conjugate pair, the one with imaginary part > 0."""
        return self.multipliers[self.multipliers.imag > 0.0]

    @cached_property
    def nearest_miss(self) -> float:
        """Return how near the masses come to an end in flight without an impact: 0 at touching."""
        return nearest_miss(self.orbit)[0]

    @cached_property
    def sticking_margins(self) -> Floats:
        """Return each impact's margin in the sticking condition (17): negative where it sticks."""
        orbit, form = self.orbit, self.orbit.form
        phase, position, velocity, closing = orbit.nodes.T
        force = form.contact_force(phase, position, velocity, orbit.sequence.outer)
        margins = 2.0 * form.separation_speed(closing) + form.sticking_time * force
        return np.where(force < 0.0, margins, np.inf)

    @property
    def violates_sticking_condition(self) -> bool:
        """Return whether an impact sticks, or does not, against the sticking condition (17)."""
        # where (17) is all but met either will do: rounding must not decide how an orbit continues
        margins = map(self.contact_margin, (Kind.CONTACT_LOST, Kind.CONTACT_BEGUN))
        return self.orbit.node_count > 0 and min(margins) <= -STICK_TOLERANCE

    def contact_margin(self, kind: Kind) -> float:
        """Return the margin to losing or gaining a permanent contact: negative beyond it."""
        orbit = self.orbit
        margins = np.minimum(self.sticking_margins, 1.0)
        if kind == Kind.CONTACT_LOST:
            return float(np.minimum(-margins, orbit.durations)[orbit.in_contact].min(initial=1.0))
        return float(margins[~(orbit.in_contact | orbit.sequence.releases)].min(initial=1.0))

    def reversed(self) -> OrbitPoint:
        return OrbitPoint(self.family, self.root.reversed())


def unit_circle_test(multipliers: NDArray[np.complex128], *, pairs: bool) -> float:
    """Return what is zero if a multiplier is -1, or if two have the product 1; NaN if grazing.

    It is the product of 1 + multiplier, or of 1 - that of two, each over its size.
    """
    with np.errstate(invalid="ignore"):
        values = -multipliers
        if pairs:
            values = np.multiply.outer(values, values)[np.triu_indices(len(values), 1)]
        return float(np.prod((1.0 - values) / (1.0 + np.abs(values))).real)


class OrbitTracer(BranchTracer[Family, OrbitPoint]):
    """Traces a branch of periodic orbits by pseudo-arclength, with its bifurcations."""

    kinds = (Kind.FOLD, Kind.FLIP, Kind.TORUS, Kind.GRAZING, Kind.TOUCHING, Kind.EARLIER_RELEASE)
    ending_kinds = (  # beyond are other impacts, or copies
        *(Kind.GRAZING, Kind.TOUCHING, Kind.EARLIER_RELEASE),
        *(Kind.HALVING, Kind.CONTACT_LOST, Kind.CONTACT_BEGUN),
    )
    finds_pairs = True

    def make_point(self, root: Root) -> OrbitPoint:
        return OrbitPoint(self.stepper.curve, root)

    def first_limited_unknown_and_limits(self) -> tuple[int, Sequence[tuple[float, float]]]:
        family = self.stepper.curve
        return family.node_unknowns, family.setting.limits

    def accepts(self, root: Root) -> bool:
        orbit = self.stepper.curve.orbit(root.unknowns)
        return bool((orbit.durations[~orbit.in_contact] > 0.0).all())

    def test_function(self, point: OrbitPoint, kind: Kind) -> float:
        orbit = point.orbit
        if kind == Kind.FOLD:
            return float(point.root.tangent[point.family.node_unknowns])
        if kind in (Kind.FLIP, Kind.TORUS):
            return unit_circle_test(point.multipliers, pairs=kind == Kind.TORUS)
        if kind == Kind.GRAZING:
            return float(orbit.nodes[~orbit.sequence.releases, CLOSING].min(initial=np.inf))
        if kind == Kind.TOUCHING:
            return point.nearest_miss
        if kind == Kind.EARLIER_RELEASE:
            return weakest_force(orbit)[0]
        return point.contact_margin(kind)

    def zero_is_bifurcation(self, kind: Kind, point: OrbitPoint, part: float) -> bool:
        # the product of two real multipliers may be 1 as well as that of a pair on the unit circle
        if part <= 1e-7 or kind != Kind.TORUS:
            return part > 1e-7
        return bool((np.abs(np.abs(point.upper_multipliers) - 1.0) < 1e-6).any())

    def locate_bifurcations(self, step: BranchStep[OrbitPoint]) -> list[Bifurcation[OrbitPoint]]:
        located, before = super().locate_bifurcations(step), step.before.orbit
        periods = before.sequence.periods
        for i, each in enumerate(located):
            # at a fold an orbit of several periods may become that of half of them
            may_halve = each.kind == Kind.FOLD and least_periods(before) == periods
            if may_halve and least_periods(each.point.orbit, 1e-4) < periods:
                return [*located[:i], replace(each, kind=Kind.HALVING)]
        return located

    def move_stepper_to(self, point: OrbitPoint) -> OrbitPoint:
        """Set the stepper to an orbit, rescaling unknowns if its size has changed; return it."""
        family, root = point.family, point.root
        nodes = root.unknowns[: family.node_unknowns].reshape(-1, 4)
        scaled = Family.from_nodes(family.setting, family.sequence, nodes)
        low, high = 0.5, 2.0
        if len(nodes) and not low < scaled.scale[POSITION] / family.scale[POSITION] < high:
            tangent = root.tangent * family.scale / scaled.scale
            family, root = scaled, replace(root, tangent=tangent / np.linalg.norm(tangent))
        self.stepper.curve, self.stepper.root = family, root
        return point

    def fit_impacts_to_step(self, step: BranchStep[OrbitPoint]) -> tuple[OrbitPoint, Kind | None]:
        """Return the step's last orbit, with impacts added or removed as chattering (17) needs."""
        # where permanent contact is lost or begins, infinitely many impacts would graze: an end
        after = step.after
        if not after.violates_sticking_condition:
            return after, None
        try:
            return fit_chattering_impacts(after), None
        except NoConvergenceError:  # too far on: go back to where the first impact comes or goes
            lost = after.contact_margin(Kind.CONTACT_LOST) <= -STICK_TOLERANCE
            kind = Kind.CONTACT_LOST if lost else Kind.CONTACT_BEGUN
            position, first = step.solve_for_level(kind, 0.0, step.length, -STICK_TOLERANCE)
        try:
            changed = fit_chattering_impacts(add_or_drop_chattering_impacts(first))
        except NoConvergenceError:
            return first, kind
        self.stepper.length = max(position, 2.0 * self.stepper.min_length)
        step.at_limit = False
        return changed, None

    def set_end_without_root(self, segment: BranchSegment[OrbitPoint]) -> None:
        last = segment.points[-1]
        if last.orbit.in_contact.any() and last.contact_margin(Kind.CONTACT_LOST) < 1e-6:
            segment.add_bifurcation(Kind.CONTACT_LOST, last, 0.0)
            segment.end = KINDS[Kind.CONTACT_LOST]
        else:
            segment.end = NO_CONVERGENCE


def fit_chattering_impacts(point: OrbitPoint) -> OrbitPoint:
    """Add or remove chattering impacts one by one until (17) holds; return the orbit."""
    for _ in range(10):  # more are no small change of an orbit
        if not point.violates_sticking_condition:
            return point
        point = add_or_drop_chattering_impacts(point)
    raise NoConvergenceError("impacts of a chattering come and go")


def add_or_drop_chattering_impacts(point: OrbitPoint) -> OrbitPoint:
    """Solve for the orbit with one impact more before contact, or with those after one dropped."""
    orbit, margins = point.orbit, point.sticking_margins
    kinds, nodes = list(orbit.sequence.kinds), orbit.nodes
    if point.contact_margin(Kind.CONTACT_BEGUN) < point.contact_margin(Kind.CONTACT_LOST):
        impacts = ~(orbit.in_contact | orbit.sequence.releases)
        sticking = int(np.where(impacts, margins, np.inf).argmin())
        later = orbit.sequence.releases[sticking + 1 :]
        if not later.any():
            raise NoConvergenceError("an impact sticks that is not of a chattering")
        release = sticking + 1 + int(later.argmax())
        kept = [*range(sticking + 1), *range(release, len(kinds))]
        kinds[sticking] = kind_at_same_end(kinds[sticking], STICK)
        kinds, nodes = [kinds[i] for i in kept], nodes[kept]
    else:
        last = int(np.where(orbit.in_contact, margins, -np.inf).argmax())
        impact = kind_at_same_end(kinds[last], IMPACT)
        kinds = [*kinds[:last], impact, *kinds[last:]]
        nodes = np.insert(nodes, last + 1, estimate_next_impact_node(orbit, last), axis=0)
    sequence = ImpactSequence(orbit.sequence.periods, tuple(kinds))
    guess, setting = (sequence, nodes), point.family.setting
    changed = OrbitPoint(
        *solve_orbit(setting, guess, point.values, max_iterations=12, max_distance=1.0)
    )
    if (changed.orbit.durations <= 0.0).any():
        raise NoConvergenceError("no time is left for contact")
    same_direction = point.root.tangent[-1] * changed.root.tangent[-1] >= 0.0
    return changed if same_direction else changed.reversed()


def estimate_next_impact_node(orbit: PeriodicOrbit, node: int) -> Floats:
    """Return the node of the impact that would follow, did the impact of a node not stick."""
    phase, position, velocity, closing = orbit.nodes[node]
    separation = orbit.form.separation_speed(closing)
    outer = bool(orbit.sequence.outer[node])
    time = 2.0 * separation / -float(orbit.form.contact_force(phase, position, velocity, outer))
    if not 0.0 < time < orbit.durations[node]:
        raise NoConvergenceError("no time is left for another impact")
    later = phase + orbit.form.eta * time
    return np.array([later, position + velocity * time, velocity, separation])
