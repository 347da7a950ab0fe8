"""Closed-form motion between impacts (10): both masses free, or in contact as one.

All in the paper's units: displacements over a eta^2, time as tau, the excitation by its phase.
A state is (xi_1, xi_2, xi_1', xi_2'). Oscillators 1 and 2 are the masses, 3 is both as one. With a
clearance, xi_2 counts from where mass 2 touches mass 1 at xi_1 = 0: the gap is xi_2 - xi_1 always,
and the clearance is a constant load of the springs, see :meth:`.Point.faces`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..model import Excitation, Structure

Floats = NDArray[np.float64]
MASSES = slice(0, 2)  # oscillators 1 and 2


def oscillators(contact: NDArray[np.bool_] | bool) -> slice | NDArray[np.intp]:
    """Return indices of the two oscillators that move: (0, 1) in flight, (2, 2) in contact."""
    if not np.any(contact):
        return MASSES
    return np.where(np.reshape(contact, (-1, 1)), 2, np.arange(2))


def has_closed_form(point: tuple[Structure, Excitation]) -> bool:
    """Return whether formulas of orbits and deviations hold: no wall, no stroke."""
    return not (point[0].wall or point[0].stroke)


@dataclass(frozen=True)
class ClosedForm:
    """Coefficients of the closed-form motion between impacts, non-dimensional."""

    # frequency ratio, mass ratio (2), restitution (15)
    eta: float
    mu: float
    e: float
    sticking_time: float  # gamma (1 - e) over the faster half's frequency: end of chattering (17)
    e_slope: float  # decrease of the restitution with the closing speed
    # D_i (8) and omega_i^2 (7)
    damping: Floats
    stiffness: Floats
    drive: Floats  # amplitude of the harmonic right-hand side of each; 1 by the box alone
    # a_i and b_i of (11), times it
    cosine: Floats
    sine: Floats
    push: float  # constant right-hand side, by a constant acceleration of the box
    offset: Floats  # displacement by it, and by the clearance
    # coefficients of the contact force f (18)
    force_v: float
    force_x: float
    gap_offset: float  # the gap where both springs are unloaded
    load: Floats  # acceleration of each oscillator at no displacement, by the clearance

    @classmethod
    def from_structure(cls, structure: Structure, excitation: Excitation) -> ClosedForm:
        """Return the coefficients for a structure under an excitation."""
        omega, m1, m2 = structure.omega, structure.m1, structure.m2
        both, springs = m1 + m2, structure.k1 + structure.k2
        unit = omega * omega
        if not has_closed_form((structure, excitation)):
            raise InputError("wall, stroke: orbits and their borders have none yet; expected none")
        eta = excitation.frequency / omega
        dampers = np.array(
            [structure.d1 / m1, structure.d2 / m2, (structure.d1 + structure.d2) / both]
        )
        damping = dampers / (2.0 * omega)
        stiffness = np.array([structure.k1 / m1, structure.k2 / m2, springs / both]) / unit
        stiffness[0] = 1.0
        detuning, loss = stiffness - eta * eta, 2.0 * damping * eta
        reach = detuning**2 + loss**2
        shaken = excitation.amplitude != 0.0
        level = excitation.amplitude * excitation.frequency**2
        level = level if shaken else unit * excitation.length(structure)  # m/s2 that is 1 here
        push, force1, force2 = (each / level for each in excitation.pushes)
        forces = np.array([force1 / m1, force2 / m2, (force1 + force2) / both])
        drive, push = shaken + forces, 0.0 - push
        with np.errstate(divide="ignore", invalid="ignore"):
            cosine, sine = -loss / reach * drive, detuning / reach * drive
        offset, load, gap_offset = push / stiffness, np.zeros(3), 0.0
        if structure.gap_offset != 0.0:
            gap_offset = structure.gap_offset / excitation.length(structure)
            load = gap_offset * stiffness[1] * np.array([0.0, 1.0, m2 / both])
            offset = offset + load / stiffness
        return cls(
            eta=eta,
            mu=m2 / m1,
            e=structure.e,
            sticking_time=structure.gamma * (1.0 - structure.e) / max(1.0, stiffness[1] ** 0.5),
            e_slope=structure.e_slope * omega * excitation.length(structure),
            damping=damping,
            stiffness=stiffness,
            drive=drive,
            cosine=cosine,
            sine=sine,
            push=push,
            offset=offset,
            force_v=float(2.0 * (damping[0] - damping[1])),
            force_x=float(stiffness[0] - stiffness[1]),
            gap_offset=gap_offset,
            load=load,
        )

    @property
    def rests_in_contact(self) -> bool:
        """Whether a preload or a constant acceleration presses the masses together at rest."""
        return bool(self.offset[1] < self.offset[0])

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

    def flight(self, time: Floats) -> Floats:
        """Return the flow matrices (n, 4, 4) of both free masses after given times."""
        matrices = np.zeros((len(time), 4, 4))
        matrices[:, 0::2, 0::2] = self.oscillator(0, time)
        matrices[:, 1::2, 1::2] = self.oscillator(1, time)
        return matrices

    def contact(self, time: Floats) -> Floats:
        """Return the flow matrices (n, 4, 4) of both masses moving as one after given times."""
        common = self.oscillator(2, time)
        matrices = np.zeros((len(time), 4, 4))
        matrices[:, 0::2, 0::2] = common
        matrices[:, 1::2, 1::2] = common
        return matrices

    def steady(self, phase: Floats, contact: NDArray[np.bool_] | bool = False) -> Floats:
        """Return the steady-state response (harmonic part of (10)) at phases, shape (n, 4)."""
        which = oscillators(contact)
        cosine, sine = np.cos(phase)[:, None], np.sin(phase)[:, None]
        a, b = self.cosine[which], self.sine[which]
        states = np.empty((len(phase), 4))
        states[:, :2] = a * cosine + b * sine + self.offset[which]
        states[:, 2:] = self.eta * (b * cosine - a * sine)
        return states

    def common_motion(
        self, time: Floats, phase: Floats, position: Floats, velocity: Floats
    ) -> tuple[Floats, Floats]:
        """Return displacement and velocity a time after contact begins, by (10) with i = 3."""
        cosine, sine = self.basis(2, time)
        damping, square = self.damping[2], self.stiffness[2]
        x, v = self.common_response(phase)
        free, rate = position - x, velocity - v
        x, v = self.common_response(phase + self.eta * time)
        x = x + (cosine + damping * sine) * free + sine * rate
        return x, v - square * sine * free + (cosine - damping * sine) * rate

    def common_response(self, phase: Floats) -> tuple[Floats, Floats]:
        """Return displacement and velocity of the steady-state response in contact, at phases."""
        cosine, sine = np.cos(phase), np.sin(phase)
        a, b = self.cosine[2], self.sine[2]
        x: Floats = a * cosine + b * sine + self.offset[2]
        return x, self.eta * (b * cosine - a * sine)

    def centre(self) -> Floats:
        """Return the (4, 4) matrix that sets both masses of a state to their centre of mass."""
        weights = np.array([[1.0, self.mu], [1.0, self.mu]]) / (1.0 + self.mu)
        return np.asarray(np.kron(np.eye(2), weights), dtype=float)

    def field(
        self, state: Floats, phase: Floats, contact: NDArray[np.bool_] | bool = False
    ) -> Floats:
        """Return d(state)/d(tau), the right-hand side of (6), for states (n, 4) at phases."""
        which = oscillators(contact)
        drive = np.sin(phase)[:, None] * self.drive[which] + self.push
        rates = np.empty((len(phase), 4))
        rates[:, :2] = state[:, 2:]
        rates[:, 2:] = drive - 2.0 * self.damping[which] * state[:, 2:]
        rates[:, 2:] -= self.stiffness[which] * state[:, :2]
        if self.gap_offset != 0.0:
            rates[:, 2:] += self.load[which]
        return rates

    def gap_drive(self, phase: Floats) -> Floats:
        """Return the difference of the masses' harmonic right-hand sides, by forces on them."""
        return float(self.drive[1] - self.drive[0]) * np.sin(phase)

    def force(self, phase: Floats, position: Floats, velocity: Floats) -> Floats:
        """Return the contact force f (18) at phases, from position and velocity; < 0: pressed."""
        force = self.force_rate(position, velocity) + self.gap_drive(phase)
        return force if self.gap_offset == 0.0 else force + float(self.load[1])

    def force_rate(self, position: Floats, velocity: Floats) -> Floats:
        """Return what the derivatives of position and velocity add to the contact force's."""
        return self.force_v * velocity + self.force_x * position
