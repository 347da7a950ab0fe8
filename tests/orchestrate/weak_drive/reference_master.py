"""The steps of ``couple.c`` in Python, operation by operation, as its reference."""

import math
from ctypes import byref, c_bool, c_double, c_int

from orchestrate.errors import FmuError
from orchestrate.fmu.channel import ANSWERS, Channel, SimulationEnded, StepAnswer
from orchestrate.fmu.instance import DISCARD
from orchestrate.weak_drive.master import (
    DRIVE,
    END,
    FORCE_PLACE,
    MOTION,
    PAST,
    PUSH_MEMORY,
    TIME,
    Master,
)
from orchestrate.weak_drive.polynomials import (
    end_derivatives,
    integrate_product,
    normalized_coefficients,
)
from orchestrate.weak_drive.step_record import PLACE, Record

H, LEVEL, THEN = (PLACE[name] for name in ("h", "level", "acceleration_then"))
VELOCITY, ACCELERATION = DRIVE + 1, DRIVE + 2
LAST_TIME, TERMINATED = 2, 3  # kinds of fmi2GetRealStatus and fmi2GetBooleanStatus


def matched_cubic(first, last, mean, moment, h):
    """Return the cubic with given end values, mean and first moment over a step."""
    a1, a2, a3 = last - first, mean - first, moment - 0.5 * first
    b = 3.0 * a1 + 36.0 * a2 - 60.0 * a3
    c = -12.0 * a1 - 96.0 * a2 + 180.0 * a3
    d = 10.0 * a1 + 60.0 * a2 - 120.0 * a3
    return first, b / h, 2.0 * c / (h * h), 6.0 * d / (h * h * h)


def integrate_work(force, velocity, acceleration, h):
    """Return the work of a cubic force over a step, J."""
    a0, a1, a2, a3 = acceleration
    speeds = (velocity, a0 * h, a1 * h * h / 2.0, a2 * h * h * h / 6.0, a3 * h * h * h * h / 24.0)
    return h * integrate_product(normalized_coefficients(force, h), speeds)


def derivatives(times, values, order: int):
    """Return four derivatives at time 0, from an order on, of the polynomial through points."""
    table = list(values)  # of divided differences
    for level in range(1, len(times)):
        for i in range(len(times) - 1, level - 1, -1):
            table[i] = (table[i] - table[i - 1]) / (times[i] - times[i - level])
    polynomial = [0.0] * (len(times) + order + 4)  # by Horner's scheme in Newton's form
    for i in range(len(times) - 1, -1, -1):
        for k in range(len(times), 0, -1):
            polynomial[k] = polynomial[k - 1] - times[i] * polynomial[k]
        polynomial[0] = table[i] - times[i] * polynomial[0]
    return tuple(math.factorial(k) * polynomial[k] for k in range(order, order + 4))


def lever(motion, h):
    """Return the first moment of the force about the middle of a step."""
    return motion[6] - 0.5 * h * motion[5]


def moved_by(held, order: int, h, age):
    """Return what a held force did over a step to a point, per inverse mass."""
    return (0.0, held * h, held * h * (0.5 * h + age))[order]


