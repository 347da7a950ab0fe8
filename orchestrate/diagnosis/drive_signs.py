"""Signs of a run on a weak drive: where its speed jumps, and the power that it takes before."""

from __future__ import annotations

import math

import numpy as np

from ..errors import InputError
from ..laboratory.pieces import Floats
from ..lazy import xr
from ..model.drive import sense_of_rotation

REQUIRED_VARIABLES = ("time", "speed", "voltage", "motor")
MIN_SPEEDS = 8  # speeds that both runs have


def is_drive_run(data: object) -> bool:
    """Return whether a dataset is a run of a motor, one row a revolution."""
    return "revolution" in getattr(data, "dims", ()) and all(
        name in data.variables  # type: ignore[attr-defined]
        for name in REQUIRED_VARIABLES
    )


def drive_signs(run: xr.Dataset, sound: xr.Dataset) -> dict[str, tuple[float, float]]:
    """Compute signs of a run against the sound beam's, relative, and their errors, NaN: unknown."""
    first, second = jump_voltage(run), jump_voltage(sound)
    lag = sum(  # of the ramps; NaN where it is not known
        abs(float(one.jump_lag.sel(jump="up")) / voltage) if "jump_lag" in one else math.nan
        for one, voltage in ((run, first), (sound, second))
    )
    fall = 1.0 - first / second
    return {"jump_voltage_fall": (fall, lag), "extra_power": extra_power_and_error(run, sound)}


def jump_voltage(run: xr.Dataset) -> float:
    """Return the size of the voltage at which the speed jumps up, V; NaN without such a jump."""
    if "jumps" not in run or "jump" not in run.coords or "up" not in run.jump.values:
        return math.nan
    return abs(float(run.jumps.sel(jump="up")))


def extra_power_and_error(run: xr.Dataset, sound: xr.Dataset) -> tuple[float, float]:
    """Return the extra power relative to the sound beam at equal speeds, and its standard error."""
    speeds, powers = speeds_and_powers_below_jump(run)
    other_speeds, other_powers = speeds_and_powers_below_jump(sound)
    if min(len(speeds), len(other_speeds)) < MIN_SPEEDS:
        return math.nan, math.nan
    low, high = max(speeds[0], other_speeds[0]), min(speeds[-1], other_speeds[-1])
    common = (speeds >= low) & (speeds <= high)
    if common.sum() < MIN_SPEEDS:
        return math.nan, math.nan
    reference = np.interp(speeds[common], other_speeds, other_powers)
    mean = float(reference.mean())
    if not mean > 0.0:
        return math.nan, math.nan
    rest = powers[common] - reference
    error = float(np.std(rest, ddof=1)) / math.sqrt(float(common.sum())) / mean
    return float(rest.mean()) / mean, error


def speeds_and_powers_below_jump(run: xr.Dataset) -> tuple[Floats, Floats]:
    """Return the sizes of the speeds up to the jump, ascending, and the motor's powers, in W."""
    time, speed, voltage, work = (run[name].values for name in REQUIRED_VARIABLES)
    if not len(time) > 1:
        raise InputError("record: a run of less than two revolutions; expected more of them")
    sense = sense_of_rotation(voltage)
    voltage, speed = sense * voltage, sense * speed
    power = np.diff(work) / np.diff(time)
    jump = jump_voltage(run)
    end = jump if math.isfinite(jump) else float(voltage.max())
    last = int(np.argmax(voltage >= end)) or len(voltage) - 1
    order = np.argsort(speed[1 : last + 1], kind="stable")
    return speed[1 : last + 1][order], power[:last][order]
