"""Step the two coupled FMUs (co-simulation master) and choose the communication step.

The structure's ``box_force`` depends on its states only, the box's acceleration on the force: there
is no algebraic loop, but what each side assumes of the other over a step decides everything.
``ALGORITHMS`` has the schemes by name.

The cubic that is exchanged has the ends, the mean and the first moment that ``box_impulse`` and
``box_impulse_moment`` give: exact on average through impacts too, where the force jumps. With
``matched=False`` it is a parabola through communication points instead, as schemes that only know
values have.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..access.channel import Channel
from ..access.instance import Instance
from ..constants import TURN
from ..errors import InputError
from ..structures.structure import Structure
from .energy_balance import EnergyBalance
from .exchange import (
    Cubic,
    OscillatorInputs,
    OscillatorOutputs,
    ShakerInputs,
    ShakerOutputs,
    Step,
)
from .extremes import Revolution
from .polynomials import end_slope, integrate_work, matched_cubic, parabola_through_points

MASTER_STATE = (
    *("time", "voltage", "slope", "force_before", "h_before"),
    *("acceleration_before", "jerk_before", "level"),
)
STATE_INDEX = {  # of what is remembered
    name: place
    for place, name in enumerate(
        (*MASTER_STATE, *OscillatorOutputs._fields, *ShakerOutputs._fields)
    )
}


def split_state(
    numbers: Any,
) -> tuple[Any, OscillatorOutputs, ShakerOutputs, Any]:
    """Split a saved state into master, structure, motor and energy balance."""
    motion, shaking = (
        STATE_INDEX[OscillatorOutputs._fields[0]],
        STATE_INDEX[ShakerOutputs._fields[0]],
    )
    rest = len(STATE_INDEX)
    ends = OscillatorOutputs(*numbers[motion:shaking]), ShakerOutputs(*numbers[shaking:rest])
    return numbers[:motion], *ends, numbers[rest:]


class Algorithm(NamedTuple):
    """Describe a coupling algorithm: passes per step and order of extrapolation."""

    # how often a step is done, one side after the other, the structure first; 0: both sides at
    # once. From 2 on the states are saved and restored
    passes: int
    # of the acceleration that the structure is told in the first pass: 1 held constant, 2 a line, 3
    # a parabola, 4 a cubic
    terms: int
    text: str


ALGORITHMS = {
    "jacobi": Algorithm(0, 1, "both at once, each with the other's last value: negative damping"),
    "jacobi-derivative": Algorithm(0, 2, "both at once, with the last value and derivative"),
    "gauss-seidel": Algorithm(
        1, 3, "structure first with an extrapolation, shaker with what came of it"
    ),
    "rollback": Algorithm(
        2, 4, "as gauss-seidel, then back and once more with the acceleration found"
    ),
    "iterated": Algorithm(40, 4, "the same until nothing changes: the reference"),
}


@dataclass(frozen=True)
class Scheme:
    """Set the coupling algorithm, the communication step and its error control."""

    algorithm: str = "rollback"  # of `ALGORITHMS`
    # communication interval, s: the longest step, and all of them without `tolerance`
    h: float = 0.1
    # exchange forces and accelerations that are exact on average; else through points only
    matched: bool = True
    # step control: a step is halved whose defect is larger than this part of the work exchanged in
    # it, and the next is twice as long where it may be, up to `h`; 0: all are `h`. Needs an
    # algorithm that goes back
    tolerance: float = 0.0
    halvings: int = 6  # how often `h` is halved at most
    # part of the tolerance: after a step with a smaller defect the length is doubled
    easy: float = 1.0 / 64.0
    # change of the force between two iterations, over its size, that counts as none
    converged: float = 1e-14
    # relative lengths of the parts of the first step, for algorithms that cannot go back: nothing
    # is known yet to extrapolate from
    beginning: tuple[int, ...] = (1, 1, 2, 4, 8)

    def __post_init__(self) -> None:
        """Check algorithm, step length and tolerance."""
        if self.algorithm not in ALGORITHMS:
            raise InputError(f"algorithm {self.algorithm}: expected one of {', '.join(ALGORITHMS)}")
        if not (math.isfinite(self.h) and self.h > 0.0):
            raise InputError(f"step {self.h}: expected a number > 0, in s")
        if not (math.isfinite(self.tolerance) and self.tolerance >= 0.0):
            raise InputError(
                f"tolerance {self.tolerance}: expected a number >= 0; 0 leaves steps as they are"
            )
        if self.tolerance and not self.goes_back:
            raise InputError(
                f"tolerance {self.tolerance} with algorithm {self.algorithm}, which cannot go "
                "back: expected 0, or algorithm rollback or iterated"
            )

    @property
    def passes(self) -> int:
        """Return how often each communication step is computed; 0 for Jacobi."""
        return ALGORITHMS[self.algorithm].passes

    @property
    def goes_back(self) -> bool:
        """Return whether the algorithm rolls the FMUs back to repeat a step."""
        return self.passes > 1


class Master:
    """Step two initialised FMU instances together and exchange force and acceleration.

    :class:`.compiled.CompiledMaster` does the same with the same bits, faster.
    """

    def __init__(
        self,
        oscillator: Instance,
        shaker: Instance,
        structure: Structure,
        scheme: Scheme,
        start_time: float = 0.0,
    ) -> None:
        """Connect both instances and read their initial outputs."""
        self.oscillator = Channel(oscillator, OscillatorInputs._fields, OscillatorOutputs._fields)
        self.shaker = Channel(shaker, ShakerInputs._fields, ShakerOutputs._fields)
        self.scheme, self._algorithm = scheme, ALGORITHMS[scheme.algorithm]
        self.structure, self.time, self.voltage = structure, start_time, math.nan
        self.level = 0
        self.motion, self.shaking = self._read_structure(), self._read_motor()
        self.revolution: Revolution | None = None
        self.slope = 0.0  # of the force, at the present communication point
        self.force_before = self.h_before = 0.0
        self.acceleration_before = self.jerk_before = 0.0
        self.balance = EnergyBalance(structure, self.motion, self.shaking)
        self._do = self._gauss_seidel_step if scheme.passes else self._jacobi_step

    def step(self, voltage: float, h: float | None = None) -> None:
        """Run one communication interval at a constant voltage, V."""
        h = h or self.scheme.h
        begin = self.time
        if self.scheme.tolerance:
            self._substeps_by_defect(voltage, h)
        else:
            known = self.h_before or self.scheme.goes_back
            beginning = (1,) if known else self.scheme.beginning
            for part in beginning:
                self._try_step(voltage, h * part / sum(beginning))
        self.time = begin + h

    def run(
        self,
        voltages: Sequence[float],
        first: int = 0,
        h: float | None = None,
        kept: np.ndarray | None = None,
    ) -> int:
        """Run communication intervals until a revolution ends; return the next index."""
        for i in range(first, len(voltages)):
            self.step(voltages[i], h)
            if kept is not None:
                kept[i] = self.get_state()
            if self.revolution and self.revolution.is_complete(self.shaking.angle / TURN):
                return i + 1
        return len(voltages)

    def _substeps_by_defect(self, voltage: float, h: float) -> None:
        """Choose communication substeps so that each energy defect is small.

        A step is halved where its defect is too large. After one with a defect that twice the
        length would still do with, the next is twice as long, where that ends on its own grid: so
        the interval's end is met without a rest, and all lengths are exact.
        """
        max_parts = 1 << self.scheme.halvings
        done = 0
        while done < max_parts:
            size, last_impact = max_parts >> self.level, self.motion.impact_time
            defect = self._try_step(
                voltage, h / (1 << self.level), self.level < self.scheme.halvings
            )
            if defect > self.scheme.tolerance and self.level < self.scheme.halvings:
                self.level += 1
                continue
            done += size
            even = done % (2 * size) == 0
            if defect < self.scheme.tolerance * self.scheme.easy and even and self.level:
                self.level -= 1
            if self.motion.impact_time != last_impact:
                self._restart_extrapolation()

    def _restart_extrapolation(self) -> None:
        """Restart the extrapolation after an impact, where the force may jump."""
        self.slope = self.h_before = 0.0
        self.shaking = self._outputs_with_force(self.motion)

    def _try_step(self, voltage: float, h: float, may_refuse: bool = False) -> float:
        """Try one communication step; return its relative energy defect."""
        if voltage != self.voltage:  # the acceleration belongs to the inputs as set now
            self.voltage = voltage
            self.shaking = self._outputs_with_force(self.motion)
        done = self._do(h)
        force = self.fit_force(done.motion, h)
        taken = done.shaking.box_force_work - self.shaking.box_force_work
        defect = taken - integrate_work(force, self.shaking.box_velocity, done.acceleration, h)
        size = self._relative_defect(done, taken, defect)
        if may_refuse and size > self.scheme.tolerance:
            self.oscillator.restore()
            self.shaker.restore()
            return size
        self.slope = end_slope(force, h)
        self.balance.add(self.motion, done.motion, done.acceleration, defect, h)
        self._accept_step(done, h)
        return size

    def _relative_defect(self, done: Step, taken: float, defect: float) -> float:
        """Return a step's energy defect relative to the work exchanged in it."""
        work = done.shaking.motor_energy - self.shaking.motor_energy
        exchanged = abs(taken) + abs(work)
        return abs(defect) / exchanged if exchanged else 0.0

    def _accept_step(self, done: Step, h: float) -> None:
        """Accept a finished step: move time, outputs and extrapolation to its end."""
        if self.revolution:
            ends = self.motion, self.shaking
            self.revolution.add(self.structure, ends, done, self.time, h)
        # at the start the force's slope was not known, nor the jerk
        self.jerk_before = self.shaking.box_jerk if self.h_before else done.acceleration[1]
        self.acceleration_before = self.shaking.box_acceleration
        self.force_before, self.h_before = self.motion.box_force, h
        self.time += h
        self.motion, self.shaking = done.motion, self._outputs_with_force(done.motion)

    def _read_structure(self) -> OscillatorOutputs:
        """Read the outputs of the structure FMU."""
        return tuple.__new__(OscillatorOutputs, self.oscillator.get())  # as _make, in half its time

    def _read_motor(self) -> ShakerOutputs:
        """Read the outputs of the motor FMU."""
        return tuple.__new__(ShakerOutputs, self.shaker.get())

    def _outputs_with_force(self, motion: OscillatorOutputs) -> ShakerOutputs:
        """Set force and voltage of the present point; return the motor's outputs."""
        self.shaker.put(motion.box_force, self.slope, 0.0, 0.0, self.voltage)
        return self._read_motor()

    # -- what each side assumes of the other --

    def fit_force(self, motion: OscillatorOutputs, h: float) -> Cubic:
        """Fit the force over a step by a cubic with exact mean and first moment."""
        mean, moment = motion.box_impulse / h, motion.box_impulse_moment / (h * h)
        return matched_cubic(self.motion.box_force, motion.box_force, mean, moment, h)

    def _force_for_shaker(self, motion: OscillatorOutputs, h: float) -> Cubic:
        """Return the force over a step as the cubic that the motor FMU gets."""
        if self.scheme.matched:
            return self.fit_force(motion, h)
        return parabola_through_points(
            self.force_before, self.motion.box_force, motion.box_force, self.h_before, h
        )

    def _acceleration_for_structure(self, after: ShakerOutputs, h: float) -> Cubic:
        """Fit the box acceleration over a step for the structure FMU."""
        now = self.shaking
        first, last = now.box_acceleration, after.box_acceleration
        if not self.scheme.matched:
            return parabola_through_points(self.acceleration_before, first, last, self.h_before, h)
        mean = (after.box_velocity - now.box_velocity) / h
        moment = mean - ((after.box_position - now.box_position) / h - now.box_velocity) / h
        return matched_cubic(first, last, mean, moment, h)

    def _extrapolated_acceleration(self) -> Cubic:
        """Extrapolate the box acceleration over the coming step."""
        value, jerk, h = self.shaking.box_acceleration, self.shaking.box_jerk, self.h_before
        terms = self._algorithm.terms
        if terms == 1:
            return value, 0.0, 0.0, 0.0
        if terms == 2 or not h:
            return value, jerk, 0.0, 0.0
        bend = (self.acceleration_before - value + jerk * h) / (h * h)
        if terms == 3:
            return value, jerk, 2.0 * bend, 0.0
        twist = ((self.jerk_before - jerk) / h + 2.0 * bend) / h
        return value, jerk, 2.0 * (bend + twist * h), 6.0 * twist

    def _extrapolated_force(self) -> Cubic:
        """Extrapolate the force over the coming step, for the Jacobi algorithms."""
        force, h = self.motion.box_force, self.h_before
        line = self._algorithm.terms > 1 and h
        return force, (force - self.force_before) / h if line else 0.0, 0.0, 0.0

    # -- the schemes --

    def _jacobi_step(self, h: float) -> Step:
        """Step both FMUs at once, each with extrapolated inputs (Jacobi)."""
        acceleration = self._extrapolated_acceleration()
        self.oscillator.put(*acceleration)
        self.oscillator.step(self.time, h)
        self.shaker.put(*self._extrapolated_force(), self.voltage)
        self.shaker.step(self.time, h)
        return Step(acceleration, self._read_structure(), self._read_motor())

    def _gauss_seidel_step(self, h: float) -> Step:
        """Step the structure, then the motor; roll back and repeat if asked."""
        passes = self._algorithm.passes
        if self.scheme.goes_back:
            self.oscillator.save()
            self.shaker.save()
            if not self.h_before:
                passes = ALGORITHMS["iterated"].passes
        acceleration, last = self._extrapolated_acceleration(), None
        for i in range(passes):
            if i:
                self.oscillator.restore()
                self.shaker.restore()
            motion, force = self._step_both(acceleration, h)
            if i + 1 == passes or (last and self._converged(motion, last)):
                break
            last = motion
            self.shaker.put(motion.box_force, end_slope(force, h), 0.0, 0.0, self.voltage)
            acceleration = self._acceleration_for_structure(self._read_motor(), h)
        return Step(acceleration, motion, self._read_motor())

    def _step_both(self, acceleration: Cubic, h: float) -> tuple[OscillatorOutputs, Cubic]:
        """Step the structure and then the motor once; return motion and force."""
        self.oscillator.put(*acceleration)
        self.oscillator.step(self.time, h)
        motion = self._read_structure()
        force = self._force_for_shaker(motion, h)
        self.shaker.put(*force, self.voltage)
        self.shaker.step(self.time, h)
        return motion, force

    def _converged(self, motion: OscillatorOutputs, last: OscillatorOutputs) -> bool:
        """Return whether two iterations of a step agree up to rounding."""
        now, then = (
            (state.box_force, state.box_impulse, state.box_impulse_moment)
            for state in (motion, last)
        )
        limit = self.scheme.converged
        return all(abs(a - b) <= limit * (abs(a) + abs(b)) for a, b in zip(now, then, strict=True))

    # -- to go on elsewhere --

    def get_state(self) -> list[float]:
        """Return the master's own state as a list of floats, to be restored later."""
        own_state = [float(getattr(self, name)) for name in MASTER_STATE]
        return [*own_state, *self.motion, *self.shaking, *self.balance.get_state()]

    def set_state(self, numbers: Sequence[float]) -> None:
        """Restore the state that :meth:`get_state` returned."""
        own_state, self.motion, self.shaking, balance = split_state(numbers)
        for name, value in zip(MASTER_STATE, own_state, strict=True):
            setattr(self, name, value)
        self.level = int(self.level)
        self.balance.set_state(balance)

    def close(self) -> None:
        """Free the FMU states saved for rollback."""
        self.oscillator.close()
        self.shaker.close()
