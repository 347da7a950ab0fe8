"""Co-simulations of both FMUs from given states, for tests."""

import contextlib

import numpy as np

from orchestrate.coupling import Master, Scheme
from orchestrate.exchange import ANGLE, OSCILLATOR, SHAKER, SPEED, V1, V2, X1, X2, V, Y
from orchestrate.fmu import Instance

from ..conftest import BUILD

GRID = 0.2  # of the comparisons


@contextlib.contextmanager
def master(setup, scheme, state=(0.0,) * 8, form="fmi2"):
    """A master from a state x1, v1, x2, v2, y, y', phi, phi'."""
    names = ("position_start", "velocity_start", "angle_start", "speed_start")
    starts = dict(zip(("x1_start", "v1_start", "x2_start", "v2_start"), state, strict=False))
    with Instance(BUILD / form / f"{OSCILLATOR}.fmu") as oscillator, Instance(BUILD / form / f"{SHAKER}.fmu") as shaker:
        oscillator.initialize(**setup.oscillator(), **starts)
        shaker.initialize(**setup.shaker(), **dict(zip(names, state[4:], strict=True)))
        made = Master(oscillator, shaker, setup, scheme)
        yield made
        made.close()


def state_of(m):
    """State of a master, in the order of :func:`master`."""
    return [*(m.x[i] for i in (X1, V1, X2, V2)), *(m.s[i] for i in (Y, V, ANGLE, SPEED))]


def settled(setup, voltage, speed, time=600.0):
    """A state of the settled motion, in flight, with the angle in the first turn."""
    with master(setup, Scheme("rollback", 0.2), (0.0,) * 7 + (speed,)) as m:
        while m.time < time or m.x[X1] == m.x[X2]:
            m.step(voltage)
        state = state_of(m)
    return [*state[:6], state[6] % (2.0 * np.pi), state[7]]


def history(setup, scheme, voltage, state, time, form="fmi2"):
    """States on the grid, shape (points, 8), and the ledger."""
    every = max(1, round(GRID / scheme.h))
    with master(setup, scheme, state, form) as m:
        rows = [state]
        for k in range(round(time / scheme.h)):
            m.step(voltage)
            if (k + 1) % every == 0:
                rows.append(state_of(m))
        return np.array(rows), m.ledger.entries(m.x, m.s)
