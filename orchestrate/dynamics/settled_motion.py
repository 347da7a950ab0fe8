"""What a response has settled to, and how that was decided; when two of these are the same."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..response.multiplicity import LEAST_GAP
from ..response.questions import Point
from .impact_sequence import PHASE, TURN, Ring
from .turning_points import Amplitudes, phase_zero, turning_points

Floats = NDArray[np.float64]
ABSENT, ORBIT, REPEATED, IRREGULAR, UNDECIDED = range(5)
DECIDED = {
    ABSENT: "absent",
    ORBIT: "orbit",
    REPEATED: "repeated",
    IRREGULAR: "irregular",
    UNDECIDED: "undecided",
}
SAME = 1e-5  # distance over the motion's size within which a state lies on a known motion
ALIKE = 1e-6  # of the nodes of two orbits over their size, within which these are one orbit


@dataclass(frozen=True, eq=False)
class SettledMotion:
    """A settled motion: an orbit, or what is known of a response that is none.

    Attributes
    ----------
    point : Point
    decided : int
        Of ``DECIDED``: by a stable orbit of Newton's method, by states that repeat, or neither.
    states : ndarray, shape (n, 4)
        x1, x2 in m, v1, v2 in m/s at phase 0 of successive periods: all of a periodic motion's,
        some of an irregular one.
    multiplicity : int
        Excitation periods after which it repeats; 0: irregular.
    impacts_per_period : float
        Of a periodic motion a whole number over ``multiplicity``.
    gap : float
        Largest gap, m.
    multiplier : float
        Largest absolute value of the orbit's Floquet multipliers; NaN where there is no orbit.
    ring : Ring, optional
        The orbit.
    free_phase : float
        Phase in rad at which it is far from impacts.
    """

    point: Point
    decided: int
    states: Floats
    multiplicity: int
    impacts_per_period: float
    gap: float
    multiplier: float = np.nan
    ring: Ring | None = None
    free_phase: float = 0.0

    @classmethod
    def from_orbit(cls, point: Point, ring: Ring, free_phase: float) -> SettledMotion:
        """A stable orbit."""
        periods, scale = ring.sequence.periods, point.scale
        states = phase_zero(ring) * scale
        states[:, 1] = np.maximum(states[:, 0], states[:, 1])  # in contact, within rounding
        return cls(
            point=point,
            decided=ORBIT,
            states=states,
            multiplicity=periods,
            impacts_per_period=ring.sequence.impacts / periods,
            gap=Amplitudes.of(ring, turning_points(ring)).gap * point.length,
            multiplier=float(np.abs(ring.multipliers()).max(initial=0.0)),
            ring=ring,
            free_phase=free_phase,
        )

    def features(self) -> list[float]:
        """Numbers that do not depend on the phase of the samples, by ``clusters.FEATURES``."""
        gaps = (self.states[:, 1] - self.states[:, 0]) / self.point.length
        means = [float(gaps.mean()), float(gaps.std())]
        gap = self.gap / self.point.length
        return [self.multiplicity, self.impacts_per_period, gap, *means]

    def nearest(self, state: ArrayLike) -> tuple[int, float]:
        """The period whose first state is nearest to a state at phase 0, and its distance."""
        return nearest_of(self.states, state, self.point.excitation.frequency, self.gap)

    def free_states(self) -> Floats:
        """States of an orbit at its free phase in successive periods, SI, shape (n, 4)."""
        assert self.ring is not None, "no orbit"
        wanted = self.free_phase + TURN * np.arange(self.multiplicity)
        begin = self.ring.begins[0]
        shifted = begin + np.mod(wanted - begin, TURN * self.multiplicity)
        segment = np.searchsorted(self.ring.begins, shifted, side="right") - 1
        found: Floats = self.ring.states(segment, shifted) * self.point.scale
        return found

    def is_orbit_of(self, other: SettledMotion) -> bool:
        """Whether both are one orbit: the same nodes, begun in another period or not."""
        if self.ring is None or other.ring is None or self.multiplicity != other.multiplicity:
            return False
        return same_nodes(self.ring, other.ring)


def nearest_of(
    states: Floats, state: ArrayLike, frequency: float, gap: float
) -> tuple[int, float]:
    """The nearest of some states, and its distance over the motion's size.

    Displacements and velocities over the frequency are compared with the largest of them; the gap
    and its rate with the largest gap, as by :func:`orchestrate.response.multiplicity.over_size`.

    Parameters
    ----------
    states : ndarray, shape (n, 4)
    state : array_like of 4 floats
        At the same phase.
    frequency : float
        Of the excitation, rad/s.
    gap : float
        Largest gap of the motion, m.
    """
    known, away = lengths(states, frequency), lengths(states - np.asarray(state), frequency)
    size = float(np.abs(known[:, :4]).max()) or 1.0
    of_gap = max(gap, LEAST_GAP * size)
    of_rate = max(of_gap, float(np.abs(known[:, 5]).max()))
    sizes = np.array([size, size, size, size, of_gap, of_rate])
    distances = np.abs(away / sizes).max(axis=1)
    period = int(distances.argmin())
    return period, float(distances[period])


def lengths(states: Floats, frequency: float) -> Floats:
    """Displacements, velocities over the frequency, gap and its rate, all in m, shape (n, 6)."""
    found = states / (1.0, 1.0, frequency, frequency)
    return np.column_stack([found, found[:, 1] - found[:, 0], found[:, 3] - found[:, 2]])


def same_nodes(one: Ring, other: Ring) -> bool:
    """Whether two orbits of as many periods have the same nodes, whole periods apart or not."""
    kinds, others = np.array(one.sequence.kinds), np.array(other.sequence.kinds)
    if len(kinds) != len(others):
        return False
    if not len(kinds):
        return True
    size = float(np.abs([one.nodes[:, 1:], other.nodes[:, 1:]]).max()) or 1.0
    for shift in range(len(kinds)):
        if (np.roll(others, -shift) != kinds).any():
            continue
        away = np.roll(other.nodes, -shift, axis=0) - one.nodes
        away[:, PHASE] -= TURN * np.round(away[:, PHASE] / TURN)
        away[:, 1:] /= size
        if np.abs(away).max() < ALIKE:
            return True
    return False
