"""A branch of stationary motions, followed by its arclength, with the bifurcations on the way.

A fold is where the voltage turns back along the branch; elsewhere a multiplier leaves the unit
circle at -1, or a pair of them does. Each is located on the branch itself, not between its points.
Where an impact or a flight grazes the branch ends: see :mod:`.grazing`.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from ..dynamics.closed_form import Floats
from ..dynamics.continuation import NoConvergenceError, Root, Walk, corrected, held, null_vector
from .averaged import FOLD, TORUS
from .grazing import FLIGHT, IMPACT, grazing_ahead
from .shooting import Period, Shooter

FLIP = "period doubling"
LIMIT, STUCK, LONG, NONE = "limit", "no convergence", "most points", "no motion at the start"
NOT_BEGUN = "not begun: the other leg has gone all the way"
HALVED = "meets the motion of half its period"
ENDS = (LIMIT, STUCK, LONG, NONE, NOT_BEGUN, HALVED, FLIGHT, IMPACT)
LOCATED = 1e-4  # of voltage over K omega and speed over omega: how near a grazing has been found
AWAY = (3e-3, 1e-3, 3e-4)  # of the unit: how far from a doubling twice the period is begun
ON_CIRCLE = 1e-4  # of a pair that has been located: how far its size may be from 1
NEAR = 0.3  # of the widest gap: where the gap at the start is less, periods begin elsewhere
CONVERGED = 1e-5  # a step by secants from which on the derivative at the root is worth its while
ACCURACY = 1e-6  # of a step: how exactly a bifurcation is located
SHORTEST = 1e-5  # of the longest step: round a fold whose radius is 1e-4 of the amplitude too


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
    """

    root: Root
    matrix: Floats
    multipliers: np.ndarray
    period: Period
    angle: float


class Bifurcation(NamedTuple):
    """A motion at which stability changes, or the voltage turns back."""

    kind: str
    motion: Motion


@dataclass(frozen=True)
class Pace:
    """How a branch is followed.

    Attributes
    ----------
    longest : float
        Longest step, in unknowns.
    most : int
        Points.
    """

    longest: float
    most: int


@dataclass
class Leg:
    """A branch from one end of the speeds.

    Attributes
    ----------
    motions : list of Motion
    bifurcations : list of Bifurcation
    end : str
        Why it ends.
    """

    motions: list[Motion] = field(default_factory=list)
    bifurcations: list[Bifurcation] = field(default_factory=list)
    end: str = ""


# -- functions that change their sign at a bifurcation ---------------------------------------------


def voltage_ahead(motion: Motion) -> float:
    """Whether the voltage rises along the branch."""
    return float(motion.root.tangent[-2])


def not_doubled(motion: Motion) -> float:
    """Product of all 1 + multiplier."""
    return float(np.prod(1.0 + motion.multipliers).real)


def pairs_inside(motion: Motion) -> float:
    """Product of 1 less the product of two multipliers, over all twos."""
    return float(np.prod([1.0 - a * b for a, b in combinations(motion.multipliers, 2)]).real)


TESTS: dict[str, Callable[[Motion], float]] = {
    FOLD: voltage_ahead,
    FLIP: not_doubled,
    TORUS: pairs_inside,
}


def happens(kind: str, motion: Motion) -> bool:
    """Whether it is a pair that leaves the circle: two real ones of product 1 do not."""
    turning = motion.multipliers[np.abs(motion.multipliers.imag) > 1e-6]
    return kind != TORUS or bool((np.abs(np.abs(turning) - 1.0) < ON_CIRCLE).any())


# -- along the branch ------------------------------------------------------------------------------


class ShooterWalk(Walk[Shooter]):
    """A walk whose every try begins with the Jacobian of the motion where it stands."""

    matrix: Floats

    def stand(self, motion: Motion) -> None:
        """Go on from a motion."""
        self.root, self.matrix = motion.root, motion.matrix

    def at(self, length: float) -> Root:
        """As :meth:`.Walk.at`."""
        self.curve.restart(self.root.unknowns, self.matrix)
        return super().at(length)

    def land(self, unknown: int, value: float) -> Root:
        """As :meth:`.Walk.land`."""
        self.curve.restart(self.root.unknowns, self.matrix)
        return super().land(unknown, value)


def motion_at(shooter: Shooter, root: Root, ahead: Floats) -> Motion:
    """A root that has just been found as a motion; ``ahead`` is the side of its tangent."""
    tangent = root.tangent if root.tangent @ ahead > 0.0 else -root.tangent
    values = shooter.multipliers()
    period = shooter.look(root.unknowns)
    return Motion(replace(root, tangent=tangent), shooter.matrix, values, period, shooter.angle)


def motion_near(shooter: Shooter, guess: Floats, up: bool) -> Motion:
    """The motion of a given speed near a guess, to go on up or down the speeds.

    Raises
    ------
    NoConvergenceError
        Where there is none.
    """
    shooter.renew(guess)
    root = corrected(shooter, guess, held(shooter, -1), most=12)
    ahead = np.zeros_like(guess)
    ahead[-1] = 1.0 if up else -1.0
    return motion_at(shooter, root, ahead)


