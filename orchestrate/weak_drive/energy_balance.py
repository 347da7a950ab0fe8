"""Balance the energies of a coupled run: motor work, losses and the coupling's energy defect.

The shaker's FMU keeps its own account. What the structure has lost, in dampers and impacts, follows
from the work that the box's acceleration did on it, as it was told it, less the energy it has
stored: the momentum P of the masses is known at both ends of a step with its rate and mean, so the
integral of P times acceleration is.

The defect of a step is the difference between the work that one side gives and the other takes. A
small defect is necessary, not sufficient: two sides may agree on a wrong motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..structures.structure import Structure
from .exchange import Cubic, OscillatorOutputs, ShakerOutputs
from .polynomials import end_value, integrate_product, matched_quartic, normalized_coefficients


class Energies(NamedTuple):
    """Store the energies since the start, J: the motor's work and where it has gone."""

    motor: float  # mechanical work of the motor
    # lost in the damper of the box, in impacts, in the dampers of the masses
    box_damper: float
    impact_loss: float
    stored: float  # kinetic energy, and energy of the springs
    dampers: float
    missing: float  # motor less all others: what the coupling has lost (negative: fed in)
    # sum of the steps' defects (work that the box takes less work that the masses give), and sum of
    # their sizes
    defect: float
    defect_sizes: float


class EnergyBalance:
    """Sum up the energies of a coupled run, step by step."""

    def __init__(
        self, structure: Structure, motion: OscillatorOutputs, shaking: ShakerOutputs
    ) -> None:
        """Record the energies at the start, from both FMUs' outputs."""
        self._masses = structure.m1, structure.m2
        self._stiffnesses = structure.k1, structure.k2
        self._rest, self._preload = structure.at_rest, structure.preload
        self.lost = self.defect = self.defect_sizes = 0.0
        self.start = self._accounts(motion, shaking)

    def relative_energy(self, motion: OscillatorOutputs) -> float:
        """Return the structure's energy by its motion relative to the box, J.

        A preload F adds F times the gap to the springs' energy by the displacements from rest; so
        little is lost of a motion that is small beside it.
        """
        (m1, m2), (k1, k2) = self._masses, self._stiffnesses
        (rest_1, rest_2), (v1, v2) = self._rest, motion[2:4]
        x1, x2 = motion.x1 - rest_1, motion.x2 - rest_2
        own = 0.5 * (m1 * v1 * v1 + m2 * v2 * v2 + k1 * x1 * x1 + k2 * x2 * x2)
        return own + self._preload * motion.x_rel

    def absolute_energy(self, motion: OscillatorOutputs, velocity: float) -> float:
        """Return the structure's energy by its absolute motion, for a box velocity, J."""
        m1, m2 = self._masses
        momentum = m1 * motion.v1 + m2 * motion.v2
        return self.relative_energy(motion) + velocity * (momentum + 0.5 * (m1 + m2) * velocity)

    def add(
        self,
        before: OscillatorOutputs,
        after: OscillatorOutputs,
        acceleration: Cubic,
        defect: float,
        h: float,
    ) -> None:
        """Add the energy lost in the structure over one step, and the step's defect."""
        work = h * integrate_product(
            self._momentum(before, after, acceleration, h), normalized_coefficients(acceleration, h)
        )
        self.lost += self.relative_energy(before) - self.relative_energy(after) - work
        self.defect += defect
        self.defect_sizes += abs(defect)

    def _momentum(
        self, before: OscillatorOutputs, after: OscillatorOutputs, acceleration: Cubic, h: float
    ) -> tuple[float, ...]:
        """Return the masses' relative momentum over a step as a quartic in t/h."""
        m1, m2 = self._masses
        mass = m1 + m2
        ends = (m1 * before.v1 + m2 * before.v2, m1 * after.v1 + m2 * after.v2)
        first = -h * (before.box_force + mass * acceleration[0])
        last = -h * (after.box_force + mass * end_value(acceleration, h))
        mean = (m1 * (after.x1 - before.x1) + m2 * (after.x2 - before.x2)) / h
        return matched_quartic(ends, (first, last), mean)

    def _accounts(self, motion: OscillatorOutputs, shaking: ShakerOutputs) -> tuple[float, ...]:
        """Return motor work, box damping, impact loss, stored energy, mass damping."""
        return (
            shaking.motor_energy,
            shaking.box_damper_energy,
            motion.impact_energy,
            shaking.stored_energy + self.absolute_energy(motion, shaking.box_velocity),
            self.lost - motion.impact_energy,
        )

    def energies(self, motion: OscillatorOutputs, shaking: ShakerOutputs) -> Energies:
        """Return all energies since the start, given both FMUs' present outputs."""
        now = self._accounts(motion, shaking)
        motor, *others = (value - start for value, start in zip(now, self.start, strict=True))
        accounts = (motor, *others, motor - sum(others), self.defect, self.defect_sizes)
        return Energies._make(accounts)

    def get_state(self) -> list[float]:
        """Return the sums as a list of floats, to be restored later."""
        return [self.lost, self.defect, self.defect_sizes, *self.start]

    def set_state(self, numbers: Sequence[float]) -> None:
        """Restore the sums that :meth:`get_state` returned."""
        self.lost, self.defect, self.defect_sizes = numbers[:3]
        self.start = tuple(numbers[3:])
