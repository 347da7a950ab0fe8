"""Runs of the weak drive: the voltage goes up and down, and each revolution of the motor is one row.

A run is cut into chunks; the journal keeps each with the states of both FMUs and of the master, so an interrupted run goes on with the same bits.
"""

import math
from dataclasses import replace

import numpy as np

from .coupling import Master
from .exchange import ANGLE, OSCILLATOR, SHAKER, SPEED, V1, X1, A, V, Y
from .fmu import Instance
from .setups import TURN

CHUNK = 2000  # steps between two entries in the journal
COLUMNS = (
    *("time", "eta0", "Omega", "amplitude", "box_amplitude", "impacts", "acceleration"),
    *("motor", "box_damper", "impact_loss", "stored", "dampers", "missing", "defect", "defect_sizes"),
)
ACCOUNTS = {"impact_loss": "impacts"}  # names in the ledger, where they differ


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
        self.numbers = [turn, time, impacts, x, x, y, y, m.x[V1], m.s[V], 0.0]

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
        for place, value, velocity, before in ((3, m.x[X1], m.x[V1], n[7]), (5, m.s[Y], m.s[V], n[8])):
            if before * velocity < 0.0:  # between the points it has turned round: as a parabola
                value += 0.5 * velocity * velocity / (before - velocity) * m.h_before
            n[place] = max(n[place], value)
            n[place + 1] = min(n[place + 1], value)
        n[7], n[8] = m.x[V1], m.s[V]
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
        self.master = Master(oscillator, shaker, setup, replace(plan.scheme, h=plan.scheme.h / setup.omega))
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
