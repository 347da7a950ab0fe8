"""Grow a curve that is an image of a parameter: adaptive steps, breaks at its discontinuities.

The number ``s`` of a point counts how often the first piece is mapped (Hobson, Journal of
Computational Physics 104, 14, 1993); every point is computed from its own start. Points are as
close as distance and bend ask for (Krauskopf and Osinga, ibid. 146, 404, 1998). Where impacts come
or go, the place is bisected to rounding: the power with which the distance of both points falls
with that of their numbers is 1 on a smooth curve, 1/2 at a grazing, 0 at a jump, and decides.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .closed_form import Floats

STILL = 1e-12  # of the size: so near are points that rounding moves
LENGTH, POINTS, CONVERGED = "length", "most points", "converges"


class CurvePoint(NamedTuple):
    """A point of a grown curve: parameter s, state, and itinerary (its counts of impacts)."""

    s: float  # its number
    state: Floats
    # what happened on the way to it, such as numbers of impacts: the curve can only be broken where
    # that changes
    itinerary: tuple[int, ...]


class ItineraryChange(NamedTuple):
    """Two neighbouring curve points, bisected to rounding, between which impacts change."""

    low: CurvePoint
    high: CurvePoint
    distance: float  # of both
    power: float  # of the distance of their numbers, with which that distance falls


@dataclass(frozen=True)
class GrowthSettings:
    """Settings for growing a curve: its length, spacing, angle between chords, most points."""

    length: float  # at which it ends
    spacing: float  # largest distance of neighbours
    angle: float  # largest angle between successive chords, rad
    max_points: int
    size: float = 1.0  # what is small is so in comparison with it
    max_step: float = 0.25  # of s
    resolution: float = 1e-14  # of s: what rounding leaves of it


@dataclass
class GrownCurve:
    """A grown curve: its points, arclengths, breaks, and why it ended."""

    points: list[CurvePoint] = field(default_factory=list)
    arclength: list[float] = field(default_factory=list)  # without what is broken
    # by the number of the first point after each break
    breaks: dict[int, ItineraryChange] = field(default_factory=dict)
    end: str = ""

    def add(self, point: CurvePoint, distance: float) -> None:
        """Append a point at a distance from the last one."""
        self.arclength.append((self.arclength[-1] if self.arclength else 0.0) + distance)
        self.points.append(point)


def distance_between(first: CurvePoint, second: CurvePoint) -> float:
    """Return the Euclidean distance of two points' states, with equal bits on all processors."""
    return math.dist(second.state.tolist(), first.state.tolist())


def shrinking_power(history: list[tuple[float, float]]) -> float:
    """Return the power with which a bisection's distances shrink with its intervals (0: jump)."""
    (far, before), (near, after) = history[-1 - len(history) // 4], history[-1]
    if not (0.0 < near < far and after > 0.0 and before > 0.0):
        return 0.0 if after > 0.0 else 1.0
    return float(np.log(before / after) / np.log(far / near))


class CurveGrower:
    """Grows a curve point by point, with steps adapted to the distance and bend of its points."""

    def __init__(self, image: Callable[[float], CurvePoint], settings: GrowthSettings) -> None:
        self.image, self.settings = image, settings
        self.direction: Floats | None = None  # of the last chord

    def grow(self) -> GrownCurve:
        """Compute points from s = 0 on until the curve is long enough, converges, or has many."""
        settings, curve = self.settings, GrownCurve()
        curve.add(self.image(0.0), 0.0)
        step, change_ahead = 0.05, None
        while not curve.end:
            last = curve.points[-1]
            if change_ahead is not None and last.s >= change_ahead.low.s:
                self.append_beyond_change(curve, change_ahead)
                change_ahead, step = None, min(step, 1e-3)  # no bend is known there yet
                curve.end = self.end_reason(curve)
                continue
            target = last.s + step
            is_beyond = change_ahead is not None and target >= change_ahead.low.s
            point = change_ahead.low if change_ahead and is_beyond else self.image(target)
            if point.itinerary != last.itinerary:
                change_ahead = self.bisect_change(last, point)
                continue
            distance, angle = distance_between(last, point), self.angle_to(last, point)
            sharp = distance <= 0.01 * settings.spacing  # the curve may bend there as it will
            if distance <= settings.spacing and (sharp or angle <= settings.angle):
                curve.add(point, distance)
                if distance > STILL * settings.size:
                    self.direction = (point.state - last.state) / distance
                easy = distance <= 0.5 * settings.spacing and angle <= 0.5 * settings.angle
                step = min(step * (1.5 if easy else 1.0), settings.max_step)
                curve.end = self.end_reason(curve)
            elif point.s - last.s > settings.resolution * max(1.0, last.s):
                step = 0.5 * (point.s - last.s)
            else:  # a jump without another itinerary
                change_ahead = ItineraryChange(last, point, distance, 0.0)
        return curve

    def angle_to(self, last: CurvePoint, point: CurvePoint) -> float:
        """Return the angle, rad, between the curve's direction and the chord to a point."""
        size = distance_between(last, point)
        if self.direction is None or size <= STILL * self.settings.size:
            return 0.0
        cosine = math.fsum((self.direction * (point.state - last.state)).tolist()) / size
        return math.acos(max(-1.0, min(1.0, cosine)))

    def bisect_change(self, low: CurvePoint, high: CurvePoint) -> ItineraryChange:
        """Bisect between two points for where the itinerary changes; return the pair there."""
        resolution = self.settings.resolution * max(1.0, low.s)
        history = [(high.s - low.s, distance_between(low, high))]
        while high.s - low.s > resolution:
            middle = self.image(0.5 * (low.s + high.s))
            if not low.s < middle.s < high.s:
                break
            if middle.itinerary == low.itinerary:
                low = middle
            else:
                high = middle
            history.append((high.s - low.s, distance_between(low, high)))
        return ItineraryChange(low, high, history[-1][1], shrinking_power(history))

    def append_beyond_change(self, curve: GrownCurve, change: ItineraryChange) -> None:
        """Append the point beyond a change of itinerary: connected, or after a break."""
        # less than half of the power of a grazing impact is a jump
        broken = change.distance > STILL * self.settings.size and change.power < 0.25
        if broken:
            curve.breaks[len(curve.points)] = change
        curve.add(change.high, 0.0 if broken else change.distance)
        self.direction = None

    def end_reason(self, curve: GrownCurve) -> str:
        """Return why a curve ends at its last point, or "" while it goes on."""
        settings, last = self.settings, curve.points[-1]
        if curve.arclength[-1] >= settings.length:
            return LENGTH
        if len(curve.points) >= settings.max_points:
            return POINTS
        window = 2.0 * max(1.0, settings.max_step)
        before = bisect_left(curve.points, last.s - window, key=lambda point: point.s)
        gained = curve.arclength[-1] - curve.arclength[before - 1]
        grown = curve.arclength[-1] > settings.spacing
        return CONVERGED if grown and before and gained < 1e-7 * settings.size else ""
