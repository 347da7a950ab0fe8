"""Branches of stationary motions of structure and motor: what the tracer needs to know of them.

A fold is where the voltage turns back along the branch; elsewhere a multiplier leaves the unit
circle at -1, or a pair of them does. Where an impact or a flight grazes, the branch ends: see
:mod:`.grazing`.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from ..dynamics.bifurcations import CONTACT_LOST, FLIP, FOLD, KINDS, TORUS, BifurcationKind
from ..dynamics.closed_form import Floats
from ..dynamics.continuation import (
    ArclengthStepper,
    NoConvergenceError,
    Root,
    newton_correct,
    unit_tangent,
    unit_vector,
)
from ..dynamics.tracer import (
    LIMIT,
    MAX_POINTS,
    NO_CONVERGENCE,
    BranchSegment,
    BranchStep,
    BranchTracer,
    ContinuationSettings,
)
from .grazing import FLIGHT, IMPACT, next_grazing
from .shooting import Period, Shooter

NO_START = "no motion at the start"
NOT_BEGUN = "not begun: the other leg has gone all the way"
HALVED = "meets the motion of half its period"
UNFINISHED = KINDS[CONTACT_LOST]  # of a chattering that no longer comes to its end
ENDS = (LIMIT, NO_CONVERGENCE, MAX_POINTS, NO_START, NOT_BEGUN, HALVED, FLIGHT, IMPACT, UNFINISHED)
AT_GRAZING = 1e-4  # of voltage over K omega and speed over omega: so near, a grazing is located
AWAY = (3e-3, 1e-3, 3e-4)  # of the unit: how far from a doubling twice the period is begun
ON_CIRCLE = 1e-4  # of a located pair of multipliers: how far its size may be from 1
COMPLEX = 1e-6  # imaginary part from which multipliers are a pair
NARROW = 0.3  # of the widest gap: where the gap at the start is less, periods begin elsewhere;
# or of the largest force in contact
STUCK = 12  # motions before an end: had one a contact phase, it is that which is lost
TOLERANCE = 1e-5  # of a step by secants, from which on the derivative at the root is worth its cost
ACCURACY = 1e-6  # of a step: how exactly a bifurcation is located
SHORTEST = 1e-5  # of the longest step: round a fold whose radius is 1e-4 of the amplitude too
ITERATIONS = 12  # of Newton's method from a guess that is not of the branch itself


class Motion(NamedTuple):
    """A stationary motion on a branch.

    Attributes
    ----------
    root : Root
    matrix : ndarray
        Jacobian there.
    multipliers : ndarray of complex
        Floquet multipliers, the largest first.
    period : Period
    angle : float
        Of the motor where the period begins, rad.
    together : bool
        Whether it begins with the masses in contact.
    """

    root: Root
    matrix: Floats
    multipliers: np.ndarray
    period: Period
    angle: float
    together: bool

    @property
    def place(self) -> Floats:
        """Position on the branch: voltage over K omega and speed over omega."""
        return self.root.unknowns[-2:]


class ShooterStepper(ArclengthStepper[Shooter]):
    """Arclength stepper that starts every attempt with the Jacobian of the current motion."""

    jacobian: Floats

    def put_to(self, motion: Motion) -> None:
        """Move the stepper to a motion."""
        self.root, self.jacobian = motion.root, motion.matrix

    def root_after(self, length: float) -> Root:
        """Return the root as :meth:`.ArclengthStepper.root_after` does."""
        self.curve.restart(self.root.unknowns, self.jacobian)
        return super().root_after(length)

    def solve_at(self, unknown: int, value: float) -> Root:
        """Return the root as :meth:`.ArclengthStepper.solve_at` does."""
        self.curve.restart(self.root.unknowns, self.jacobian)
        return super().solve_at(unknown, value)


class DriveTracer(BranchTracer[Shooter, Motion]):
    """Traces a branch of stationary motions until it leaves a range of speeds, or is lost.

    Parameters
    ----------
    shooter : Shooter
    start : Motion
    speeds : (float, float)
        Lowest and highest, over omega.
    settings : ContinuationSettings
    """

    kinds = (FOLD, FLIP, TORUS)
    stepper: ShooterStepper

    def __init__(
        self,
        shooter: Shooter,
        start: Motion,
        speeds: tuple[float, float],
        settings: ContinuationSettings,
    ) -> None:
        self.shooter, self.speeds = shooter, speeds
        longest = settings.max_step
        stepper = ShooterStepper(
            shooter,
            start.root,
            longest,
            longest,
            min_length=SHORTEST * longest,
            tolerance=TOLERANCE,
        )
        super().__init__(stepper, settings.max_points)

    def point(self, root: Root) -> Motion:
        """Return the motion of a root that has just been solved for."""
        return motion_at(self.shooter, root, self.stepper.root.tangent)

    def limits(self) -> tuple[int, Sequence[tuple[float, float]]]:
        """Return the index of the speed among the unknowns, and its limits in a list."""
        return self.shooter.size + 1, [self.speeds]

    def go_on_from(self, point: Motion) -> Motion:
        """Move the stepper to a motion whose period begins far from impacts."""
        motion = start_far_from_impacts(self.shooter, point)
        self.stepper.put_to(motion)
        self.shot = self.shooter.shoot(motion.root.unknowns)
        self.half_period_change = half_period_change(self.shooter, motion.root)
        return motion

    def accepts(self, root: Root) -> bool:
        """Return whether a motion has the impacts of the one before.

        With others it lies beyond a grazing.
        """
        return self.shooter.shoot(root.unknowns).like(self.shot)

    def test(self, point: Motion, kind: BifurcationKind) -> float:
        """Evaluate a test function: change of the voltage, or a product of multipliers."""
        values = point.multipliers
        if kind == FOLD:
            return float(point.root.tangent[-2])
        if kind == FLIP:
            return float(np.prod(1.0 + values).real)
        return float(np.prod([1.0 - a * b for a, b in combinations(values, 2)]).real)

    def confirms(self, kind: BifurcationKind, point: Motion, part: float) -> bool:
        """Return whether a torus is one: its pair is complex, not two real ones of product 1."""
        pairs = point.multipliers[np.abs(point.multipliers.imag) > COMPLEX]
        return kind != TORUS or bool((np.abs(np.abs(pairs) - 1.0) < ON_CIRCLE).any())

    def location_tolerances(self, length: float) -> dict[str, float]:
        """Return the tolerances of a bifurcation's location, as parts of the step."""
        return {"xtol": ACCURACY * length}

    def end_before(self, step: BranchStep[Motion]) -> tuple[str, Iterable[Motion]]:
        """Return a reason where a motion of half the period is passed, else ``""``; no points.

        Beyond it come the same motions again, half a period later.
        """
        change = half_period_change(self.shooter, step.after.root)
        return (HALVED if self.half_period_change @ change < 0.0 else ""), ()

    def end_without_root(self, segment: BranchSegment[Motion]) -> None:
        """Set why a segment ends where Newton's method fails; drop motions crowded there.

        Steps are short there: one motion stands for all that are too near to be seen in a plot.
        """
        if any(motion.period.sticks for motion in segment.points[-STUCK:]):
            segment.end = UNFINISHED
            return
        motions = [each for each in segment.points if each.together == segment.points[-1].together]
        kind, distance = next_grazing(
            self.shooter, [(motion.root.unknowns, motion.angle) for motion in motions]
        )
        segment.end = NO_CONVERGENCE if kind is None else KINDS[kind]
        last = motions[-1]
        kept = [each for each in segment.points[:-1] if distance_between(each, last) > AT_GRAZING]
        segment.points = [*kept, last]
        if kind is not None and distance < AT_GRAZING:
            segment.add_bifurcation(kind, last, 0.0)


