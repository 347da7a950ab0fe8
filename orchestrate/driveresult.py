"""From the revolutions of a run to a labelled dataset."""

import numpy as np
import xarray

from . import averaged
from .weakdrive import COLUMNS, jumps

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
