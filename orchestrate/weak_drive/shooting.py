"""Stationary motions of structure and motor together: periodic after some revolutions, by shooting.

Both FMUs are started from a state, stepped together over one period, and compared with where they
began. At a given mean speed the period is known, and the voltage is one of the unknowns: so a
branch goes round its folds without more ado, as long as it is one over the speed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..access.instance import Instance
from ..errors import FmuError
from ..structures.drive import Drive
from ..structures.structure import Structure
from .couple import oscillator_start
from .extremes import reach_of_mass
from .master import Master, Scheme, Step
from .revolutions import TURN

STARTS = {  # start values of the shaker and of the structure by the outputs that they are
    **{"box_position": "position_start", "box_velocity": "velocity_start", "speed": "speed_start"},
    **{name: f"{name}_start" for name in ("x1", "v1", "x2", "v2")},
    "motor_current": "current_start",
}


class Orbit(NamedTuple):
    """A periodic motion.

    Attributes
    ----------
    voltage : float
        V.
    state : ndarray, shape (n,)
        Where the angle has its value at the start, each quantity over its unit.
    jacobian : ndarray, shape (n + 1, n + 2)
        State and angle a period later by state, voltage and length of the period.
    """

    voltage: float
    state: np.ndarray
    jacobian: np.ndarray


class Shooter:
    """Both FMUs, and what a state of theirs is.

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
    """

    def __init__(
        self,
        fmus: tuple[Instance, Instance],
        structure: Structure,
        drive: Drive,
        revolutions: int,
        steps: int,
    ) -> None:
        self.fmus, self.structure, self.drive = fmus, structure, drive
        self.turns, self.count, self.angle = revolutions, revolutions * steps, 0.0
        self.used = False
        length, omega = 10.0 * drive.length, structure.omega
        masses = ("x1", "v1") if structure.bonded else ("x1", "v1", "x2", "v2")
        self.names = (*masses, "box_position", "box_velocity", "speed")
        units = {"x1": length, "x2": length, "box_position": length, "speed": omega}
        units["motor_current"] = drive.volts(structure) / drive.armature_resistance
        if drive.armature_inductance > 0.0:
            self.names = (*self.names, "motor_current")
        self.units = np.array([units.get(name, length * omega) for name in self.names])
        self.volts = drive.volts(structure)

    def master(self, state: np.ndarray, voltage: float, h: float) -> Master:
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
        return Master(oscillator, shaker, self.structure, Scheme("rollback", h))

    def state_of(self, master: Master) -> np.ndarray:
        """The state of both, each quantity over its unit."""
        values = {**master.motion._asdict(), **master.shaking._asdict()}
        if "motor_current" in self.names:
            values["motor_current"] = self.fmus[1].get("motor_current")[0]
        return np.array([values[name] for name in self.names]) / self.units

    def settle(self, voltage: float, speed: float, time: float) -> np.ndarray:
        """The state after a time at a voltage, with the masses apart unless they are bonded."""
        state = np.zeros(len(self.names))
        state[self.names.index("speed")] = speed / self.structure.omega
        master = self.master(state, voltage, 0.1 / self.structure.omega)
        while master.time < time or self._touching(master):
            master.step(voltage)
        self.angle = master.shaking.angle % TURN
        found = self.state_of(master)
        master.close()
        return found

    def _touching(self, master: Master) -> bool:
        return not self.structure.bonded and master.motion.x1 == master.motion.x2

    def after(self, unknowns: np.ndarray, period: float) -> np.ndarray:
        """State, and angle beyond full turns, a period after the state and voltage in unknowns."""
        voltage = float(unknowns[-1]) * self.volts
        master = self.master(unknowns[:-1], voltage, period / self.count)
        for _ in range(self.count):
            master.step(voltage)
        turned = master.shaking.angle - self.angle - self.turns * TURN
        found = np.append(self.state_of(master), turned)
        master.close()
        return found

    def jacobian(self, unknowns: np.ndarray, period: float, base: np.ndarray) -> np.ndarray:
        """Derivatives of :meth:`after` by the unknowns and the period's relative length."""
        change = 1e-5
        columns = []
        for i in range(len(unknowns)):
            name = self.names[i] if i < len(self.names) else ""
            step = -change if name == "x1" else change  # the masses must not overlap
            moved = unknowns.copy()
            moved[i] += step
            columns.append((self.after(moved, period) - base) / step)
        columns.append((self.after(unknowns, period * (1.0 + change)) - base) / change)
        return np.stack(columns, axis=1)

    def orbit(
        self, guess: Orbit, speed: float, tolerance: float = 1e-8, tries: int = 12
    ) -> Orbit | None:
        """The periodic motion at a mean speed, rad/s, by Newton's method; None if there is none.

        The Jacobian of the guess serves as long as the error falls to a tenth each time.
        """
        period = self.turns * TURN / speed
        unknowns = np.append(guess.state, guess.voltage / self.volts)
        jacobian, error = guess.jacobian, np.inf
        target = np.eye(len(unknowns))[:, : len(unknowns) - 1]
        try:
            for _ in range(tries):
                found = self.after(unknowns, period)
                misfit = found - target @ unknowns[:-1]
                last, error = error, float(np.abs(misfit).max())
                if error < tolerance:
                    jacobian = self.jacobian(unknowns, period, found)
                    return Orbit(unknowns[-1] * self.volts, unknowns[:-1], jacobian)
                if not jacobian.size or error > 0.1 * last:
                    jacobian = self.jacobian(unknowns, period, found)
                slope = jacobian[:, :-1] - np.column_stack([target, np.zeros(len(target))])
                unknowns = unknowns - np.linalg.solve(slope, misfit)
        except (FmuError, np.linalg.LinAlgError):  # masses through each other, or nothing to solve
            return None
        return None

    def amplitude(self, orbit: Orbit, speed: float) -> float:
        """Half the range of x1 over a period, m."""
        h = self.turns * TURN / speed / self.count
        master = self.master(orbit.state, orbit.voltage, h)
        seen = [master.motion.x1]

        def watch(done: Step, h: float) -> None:
            ends = (master.motion, done.motion)
            seen.extend(reach_of_mass(self.structure, ends, done.acceleration, master.time, h))

        master.watch = watch
        for _ in range(self.count):
            master.step(orbit.voltage)
        master.close()
        return 0.5 * (max(seen) - min(seen))

    def multipliers(self, orbit: Orbit) -> np.ndarray:
        """Floquet multipliers: of the map from the angle at the start to the same angle again."""
        count = len(self.names)
        flow, drift = orbit.jacobian[:, :count], orbit.jacobian[:, -1]
        section = flow[:count] - np.outer(drift[:count], flow[count]) / drift[count]
        values = np.linalg.eigvals(section)
        return np.asarray(values[np.argsort(-np.abs(values))])
