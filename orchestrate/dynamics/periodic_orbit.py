"""Periodic orbits with a given sequence of impacts, in unknowns in which everything is smooth.

An orbit is a closed sequence of nodes: impacts, impacts that end in permanent contact, and
releases. Each node has four unknowns: the excitation's phase, and displacement, velocity and
closing speed of both masses there, the velocity being that of their centre of mass. From node to
node the motion is the closed form (10), so the orbit is a root of 4k equations in 4k unknowns which
are analytic, also where a closing speed goes through zero: a map whose unknowns are states has a
square root there (compare Ghosh and Simpson, arXiv 2510.16218). Negative closing speeds are roots,
but no motions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from .closed_form import ClosedForm, Floats

IMPACT, STICK, RELEASE = 0, 1, 2  # kinds of nodes; after STICK follows permanent contact
PHASE, POSITION, VELOCITY, CLOSING = range(4)  # unknowns of a node
ON_CIRCLE = 1e-7  # of a multiplier's size: nearer to the unit circle no orbit is called stable


@dataclass(frozen=True)
class ImpactSequence:
    """What happens in an orbit.

    Attributes
    ----------
    periods : int
        Of the excitation, until the orbit closes.
    kinds : tuple of int
        Of its nodes in their order.
    """

    periods: int
    kinds: tuple[int, ...]

    @cached_property
    def sticks(self) -> NDArray[np.bool_]:
        """Nodes after which the masses are in permanent contact."""
        return np.array(self.kinds, dtype=int) == STICK

    @cached_property
    def releases(self) -> NDArray[np.bool_]:
        """Nodes where permanent contact ends."""
        return np.array(self.kinds, dtype=int) == RELEASE

    @property
    def impacts(self) -> int:
        """Number of impacts."""
        return len(self.kinds) - self.kinds.count(RELEASE)

    def doubled(self) -> ImpactSequence:
        """Return the same orbit run through twice."""
        return ImpactSequence(2 * self.periods, self.kinds * 2)

    def without(self, node: int) -> ImpactSequence:
        """Return the sequence without the node of this index."""
        return ImpactSequence(self.periods, self.kinds[:node] + self.kinds[node + 1 :])

    def with_impact(self, before: int) -> ImpactSequence:
        """Return the sequence with one impact more, before a node."""
        return ImpactSequence(self.periods, (*self.kinds[:before], IMPACT, *self.kinds[before:]))


@dataclass(frozen=True)
class PeriodicOrbit:
    """A periodic orbit by its nodes, and the equations that these must solve.

    Attributes
    ----------
    sequence : ImpactSequence
    form : ClosedForm
    nodes : ndarray, shape (k, 4)
        Phase in rad, displacement, velocity of the centre of mass, closing speed.
    """

    sequence: ImpactSequence
    form: ClosedForm
    nodes: Floats

    @property
    def count(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    @cached_property
    def begins(self) -> Floats:
        """Phases at which the segments begin; without nodes there is one, from phase 0 on."""
        return self.nodes[:, PHASE] if self.count else np.zeros(1)

    @cached_property
    def ends(self) -> Floats:
        """Return the phases at which the segments end, rad."""
        phases = np.roll(self.begins, -1)
        phases[-1] += TURN * self.sequence.periods
        return phases

    @cached_property
    def durations(self) -> Floats:
        """Return the durations of the segments in units of tau."""
        return (self.ends - self.begins) / self.form.eta

    @cached_property
    def contact(self) -> NDArray[np.bool_]:
        """Return whether each segment is permanent contact."""
        return self.sequence.sticks if self.count else np.array([self.form.rests_in_contact])

    @cached_property
    def starts(self) -> Floats:
        """Return the states at the segments' begins, shape (k, 4): after the impact (15)."""
        if not self.count:
            return self.form.steady(np.zeros(1), self.contact)
        _, position, velocity, closing = self.nodes.T
        parting = np.where(self.contact | self.sequence.releases, 0.0, self.form.parting(closing))
        part = parting / (1.0 + self.form.mu)
        return np.stack(
            [position, position, velocity - self.form.mu * part, velocity + part], axis=1
        )

    @cached_property
    def flows(self) -> Floats:
        """Return each segment's flow matrix, from its start to its end, shape (k, 4, 4)."""
        matrices = self.form.flight(self.durations)
        if self.contact.any():
            matrices[self.contact] = self.form.contact(self.durations[self.contact])
        return matrices

    def states(self, segment: NDArray[np.int_], phase: Floats) -> Floats:
        """Return the states at phases inside segments, from the closed form.

        Parameters
        ----------
        segment : ndarray of int, shape (n,)
        phase : ndarray, shape (n,)
            From the segment's begin to its end, rad.

        Returns
        -------
        ndarray, shape (n, 4)
        """
        contact = self.contact[segment]
        time = (phase - self.begins[segment]) / self.form.eta
        free = (self.starts - self.form.steady(self.begins, self.contact))[segment]
        flow = self.form.flight(time)
        if contact.any():
            flow[contact] = self.form.contact(time[contact])
        moved: Floats = (flow @ free[:, :, None])[:, :, 0] + self.form.steady(phase, contact)
        return moved

    @cached_property
    def arrivals(self) -> Floats:
        """States at the segments' ends, before what happens there, shape (k, 4)."""
        free = self.starts - self.form.steady(self.begins, self.contact)
        moved: Floats = (self.flows @ free[:, :, None])[:, :, 0]
        return moved + self.form.steady(self.ends, self.contact)

    @cached_property
    def reduction(self) -> Floats:
        """Gap, place and velocity of the centre of mass, closing speed of a state, shape (4, 4)."""
        share = self.form.mu / (1.0 + self.form.mu)
        return np.array(
            [
                [-1.0, 1.0, 0.0, 0.0],
                [1.0 - share, share, 0.0, 0.0],
                [0.0, 0.0, 1.0 - share, share],
                [0.0, 0.0, 1.0, -1.0],
            ]
        )

    def residual(self) -> Floats:
        """Return the residual of the equations, shape (4 k,).

        Each segment must arrive at the node after it: with no gap, at its displacement and
        velocity, and with its closing speed; at a release with f = 0 (19) and no closing speed.
        """
        if not self.count:
            return np.zeros(0)
        after = np.roll(self.nodes, -1, axis=0)
        residual = self.arrivals @ self.reduction.T
        residual[:, 1:] -= after[:, 1:]
        released = np.roll(self.sequence.releases, -1)
        if released.any():
            _, position, velocity, closing = after[released].T
            residual[released, 0] = self.form.force(position, velocity)
            residual[released, 3] = closing
        return residual.ravel()

    def blocks(self) -> tuple[Floats, Floats]:
        """Return derivatives of each segment's equations by the node before and the one after it.

        Returns
        -------
        before, after : ndarray, shape (k, 4, 4)
        """
        form, sequence = self.form, self.sequence
        share = form.mu / (1.0 + form.mu)
        begun = form.field(self.starts, self.begins, self.contact)
        shift = np.zeros((self.count, 4, 4))  # of the start, by the node's unknowns
        shift[:, :, PHASE] = -begun / form.eta
        shift[:, :2, POSITION] = 1.0
        shift[:, 2:, VELOCITY] = 1.0
        parting = ~(self.contact | sequence.releases)
        rates = form.parting_rate(self.nodes[parting, CLOSING])
        shift[parting, 2:, CLOSING] = rates[:, None] * np.array([-share, 1.0 - share])
        before = self.reduction @ self.flows @ shift
        after = np.zeros((self.count, 4, 4))
        rates = form.field(self.arrivals, self.ends, self.contact)
        after[:, :, PHASE] = rates @ self.reduction.T / form.eta
        after[:, [1, 2, 3], [1, 2, 3]] = -1.0
        released = np.roll(sequence.releases, -1)
        before[released] *= np.array([0.0, 1.0, 1.0, 0.0])[:, None]
        after[released, 0] = [0.0, form.force_x, form.force_v, 0.0]
        after[released, 3] = [0.0, 0.0, 0.0, 1.0]
        return before, after

    def jacobian(self, multiplier: complex = 1.0) -> NDArray[np.inexact]:
        """Return the derivative of the residual by the unknowns, shape (4 k, 4 k).

        Parameters
        ----------
        multiplier : complex
            What a deviation is multiplied by in one run through the orbit. Where the matrix is
            singular, it is a Floquet multiplier.
        """
        before, after = self.blocks()
        k = self.count
        matrix = np.zeros((k, 4, k, 4), dtype=complex if isinstance(multiplier, complex) else float)
        for i in range(k):
            matrix[i, :, i] += before[i]
            matrix[i, :, (i + 1) % k] += after[i] * (multiplier if i == k - 1 else 1.0)
        return matrix.reshape(4 * k, 4 * k)

    def monodromy(self) -> Floats:
        """Return the matrix of a deviation at the first node over one run through the orbit.

        Its eigenvalues are the Floquet multipliers: those of the stroboscopic map too. In permanent
        contact the deviation of the gap is gone, so with a contact two of them are zero.
        """
        if not self.count:
            return self.flows[0] @ self.form.centre() if self.contact[0] else self.flows[0]
        before, after = self.blocks()
        product = np.eye(4)
        for step in -np.linalg.solve(after, before):
            product = step @ product
        return product

    def multipliers(self) -> NDArray[np.complex128]:
        """Return the Floquet multipliers, the largest first; infinite where an impact grazes."""
        try:
            values = np.linalg.eigvals(self.monodromy()).astype(complex)
        except np.linalg.LinAlgError:
            return np.full(4, complex(np.inf))
        if self.contact.any():
            values[np.argsort(np.abs(values))[:2]] = 0.0
        return values[np.lexsort((values.imag, values.real.round(12), -np.abs(values).round(12)))]

    @property
    def stable(self) -> bool:
        """Return whether all multipliers lie inside the unit circle, by more than their error.

        At a bifurcation, where one lies on the circle, rounding would say so or not.
        """
        return bool(np.abs(self.multipliers()).max() < 1.0 - ON_CIRCLE)

    def multiplier_product(self) -> float:
        """Return the multipliers' product, by Liouville's formula and the impacts' restitutions.

        An impact contributes e(v) d(e(v) v)/dv: e^2 where e is constant.
        """
        lost = float(self.form.damping[0] + self.form.damping[1])
        time = TURN * self.sequence.periods / self.form.eta
        if self.contact.any():
            return 0.0
        slower = np.prod((1.0 + self.form.e_slope * self.nodes[:, CLOSING]) ** -3)
        return float(self.form.e ** (2 * self.count) * slower * np.exp(-2.0 * lost * time))
