"""From the revolutions of a run to a labelled dataset, and the voltages at which the speed jumps."""

import math

import numpy as np
import xarray

from . import averaged
from .weakdrive import COLUMNS

NAMES = {
    "time": "time at the revolution's end, times omega",
    "eta0": "voltage as no-load speed, U/(K omega)",
    "Omega": "mean speed of the revolution, over omega",
    "amplitude": "half the range of x1 over the revolution, over S/M_t",
    "box_amplitude": "half the range of the box's position, over S/M_t",
    "impacts": "impacts in the revolution",
    "acceleration": "largest acceleration of the box at communication points, over omega^2 S/M_t",
    "motor": "work of the motor since the start",
    "box_damper": "energy lost in the damper of the box since the start",
    "impact_loss": "energy lost in impacts since the start",
    "stored": "energy stored since the start",
    "dampers": "energy lost in the dampers of the masses since the start",
    "missing": "motor less all others: what the coupling has lost (negative: fed in)",
    "defect": "sum of the steps' defects: work taken by the box less work given by the masses",
    "defect_sizes": "sum of their sizes",
}
LIMIT = 1e-6  # of the motor's work: more is missed with a warning


def books(rows):
    """What the coupling has lost, and the sum of the defects' sizes, over the motor's work.

    Parameters
    ----------
    rows : ndarray, shape (revolutions, len(COLUMNS))

    Returns
    -------
    missing, defects : float
    """
    motor, missing, defects = (rows[-1, COLUMNS.index(name)] for name in ("motor", "missing", "defect_sizes"))
    return float(missing / motor), float(defects / motor)


def dataset(plan, rows, fmus):
    """A run as a self-describing dataset.

    Parameters
    ----------
    plan : .weakdrive.Plan
    rows : ndarray, shape (revolutions, len(COLUMNS))
    fmus : sequence of Description

    Returns
    -------
    xarray.Dataset
        Dimension revolution; non-dimensional, see :mod:`.setups`.
    """
    variables = {name: ("revolution", rows[:, i], {"units": "1", "long_name": NAMES[name]}) for i, name in enumerate(COLUMNS)}
    found = xarray.Dataset(variables, {"revolution": np.arange(1, len(rows) + 1)})
    setup, schedule = plan.setup, plan.schedule
    up, down = jumps(rows, plan)
    missing, defects = books(rows)
    found.attrs = {
        "title": f"Weak drive, {setup.name}, {'bonded' if setup.bonded else 'delaminated'}",
        "setup": setup.name,
        "structure": "bonded" if setup.bonded else "delaminated",
        **{name: getattr(setup, name) for name in ("beta", "epsilon", "b", "mu", "kappa", "D", "e", "Omega_b", "D_b", "volts")},
        **{f"eta0_{name}": getattr(schedule, name) for name in ("first", "last", "rate", "settle", "increment")},
        "turn_time": schedule.settle + schedule.rise,
        "algorithm": plan.scheme.algorithm,
        "step": plan.scheme.h,
        "tolerance": plan.scheme.tolerance,
        "jump_up": up,
        "jump_down": down,
        "missing_over_motor_work": missing,
        "defects_over_motor_work": defects,
        **{f"fmu_guid_{fmu.name}": fmu.guid for fmu in fmus},
    }
    if setup.bonded:
        for name, (eta0, _) in zip(("up", "down"), averaged.folds(setup), strict=False):
            found.attrs[f"averaged_jump_{name}"] = eta0
    return found


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
