"""Balance the energies of a coupled run: motor work, losses and the coupling's energy defect.

What the structure loses follows from the work of the box's acceleration on its momentum, less what
it stores. A step's defect is the work that one side gives less that which the other takes.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..model.structure import Structure
from .polynomials import (
    end_derivatives,
    integrate_product,
    matched_quartic,
    normalized_coefficients,
)
from .step_record import Floats, OscillatorOutputs, Record


class Energies(NamedTuple):
    """Store the energies since the start, J: the motor's work and where it has gone."""

    motor: Any  # mechanical work of the motor
    # lost in the damper of the box, in impacts, in the dampers of the masses
    box_damper: Any
    impact_loss: Any
    stored: Any  # kinetic energy, and energy of the springs
    dampers: Any
    missing: Any  # motor less all others: what the coupling has lost (negative: fed in)
    # sum of the steps' defects (work that the box takes less work that the masses give), and sum of
    # their sizes
    defect: Any
    defect_sizes: Any


ACCOUNTS = Energies._fields[:5]  # what counts from the start


class EnergyBalance:
    """Sum up the energies of a coupled run, record after record."""

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        self.sums = np.zeros(3)  # lost by the structure, defects, and their sizes
        self.start = np.full(len(ACCOUNTS), np.nan)

    def add_record(self, record: Record) -> Energies:
        """Return the energies since the start at all rows of a record, and add them up."""
        # the work that the box takes, by the drive's account, less what the masses give
        defects = np.diff(record["box_force_work"]) - record.after["given"]
        steps = np.stack([self.energy_lost_per_step(record), defects, np.abs(defects)])
        sums = np.cumsum(np.hstack([self.sums[:, np.newaxis], steps]), axis=1)
        motion, velocity, s = record.motion(), record["box_velocity"], self.structure
        momentum = s.m1 * motion.v1 + s.m2 * motion.v2 + 0.5 * (s.m1 + s.m2) * velocity
        stored = record["stored_energy"] + self.relative_energy(motion) + velocity * momentum
        loss = np.asarray(motion.impact_energy)
        motor, damper = record["motor_energy"], record["box_damper_energy"]
        accounts = np.stack([motor, damper, loss, stored, sums[0] - loss])
        if np.isnan(self.start[0]):
            self.start = accounts[:, 0].copy()
        self.sums = sums[:, -1].copy()
        since = accounts - self.start[:, np.newaxis]
        missing = since[0] - sum(since[1:])
        return Energies._make([*since, missing, sums[1], sums[2]])

    def energy_lost_per_step(self, record: Record) -> Floats:
        before, after = record.before.motion(), record.after.motion()
        h, acceleration = record.after["h"], record.after.acceleration_cubics()
        # the relative momentum over a step is a quartic in t/h
        m1, m2 = self.structure.m1, self.structure.m2
        mass = m1 + m2
        ends = (m1 * before.v1 + m2 * before.v2, m1 * after.v1 + m2 * after.v2)
        first = -h * (before.box_force + mass * acceleration[0])
        last = -h * (after.box_force + mass * end_derivatives(acceleration, h)[0])
        mean = (m1 * (after.x1 - before.x1) + m2 * (after.x2 - before.x2)) / h
        momentum = matched_quartic(ends, (first, last), mean)
        work = h * integrate_product(momentum, normalized_coefficients(acceleration, h))
        return np.asarray(self.relative_energy(before) - self.relative_energy(after) - work)

    def relative_energy(self, motion: OscillatorOutputs) -> Any:
        """Return the structure's energy by its motion relative to the box, J."""
        # a preload adds itself times the gap: little is lost of a much smaller motion
        s, (rest_1, rest_2) = self.structure, self.structure.at_rest
        x1, x2, v1, v2 = motion.x1 - rest_1, motion.x2 - rest_2, motion.v1, motion.v2
        own = 0.5 * (s.m1 * v1 * v1 + s.m2 * v2 * v2 + s.k1 * x1 * x1 + s.k2 * x2 * x2)
        return own + s.preload * motion.x_rel

    def numbers_to_resume(self) -> list[float]:
        return [*self.sums.tolist(), *self.start.tolist()]

    def resume_from(self, numbers: list[float]) -> None:
        self.sums, self.start = np.array(numbers[:3]), np.array(numbers[3:])
