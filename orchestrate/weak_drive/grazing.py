"""Measure how close a stationary motion is to grazing, a contact without closing speed.

There the motion has an impact more or less, and with it a term that grows as the root of the
distance: multipliers run away, and Newton's method ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..dynamics.bifurcations import KINDS, Kind
from ..dynamics.closed_form import Floats
from ..model.structure import Structure
from .record import OscillatorOutputs
from .shooting import Shooter

IMPACT, FLIGHT = KINDS[Kind.GRAZING], KINDS[Kind.TOUCHING]
BACK = 3  # motions over which the slope of a margin is taken


class Margins(NamedTuple):
    """Store how far a motion's gaps and impacts are from grazing, non-dimensional."""

    flight: float  # smallest gap at which the masses turn away from each other without an impact
    impact: float  # smallest closing speed of an impact, over omega


def grazing_margins(shooter: Shooter, unknowns: Floats, angle: float) -> Margins:
    """Simulate one period and return its smallest gap and smallest closing speed."""
    shooter.angle = angle
    master, voltage = shooter.begin_period(unknowns)
    gaps, closing = [math.inf], [math.inf]
    for _ in range(shooter.count):
        before = master.motion
        master.step(voltage)
        if master.motion.impact_time != before.impact_time:
            closing.append(float(shooter.fmus[0].get("impact_velocity")[0]))
        elif before.v2 < before.v1 and master.motion.v2 >= master.motion.v1:
            gaps.append(turning_gap(shooter.structure, before, master.motion, master.scheme.h))
    master.close()
    length = float(shooter.units[0])
    return Margins(min(gaps) / length, min(closing) / length / shooter.structure.omega)


def turning_gap(
    structure: Structure, before: OscillatorOutputs, after: OscillatorOutputs, h: float
) -> float:
    """Return the smallest gap within a step without an impact, m."""
    from scipy.interpolate import BPoly, PPoly

    ends = []
    for outputs in (before, after):
        first = (structure.k1 * outputs.x1 + structure.d1 * outputs.v1) / structure.m1
        second = (structure.k2 * outputs.x2 + structure.d2 * outputs.v2) / structure.m2
        ends.append([outputs.x_rel, outputs.v2 - outputs.v1, first - second])
    gap = PPoly.from_bernstein_basis(BPoly.from_derivatives([0.0, h], ends))
    return float(gap(gap.derivative().roots(extrapolate=False)).min())


def next_grazing(
    shooter: Shooter, motions: Sequence[tuple[Floats, float]]
) -> tuple[Kind | None, float]:
    """Extrapolate which grazing comes next along a branch, and how far away it is."""
    last_motions = motions[-2 * BACK :]
    falling = np.array([grazing_margins(shooter, *motion) for motion in last_motions])
    places = np.array([unknowns[-2:] for unknowns, _ in last_motions])
    kind, distance = None, math.inf
    for last in range(BACK, len(last_motions)):
        first = last - BACK
        distance_back = float(np.linalg.norm(places[last] - places[first]))
        for i, each in enumerate((Kind.TOUCHING, Kind.GRAZING)):
            before, now = float(falling[first, i]), float(falling[last, i])
            ahead = distance_back * now / (before - now) if now < before < math.inf else math.inf
            if ahead < min(distance, 5e-3):  # further on, no fall is extrapolated
                kind, distance = each, ahead
    return kind, distance
