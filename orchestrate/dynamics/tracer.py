"""Trace a branch: predictor-corrector steps; folds and other bifurcations located; its end.

A bifurcation is where a test function changes its sign; it is located by Brent's method on the
branch itself, not between its points (Kuznetsov, Elements of Applied Bifurcation Theory, 10).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from .bifurcation_kinds import KINDS, Kind
from .continuation import SOLVER_ERRORS, AnyCurve, ArclengthStepper, Root, solve_by_brent

LIMIT, NO_CONVERGENCE, MAX_POINTS = "limit", "no convergence", "most points"  # ends of branches
ACCURACY = 1e-14  # of a position along the branch, in unknowns over their scale

Point = TypeVar("Point")


@dataclass(frozen=True)
class ContinuationSettings:
    """Settings for tracing a branch: the longest step, and the most points."""

    # longest step, in unknowns over their scale: shorter where branches lie close to each other
    max_step: float
    # points in one direction, without the start: more where a branch ends with `"most points"`
    max_points: int


@dataclass(frozen=True)
class Bifurcation(Generic[Point]):
    """A bifurcation located on a branch: its kind, where it lies, and the branch's point there."""

    kind: Kind
    # of one located in a step: its arclength; of one on a branch: its number among the points
    position: float
    point: Point


@dataclass
class BranchSegment(Generic[Point]):
    """One direction of a traced branch: points, bifurcations, and why it ends."""

    points: list[Point] = field(default_factory=list)  # from the start on
    # in their order along the branch
    bifurcations: list[Bifurcation[Point]] = field(default_factory=list)
    end: str = ""  # why it ends

    def add_bifurcation(self, kind: Kind, point: Point, beyond: float) -> None:
        """Append a bifurcation located ``beyond`` the last point, as a fraction of a step."""
        self.bifurcations.append(Bifurcation(kind, len(self.points) - 1 + beyond, point))


class BranchTracer(ABC, Generic[AnyCurve, Point]):
    """Base of tracers: the loop of continuation; subclasses supply points and test functions."""

    kinds: ClassVar[tuple[Kind, ...]] = ()  # those with a test function
    ending_kinds: ClassVar[tuple[Kind, ...]] = ()  # those beyond which there are no points
    # whether two bifurcations of a kind in one step are sought: it takes further roots
    finds_pairs: ClassVar[bool] = False

    def __init__(self, stepper: ArclengthStepper[AnyCurve], max_points: int) -> None:
        self.stepper, self.max_points = stepper, max_points

    # -- what a subclass supplies ------------------------------------------------------------------

    @abstractmethod
    def make_point(self, root: Root) -> Point:
        """Return the branch point of a solved root; subclasses define what a point is."""

    @abstractmethod
    def first_limited_unknown_and_limits(self) -> tuple[int, Sequence[tuple[float, float]]]:
        """Return the index of the first limited unknown, and (low, high) from it onwards."""

    def accepts(self, root: Root) -> bool:
        """Return whether a solved root may be the branch's next point; by default yes."""
        return True

    def test_function(self, point: Point, kind: Kind) -> float:
        """Return the test function of a bifurcation kind: it changes sign at the bifurcation."""
        raise NotImplementedError

    def zero_is_bifurcation(self, kind: Kind, point: Point, part: float) -> bool:
        """Return whether a test function's zero at a fraction of a step is a true bifurcation."""
        return True

    def location_tolerances(self, length: float) -> dict[str, float]:
        return {"xtol": ACCURACY, "rtol": ACCURACY}

    def end_reason_and_last_points(self, step: BranchStep[Point]) -> tuple[str, Iterable[Point]]:
        """Return why the branch ends within a step (empty if not), and its last points."""
        return "", ()

    def fit_impacts_to_step(self, step: BranchStep[Point]) -> tuple[Point, Kind | None]:
        """Return the point that a step appends, and the bifurcation there if it ends the branch.

        The point may be before the step's end, where an orbit's impacts change.
        """
        return step.after, None

    def set_end_without_root(self, segment: BranchSegment[Point]) -> None:
        """Set the reason why a segment ends where no step converges, however short."""
        segment.end = NO_CONVERGENCE

    @abstractmethod
    def move_stepper_to(self, point: Point) -> Point:
        """Set the stepper to a point for the next step; return it, or the same motion restarted."""

    # -- the loop ----------------------------------------------------------------------------------

    def trace(self, start: Point) -> BranchSegment[Point]:
        """Follow the branch from a point on, in the direction of its tangent, to its end."""
        segment, rates = BranchSegment([start]), dict.fromkeys(self.kinds, np.inf)
        try:
            while not segment.end:
                if len(segment.points) > self.max_points:
                    segment.end = MAX_POINTS
                    break
                before = self.move_stepper_to(segment.points[-1])
                step, located = self.take_step(before, rates)
                rates = {kind: step.mean_slope(kind) for kind in self.kinds}
                for each in located:
                    if each.kind in self.ending_kinds:
                        step.end, step.last_points = KINDS[each.kind], [each.point]
                        segment.add_bifurcation(each.kind, each.point, 1.0)
                        break
                    segment.add_bifurcation(each.kind, each.point, each.position / step.length)
                segment.points += step.last_points
                segment.end = step.end
        except SOLVER_ERRORS:
            self.set_end_without_root(segment)
        return segment

    def take_step(
        self, before: Point, rates: Mapping[Kind, float]
    ) -> tuple[BranchStep[Point], list[Bifurcation[Point]]]:
        """Take a step, shortened until all in it can be solved for; return its bifurcations too."""
        stepper = self.stepper
        while True:
            limited = self.first_limited_unknown_and_limits()
            root, length, at_limit = stepper.step(*limited, self.accepts)
            try:
                step = BranchStep(self, before, self.make_point(root), length, at_limit, rates)
                step.end, step.last_points = self.end_reason_and_last_points(step)
                if step.end:
                    return step, []
                located = self.locate_bifurcations(step)
                if not (located and located[-1].kind in self.ending_kinds):
                    last, kind = self.fit_impacts_to_step(step)
                    step.end, step.last_points = LIMIT if step.at_limit else "", [last]
                    if kind is not None:
                        located = [*located, Bifurcation(kind, step.length, last)]
                return step, located
            except SOLVER_ERRORS:
                stepper.length = 0.3 * length
                if stepper.length < stepper.min_length:
                    raise

    def locate_bifurcations(self, step: BranchStep[Point]) -> list[Bifurcation[Point]]:
        """Locate all bifurcations in a step, in order, up to the first that ends the branch."""
        tested = [kind for kind in self.kinds if kind in self.ending_kinds]
        ends = self.locate_bifurcations_of(step, tested)[:1]
        if ends:
            length = ends[0].position * (1.0 - 1e-6)  # where the other test functions are defined
            step = replace(step, after=step.point(length), length=length)
        others = [kind for kind in self.kinds if kind not in self.ending_kinds]
        return [*self.locate_bifurcations_of(step, others), *ends]

    def locate_bifurcations_of(
        self, step: BranchStep[Point], kinds: Sequence[Kind]
    ) -> list[Bifurcation[Point]]:
        """Locate the confirmed bifurcations of given kinds in a step; return them in order."""
        confirmed = []
        for kind in kinds:
            for bracket in step.sign_change_brackets(kind):
                position, point = step.solve_for_level(kind, *bracket)
                if self.zero_is_bifurcation(kind, point, position / step.length):
                    confirmed.append(Bifurcation(kind, position, point))
        return sorted(confirmed, key=lambda each: each.position)


