"""Continuation of orbit branches: the tracer's steps, limits and tests for periodic orbits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .bifurcations import KINDS, Kind
from .chattering import add_or_remove_impacts, change_one_impact
from .continuation import ArclengthStepper, NoConvergenceError, Root
from .families import Family
from .orbit_point import STICK_TOLERANCE, OrbitPoint
from .orbit_search import least_periods
from .periodic_orbit import POSITION
from .tracer import (
    NO_CONVERGENCE,
    BranchSegment,
    BranchStep,
    BranchTracer,
    ContinuationSettings,
    LocatedBifurcation,
)


class OrbitTracer(BranchTracer[Family, OrbitPoint]):
    """Traces a branch of periodic orbits by pseudo-arclength, with its bifurcations."""

    kinds = (Kind.FOLD, Kind.FLIP, Kind.TORUS, Kind.GRAZING, Kind.TOUCHING, Kind.EARLIER_RELEASE)
    ending_kinds = (
        Kind.GRAZING,
        Kind.TOUCHING,
        Kind.EARLIER_RELEASE,
        Kind.HALVING,
        Kind.CONTACT_LOST,
        Kind.CONTACT_BEGUN,
    )  # beyond are other impacts, or copies
    finds_pairs = True

    def __init__(self, start: OrbitPoint, settings: ContinuationSettings) -> None:
        # short, as the branch is not known yet
        first, longest = min(1e-3, settings.max_step), settings.max_step
        stepper = ArclengthStepper(start.family, start.root, first, longest)
        super().__init__(stepper, settings.max_points)

    def point(self, root: Root) -> OrbitPoint:
        return OrbitPoint(self.stepper.curve, root)

    def limits(self) -> tuple[int, Sequence[tuple[float, float]]]:
        family = self.stepper.curve
        return family.size, family.setting.limits

    def accepts(self, root: Root) -> bool:
        """Return whether all flights between the root's impacts have positive duration."""
        orbit = self.stepper.curve.orbit(root.unknowns)
        return bool((orbit.durations[~orbit.contact] > 0.0).all())

    def test(self, point: OrbitPoint, kind: Kind) -> float:
        """Return a point's test function of a bifurcation kind: it changes sign there."""
        return point.test(kind)

    def confirms(self, kind: Kind, point: OrbitPoint, part: float) -> bool:
        """Return whether a located zero is a true bifurcation, and not the step's own start."""
        return part > 1e-7 and point.zero_is_bifurcation(kind)

    def locate(self, step: BranchStep[OrbitPoint]) -> list[LocatedBifurcation[OrbitPoint]]:
        """Locate the bifurcations in a step, up to where its orbit has half the period."""
        located = super().locate(step)
        for i, each in enumerate(located):
            if is_halved(each, step.before):
                return [*located[:i], replace(each, kind=Kind.HALVING)]
        return located

    def go_on_from(self, point: OrbitPoint) -> OrbitPoint:
        """Set the stepper to an orbit, rescaling unknowns if its size has changed; return it."""
        family, root = point.family, point.root
        nodes = root.unknowns[: family.size].reshape(-1, 4)
        scaled = Family.from_nodes(family.setting, family.sequence, nodes)
        low, high = 0.5, 2.0
        if len(nodes) and not low < scaled.scale[POSITION] / family.scale[POSITION] < high:
            tangent = root.tangent * family.scale / scaled.scale
            family, root = scaled, replace(root, tangent=tangent / np.linalg.norm(tangent))
        self.stepper.curve, self.stepper.root = family, root
        return point

    def finish_step(self, step: BranchStep[OrbitPoint]) -> tuple[OrbitPoint, Kind | None]:
        """Return the step's last orbit, with impacts added or removed as chattering (17) needs."""
        # where permanent contact is lost or begins, infinitely many impacts would graze: an end
        after = step.after
        if not after.wrong_contact:
            return after, None
        try:
            return add_or_remove_impacts(after), None
        except NoConvergenceError:  # too far on: go back to where the first impact comes or goes
            lost = after.contact_margin(Kind.CONTACT_LOST) <= -STICK_TOLERANCE
            kind = Kind.CONTACT_LOST if lost else Kind.CONTACT_BEGUN
            position, first = step.solve_for_level(kind, 0.0, step.length, -STICK_TOLERANCE)
        try:
            changed = add_or_remove_impacts(change_one_impact(first))
        except NoConvergenceError:
            return first, kind
        self.stepper.length = max(position, 2.0 * self.stepper.min_length)
        step.at_limit = False
        return changed, None

    def end_without_root(self, segment: BranchSegment[OrbitPoint]) -> None:
        """Set why a branch ends where Newton fails: contact lost, or no convergence."""
        last = segment.points[-1]
        if last.orbit.contact.any() and last.contact_margin(Kind.CONTACT_LOST) < 1e-6:
            segment.add_bifurcation(Kind.CONTACT_LOST, last, 0.0)
            segment.end = KINDS[Kind.CONTACT_LOST]
        else:
            segment.end = NO_CONVERGENCE


def is_halved(located: LocatedBifurcation[OrbitPoint], before: OrbitPoint) -> bool:
    """Return whether an orbit has half the period at a fold, of several that had not before."""
    periods = before.orbit.sequence.periods
    if located.kind != Kind.FOLD or least_periods(before.orbit) < periods:
        return False
    return least_periods(located.point.orbit, 1e-4) < periods
