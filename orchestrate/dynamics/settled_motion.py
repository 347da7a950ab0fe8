"""Settled motions (orbit, repeated or irregular) and comparison of states and orbits with them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..constants import TURN
from ..fmu import gaps_of_states
from ..model.outcomes import ORBIT
from ..response.multiplicity import nearest_state
from ..response.questions import Point
from .periodic_orbit import PHASE, PeriodicOrbit
from .turning_points import amplitudes, stroboscopic_states

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SettledMotion:
    """A motion that responses settle to: its states, period, impacts, gap, and how decided."""

    point: Point
    decided: int  # of `Outcome`: by a stable orbit of Newton's method, repeated states, or neither
    # x1, x2 in m, v1, v2 in m/s at phase 0 of successive periods: all of a periodic motion's, some
    # of an irregular one
    states: Floats
    multiplicity: int  # excitation periods after which it repeats; 0: irregular
    impacts_per_period: float  # of a periodic motion a whole number over `multiplicity`
    gap: float  # largest gap, m
    # largest absolute value of the orbit's Floquet multipliers; NaN where there is no orbit
    multiplier: float = np.nan
    orbit: PeriodicOrbit | None = None  # the orbit
    free_phase: float = 0.0  # phase in rad at which it is far from impacts

    @classmethod
    def from_orbit(cls, point: Point, orbit: PeriodicOrbit, free_phase: float) -> SettledMotion:
        periods, faces = orbit.sequence.periods, stroboscopic_states(orbit)
        faces[:, 1] = np.maximum(faces[:, 0], faces[:, 1])  # in contact, within rounding
        return cls(
            point=point,
            decided=ORBIT,
            states=point.states_from_faces(faces),
            multiplicity=periods,
            impacts_per_period=orbit.sequence.impact_count / periods,
            gap=amplitudes(orbit)[2] * point.displacement_unit,
            multiplier=float(np.abs(orbit.multipliers()).max(initial=0.0)),
            orbit=orbit,
            free_phase=free_phase,
        )

    @property
    def state_of_least_x1(self) -> Floats:
        """Return the state at phase 0 with the smallest x1, of equal ones x2, v1, v2."""
        return np.array(min(self.states.tolist()))

    @property
    def sort_key(self) -> tuple[float, ...]:
        """Return what attractors are numbered by: periodic first, periods, impacts, gap, state."""
        return (self.multiplicity == 0, *self.features[:3], *self.state_of_least_x1)

    @cached_property
    def features(self) -> list[float]:
        """Return features that do not depend on the phase: period, impacts, gap statistics."""
        unit, offset = self.point.displacement_unit, self.point.structure.gap_offset
        gaps = gaps_of_states(self.states, offset) / unit
        means = [float(gaps.mean()), float(gaps.std())]
        return [self.multiplicity, self.impacts_per_period, self.gap / unit, *means]

    def nearest_state(self, state: ArrayLike) -> tuple[int, float]:
        """Return the period whose state at phase 0 is nearest to a state, and its distance."""
        return nearest_state(self.states, self.point.excitation.frequency, self.gap, state)

    def nearest_state_at_free_phase(self, state: ArrayLike) -> tuple[int, float]:
        """Return the same at the orbit's impact-free phase."""
        states, frequency = self.states_at_free_phase, self.point.excitation.frequency
        return nearest_state(states, frequency, self.gap, state)

    @cached_property
    def states_at_free_phase(self) -> Floats:
        assert self.orbit is not None, "no orbit"
        return self.point.states_from_faces(stroboscopic_states(self.orbit, self.free_phase))

    def is_same_orbit_as(self, other: SettledMotion, within: float) -> bool:
        """Return whether both motions are the same orbit: same nodes, or states that are close."""
        if self.orbit is None or other.orbit is None or self.multiplicity != other.multiplicity:
            return False
        same_nodes = have_same_nodes(self.orbit, other.orbit)
        return same_nodes or self.nearest_state(other.states[0])[1] < within


def have_same_nodes(first: PeriodicOrbit, second: PeriodicOrbit) -> bool:
    """Return whether two orbits have the same nodes, up to a shift by whole periods."""
    kinds, second_kinds = np.array(first.sequence.kinds), np.array(second.sequence.kinds)
    if len(kinds) != len(second_kinds):
        return False
    if not len(kinds):
        return True
    size = float(np.abs([first.nodes[:, 1:], second.nodes[:, 1:]]).max()) or 1.0
    for shift in range(len(kinds)):
        away = np.roll(second.nodes, -shift, axis=0) - first.nodes
        away[:, PHASE] -= TURN * np.round(away[:, PHASE] / TURN)
        away[:, 1:] /= size
        if (np.roll(second_kinds, -shift) == kinds).all() and np.abs(away).max() < 1e-6:
            return True
    return False