class SteppingChannel(Channel):
    """A channel that steps, saves and restores its instance from Python."""

    def __init__(self, channel):
        self.__dict__ |= channel.__dict__
        self._reused = not self.instance.description.needs_tool
        functions = self._functions3() if self.instance.is_fmi3 else self._functions2()
        self._step, self._save, self._restore, self._free = functions

    def _functions2(self):
        """Return the FMI 2.0 C functions step, and get/set/free of a state."""
        dll, component, answer = self._fmu.dll, self._fmu.component, self.answer
        do_step, ended, last = dll.fmi2DoStep, c_int(), self._pointer("last")

        def step(time: float, h: float):
            answer.time, answer.h, answer.last = time, h, time
            status = int(do_step(component, time, h, 0))
            if status == DISCARD:
                dll.fmi2GetRealStatus(component, LAST_TIME, last)
                dll.fmi2GetBooleanStatus(component, TERMINATED, byref(ended))
                answer.terminate = bool(ended.value)
            return 0 if answer.terminate else status

        states = (dll.fmi2GetFMUstate, dll.fmi2SetFMUstate, dll.fmi2FreeFMUstate)
        return step, *states

    def _functions3(self):
        """Return the FMI 3.0 C functions step, and get/set/free of a state."""
        dll, component, answer = self._fmu.dll, self._fmu.component, self.answer
        do_step = dll.fmi3DoStep
        answers = [self._pointer(name) for name in (*ANSWERS, "last")]

        def step(time: float, h: float):
            answer.time, answer.h, answer.last = time, h, time
            return int(do_step(component, time, h, False, *answers))

        states = (dll.fmi3GetFMUState, dll.fmi3SetFMUState, dll.fmi3FreeFMUState)
        return step, *states

    def _pointer(self, name: str):
        """Return a pointer to a field of the answer to a step."""
        kind = c_bool if name in ANSWERS else c_double
        return byref(kind.from_buffer(self.answer, getattr(StepAnswer, name).offset))

    def step(self, time, h: float):
        """Do one communication step of length ``h`` from ``time``, s."""
        if self.ended:
            raise SimulationEnded(self.ended)
        self.begin()
        self.status = self._step(time, h)
        self.check_step(self.status, self.answer.last >= time + (1.0 - 1e-6) * h)

    def save(self):
        if self.kept and not self._reused:
            self._call(self._free, self._fmu.component, byref(self.kept))
        self._call(self._save, self._fmu.component, byref(self.kept))

    def restore(self):
        self._call(self._restore, self._fmu.component, self.kept)