def trace_branch(
    shooter: Shooter, start: Motion, speeds: tuple[float, float], settings: ContinuationSettings
) -> BranchSegment[Motion]:
    """Trace the branch from a motion until it leaves a range of speeds, over omega, or is lost."""
    return DriveTracer(shooter, start, speeds, settings).trace(start)


def motion_at(shooter: Shooter, root: Root, direction: Floats) -> Motion:
    """Make a motion of a root just solved for, its tangent along a direction."""
    along = root if root.tangent @ direction > 0.0 else root.reversed()
    values = shooter.multipliers()
    period = shooter.observe_period(root.unknowns)
    return Motion(along, shooter.matrix, values, period, shooter.angle, shooter.together)


def motion_near(shooter: Shooter, guess: Floats, up: bool) -> Motion:
    """Return the motion of a given speed near a guess, to go on up or down the speeds.

    Raises
    ------
    NoConvergenceError
        Where there is none.
    """
    shooter.renew_jacobian(guess)
    speed = unit_vector(len(guess), -1)
    root = newton_correct(shooter, guess, speed, max_iterations=ITERATIONS)
    return motion_at(shooter, root, speed if up else -speed)


def double_period(shooter: Shooter, flip: Motion) -> Motion:
    """Return a motion of twice the period near a period doubling, to go away from it.

    Raises
    ------
    NoConvergenceError
        Where there is none.
    """
    for distance in AWAY:
        shooter.begin_together(flip.together)
        shooter.repeat_after(flip.period.revolutions)
        shooter.angle, shooter.matrix = flip.angle, flip.matrix
        away = np.append(shooter.flip_direction(), [0.0, 0.0])
        guess = flip.root.unknowns + distance * away
        shooter.repeat_after(2 * shooter.turns)
        with contextlib.suppress(NoConvergenceError):
            root = newton_correct(shooter, guess, away, max_iterations=ITERATIONS)
            return motion_at(shooter, root, away)
    raise NoConvergenceError("no motion of twice the period near a period doubling")


def start_far_from_impacts(shooter: Shooter, motion: Motion) -> Motion:
    """Return a motion begun where the gap is wide, or the masses are pressed hard.

    A motion that begins with an impact has no derivative.
    """
    period, together = motion.period, motion.period.together
    if period.share > NARROW and together == motion.together:
        return motion
    root = motion.root
    unknowns = shooter.begin_later(root.unknowns, period.clear, together)
    matrix = shooter.renew_jacobian(unknowns)
    direction = np.append(np.zeros(shooter.size), root.tangent[-2:])  # of voltage and speed
    tangent = unit_tangent(np.vstack([matrix, direction]))
    moved = replace(root, unknowns=unknowns, tangent=tangent)
    return motion._replace(
        root=moved, matrix=matrix, angle=shooter.angle, together=shooter.together
    )


def half_period_change(shooter: Shooter, root: Root) -> Floats:
    """Return the change of the state in half of an even number of revolutions; 0 if it is odd."""
    if shooter.turns % 2:
        return np.zeros(1)
    return shooter.change_in(root.unknowns, shooter.turns // 2)


def distance_between(first: Motion, second: Motion) -> float:
    """Return the distance of two motions in (voltage over K omega, speed over omega)."""
    return float(np.linalg.norm(first.place - second.place))
