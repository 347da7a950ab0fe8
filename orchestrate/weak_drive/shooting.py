"""Stationary motions of structure and motor together: periodic after some revolutions, by shooting.

Both FMUs are started from a state, stepped together over one period, and compared with where they
began. The motor's angle at the start is fixed, voltage and mean speed are two more unknowns: so the
motions make a curve, which :mod:`orchestrate.dynamics.continuation` follows round all its folds.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..access.instance import Instance
from ..dynamics.closed_form import Floats
from ..dynamics.continuation import NoConvergenceError
from ..errors import FmuError
from ..structures.drive import Drive
from ..structures.structure import Structure
from .compiled import master_of
from .couple import oscillator_start
from .extremes import Revolution
from .master import PLACES, TURN, Master, Scheme

STARTS = {  # start values of the shaker and of the structure by the outputs that they are
    **{"box_position": "position_start", "box_velocity": "velocity_start", "speed": "speed_start"},
    **{name: f"{name}_start" for name in ("x1", "v1", "x2", "v2")},
    "motor_current": "current_start",
}
COARSE, FINE = 1e-5, 1e-7  # differences of the unknowns: see Shooter.change
HEAVY = 1e6  # times its inertia, a rotor that keeps its speed


class Period(NamedTuple):
    """What is seen of a motion over a period.

    Attributes
    ----------
    amplitude : float
        Half the range of x1, m.
    impacts : int
    revolutions : int
    clear : int
        Steps from the start to where the gap is widest.
    share : float
        The gap at the start over the widest one; 1 where bonded.
    """

    amplitude: float
    impacts: int
    revolutions: int
    clear: int
    share: float


class Shooter:
    """Both FMUs as equations whose roots are periodic motions.

    Unknowns are the state where the angle has its value at the start, each quantity over its unit,
    then the voltage over K omega and the mean speed over omega. The Jacobian is renewed where it is
    asked for, and follows the residuals by Broyden's secants between.

    Parameters
    ----------
    fmus : tuple of Instance
        Of the structure and of the shaker.
    structure : Structure
    drive : Drive
    revolutions : int
        After which the motion is to repeat.
    steps : int
        Communication steps in each.
    length : float
        Unit of the displacements, m: about the amplitude.

    Attributes
    ----------
    size : int
        Quantities of the state; the voltage's place among the unknowns.
    angle : float
        Of the motor at the start, rad.
    matrix : ndarray, shape (size + 1, size + 2)
        The residual's Jacobian.
    change : float
        Of the unknowns, for its differences: ``COARSE``, since an impact that passes from one step
        to the next changes what the coupling leaves, or ``FINE`` near a grazing, where both states
        are to have the same impacts.
    """

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
        self.turns, self.count, self.angle = revolutions, revolutions * steps, 0.0
        self.used, self.change = False, COARSE
        omega = structure.omega
        masses = ("x1", "v1") if structure.bonded else ("x1", "v1", "x2", "v2")
        self.names = (*masses, "box_position", "box_velocity", "speed")
        units = {"x1": length, "x2": length, "box_position": length, "speed": omega}
        units["motor_current"] = drive.volts(structure) / drive.armature_resistance
        if drive.armature_inductance > 0.0:
            self.names = (*self.names, "motor_current")
        self.units = np.array([units.get(name, length * omega) for name in self.names])
        self.volts, self.size = drive.volts(structure), len(self.names)
        self.scale: Floats = np.ones(self.size + 2)
        self.matrix: Floats = np.empty((0, 0))
        self._last: tuple[Floats, Floats] | None = None

    def repeat_after(self, revolutions: int) -> None:
        """From now on motions are to repeat after another number of revolutions."""
        self.turns, self.count = revolutions, self.count // self.turns * revolutions
        self.matrix, self._last = np.empty((0, 0)), None

    def change_in(self, unknowns: Floats, revolutions: int) -> Floats:
        """What the state changes in some revolutions, of a motion that repeats after more."""
        turns, matrix, last = self.turns, self.matrix, self._last
        self.repeat_after(revolutions)
        try:
            return self.after(unknowns)[: self.size] - unknowns[: self.size]
        finally:
            self.repeat_after(turns)
            self.matrix, self._last = matrix, last

    # -- both FMUs over a period --

    def master(self, state: Floats, voltage: float, h: float) -> Master:
        """Both FMUs, started from a state."""
        oscillator, shaker = self.fmus
        if self.used:
            oscillator.reset()
            shaker.reset()
        self.used = True
        values = dict(zip(self.names, (state * self.units).tolist(), strict=True))
        if self.structure.bonded:
            values |= {"x2": values["x1"], "v2": values["v1"]}
        starts = {STARTS[name]: value for name, value in values.items()}
        own = {name: starts.pop(name) for name in ("x1_start", "v1_start", "x2_start", "v2_start")}
        oscillator.initialize(**oscillator_start(self.structure), **own)
        more = {"angle_start": self.angle, "voltage": voltage}
        shaker.initialize(**self.drive.parameters(), **starts, **more)
        return master_of(oscillator, shaker, self.structure, Scheme("rollback", h))

    def begin(self, unknowns: Floats) -> tuple[Master, float]:
        """Both FMUs at the start of a period, and the voltage, V."""
        voltage = float(unknowns[-2]) * self.volts
        period = self.turns * TURN / (float(unknowns[-1]) * self.structure.omega)
        return self.master(unknowns[:-2], voltage, period / self.count), voltage

    def state_of(self, master: Master) -> Floats:
        """The state of both, each quantity over its unit."""
        values = {**master.motion._asdict(), **master.shaking._asdict()}
        if "motor_current" in self.names:
            values["motor_current"] = self.fmus[1].get("motor_current")[0]
        return np.array([values[name] for name in self.names]) / self.units

    def settle(self, voltage: float, speed: float, time: float) -> Floats:
        """The state after a time at a speed, with the masses apart unless they are bonded.

        The speed is held by a heavy rotor: so motions are found that a motor would not stay on.
        """
        own = self.drive
        self.drive = own.replace(rotor_inertia=HEAVY * own.rotor_inertia)
        state = np.zeros(self.size)
        state[self.names.index("speed")] = speed / self.structure.omega
        if "motor_current" in self.names:
            current = (voltage - own.motor_constant * speed) / own.armature_resistance
            state[-1] = current / self.units[-1]
        try:
            master = self.master(state, voltage, 0.1 / self.structure.omega)
            while master.time < time or self._touching(master):
                master.step(voltage)
        finally:
            self.drive = own
        self.angle = master.shaking.angle % TURN
        found = self.state_of(master)
        master.close()
        return found

    def _touching(self, master: Master) -> bool:
        return not self.structure.bonded and master.motion.x1 == master.motion.x2

    def after(self, unknowns: Floats) -> Floats:
        """State, and angle beyond full turns, a period later.

        Raises
        ------
        NoConvergenceError
            Where the FMUs cannot begin there, as with masses through each other.
        """
        try:
            master, voltage = self.begin(unknowns)
            master.run([voltage] * self.count)
        except FmuError as error:
            raise NoConvergenceError(str(error)) from None
        turned = master.shaking.angle - self.angle - self.turns * TURN
        found = np.append(self.state_of(master), turned)
        master.close()
        return found

    def look(self, unknowns: Floats) -> Period:
        """What a motion does over a period."""
        master, voltage = self.begin(unknowns)
        ends = master.motion, master.shaking
        seen = master.revolution = Revolution.begin(*ends, turn=math.nan)  # never complete
        kept = np.empty((self.count + 1, len(master.memory())))
        kept[0] = master.memory()
        master.run([voltage] * self.count, kept=kept[1:])
        gaps = kept[:, PLACES["x2"]] - kept[:, PLACES["x1"]]
        master.close()
        impacts = int(self.fmus[0].get("impact_count")[0])
        clear = int(np.argmax(gaps))
        share = gaps[0] / gaps[clear] if gaps[clear] > 0.0 else 1.0
        return Period(0.5 * (seen.x1_high - seen.x1_low), impacts, self.turns, clear, share)

    def begin_later(self, unknowns: Floats, steps: int) -> Floats:
        """Begin periods some steps later from now on; the unknowns of the same motion there."""
        master, voltage = self.begin(unknowns)
        master.run([voltage] * steps)
        self.angle = master.shaking.angle % TURN
        found = np.append(self.state_of(master), unknowns[-2:])
        master.close()
        return found

    # -- the equations --

    def residual(self, unknowns: Floats) -> Floats:
        """What a period changes: of the state, and of the angle beyond full turns."""
        if self._last is not None and np.array_equal(self._last[0], unknowns):
            return self._last[1]
        found = self.after(unknowns)
        found[: self.size] -= unknowns[: self.size]
        return found

    def jacobian(self, unknowns: Floats) -> Floats:
        """The residual's derivative, by the secant from where it was last asked for."""
        found = self.residual(unknowns)
        if not self.matrix.size:
            return self.renew(unknowns)
        if self._last is not None:
            way = unknowns - self._last[0]
            length = float(way @ way)
            if length > 0.0:
                change = found - self._last[1] - self.matrix @ way
                self.matrix = self.matrix + np.outer(change, way) / length
        self._last = unknowns.copy(), found
        return self.matrix

    def renew(self, unknowns: Floats, central: bool = False) -> Floats:
        """The Jacobian by differences at a root or near one."""
        change = self.change
        base = self.residual(unknowns)
        columns = []
        for i in range(len(unknowns)):
            moved = unknowns.copy()
            moved[i] += change
            there = self.residual(moved)
            if central:
                moved[i] -= 2.0 * change
                columns.append((there - self.residual(moved)) / (2.0 * change))
            else:
                columns.append((there - base) / change)
        self.matrix = np.stack(columns, axis=1)
        self._last = unknowns.copy(), base
        return self.matrix

    def multipliers(self) -> np.ndarray:
        """Floquet multipliers by the Jacobian: of the map from the angle at the start to itself.

        The angle's own, 1 for every motion, is not among them.
        """
        values = np.linalg.eigvals(self.section())
        return np.asarray(values[np.argsort(-np.abs(values))])

    def section(self) -> Floats:
        """The derivative of the map from the angle at the start to itself, by the Jacobian."""
        count = self.size
        flow = self.matrix[:, :count] + np.eye(count + 1, count)
        drift = self.matrix[:, -1]  # a longer period is a slower mean speed
        return np.asarray(flow[:count] - np.outer(drift[:count], flow[count]) / drift[count])

    def alternating(self) -> Floats:
        """The direction of length 1 of the state that the map turns round: multiplier -1."""
        values, vectors = np.linalg.eig(self.section())
        found = vectors[:, np.argmin(np.abs(values + 1.0))].real
        return np.asarray(found / np.linalg.norm(found))