class PythonMaster(Master):
    """Steps in Python."""

    def __init__(self, *arguments, **keywords):
        super().__init__(*arguments, **keywords)
        self.oscillator = SteppingChannel(self.oscillator)
        self.drive.channel = SteppingChannel(self.drive.channel)
        self.is_whole = len(self.drive.forces) == 4
        self.points = [[], []]  # times and values
        self.weights, self.held, self.owed = list(self.pair.inverse_mass), 0.0, [0.0, 0.0]
        known = [not math.isnan(x) for x in self.row[DRIVE:END]]
        self.knows_both, self.order = known[1] and known[2], 0 if known[2] else 2 - known[1]

    def run(self, inputs, h=None):
        rows = [[float(x) for x in (row if hasattr(row, "__len__") else [row])] for row in inputs]
        return self.run_controlled(rows, len(rows), h)

    def run_controlled(self, inputs, count, h=None):
        rows, ends, recorded = [list(self.row)], [], []
        own = len(self.connection.inputs)
        for values in inputs:
            try:
                rows += self._interval(list(values[:own]), h or self.scheme.h)
            except SimulationEnded:
                break
            ends.append(len(rows) - 1)
            recorded += [self.recorded(values[own:])] if self.connection.recorded else []
            if self.ended:
                break
        return Record.of_rows(self.names, rows, ends, recorded)

    def get_state(self):
        pairs = [x for point in zip(*self.points, strict=True) for x in point]
        missing = [math.nan] * (2 * PAST - len(pairs))
        pushes = [0.0] * sum(PUSH_MEMORY.values())
        return [*self.row, *self.weights, self.held, *self.owed, *pushes, *pairs, *missing]

    def set_state(self, numbers):
        super().set_state(numbers)
        pair, known = self.pair, 2 * self.pair.point_count
        self.points = [pair.points[first:known:2] for first in (0, 1)]
        self.weights, (self.held,) = list(pair.inverse_mass), pair.held
        self.owed = list(pair.owed)

    def _interval(self, inputs: list[float], h):
        """Run one communication interval; return the rows of its steps."""
        end = self.time + h
        # the acceleration belongs to the inputs as set now
        if inputs != self.row[self.inputs] or self.connection.cubic >= 0:
            self.row[self.inputs] = inputs
            force, before = self.row[MOTION + FORCE_PLACE], self.row[ACCELERATION]
            self.row[DRIVE : self.inputs.start] = self._outputs_at(force, inputs)
            if not math.isnan(before):
                jump = self.row[ACCELERATION] - before
                self.points[1] = [value + jump for value in self.points[1]]
        if self.row[H] == 0.0 and not self.points[0]:
            self.weights = [self._feel(self.row[MOTION + FORCE_PLACE], inputs)] * 2
            self._remember()
        halves = self.scheme.tolerance or self.pair.halves_discarded
        rows = self._steps(h, self.scheme.halvings if halves else 0)
        rows[-1][TIME] = self.row[TIME] = end
        return rows

    def _steps(self, h, halvings: int):
        """Run an interval in steps of its length halved, so that each defect is small."""
        # doubled only on their own grid: the end is met without a rest, lengths are exact
        level = int(self.row[LEVEL]) if self.scheme.tolerance else 0
        rows, most, done = [], 1 << halvings, 0
        while done < most:
            size = most >> level
            row, defect = self._attempt(h / (1 << level), level < halvings)
            if row:
                rows.append(row)
                done += size
                if level:
                    self.row[self.inputs] = self._later(self.row[self.inputs], h / (1 << level))
                is_easy = defect < self.scheme.tolerance * self.scheme.easy
                level -= is_easy and done % (2 * size) == 0 and level > 0
            else:
                level += 1
            self.row[LEVEL] = float(level)
        return rows

    def _attempt(self, h, may_refuse: bool):
        """Try one step; return its row, None where it is refused, and its relative defect."""
        now, inputs, drive = self.row, self.row[self.inputs], self.drive
        passes = self.pair.first_passes if now[H] == 0.0 else 1
        self.oscillator.save()
        if may_refuse or passes > 1:
            drive.channel.save()
        acceleration = self._run_on()
        for i in range(passes):
            if i:
                self.oscillator.restore()
                drive.channel.restore()
            motion = self._oscillate(acceleration, h)
            drive.put(self._force_over(motion, h), inputs)
            try:
                drive.channel.step(now[TIME], h)
            except FmuError:
                halves = may_refuse and self.pair.halves_discarded
                if not halves or drive.channel.status != DISCARD:
                    raise
                self.oscillator.restore()
                drive.channel.restore()
                return None, math.inf
            later = self._later(inputs, h)
            self.weights[1] = self._feel(motion[FORCE_PLACE], later)
            outputs = self._outputs_at(motion[FORCE_PLACE], later)
            acceleration = self._acceleration_over(motion, outputs, h)
        if any(self.weights):
            given = motion[FORCE_PLACE]
            self.oscillator.restore()
            motion = self._oscillate(acceleration, h)
            outputs[2] += self.weights[1] * (motion[FORCE_PLACE] - given)
            acceleration = self._acceleration_over(motion, outputs, h)
        self.oscillator.restore()
        motion = self._oscillate(acceleration, h)
        outputs = self._outputs_at(motion[FORCE_PLACE], self._later(inputs, h))
        force = self._exact_force(motion, h)
        given = integrate_work(force, now[VELOCITY], acceleration, h)
        defect = self._defect(outputs, given) if self.scheme.tolerance else 0.0
        if may_refuse and defect > self.scheme.tolerance:
            self.oscillator.restore()
            drive.channel.restore()
            return None, defect
        count = float(self.oscillator.instance.get("impact_count")[0])
        step = (now[TIME] + h, h, now[LEVEL], *acceleration, count, given)
        if not self.is_whole:
            lacks = motion[5] - self.held * h
            self.owed[1] += h * (self.owed[0] + 0.5 * lacks) - lever(motion, h)
            self.owed[0] += lacks
        self.row = [*step, *motion, *outputs, *inputs]
        self._remember()
        self.weights[0] = self.weights[1]
        return list(self.row), defect

    def _oscillate(self, acceleration, h):
        """Step the oscillator under an acceleration of the box; return its outputs."""
        self.oscillator.put(*acceleration)
        self.oscillator.step(self.time, h)
        return self.oscillator.get()

    def _outputs_at(self, force, inputs):
        """Return the drive's outputs under the force at a communication point."""
        self.drive.put((force, 0.0, 0.0, 0.0), inputs)
        return self.drive.get()

    def _later(self, inputs: list[float], h):
        """Return the drive's inputs at the end of a step: a cubic among them runs on."""
        first = self.connection.cubic
        if first < 0:
            return inputs
        later = list(inputs)
        for i in range(first, len(inputs), 4):
            later[i : i + 4] = end_derivatives(tuple(inputs[i : i + 4]), h)
        return later

    def _feel(self, force, inputs):
        """Return what 1 N more adds to the acceleration; as it was known where that is not read."""
        if self.is_whole or self.order:
            return self.weights[1]
        more = self._outputs_at(force + 1.0, inputs)[2]
        return more - self._outputs_at(force, inputs)[2]

    def _exact_force(self, motion, h):
        """Return the force over a step, exact in its ends, mean and first moment."""
        _, _, _, _, force, impulse, moment, *_ = motion
        first = self.row[MOTION + FORCE_PLACE]
        return matched_cubic(first, force, impulse / h, moment / (h * h), h)

    def _force_over(self, motion, h):
        """Return the force that the drive gets over a step."""
        if self.is_whole:
            return self._exact_force(motion, h)
        impulse, moment = self.owed
        owed = moment / h + 1.5 * (impulse - lever(motion, h) / h)
        self.held = motion[5] / h + owed / h
        return self.held, 0.0, 0.0, 0.0

    def _acceleration_over(self, motion, after, h):
        """Return the box acceleration over a step: w(t) F(t), and the rest."""
        rest = self._rest_of_ends if self.knows_both else self._rest_of_points
        acceleration = list(rest(motion, after, h))
        w, rise = self.weights[0], (self.weights[1] - self.weights[0]) / h
        if w == 0.0 and rise == 0.0:
            return acceleration
        force = self._exact_force(motion, h)
        for i in range(4):
            acceleration[i] += w * force[i] + (i * rise * force[i - 1] if i else 0.0)
        return acceleration

    def _rest_of_ends(self, motion, after, h):
        """Return the rest from its ends, its mean, and its first moment."""
        w0, w1 = self.weights
        position, velocity, acceleration = self.row[DRIVE:END]
        first = acceleration - w0 * self.row[MOTION + FORCE_PLACE]
        last = after[2] - w1 * motion[FORCE_PLACE]
        mean = (after[1] - velocity) / h - 0.5 * (w0 + w1) * self.held
        moment = 0.5 * mean + (last - first) / 12.0
        if not math.isnan(position):
            lag = ((after[0] - position) / h - velocity) / h
            moment = mean - lag + (w0 + 0.5 * w1) / 3.0 * self.held
        return matched_cubic(first, last, mean, moment, h)

    def _rest_of_points(self, motion, after, h):
        """Return the rest as the parabola through points of it, or of its integrals."""
        w, order = self.weights[1], self.order
        new = after[2 - order] - (w * motion[FORCE_PLACE] if order == 0 else 0.0)
        times, values = (part[-2 - order :] for part in self.points)
        ages = [*(t - self.row[TIME] for t in times), h]
        values = [*values, new - w * moved_by(self.held, order, h, 0.0)]
        return derivatives(ages, values, order)

    def _remember(self):
        """Keep the last points, as though w times the forces held since then had not acted."""
        if self.knows_both:
            return
        (times, values), row, w = self.points, self.row, self.weights[1]
        if row[H] != 0.0:
            moved = [moved_by(self.held, self.order, row[H], t - row[TIME]) for t in times]
            values = [v + w * m for v, m in zip(values, moved, strict=True)]
        new = row[DRIVE + 2 - self.order]
        new -= w * row[MOTION + FORCE_PLACE] if self.order == 0 else 0.0
        self.points = [[*times, row[TIME]][-PAST:], [*values, new][-PAST:]]

    def _run_on(self):
        """Extrapolate the box acceleration over the coming step: its last cubic goes on."""
        h, value = self.row[H], self.row[ACCELERATION]
        slopes = (0.0, 0.0, 0.0, 0.0)
        if h != 0.0:
            slopes = end_derivatives(tuple(self.row[THEN : THEN + 4]), h)
        return slopes if math.isnan(value) else (value, *slopes[1:])

    def _defect(self, outputs, given):
        """Return the energy that a step loses or makes, over the work exchanged in it."""
        work, energy = END, END + 1  # by the drive's own account
        taken = outputs[work - DRIVE] - self.row[work]
        exchanged = abs(taken) + abs(outputs[energy - DRIVE] - self.row[energy])
        return abs(taken - given) / exchanged if exchanged else 0.0
