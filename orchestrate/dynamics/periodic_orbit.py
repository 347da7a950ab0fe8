"""Equations of periodic orbits with a fixed impact sequence: residual, Jacobian, multipliers.

An orbit is a closed sequence of nodes: impacts, impacts that end in permanent contact, and
releases. Each node has four unknowns: the excitation's phase, and displacement, velocity and
closing speed of both masses there, the displacement being that of mass 1 and the velocity that of
their centre of mass; it is at one end of the gap, or at the outer one of a stroke. From node to
node the motion is the closed form (10), so the orbit is a root of 4k equations in 4k unknowns which
are analytic, also where a closing speed goes through zero: a map whose unknowns are states has a
square root there (compare Ghosh and Simpson, arXiv 2510.16218). Negative closing speeds are roots,
but no motions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from .closed_form import FREE, INNER, OUTER, ClosedForm, Floats

IMPACT, STICK, RELEASE = range(3)  # kinds of nodes; after STICK follows permanent contact
AT_OUTER_END = 3  # added to the kind of a node at the outer end of a stroke
PHASE, POSITION, VELOCITY, CLOSING = range(4)  # unknowns of a node
ON_CIRCLE = 1e-7  # of a multiplier's size: nearer to the unit circle no orbit is called stable


@dataclass(frozen=True)
class ImpactSequence:
    """The order of impacts, sticking impacts and releases in an orbit, and its periods."""

    periods: int  # of the excitation, until the orbit closes
    kinds: tuple[int, ...]  # of its nodes in their order

    @cached_property
    def sticks(self) -> NDArray[np.bool_]:
        return np.array(self.kinds, dtype=int) % AT_OUTER_END == STICK

    @cached_property
    def releases(self) -> NDArray[np.bool_]:
        return np.array(self.kinds, dtype=int) % AT_OUTER_END == RELEASE

    @cached_property
    def outer(self) -> NDArray[np.bool_]:
        """Return, for each node, whether it is at the outer end of a stroke."""
        return np.array(self.kinds, dtype=int) >= AT_OUTER_END

    @cached_property
    def modes(self) -> NDArray[np.int_]:
        return np.where(self.sticks, np.where(self.outer, OUTER, INNER), FREE)

    @property
    def impact_count(self) -> int:
        """Return the number of impacts, releases not counted."""
        return len(self.kinds) - int(self.releases.sum())


def kind_at_same_end(kind: int, event: int) -> int:
    """Return the kind of an event at the end of the stroke that a node of this kind is at."""
    return event + AT_OUTER_END * (kind // AT_OUTER_END)


def next_rows(rows: NDArray[Any]) -> NDArray[Any]:
    """Return the rows of the next nodes, the first one after the last; np.roll is slow."""
    return np.concatenate([rows[1:], rows[:1]])


@dataclass(frozen=True)
class PeriodicOrbit:
    """A candidate periodic orbit: nodes (impacts and releases) and the equations they solve."""

    sequence: ImpactSequence
    form: ClosedForm
    nodes: Floats  # phase in rad, displacement of mass 1, velocity of the centre, closing speed

    @property
    def node_count(self) -> int:
        return len(self.nodes)

    @cached_property
    def begin_phases(self) -> Floats:
        """Return the phases, rad, at which segments between nodes begin (0 without nodes)."""
        return self.nodes[:, PHASE] if self.node_count else np.zeros(1)

    @cached_property
    def end_phases(self) -> Floats:
        phases = next_rows(self.begin_phases)
        phases[-1] += TURN * self.sequence.periods
        return phases

    @cached_property
    def durations(self) -> Floats:
        """Return the durations of the segments between nodes, in units of tau."""
        return (self.end_phases - self.begin_phases) / self.form.eta

    @property
    def modes(self) -> NDArray[np.int_]:
        """Return the mode of each segment: in flight, or in permanent contact at either end."""
        return self.sequence.modes if self.node_count else np.array([self.form.rest_mode])

    @cached_property
    def in_contact(self) -> NDArray[np.bool_]:
        return self.modes != FREE

    @cached_property
    def segment_arrays(self) -> tuple[Floats, ...]:
        """Return segments' residuals (k, 4), derivatives by both nodes (k, 4, 4), end states."""
        columns = *self.nodes.T, self.modes, self.sequence.releases, self.sequence.outer
        span = TURN * self.sequence.periods
        rows = self.form.call_kernel("find_segments", columns, 44, span).reshape(11, -1, 4)
        before, after = (rows[i : i + 4].reshape(-1, 4, 4) for i in (1, 5))
        return rows[0], before, after, rows[9], rows[10]

    @property
    def start_states(self) -> Floats:
        """Return the states at the begin of segments, just after impacts (15), shape (k, 4)."""
        if not self.node_count:
            return self.form.steady_response(np.zeros(1), self.modes)
        return self.segment_arrays[3]

    @property
    def end_states(self) -> Floats:
        """Return the states at the end of segments, just before the next node, shape (k, 4)."""
        return self.segment_arrays[4] if self.node_count else self.start_states

    def states_and_rates(self, segment: NDArray[np.int_], phase: Floats) -> tuple[Floats, Floats]:
        """Return the states at phases inside given segments, and their rates, both (n, 4)."""
        begins, starts = self.begin_phases[segment], self.start_states[segment]
        columns = begins, self.modes[segment], phase, *starts.T
        numbers = self.form.call_kernel("find_motion", columns, 8)
        return numbers[:, :4], numbers[:, 4:]

    def states(self, segment: NDArray[np.int_], phase: Floats) -> Floats:
        """Return the states at phases inside given segments, (n, 4)."""
        return self.states_and_rates(segment, phase)[0]

    def residual(self) -> Floats:
        return self.segment_arrays[0].ravel() if self.node_count else np.zeros(0)

    def jacobian(self, multiplier: complex = 1.0) -> NDArray[np.inexact]:
        """Return the residual's Jacobian by all nodes, (4 k, 4 k); singular at a multiplier."""
        _, before, after, *_ = self.segment_arrays
        k = self.node_count
        matrix = np.zeros((k, 4, k, 4), dtype=complex if isinstance(multiplier, complex) else float)
        for i in range(k):
            matrix[i, :, i] += before[i]
            matrix[i, :, (i + 1) % k] += after[i] * (multiplier if i == k - 1 else 1.0)
        return matrix.reshape(4 * k, 4 * k)

    def monodromy(self) -> Floats:
        """Return the monodromy matrix (4, 4): a deviation at the first node over one period."""
        if not self.node_count:
            flow = self.form.flow_matrices(self.durations, self.modes)[0]
            return flow @ self.form.centre_matrix() if self.in_contact[0] else flow
        _, before, after, *_ = self.segment_arrays
        product = np.eye(4)
        for step in -np.linalg.solve(after, before):
            product = step @ product
        return product

    def multipliers(self) -> NDArray[np.complex128]:
        """Return the Floquet multipliers, the largest first; infinite if an impact grazes."""
        try:
            values = np.linalg.eigvals(self.monodromy()).astype(complex)
        except np.linalg.LinAlgError:
            return np.full(4, complex(np.inf))
        if self.in_contact.any():
            values[np.argsort(np.abs(values))[:2]] = 0.0
        return values[np.lexsort((values.imag, values.real.round(12), -np.abs(values).round(12)))]

    @property
    def stable(self) -> bool:
        """Return whether all multipliers lie inside the unit circle, by more than rounding."""
        return bool(np.abs(self.multipliers()).max() < 1.0 - ON_CIRCLE)

    def multiplier_product(self) -> float:
        """Return the multipliers' product by Liouville's formula, as an independent check."""
        lost = float(self.form.damping[0] + self.form.damping[1])
        time = TURN * self.sequence.periods / self.form.eta
        if self.in_contact.any() or self.form.wall:
            return 0.0
        slower = np.prod((1.0 + self.form.e_slope * self.nodes[:, CLOSING]) ** -3)
        return float(self.form.e ** (2 * self.node_count) * slower * np.exp(-2.0 * lost * time))