@dataclass
class BranchStep(Generic[Point]):
    """One continuation step between two points, with the points solved for in between."""

    tracer: BranchTracer[Any, Point]  # whose stepper is at the step's begin
    before: Point  # at the step's ends
    after: Point
    length: float
    at_limit: bool = False  # whether it ends at a limit of a parameter
    # how fast each test function changed in the step before; infinite where that is not known
    rates: Mapping[Kind, float] = field(default_factory=dict)
    end: str = ""  # why the branch ends with this step; empty where it does not
    last_points: Iterable[Point] = ()  # to add to the branch

    def __post_init__(self) -> None:
        self.solved = {0.0: self.before, self.length: self.after}

    def point(self, position: float) -> Point:
        """Return the branch's point at an arclength into the step, solved for once."""
        if position not in self.solved:
            tracer = self.tracer
            self.solved[position] = tracer.make_point(tracer.stepper.root_after(position))
        return self.solved[position]

    def test_function(self, position: float, kind: Kind) -> float:
        """Return a kind's test function at an arclength into the step; 1 where not finite."""
        value = self.tracer.test_function(self.point(position), kind)
        return value if np.isfinite(value) else 1.0

    def end_values(self, kind: Kind) -> tuple[float, float]:
        """Return a kind's test function at the step's begin and end."""
        value = self.tracer.test_function
        return value(self.before, kind), value(self.after, kind)

    def sign_change_brackets(self, kind: Kind) -> list[tuple[float, float]]:
        """Return intervals of the step in which a kind's test function changes sign."""
        before, after = self.end_values(kind)
        if before * after < 0.0:
            return [(0.0, self.length)]
        if not self.tracer.finds_pairs or self.length <= ACCURACY:
            return []
        # it may cross zero twice: where its size falls and then rises, and reaches zero if it
        # changes twice as fast as in the step before
        if not abs(before) < 2.0 * abs(self.rates.get(kind, np.inf)) * self.length:
            return []
        sign = np.sign(before)
        if not sign * self.end_slope(0.0, kind) < 0.0 < sign * self.end_slope(self.length, kind):
            return []
        from scipy.optimize import minimize_scalar

        minimum = minimize_scalar(
            lambda position: sign * self.test_function(float(position), kind),
            bounds=(0.0, self.length),
            method="bounded",
            options={"xatol": 1e-6 * self.length},
        )
        middle = float(minimum.x)
        crosses = before * self.test_function(middle, kind) < 0.0
        return [(0.0, middle), (middle, self.length)] if crosses else []

    def mean_slope(self, kind: Kind) -> float:
        """Return a test function's mean slope over the step; infinite where it is not finite."""
        before, after = self.end_values(kind)
        change = after - before
        return change / self.length if np.isfinite(change) and self.length else np.inf

    def end_slope(self, position: float, kind: Kind) -> float:
        """Return a test function's slope at the step's begin or end; 0 where not computable."""
        near = position + (1e-3 if position == 0.0 else -1e-3) * self.length
        value = self.tracer.test_function
        try:
            change = value(self.point(near), kind) - value(self.point(position), kind)
        except SOLVER_ERRORS:
            return 0.0
        return change / (near - position) if np.isfinite(change) else 0.0

    def solve_for_level(
        self, kind: Kind, low: float, high: float, level: float = 0.0
    ) -> tuple[float, Point]:
        """Solve by Brent's method for where a test function has a level; return position, point."""
        tolerances = self.tracer.location_tolerances(self.length)
        position = solve_by_brent(
            lambda at: self.test_function(at, kind) - level, low, high, **tolerances
        )
        return position, self.point(position)
