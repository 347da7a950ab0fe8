"""Trace one branch of stationary motions of structure and motor by arclength continuation.

A fold is where the voltage turns back along the branch; elsewhere a multiplier leaves the unit
circle at -1, or a pair of them does. Where an impact or a flight grazes, the branch ends.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from ..dynamics import continuation
from ..dynamics.bifurcation_kinds import KINDS, Kind
from ..dynamics.closed_form import Floats
from ..dynamics.tracer import (
    LIMIT,
    MAX_POINTS,
    NO_CONVERGENCE,
    BranchSegment,
    BranchStep,
    BranchTracer,
    ContinuationSettings,
)
from ..model.structure import Structure
from .extremes import gap_acceleration
from .shooting import Period, Shooter
from .step_record import OscillatorOutputs

IMPACT, FLIGHT = KINDS[Kind.GRAZING], KINDS[Kind.TOUCHING]
BACK = 3  # motions over which the slope of a margin is taken
NO_START = "no motion at the start"
NOT_BEGUN = "not begun: the other leg has gone all the way"
HALVED = "reaches the motion of half its period"
UNFINISHED = KINDS[Kind.CONTACT_LOST]  # of a chattering that no longer comes to its end
ENDS = (LIMIT, NO_CONVERGENCE, MAX_POINTS, NO_START, NOT_BEGUN, HALVED, FLIGHT, IMPACT, UNFINISHED)
AT_GRAZING = 1e-4  # of voltage over K omega and speed over omega: so near, a grazing is located
ITERATIONS = 12  # of Newton's method from a guess that is not of the branch itself


class Motion(NamedTuple):
    """Store one stationary motion of a branch: root, Jacobian, multipliers and period."""

    root: continuation.Root
    matrix: Floats  # jacobian there
    multipliers: np.ndarray  # floquet multipliers, the largest first
    period: Period
    angle: float  # of the motor where the period begins, rad
    in_contact: bool  # whether it begins with the masses in contact

    @property
    def coordinates(self) -> Floats:
        """Return the motion's voltage over K omega and its speed over omega."""
        return self.root.unknowns[-2:]


class ShooterStepper(continuation.ArclengthStepper[Shooter]):
    """Step along a branch by arclength, each attempt from the current motion's Jacobian."""

    jacobian: Floats

    def root_after(self, length: float) -> continuation.Root:
        self.curve.set_root_jacobian(self.root.unknowns, self.jacobian)
        return super().root_after(length)

    def solve_at(self, unknown: int, value: float) -> continuation.Root:
        self.curve.set_root_jacobian(self.root.unknowns, self.jacobian)
        return super().solve_at(unknown, value)


class DriveTracer(BranchTracer[Shooter, Motion]):
    """Trace a branch of stationary motions within a range of speeds; locate bifurcations."""

    kinds = (Kind.FOLD, Kind.FLIP, Kind.TORUS)
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
            min_length=1e-5 * longest,  # round a fold whose radius is 1e-4 of the amplitude too
            tolerance=1e-5,  # from which on the derivative at the root is worth its cost
        )
        super().__init__(stepper, settings.max_points)

    def make_point(self, root: continuation.Root) -> Motion:
        return observe_motion(self.shooter, root, self.stepper.root.tangent)

    def first_limited_unknown_and_limits(self) -> tuple[int, Sequence[tuple[float, float]]]:
        return self.shooter.size + 1, [self.speeds]

    def move_stepper_to(self, point: Motion) -> Motion:
        """Set the stepper to a motion, begun far from impacts, for the next step; return it."""
        motion = begin_far_from_impacts(self.shooter, point)
        self.stepper.root, self.stepper.jacobian = motion.root, motion.matrix
        self.shot = self.shooter.shoot(motion.root.unknowns)
        self.half_change = state_change_over_half_period(self.shooter, motion.root)
        return motion

    def accepts(self, root: continuation.Root) -> bool:
        return self.shooter.shoot(root.unknowns).is_connected_to(self.shot)

    def test_function(self, point: Motion, kind: Kind) -> float:
        values = point.multipliers
        if kind == Kind.FOLD:
            return float(point.root.tangent[-2])
        if kind == Kind.FLIP:
            return float(np.prod(1.0 + values).real)
        return float(np.prod([1.0 - a * b for a, b in combinations(values, 2)]).real)

    def zero_is_bifurcation(self, kind: Kind, point: Motion, part: float) -> bool:
        """Return True, but for a torus whether a complex pair lies on the unit circle."""
        pairs = point.multipliers[np.abs(point.multipliers.imag) > 1e-6]
        return kind != Kind.TORUS or bool((np.abs(np.abs(pairs) - 1.0) < 1e-4).any())

    def location_tolerances(self, length: float) -> dict[str, float]:
        return {"xtol": 1e-6 * length}

    def end_reason_and_last_points(self, step: BranchStep[Motion]) -> tuple[str, Iterable[Motion]]:
        # beyond, the same motions come again, half a period later
        change = state_change_over_half_period(self.shooter, step.after.root)
        return (HALVED if self.half_change @ change < 0.0 else ""), ()

    def set_end_without_root(self, segment: BranchSegment[Motion]) -> None:
        """Set why a leg ends where Newton's method fails; thin out its points next to a grazing."""
        # had a late motion a contact phase, it is that which is lost
        if any(motion.period.sticks for motion in segment.points[-12:]):
            segment.end = UNFINISHED
            return
        last = segment.points[-1]
        motions = [each for each in segment.points if each.in_contact == last.in_contact]
        kind, distance = extrapolate_next_grazing(self.shooter, motions)
        segment.end = NO_CONVERGENCE if kind is None else KINDS[kind]
        kept = [each for each in segment.points[:-1] if distance_between(each, last) > AT_GRAZING]
        segment.points = [*kept, last]
        if kind is not None and distance < AT_GRAZING:
            segment.add_bifurcation(kind, last, 0.0)


