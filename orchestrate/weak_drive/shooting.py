"""Solve for stationary (periodic) motions of structure and motor by a shooting method.

Both FMUs are started from a state, stepped together over one period, and compared with where they
began. The motor's angle at the start is fixed, voltage and mean speed are two more unknowns: so the
motions make a curve, which :mod:`orchestrate.dynamics.continuation` follows round all its folds.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import NamedTuple

import numpy as np

from ..constants import TURN
from ..dynamics.closed_form import Floats
from ..dynamics.continuation import NoConvergenceError, with_positive_leading_component
from ..errors import FmuError
from ..fmu.instance import Instance
from ..model.drive import Drive
from ..model.structure import Structure
from .connection import MOTOR
from .extremes import gap_acceleration, range_of_mass_1
from .master import Master, Scheme
from .run import oscillator_start_values
from .step_record import LEADING, Record

# start values of the structure and of the motor, in the order of the unknowns
MASSES = ("x1_start", "v1_start", "x2_start", "v2_start")
STARTS = ("position_start", "velocity_start", "speed_start", "current_start")
COLUMNS = (*LEADING, *MOTOR.outputs)  # of a row of the master


class Period(NamedTuple):
    """Store what a simulation of one period shows: amplitude, impacts, best start."""

    amplitude: float  # half the range of x1, m
    impacts: int
    revolutions: int
    # steps from the start to where the gap is widest, or with `in_contact` the masses are pressed
    # hardest
    clearest_step: int
    start_clearance: float  # gap (or force) at the start over the widest (largest); 1 if bonded
    in_contact: bool = False  # whether the period of a preloaded structure is to begin in contact
    # whether the masses of a preloaded structure are in contact at a communication point
    sticks: bool = False


class Shot(NamedTuple):
    """Store the state of both FMUs after one period, and the number of impacts."""

    end: Floats  # the state, each quantity over its unit, and the angle beyond full turns
    impacts: int  # on the way
    # whether the masses were in permanent contact at a communication point on the way
    contact: bool

    def is_connected_to(self, other: Shot) -> bool:
        """Return whether two motions have the same impacts, with no grazing between."""
        # the last impacts of a chattering that ends in contact come and go with next to no speed
        return self.impacts == other.impacts or (self.contact and other.contact)


class Shooter:
    """Define the equations of a periodic motion of both FMUs, and their Jacobian."""

    # Unknowns: the state where the angle has its start value, displacements from rest, each over
    # its unit; voltage over K omega; mean speed over omega. Rounding leaves 1e-15 to 1e-13 times
    # the largest multiplier. Under a preload a period may begin and end in contact.

    accuracy: float = 1e-9  # of the unit: what a root may leave of the equations

    def __init__(
        self,
        fmus: tuple[Instance, Instance],
        structure: Structure,
        drive: Drive,
        revolutions: int,
        steps: int,
        length: float,
    ) -> None:
        self.fmus, self.structure, self.drive = fmus, structure, drive
        self.revolutions, self.period_steps, self.angle = revolutions, revolutions * steps, 0.0
        self.master: Master | None = None  # of both FMUs, from the first start on
        self.volts, self.length = drive.volts(structure), length
        self.define_unknowns(structure.bonded)

    def define_unknowns(self, in_contact: bool) -> None:
        """Set whether periods begin in contact, and so the unknowns; forget the Jacobian."""
        self.in_contact = in_contact
        structure, drive, length = self.structure, self.drive, self.length
        omega = structure.omega
        masses = ("x1", "v1") if in_contact else ("x1", "v1", "x2", "v2")
        self.names: tuple[str, ...] = (*masses, "box_position", "box_velocity", "speed")
        rest = dict(zip(("x1", "x2"), structure.at_rest, strict=True))
        # where the values stand in a row of the master, and what they are counted from
        self.columns_and_rests = [(COLUMNS.index(name), rest.get(name, 0.0)) for name in self.names]
        units = {"x1": length, "x2": length, "box_position": length, "speed": omega}
        units["motor_current"] = drive.volts(structure) / drive.armature_resistance
        if drive.armature_inductance > 0.0:
            self.names = (*self.names, "motor_current")
        self.units = np.array([units.get(name, length * omega) for name in self.names])
        self.size = len(self.names)
        self.scale: Floats = np.ones(self.size + 2)
        self.jacobian_matrix: Floats = np.empty((0, 0))
        self._last: tuple[Floats, Floats] | None = None

    def set_revolutions(self, revolutions: int) -> None:
        """Set after how many revolutions the motion repeats; forget the Jacobian."""
        self.period_steps = self.period_steps // self.revolutions * revolutions
        self.revolutions = revolutions
        self.jacobian_matrix, self._last = np.empty((0, 0)), None

    def state_change_after(self, unknowns: Floats, revolutions: int) -> Floats:
        before, matrix, last = self.revolutions, self.jacobian_matrix, self._last
        self.set_revolutions(revolutions)
        try:
            return self.shoot(unknowns).end[: self.size] - unknowns[: self.size]
        finally:
            self.set_revolutions(before)
            self.jacobian_matrix, self._last = matrix, last

    # -- both FMUs over a period --

    def start_master(self, state: Floats, voltage: float, h: float) -> Master:
        oscillator, shaker = self.fmus
        oscillator.reset()
        shaker.reset()
        values = (state * self.units).tolist()
        count = 2 if self.in_contact else 4  # of the values that are the masses'
        masses = values[:count] * (4 // count)
        starts = dict(zip(MASSES, masses, strict=True))
        oscillator.initialize(**oscillator_start_values(self.structure), **starts)
        own = dict(zip(STARTS, values[count:], strict=False))
        own |= {"angle_start": self.angle, "voltage": voltage}
        shaker.initialize(**self.drive.parameters(), **own)
        if self.master is None:
            self.master = Master(oscillator, shaker, Scheme(h))
        else:
            self.master.scheme = Scheme(h)
            self.master.reset()
        return self.master

    def close(self) -> None:
        if self.master is not None:
            self.master.close()

    def begin_period(self, unknowns: Floats) -> tuple[Master, float]:
        """Initialise both FMUs at a period's start; return master and voltage, V."""
        voltage = float(unknowns[-2]) * self.volts
        period = self.revolutions * TURN / (float(unknowns[-1]) * self.structure.omega)
        return self.start_master(unknowns[:-2], voltage, period / self.period_steps), voltage

    def scaled_state(self, master: Master) -> Floats:
        values = [master.row[place] - rest for place, rest in self.columns_and_rests]
        if "motor_current" in self.names:
            values += self.fmus[1].get("motor_current")
        return np.array(values) / self.units

    def simulate_at_speed(self, voltage: float, speed: float, time: float) -> Floats:
        """Simulate for a time at a nearly fixed speed (heavy rotor); begin periods at its end.

        Return the state there.
        """
        self.define_unknowns(self.structure.bonded)
        longest = time + (self.revolutions + 1) * TURN / speed
        own_drive = self.drive
        # a rotor that keeps its speed
        self.drive = own_drive.replace(rotor_inertia=1e6 * own_drive.rotor_inertia)
        state = np.zeros(self.size)
        state[self.names.index("speed")] = speed / self.structure.omega
        if "motor_current" in self.names:
            current = (voltage - own_drive.motor_constant * speed) / own_drive.armature_resistance
            state[-1] = current / self.units[-1]
        try:
            master = self.start_master(state, voltage, 0.1 / self.structure.omega)
            master.run(np.full(max(0, round(time / master.scheme.h) - 1), voltage))
            while master.time < time or (self._is_touching(master) and master.time < longest):
                master.step(voltage)
            if self.structure.preload > 0.0:  # once more round, to where a period is best begun
                h = self.revolutions * TURN / speed / self.period_steps
                record = master.run(np.full(self.period_steps, voltage), h=h).after
                master.run(np.full(1 + self.find_best_start(record)[0], voltage), h=h)
        finally:
            self.drive = own_drive
        self.angle = master["angle"] % TURN
        self.define_unknowns(self._is_touching(master) or self.structure.bonded)
        return self.scaled_state(master)

    def _is_touching(self, master: Master) -> bool:
        return not self.structure.bonded and master.motion.x_rel == 0.0

    def shoot(self, unknowns: Floats) -> Shot:
        try:
            master, voltage = self.begin_period(unknowns)
            record = master.run(np.full(self.period_steps, voltage)).after
        except FmuError as error:
            raise NoConvergenceError(str(error)) from None
        turned = master["angle"] - self.angle - self.revolutions * TURN
        end = np.append(self.scaled_state(master), turned)
        if self.in_contact and master.motion.x_rel > 0.0:
            raise NoConvergenceError("the masses are apart at the end of a period")
        contact = bool((record["x_rel"] == 0.0).any())
        return Shot(end, int(master["impacts"]), contact)

    def observe_period(self, unknowns: Floats) -> Period:
        """Simulate one period; return its amplitude, impacts and best start."""
        master, voltage = self.begin_period(unknowns)
        record = master.run(np.full(self.period_steps, voltage))
        reached = range_of_mass_1(self.structure, record)
        amplitude = 0.5 * float(reached.high.max() - reached.low.min())
        start = self.find_best_start(record.before)
        return Period(amplitude, int(master["impacts"]), self.revolutions, *start)

    def find_best_start(self, record: Record) -> tuple[int, float, bool, bool]:
        """Find the step farthest from impacts; return a Period's last four fields."""
        sizes = record["x_rel"]
        in_contact, sticks = self.in_contact and not sizes.any(), False
        if self.structure.preload > 0.0:
            sticks = bool((sizes == 0.0).any())
            s, motion = self.structure, record.motion()
            touching = (motion.x_rel == 0.0) & (motion.v1 == motion.v2)
            inside = touching & np.roll(touching, 1) & np.roll(touching, -1)
            force = -gap_acceleration(s, motion) * s.m1 * s.m2 / (s.m1 + s.m2)
            forces = np.where(inside, np.maximum(force, 0.0), 0.0)
            in_contact = in_contact or bool(forces.any())
            sizes = forces if in_contact else sizes
        clear = int(np.argmax(sizes))
        share = float(sizes[0] / sizes[clear]) if sizes[clear] > 0.0 else 1.0
        return clear, share, in_contact, sticks

    def shift_start(self, unknowns: Floats, steps: int, in_contact: bool) -> Floats:
        """Shift the period's start by some steps; return the unknowns there."""
        master, voltage = self.begin_period(unknowns)
        master.run(np.full(steps, voltage))
        self.angle = master["angle"] % TURN
        self.define_unknowns(in_contact)
        return np.append(self.scaled_state(master), unknowns[-2:])

    # -- the equations --

    def residual(self, unknowns: Floats) -> Floats:
        """Return how state and angle miss periodicity after one period."""
        if self._last is not None and np.array_equal(self._last[0], unknowns):
            return self._last[1]
        end_state = self.shoot(unknowns).end
        end_state[: self.size] -= unknowns[: self.size]
        return end_state

    def jacobian(self, unknowns: Floats, at_root: bool = False) -> Floats:
        """Return the Jacobian by differences, or updated by Broyden's secant rule."""
        if at_root or not self.jacobian_matrix.size:
            return self.compute_jacobian(unknowns)
        residual = self.residual(unknowns)
        if self._last is not None:
            change = unknowns - self._last[0]
            square = float(change @ change)
            if square > 0.0:
                missed = residual - self._last[1] - self.jacobian_matrix @ change
                self.jacobian_matrix = self.jacobian_matrix + np.outer(missed, change) / square
        self._last = unknowns.copy(), residual
        return self.jacobian_matrix

    def set_root_jacobian(self, root: Floats, matrix: Floats) -> None:
        self.jacobian_matrix, self._last = matrix, (root, np.zeros(self.size + 1))

    def compute_jacobian(self, unknowns: Floats) -> Floats:
        base = self.shoot(unknowns)
        columns = [self.jacobian_column(unknowns, i, base) for i in range(len(unknowns))]
        matrix = np.stack(columns, axis=1)
        matrix[: self.size, : self.size] -= np.eye(self.size)
        self.jacobian_matrix, residual = matrix, base.end.copy()
        residual[: self.size] -= unknowns[: self.size]
        self._last = unknowns.copy(), residual
        return self.jacobian_matrix

    def jacobian_column(self, unknowns: Floats, which: int, base: Shot) -> Floats:
        known: dict[float, Shot] = {0.0: base}

        def end_state_shifted_by(change: float) -> Floats | None:
            if change not in known:
                moved = unknowns.copy()
                moved[which] += change
                known[change] = self.shoot(moved)
            return known[change].end if known[change].is_connected_to(base) else None

        sides = (central_difference, 1.0), (one_sided_difference, 1.0), (one_sided_difference, -1.0)
        for change, (difference, side) in product((1e-6, 1e-7), sides):  # the first that will do
            fine = difference(end_state_shifted_by, side * change)
            coarse = difference(end_state_shifted_by, 2.0 * side * change)
            if fine is None or coarse is None:
                continue
            if np.abs(fine - coarse).max() <= 1e-3 * max(1.0, np.abs(fine).max()):
                return (4.0 * fine - coarse) / 3.0  # Richardson
        raise NoConvergenceError("a grazing is too near for a derivative")

    def floquet_multipliers(self) -> np.ndarray:
        """Return the multipliers by the present Jacobian, the largest first."""
        # without the angle's own, which is 1 for every motion
        values = np.linalg.eigvals(self.return_map_derivative())
        return np.asarray(values[np.argsort(-np.abs(values))])

    def return_map_derivative(self) -> Floats:
        count = self.size
        flow = self.jacobian_matrix[:, :count] + np.eye(count + 1, count)
        drift = self.jacobian_matrix[:, -1]  # a longer period is a slower mean speed
        return np.asarray(flow[:count] - np.outer(drift[:count], flow[count]) / drift[count])

    def flip_direction(self) -> Floats:
        """Return the unit eigenvector of the multiplier -1 (period doubling)."""
        values, vectors = np.linalg.eig(self.return_map_derivative())
        direction = vectors[:, np.argmin(np.abs(values + 1.0))].real
        return with_positive_leading_component(np.asarray(direction / np.linalg.norm(direction)))


Ends = Callable[[float], "Floats | None"]  # of a period, by a change of an unknown


def central_difference(end: Ends, change: float) -> Floats | None:
    """Compute a derivative by central differences; None across a grazing."""
    after, before = end(change), end(-change)
    return None if after is None or before is None else (after - before) / (2.0 * change)


def one_sided_difference(end: Ends, change: float) -> Floats | None:
    """Compute a derivative by one-sided second-order differences; None across a grazing."""
    here, near, far = end(0.0), end(change), end(2.0 * change)
    if here is None or near is None or far is None:
        return None
    return (4.0 * near - far - 3.0 * here) / (2.0 * change)
