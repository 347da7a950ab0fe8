"""Closed-form motion between impacts (10): both masses free, or in contact as one.

All in the paper's units: displacements over a eta^2, time as tau, the excitation by its phase.
A state is (xi_1, xi_2, xi_1', xi_2'). Oscillators 1 and 2 are the masses, 3 is both as one, 4 both
at the outer end of a stroke. With a clearance, xi_2 counts from where mass 2 touches mass 1 at
xi_1 = 0: the gap is xi_2 - xi_1 always, and the clearance is a constant load of the springs, see
:meth:`.Point.faces_from_states`. A wall is a mass 2 that nothing moves.
"""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import c_void_p
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fmu_src.kernels import orbits

from ..constants import TURN
from ..fmu.c_library import load_loop
from ..model import Excitation, Structure

Floats = NDArray[np.float64]
FREE, INNER, OUTER = 0, 1, 2  # modes: in flight, in permanent contact at either end
Modes = NDArray[np.int_] | int
Ends = NDArray[np.bool_] | bool  # whether an end is the outer one
SAME = 1e-14  # of two amplitudes: within their rounding


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
        damping = append_joint_values(structure.d1 / m1, structure.d2 / m2, share) / (2.0 * omega)
        stiffness = append_joint_values(structure.k1 / m1, structure.k2 / m2, share) / unit
        stiffness[0] = 1.0
        if wall:
            damping[:], stiffness[:] = damping[0], 1.0
        detuning, loss = stiffness - eta * eta, 2.0 * damping * eta
        reach = detuning**2 + loss**2
        shaken = float(excitation.amplitude != 0.0)
        level = excitation.amplitude * excitation.frequency**2 if shaken else unit * length
        push, force1, force2 = (each / level for each in excitation.pushes)  # m/s2 that is 1 here
        free = 0.0 if wall else 1.0
        drive = append_joint_values(shaken + force1 / m1, free * shaken + force2 / m2, share)
        with np.errstate(divide="ignore", invalid="ignore"):
            cosine, sine = -loss / reach * drive, detuning / reach * drive
        pushes = append_joint_values(0.0 - push, free * (0.0 - push), share)
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
    def impact_free_mode(self) -> int:
        """The mode of the settled response if it has no impacts and no releases, else -1."""
        mode, gap = self.rest_mode, float(self.offset[1] - self.offset[0])
        if mode == FREE:
            swings = np.stack([self.cosine[:2], self.sine[:2]])
            room, swing = min(gap, self.limit - gap), np.hypot(*np.diff(swings)[:, 0])
            return FREE if swing <= room + SAME * np.abs(swings).sum() else -1
        phase = np.array([0.0, 0.5, 1.0]) * np.pi
        position, _, velocity, _ = self.steady_response(phase, mode).T
        force = self.contact_force(phase, position, velocity, mode == OUTER)
        middle = 0.5 * (force[0] + force[2])
        return mode if np.hypot(*(force[:2] - middle)) <= -middle else -1

    @property
    def highest_frequency(self) -> float:
        """The highest frequency in the motion, over omega: excitation or a natural frequency."""
        swinging = np.sqrt(np.maximum(self.stiffness - self.damping**2, 0.0))
        return float(max(self.eta, swinging.max()))

    def separation_speed(self, closing: Floats) -> Floats:
        """Return the separation speeds e(v) v after impacts (15) by their closing speeds."""
        return self.e * closing / (1.0 + self.e_slope * closing)

    @cached_property
    def kernel_numbers(self) -> Floats:
        """Return the memory of ``kernels.orbits`` up to its tables."""
        square = self.stiffness - self.damping * self.damping  # (11)
        square[np.abs(square) <= 1e-14 * self.stiffness] = 0.0  # critical but for rounding
        nu = np.sqrt(np.abs(square))
        columns = self.damping, self.stiffness, square, nu, nu / TURN, self.damping
        more = self.cosine, self.sine, self.drive, self.push, self.offset, self.load
        forces = self.force_v, self.force_x, float(self.wall), self.limit
        motion = self.eta, self.e, self.e_slope, *self.shares, *forces
        return np.concatenate([motion, np.array([*columns, *more]).T.ravel()])

    def call_kernel(
        self, name: str, columns: Sequence[Any], width: int, span: float = 0.0
    ) -> Floats:
        """Call a function of ``kernels.orbits`` for n rows; return what it writes, (n, width)."""
        count, first = len(columns[0]), orbits.TABLE + len(columns) * len(columns[0])
        memory = np.empty(first + width * count + orbits.SPARE)
        memory[: orbits.ROWS] = self.kernel_numbers
        memory[orbits.ROWS : orbits.TABLE] = count, span
        for i, column in enumerate(columns):
            memory[orbits.TABLE + i : first : len(columns)] = column
        getattr(load_loop("orbits"), name)(c_void_p(memory.ctypes.data))
        return memory[first : first + width * count].reshape(-1, width)

    def flow_matrices(self, time: Floats, mode: Modes = FREE) -> Floats:
        """Return the flow matrices (n, 4, 4) of the motion in modes after given times."""
        by_mass = self.call_kernel("find_flows", (time, mode), 8).reshape(-1, 2, 2, 2)
        matrices = np.zeros((len(time), 4, 4))
        matrices[:, ::2, ::2], matrices[:, 1::2, 1::2] = by_mass[:, 0], by_mass[:, 1]
        return matrices

    def steady_response(self, phase: Floats, mode: Modes = FREE) -> Floats:
        """Return the steady-state response (harmonic part of (10)) at phases, shape (n, 4)."""
        return self.call_kernel("find_steady", (phase, mode), 4)

    def gap_at_end(self, outer: Ends) -> Floats:
        """Return the gap at which the masses meet: 0, or the largest at the outer end."""
        return np.where(outer, self.limit, 0.0)

    def centre_matrix(self) -> Floats:
        """Return the (4, 4) matrix that sets both masses of a state to their centre of mass."""
        return np.asarray(np.kron(np.eye(2), [self.shares] * 2), dtype=float)

    def state_rates(self, state: Floats, phase: Floats, mode: Modes = FREE) -> Floats:
        """Return d(state)/d(tau), the right-hand side of (6), for states (n, 4) at phases."""
        return self.call_kernel("find_rates", (phase, mode, *state.T), 4)

    def harmonic_part_of_force(self, phase: Floats, outer: Ends = False) -> Floats:
        """Return what the excitation adds to the contact force f (18): it is harmonic."""
        return separating_sign(outer) * float(self.drive[1] - self.drive[0]) * np.sin(phase)

    def contact_force(
        self, phase: Floats, position: Floats, velocity: Floats, outer: Ends = False
    ) -> Floats:
        """Return the contact force f (18) at phases, from mass 1 at an end; < 0: pressed."""
        constant = float(self.load[1] + (self.push[1] - self.push[0]))
        at_end = constant - self.stiffness[1] * self.gap_at_end(outer)
        linear = self.motion_part_of_contact_force(position, velocity, outer)
        return linear + self.harmonic_part_of_force(phase, outer) + separating_sign(outer) * at_end

    def motion_part_of_contact_force(
        self, position: Floats, velocity: Floats, outer: Ends = False
    ) -> Floats:
        """Return what position and velocity add to f (18), or their derivatives to f's."""
        return separating_sign(outer) * (self.force_v * velocity + self.force_x * position)


def separating_sign(outer: Ends) -> Floats:
    """Return the sign of the gap's acceleration that parts the masses: -1 at the outer end."""
    return np.where(outer, -1.0, 1.0)


def append_joint_values(of_mass1: float, of_mass2: float, mass2_share: float) -> Floats:
    """Return the values of mass 1, of mass 2, and two times the value of both moving as one."""
    # that is the mean of the first two, weighted by the share of mass 2 in the masses
    joint = of_mass1 + mass2_share * (of_mass2 - of_mass1)
    return np.array([of_mass1, of_mass2, joint, joint])