def observe_motion(shooter: Shooter, root: continuation.Root, direction: Floats) -> Motion:
    along = root if root.tangent @ direction > 0.0 else root.reversed()
    values = shooter.floquet_multipliers()
    period = shooter.observe_period(root.unknowns)
    return Motion(along, shooter.jacobian_matrix, values, period, shooter.angle, shooter.in_contact)


def find_motion_near(shooter: Shooter, guess: Floats, up: bool) -> Motion:
    shooter.compute_jacobian(guess)
    speed = continuation.unit_vector(len(guess), -1)
    root = continuation.newton_correct(shooter, guess, speed, max_iterations=ITERATIONS)
    return observe_motion(shooter, root, speed if up else -speed)


def find_doubled_motion(shooter: Shooter, flip: Motion) -> Motion:
    for distance in (3e-3, 1e-3, 3e-4):
        shooter.define_unknowns(flip.in_contact)
        shooter.set_revolutions(flip.period.revolutions)
        shooter.angle, shooter.jacobian_matrix = flip.angle, flip.matrix
        away = np.append(shooter.flip_direction(), [0.0, 0.0])
        guess = flip.root.unknowns + distance * away
        shooter.set_revolutions(2 * shooter.revolutions)
        with contextlib.suppress(continuation.NoConvergenceError):
            root = continuation.newton_correct(shooter, guess, away, max_iterations=ITERATIONS)
            return observe_motion(shooter, root, away)
    raise continuation.NoConvergenceError("no motion of twice the period near a period doubling")


def begin_far_from_impacts(shooter: Shooter, motion: Motion) -> Motion:
    """Return a motion begun far from impacts: the same, or begun later."""
    # a motion that begins with an impact has no derivative
    period, in_contact = motion.period, motion.period.in_contact
    if period.start_clearance > 0.3 and in_contact == motion.in_contact:
        return motion
    root = motion.root
    unknowns = shooter.shift_start(root.unknowns, period.clearest_step, in_contact)
    matrix = shooter.compute_jacobian(unknowns)
    direction = np.append(np.zeros(shooter.size), root.tangent[-2:])  # of voltage and speed
    tangent = continuation.unit_tangent(np.vstack([matrix, direction]))
    moved = replace(root, unknowns=unknowns, tangent=tangent)
    return motion._replace(
        root=moved, matrix=matrix, angle=shooter.angle, in_contact=shooter.in_contact
    )


def state_change_over_half_period(shooter: Shooter, root: continuation.Root) -> Floats:
    """Return how the state changes over half the period; 0 for an odd one."""
    if shooter.revolutions % 2:
        return np.zeros(1)
    return shooter.state_change_after(root.unknowns, shooter.revolutions // 2)


def distance_between(first: Motion, second: Motion) -> float:
    """Return the distance of two motions in voltage and speed, both non-dimensional."""
    return float(np.linalg.norm(first.coordinates - second.coordinates))


def measure_grazing_margins(shooter: Shooter, motion: Motion) -> tuple[float, float]:
    """Return how far a motion is from grazing: by a flight, and by an impact, non-dimensional."""
    # the smallest gap at which the masses turn away from each other without an impact,
    # and the smallest closing speed of an impact, over omega
    shooter.angle = motion.angle
    master, voltage = shooter.begin_period(motion.root.unknowns)
    gaps, closing = [math.inf], [math.inf]
    for _ in range(shooter.period_steps):
        before = master.motion
        master.step(voltage)
        if master.motion.impact_time != before.impact_time:
            closing.append(float(shooter.fmus[0].get("impact_velocity")[0]))
        elif before.v2 < before.v1 and master.motion.v2 >= master.motion.v1:
            ends = before, master.motion
            gaps.append(smallest_gap_in_step(shooter.structure, ends, master.scheme.h))
    length = float(shooter.units[0])
    return min(gaps) / length, min(closing) / length / shooter.structure.omega


def smallest_gap_in_step(
    structure: Structure, ends: Sequence[OscillatorOutputs], h: float
) -> float:
    """Return the smallest gap within a step without an impact, m."""
    from scipy.interpolate import BPoly, PPoly

    derivatives = [[m.x_rel, m.v2 - m.v1, gap_acceleration(structure, m)] for m in ends]
    gap = PPoly.from_bernstein_basis(BPoly.from_derivatives([0.0, h], derivatives))
    return float(gap(gap.derivative().roots(extrapolate=False)).min())


def extrapolate_next_grazing(
    shooter: Shooter, motions: Sequence[Motion]
) -> tuple[Kind | None, float]:
    """Extrapolate which grazing comes next along a branch, and how far away it is."""
    late = motions[-2 * BACK :]
    margins = np.array([measure_grazing_margins(shooter, motion) for motion in late])
    kind, distance = None, math.inf
    for last in range(BACK, len(late)):
        first = last - BACK
        distance_back = distance_between(late[last], late[first])
        for i, each in enumerate((Kind.TOUCHING, Kind.GRAZING)):
            before, now = float(margins[first, i]), float(margins[last, i])
            ahead = distance_back * now / (before - now) if now < before < math.inf else math.inf
            if ahead < min(distance, 5e-3):  # further on, no fall is extrapolated
                kind, distance = each, ahead
    return kind, distance