def doubled(shooter: Shooter, flip: Motion) -> Motion:
    """A motion of twice the period near a period doubling, to go away from it.

    Raises
    ------
    NoConvergenceError
        Where there is none.
    """
    for distance in AWAY:
        shooter.repeat_after(flip.period.revolutions)
        shooter.angle, shooter.matrix = flip.angle, flip.matrix
        away = np.append(shooter.alternating(), [0.0, 0.0])
        guess = flip.root.unknowns + distance * away
        shooter.repeat_after(2 * shooter.turns)
        with contextlib.suppress(NoConvergenceError):
            root = corrected(shooter, guess, away, most=12)
            return motion_at(shooter, root, away)
    raise NoConvergenceError("no motion of twice the period near a period doubling")


def clear_start(shooter: Shooter, motion: Motion) -> Motion:
    """The same motion, begun where the gap is wide: an impact at the start has no derivative."""
    if motion.period.share > NEAR:
        return motion
    root = motion.root
    unknowns = shooter.begin_later(root.unknowns, motion.period.clear)
    matrix = shooter.renew(unknowns)
    ahead = np.append(np.zeros(shooter.size), root.tangent[-2:])  # as before: voltage and speed
    tangent = null_vector(np.vstack([matrix, ahead]))
    moved = replace(root, unknowns=unknowns, tangent=tangent)
    return motion._replace(root=moved, matrix=matrix, angle=shooter.angle)


def follow(shooter: Shooter, start: Motion, speeds: tuple[float, float], pace: Pace) -> Leg:
    """Follow a branch until it leaves a range of speeds, over omega, or is lost."""
    leg = Leg([start])
    begin = clear_start(shooter, start)
    walk = ShooterWalk(
        shooter,
        begin.root,
        pace.longest,
        pace.longest,
        shortest=SHORTEST * pace.longest,
        tolerance=CONVERGED,
    )
    halves = half_way(shooter, begin.root)
    while not leg.end:
        if len(leg.motions) >= pace.most:
            leg.end = LONG
            break
        walk.stand(begin)
        try:
            after, length, arrived = next_motion(walk, speeds)
        except NoConvergenceError:
            end_without_root(leg, shooter)
            break
        halves_before, halves = halves, half_way(shooter, after.root)
        if halves_before @ halves < 0.0:  # the same motion from here on, half a period later
            leg.end = HALVED
            break
        leg.bifurcations += located(walk, begin, after, length)
        leg.motions.append(after)
        leg.end = LIMIT if arrived else ""
        begin = clear_start(shooter, after)
        if begin is not after:
            halves = half_way(shooter, begin.root)
    return leg


def next_motion(walk: ShooterWalk, speeds: tuple[float, float]) -> tuple[Motion, float, bool]:
    """The next motion, the length of the step to it, and whether it lies on a limit.

    It has the impacts of the one before: with others it lies beyond a grazing.

    Raises
    ------
    NoConvergenceError
        Where there is none.
    """
    shooter = walk.curve
    here = shooter.shoot(walk.root.unknowns)
    root, length, arrived = walk.inside(
        shooter.size + 1, [speeds], lambda root: shooter.shoot(root.unknowns).like(here)
    )
    return motion_at(shooter, root, walk.root.tangent), length, arrived


def end_without_root(leg: Leg, shooter: Shooter) -> None:
    """Say why a branch ends where Newton's method finds no motion further on.

    Steps are short there: one motion stands for all that are nearer than can be told from a plot.
    """
    seen = [(motion.root.unknowns, motion.angle) for motion in leg.motions]
    kind, distance = grazing_ahead(shooter, seen)
    leg.end = kind or STUCK
    last = leg.motions.pop()
    leg.motions = [one for one in leg.motions if apart(one, last) > LOCATED]
    leg.motions.append(last)
    if kind and distance < LOCATED:
        leg.bifurcations.append(Bifurcation(kind, last))


def apart(one: Motion, other: Motion) -> float:
    """How far apart motions are: voltage over K omega and speed over omega."""
    return float(np.linalg.norm(one.root.unknowns[-2:] - other.root.unknowns[-2:]))


def half_way(shooter: Shooter, root: Root) -> Floats:
    """What the state changes in half of an even period; nothing in an odd one."""
    if shooter.turns % 2:
        return np.zeros(1)
    return shooter.change_in(root.unknowns, shooter.turns // 2)


def located(walk: ShooterWalk, before: Motion, after: Motion, length: float) -> list[Bifurcation]:
    """Bifurcations in a step, in order."""
    found = []
    for kind, test in TESTS.items():
        if test(before) * test(after) < 0.0:
            there = locate(walk, test, {0.0: before, length: after})
            if there is not None and happens(kind, there[1]):
                found.append((there[0], Bifurcation(kind, there[1])))
    return [one for _, one in sorted(found, key=lambda each: each[0])]


def locate(
    walk: ShooterWalk, test: Callable[[Motion], float], ends: dict[float, Motion]
) -> tuple[float, Motion] | None:
    """Where on the way a test is 0: length, and the motion; ``ends`` are those of the step."""
    from scipy.optimize import brentq

    shooter, ahead, length = walk.curve, walk.root.tangent, max(ends)
    known = dict(ends)

    def value(place: float) -> float:
        if place not in known:
            known[place] = motion_at(shooter, walk.at(place), ahead)
        return test(known[place])

    try:
        place = brentq(value, 0.0, length, xtol=ACCURACY * length)
        value(place)
    except NoConvergenceError:
        return None
    return place, known[place]
