"""The FMU's own stroboscopic map, and its derivative by differences: no equation of ours."""

import numpy as np

from orchestrate.fmu import STATE, start_motion


def after(instance, point, start, periods=1):
    """State some periods after a start, in an instance that is there."""
    start_motion(instance, *point, start)
    instance.step(0.0, periods * point.excitation.period)
    return np.array(instance.get(*STATE))


def moving(point):
    """Coordinates of the state that may deviate: those of mass 1 alone beside a wall."""
    return slice(0, 4, 2 if point.structure.wall else 1)


def differences(instance, point, start, periods=1):
    """Central differences of the state after some periods: the matrix through the FMU alone."""
    units, own = point.state_units, moving(point)
    step = 1e-7 * np.abs(start / units).max()
    moves = step * np.diag(units)[own]
    ends = [[after(instance, point, start + k * d, periods) for d in moves] for k in (1, -1)]
    return np.subtract(*ends).T[own] / units[own, None] / (2.0 * step)
