"""Runs of the weak drive: the voltage goes up and down, and each revolution of the motor is one row.

A run is cut into chunks; the journal keeps each with the states of both FMUs and of the master, so an interrupted run goes on with the same bits.
"""

import math
from dataclasses import asdict, dataclass

import numpy as np

from .coupling import ANGLE, OSCILLATOR, SHAKER, SPEED, V1, X1, A, Master, Scheme, Y
from .fmu import Instance
from .setups import TURN, Setup

CHUNK = 2000  # steps between two entries in the journal
COLUMNS = (
    *("time", "eta0", "Omega", "amplitude", "box_amplitude", "impacts", "acceleration"),
    *("motor", "box_damper", "impact_loss", "stored", "dampers", "missing", "defect", "defect_sizes"),
)
ACCOUNTS = {"impact_loss": "impacts"}  # names in the ledger, where they differ


@dataclass(frozen=True)
class Schedule:
    """The voltage over time: settle, there, back; eta0 and 1/omega.

    Attributes
    ----------
    first, last : float
        Ends of eta0; the same for a constant voltage.
    rate : float
        Change of eta0 per unit time, > 0; on average, where ``increment`` is not 0.
    settle : float
        Time at ``first`` before.
    increment : float
        Height of steps; 0 for a ramp.
    back : bool
        Whether it goes back to ``first`` again.
    """

    first: float
    last: float
    rate: float
    settle: float = 300.0
    increment: float = 0.0
    back: bool = True

    @property
    def rise(self):
        """Time the voltage takes from one end to the other."""
        return abs(self.last - self.first) / self.rate

    @property
    def duration(self):
        """Time of the whole run."""
        return self.settle + self.rise * (2 if self.back else 1)

    def eta0(self, time):
        """Voltage at a time."""
        ramp = min(max(time - self.settle, 0.0), self.duration - self.settle)
        there = ramp <= self.rise
        change = self.rate * (ramp if there else 2.0 * self.rise - ramp)
        if self.increment:
            count = change / self.increment
            change = self.increment * (math.floor(count + 1e-9) if there else math.ceil(count - 1e-9))
        return self.first + math.copysign(min(change, abs(self.last - self.first)), self.last - self.first)


@dataclass(frozen=True)
class Plan:
    """One run.

    Attributes
    ----------
    setup : Setup
    schedule : Schedule
    scheme : Scheme
        With its step in 1/omega.
    speed : float
        At the start, over omega.
    guids : tuple of str
        Of the FMUs that compute it.
    """

    setup: Setup
    schedule: Schedule
    scheme: Scheme
    speed: float
    guids: tuple

    def identity(self):
        """All that decides the numbers, as plain data."""
        return asdict(self)

    @property
    def steps(self):
        """Number of communication steps."""
        return math.ceil(self.schedule.duration / self.scheme.h - 1e-9)


class Revolutions:
    """Turns a run into one row a revolution of the motor.

    Parameters
    ----------
    setup : Setup
    """

    def __init__(self, setup):
        self.setup = setup
        self.numbers = [0.0] * 10  # turn, time and impacts at its beginning, highest and lowest x1 and y, last v1 and box velocity, acceleration

    def begin(self, m, turn, time, impacts):
        """A revolution begins."""
        x, y = m.x[X1], m.s[Y]
        self.numbers = [turn, time, impacts, x, x, y, y, m.x[V1], m.s[Y + 1], 0.0]

    def add(self, m, count):
        """Look at the state after a step.

        Parameters
        ----------
        m : Master
        count : callable
            The number of impacts so far, asked at the end of a revolution.

        Returns
        -------
        list of float, or None
            In the order of ``COLUMNS``, when a revolution is complete.
        """
        n = self.numbers
        for place, value, velocity, before in ((3, m.x[X1], m.x[V1], n[7]), (5, m.s[Y], m.s[Y + 1], n[8])):
            if before * velocity < 0.0:  # between the points it has turned round: as a parabola
                value += 0.5 * velocity * velocity / (before - velocity) * m.h_before
            n[place] = max(n[place], value)
            n[place + 1] = min(n[place + 1], value)
        n[7], n[8] = m.x[V1], m.s[Y + 1]
        n[9] = max(n[9], abs(m.s[A]))
        turn = math.floor(m.s[ANGLE] / TURN)
        if turn <= n[0]:
            return None
        time = m.time - (m.s[ANGLE] - turn * TURN) / m.s[SPEED]
        impacts = count()
        row = self.row(m, time, (turn - n[0]) * TURN / (time - n[1]), impacts - n[2])
        self.begin(m, turn, time, impacts)
        return row

    def row(self, m, time, speed, impacts):
        """Non-dimensional numbers of a revolution that ends at ``time``."""
        setup, n = self.setup, self.numbers
        accounts = m.ledger.entries(m.x, m.s)
        shaking = setup.length * setup.omega**2
        motion = [0.5 * (n[3] - n[4]) / setup.length, 0.5 * (n[5] - n[6]) / setup.length, impacts, n[9] / shaking]
        energies = [accounts[ACCOUNTS.get(name, name)] / setup.energy for name in COLUMNS[7:]]
        return [time * setup.omega, m.voltage / setup.volts, speed / setup.omega, *motion, *energies]


