"""Closed-form motion between impacts (10): both masses free, or in contact as one.

All in the paper's units: displacements over a eta^2, time as tau, the excitation by its phase.
A state is (xi_1, xi_2, xi_1', xi_2'). Oscillators 1 and 2 are the masses, 3 is both as one, 4 both
at the outer end of a stroke. With a clearance, xi_2 counts from where mass 2 touches mass 1 at
xi_1 = 0: the gap is xi_2 - xi_1 always, and the clearance is a constant load of the springs, see
:meth:`.Point.faces`. A wall is a mass 2 that nothing moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..model import Excitation, Structure

Floats = NDArray[np.float64]
FREE, INNER, OUTER = 0, 1, 2  # modes: in flight, in permanent contact at either end
Modes = NDArray[np.int_] | int
Ends = NDArray[np.bool_] | bool  # whether an end is the outer one
MASSES = slice(0, 2)  # oscillators 1 and 2
MOVING = np.array([[0, 1], [2, 2], [3, 3]])  # oscillators that are the two masses, in each mode
SAME = 1e-14  # of two amplitudes: within their rounding


def oscillators(mode: Modes) -> slice | NDArray[np.intp]:
    """Return indices of the two oscillators that move, (2) in flight alone, else (n, 2)."""
    return MOVING[np.reshape(mode, -1)] if np.any(mode) else MASSES


@dataclass(frozen=True)
class ClosedForm:
    """Coefficients of the closed-form motion between impacts, non-dimensional."""

    # frequency ratio, the masses' shares in both, restitution (15)
    eta: float
    shares: Floats
    e: float
    sticking_time: float  # gamma (1 - e) over the faster half's frequency: end of chattering (17)
    e_slope: float  # decrease of the restitution with the closing speed
    # D_i (8) and omega_i^2 (7)
    damping: Floats
    stiffness: Floats
    drive: Floats  # amplitude of the harmonic right-hand side of each; 1 by the box
    # a_i and b_i of (11), times it
    cosine: Floats
    sine: Floats
    push: Floats  # constant right-hand side, by a constant acceleration of the box
    offset: Floats  # displacement by it, and by the clearance
    # coefficients of the contact force f (18)
    force_v: float
    force_x: float
    wall: bool  # whether nothing moves mass 2
    gap_offset: float  # the gap where both springs are unloaded
    limit: float  # the largest gap; infinite without a stroke
    load: Floats  # acceleration of each oscillator at no displacement, by clearance and stroke

    @classmethod
    def from_structure(cls, structure: Structure, excitation: Excitation) -> ClosedForm:
        omega, m1, m2, wall = structure.omega, structure.m1, structure.m2, structure.wall
        unit, length = omega * omega, excitation.length(structure)
        shares = np.array([0.0, 1.0] if wall else [m1, m2]) / (1.0 if wall else m1 + m2)
        share = float(shares[1])
        eta = excitation.frequency / omega
        damping = of_both_and_common(structure.d1 / m1, structure.d2 / m2, share) / (2.0 * omega)
        stiffness = of_both_and_common(structure.k1 / m1, structure.k2 / m2, share) / unit
        stiffness[0] = 1.0
        if wall:
            damping[:], stiffness[:] = damping[0], 1.0
        detuning, loss = stiffness - eta * eta, 2.0 * damping * eta
        reach = detuning**2 + loss**2
        shaken = float(excitation.amplitude != 0.0)
        level = excitation.amplitude * excitation.frequency**2 if shaken else unit * length
        push, force1, force2 = (each / level for each in excitation.pushes)  # m/s2 that is 1 here
        moved = 0.0 if wall else 1.0
        drive = of_both_and_common(shaken + force1 / m1, moved * shaken + force2 / m2, share)
        with np.errstate(divide="ignore", invalid="ignore"):
            cosine, sine = -loss / reach * drive, detuning / reach * drive
        pushes = of_both_and_common(0.0 - push, moved * (0.0 - push), share)
        gap_offset = structure.gap_offset / length if structure.gap_offset else 0.0
        limit = structure.stroke / length if structure.stroke else np.inf
        load = gap_offset * stiffness[1] * np.array([0.0, 1.0, share, share])
        load[3] -= 0.0 if limit == np.inf else limit * stiffness[1] * share
        return cls(
            eta=eta,
            shares=shares,
            e=structure.e,
            sticking_time=structure.gamma * (1.0 - structure.e) / max(1.0, stiffness[1] ** 0.5),
            e_slope=structure.e_slope * omega * length,
            damping=damping,
            stiffness=stiffness,
            drive=drive,
            cosine=cosine,
            sine=sine,
            push=pushes,
            offset=(pushes + load) / stiffness,
            force_v=float(2.0 * (damping[0] - damping[1])),
            force_x=float(stiffness[0] - stiffness[1]),
            wall=wall,
            gap_offset=gap_offset,
            limit=limit,
            load=load,
        )

    @property
    def rest_mode(self) -> int:
        """The mode in which the masses rest: a preload, or what pushes, may press them together."""
        gap = self.offset[1] - self.offset[0]
        return INNER if gap < 0.0 else OUTER if gap > self.limit else FREE

    @property
    def linear_mode(self) -> int:
        """The mode of the response that never impacts, -1 where there is none.

        In flight its gap, in contact its force (18), is a constant and a harmonic.
        """
        mode, gap = self.rest_mode, float(self.offset[1] - self.offset[0])
        if mode == FREE:
            swings = np.stack([self.cosine[:2], self.sine[:2]])
            room, swing = min(gap, self.limit - gap), np.hypot(*np.diff(swings)[:, 0])
            return FREE if swing <= room + SAME * np.abs(swings).sum() else -1
        phase = np.array([0.0, 0.5, 1.0]) * np.pi
        position, _, velocity, _ = self.steady_response(phase, mode).T
        force = self.force(phase, position, velocity, mode == OUTER)
        middle = 0.5 * (force[0] + force[2])
        return mode if np.hypot(*(force[:2] - middle)) <= -middle else -1

    @property
    def fastest(self) -> float:
        """The highest frequency in the motion, over omega: excitation or a natural frequency."""
        swinging = np.sqrt(np.maximum(self.stiffness - self.damping**2, 0.0))
        return float(max(self.eta, swinging.max()))

    def parting(self, closing: Floats) -> Floats:
        """Return the separation speeds e(v) v after impacts (15) by their closing speeds."""
        return self.e * closing / (1.0 + self.e_slope * closing)

    def parting_rate(self, closing: Floats) -> Floats:
        """Return the derivative of :meth:`parting` by the closing speed, e/(1 + e_slope v)^2."""
        factor = 1.0 / (1.0 + self.e_slope * closing)
        return self.e * factor * factor

    def basis(self, i: int, time: Floats) -> tuple[Floats, Floats]:
        """Return ``e^{-D t} cos(nu t)`` and ``e^{-D t} sin(nu t)/nu`` of (10), overdamped too."""
        damping, square = self.damping[i], self.stiffness[i]
        nu_squared = square - damping * damping  # (11)
        if abs(nu_squared) <= 1e-14 * square:  # critical but for rounding
            decay = np.exp(-damping * time)
            return decay, time * decay
        nu = np.sqrt(abs(nu_squared))
        if nu_squared > 0.0:
            decay = np.exp(-damping * time)
            return decay * np.cos(nu * time), decay * np.sin(nu * time) / nu
        slow, faster = np.exp(-square / (damping + nu) * time), np.expm1(-2.0 * nu * time)
        return slow * (1.0 + 0.5 * faster), -0.5 * slow * faster / nu

    def oscillator(self, i: int, time: Floats) -> Floats:
        """Return the free flow matrices (n, 2, 2) of oscillator ``i`` after given times."""
        cosine, sine = self.basis(i, time)
        matrices = np.empty((len(time), 2, 2))
        matrices[:, 0, 0] = cosine + self.damping[i] * sine
        matrices[:, 0, 1] = sine
        matrices[:, 1, 0] = -self.stiffness[i] * sine
        matrices[:, 1, 1] = cosine - self.damping[i] * sine
        return matrices

    def flow(self, time: Floats, mode: Modes = FREE) -> Floats:
        """Return the flow matrices (n, 4, 4) of the motion in modes after given times."""
        modes = np.broadcast_to(mode, len(time))
        matrices = np.zeros((len(time), 4, 4))
        for held in (False, True):
            chosen = np.flatnonzero((modes != FREE) == held)
            for mass in range(0 if len(chosen) else 2, 2):
                if not (self.wall and (held or mass)):  # what a wall does forgets deviations
                    own = self.oscillator(2 if held else mass, time[chosen])
                    matrices[chosen, mass::2, mass::2] = own
        return matrices

    def steady_response(self, phase: Floats, mode: Modes = FREE) -> Floats:
        """Return the steady-state response (harmonic part of (10)) at phases, shape (n, 4)."""
        which = oscillators(mode)
        cosine, sine = np.cos(phase)[:, None], np.sin(phase)[:, None]
        a, b = self.cosine[which], self.sine[which]
        states = np.empty((len(phase), 4))
        states[:, :2] = a * cosine + b * sine + self.offset[which]
        states[:, 2:] = self.eta * (b * cosine - a * sine)
        states[:, 1] += self.gap_at_end(np.asarray(mode) == OUTER)
        return states

    def gap_at_end(self, outer: Ends) -> Floats:
        """Return the gap at an end: the limit at the outer one."""
        return np.where(outer, self.limit, 0.0)

    def centre(self) -> Floats:
        """Return the (4, 4) matrix that sets both masses of a state to their centre of mass."""
        return np.asarray(np.kron(np.eye(2), [self.shares] * 2), dtype=float)

    def field(self, state: Floats, phase: Floats, mode: Modes = FREE) -> Floats:
        """Return d(state)/d(tau), the right-hand side of (6), for states (n, 4) at phases."""
        which = oscillators(mode)
        rates = np.empty((len(phase), 4))
        rates[:, :2] = state[:, 2:]
        rates[:, 2:] = np.sin(phase)[:, None] * self.drive[which] + self.push[which]
        rates[:, 2:] -= 2.0 * self.damping[which] * state[:, 2:]
        rates[:, 2:] -= self.stiffness[which] * state[:, :2]
        rates[:, 2:] += self.load[which]
        outer = np.asarray(mode) == OUTER
        if outer.any():
            rates[:, 3] = np.where(outer, rates[:, 2], rates[:, 3])
        return rates

    def gap_drive(self, phase: Floats, outer: Ends = False) -> Floats:
        """Return the difference of the masses' harmonic right-hand sides, towards an end."""
        return parting_sign(outer) * float(self.drive[1] - self.drive[0]) * np.sin(phase)

    def force(
        self, phase: Floats, position: Floats, velocity: Floats, outer: Ends = False
    ) -> Floats:
        """Return the contact force f (18) at phases, from mass 1 at an end; < 0: pressed."""
        constant = float(self.load[1] + (self.push[1] - self.push[0]))
        at_end = constant - self.stiffness[1] * self.gap_at_end(outer)
        rate = self.force_rate(position, velocity, outer)
        return rate + self.gap_drive(phase, outer) + parting_sign(outer) * at_end

    def force_rate(self, position: Floats, velocity: Floats, outer: Ends = False) -> Floats:
        """Return what the derivatives of position and velocity add to the contact force's."""
        return parting_sign(outer) * (self.force_v * velocity + self.force_x * position)


def parting_sign(outer: Ends) -> Floats:
    """Return the sign of the gap's acceleration that parts the masses: -1 at the outer end."""
    return np.where(outer, -1.0, 1.0)


def of_both_and_common(one: float, two: float, share: float) -> Floats:
    """Return what both masses have, and twice what they have as one, by mass 2's share."""
    both = one + share * (two - one)
    return np.array([one, two, both, both])