class Run:
    """A run under way: both instances, the master, and the revolutions so far.

    Parameters
    ----------
    plan : Plan
    oscillator, shaker : Instance
        Not yet initialised.
    """

    def __init__(self, plan, oscillator, shaker):
        setup = plan.setup
        self.plan, self.instances, self.done = plan, (oscillator, shaker), 0
        voltage = plan.schedule.eta0(0.0) * setup.volts
        oscillator.initialize(**setup.oscillator())
        shaker.initialize(**setup.shaker(), speed_start=plan.speed * setup.omega, voltage=voltage)
        self.master = Master(oscillator, shaker, setup, Scheme(plan.scheme.algorithm, plan.scheme.h / setup.omega, plan.scheme.matched))
        self.revolutions = Revolutions(setup)
        self.revolutions.begin(self.master, 0.0, 0.0, 0.0)

    def chunk(self):
        """Do some steps; returns their complete revolutions, shape (n, len(COLUMNS))."""
        plan, master = self.plan, self.master
        rows, h, volts, schedule = [], plan.scheme.h, plan.setup.volts, plan.schedule
        for i in range(self.done, min(self.done + CHUNK, plan.steps)):
            master.step(schedule.eta0((i + 0.5) * h) * volts)  # constant over the step, the mean of the ramp
            row = self.revolutions.add(master, lambda: float(self.instances[0].get("impact_count")[0]))
            if row:
                rows.append(row)
            self.done = i + 1
        return np.array(rows).reshape(-1, len(COLUMNS))

    def pack(self, rows):
        """Rows and everything to go on from, as one flat array."""
        own = [float(self.done), *self.revolutions.numbers, *self.master.memory()]
        states = [np.frombuffer(instance.save_state()) for instance in self.instances]
        head = [len(rows), len(own), len(states[0])]
        return np.concatenate([head, rows.ravel(), own, *states])

    def unpack(self, data):
        """Go on from what :meth:`pack` gave."""
        rows, own, first = (int(value) for value in data[:3])
        place = 3 + rows * len(COLUMNS)
        numbers = [float(value) for value in data[place : place + own]]
        self.done, self.revolutions.numbers = int(numbers[0]), numbers[1:11]
        place += own
        self.instances[0].restore_state(data[place : place + first].tobytes())
        self.instances[1].restore_state(data[place + first :].tobytes())
        self.master.remember(numbers[11:])


def rows_of(data):
    """The revolutions in an entry of the journal."""
    count = int(data[0])
    return data[3 : 3 + count * len(COLUMNS)].reshape(-1, len(COLUMNS))


def run(plan, fmus, journal, progress=lambda done: None):
    """Carry out a run, going on where the journal ends.

    Parameters
    ----------
    plan : Plan
    fmus : (path-like, path-like)
        Oscillator and shaker.
    journal : .store.Journal
    progress : callable
        Told the number of steps done.

    Returns
    -------
    ndarray, shape (revolutions, len(COLUMNS))
    """
    with Instance(fmus[0], OSCILLATOR) as oscillator, Instance(fmus[1], SHAKER) as shaker:
        state = Run(plan, oscillator, shaker)
        index = journal.length()
        if index:
            state.unpack(journal.row(index - 1))
        progress(state.done)
        while state.done < plan.steps:
            journal.append(index, state.pack(state.chunk()))
            index += 1
            progress(state.done)
        state.master.close()
    return np.concatenate([rows_of(journal.row(i)) for i in range(index)])


def jumps(rows, plan):
    """The voltages at which the speed jumps, up and down; NaN where it does not.

    The slip eta0 - Omega is what the vibration takes from the motor. It falls at the jump up and rises at the jump down; where it passes half of
    its largest value on that way is where the jump is said to be.
    """
    schedule, time, eta0, slip = plan.schedule, rows[:, 0], rows[:, 1], rows[:, 1] - rows[:, 2]
    turn, rising = schedule.settle + schedule.rise, schedule.last > schedule.first
    there = (time > schedule.settle) & (time <= turn)
    return first_fall(eta0, slip, there if rising else time > turn), first_rise(eta0, slip, time > turn if rising else there)


def first_fall(eta0, slip, part):
    """Where the slip falls below half of its largest value, after that."""
    level, where = slip[part], eta0[part]
    after = np.flatnonzero(level < 0.5 * level.max(initial=-math.inf))
    after = after[after > np.argmax(level)] if level.size else after
    return float(where[after[0]]) if after.size else math.nan


def first_rise(eta0, slip, part):
    """Where the slip rises above half of its largest value."""
    level, where = slip[part], eta0[part]
    after = np.flatnonzero(level > 0.5 * level.max(initial=-math.inf))
    return float(where[after[0]]) if after.size and after[0] > 0 else math.nan
