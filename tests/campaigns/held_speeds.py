"""Simulate a course of ramps and long voltage holds, and read the speed of each hold.

It is none of the ways in which `couple` decides: one run through all voltages, nothing restored,
and the speed is read at the end of each hold.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from orchestrate import couple
from orchestrate.weak_drive.couple import schedule_from_arguments
from orchestrate.weak_drive.schedule import Course, Ramp
from tools.draws import System

RATE = 5e-5  # of eta0 in a time 1/omega, between holds
LONG, LONG_OF_ROTOR = 4000.0, 200.0  # of a hold, in 1/omega and in the rotor's time 1/b
SETTLED = 1e-3  # of omega: mean speeds of the last two quarters of a hold


def begin_course(system: System, first: float, second: float) -> tuple[list[float], list[float]]:
    """Return times over omega and voltages over K omega of how `couple` begins a ramp.

    Where motions coexist another begin leads to another one.
    """
    structure, drive = system
    omega, volts = structure.omega, drive.volts(structure)
    ramp = schedule_from_arguments(structure, drive, (first * volts, second * volts))
    assert isinstance(ramp, Ramp)
    spin_up, settled = ramp.spin_up * omega, ramp.begin * omega
    if not spin_up:
        return [0.0, settled], [first, first]
    return [0.0, spin_up, settled], [ramp.low / volts, first, first]


def held_speeds(
    system: System,
    first: float,
    voltages: Sequence[float],
    part: float = 1.0,
    rate: float = RATE,
) -> np.ndarray:
    """Compute the settled mean speed at each of a series of held voltages."""
    structure, drive = system
    hold = part * (LONG + LONG_OF_ROTOR / drive.b(structure))
    times, course, ends = *begin_course(system, first, voltages[0]), []
    for voltage in voltages:
        arrival = times[-1] + max(abs(voltage - course[-1]) / rate, 1.0)
        times += [arrival, arrival + hold]
        course += [voltage, voltage]
        ends.append(times[-1])
    omega, volts = structure.omega, drive.volts(structure)
    schedule = Course(
        tuple(time / omega for time in times), tuple(voltage * volts for voltage in course)
    )
    run = couple(structure, drive, voltage=schedule, hold=0.0, progress=False)
    time, speed = run.time.values * omega, np.abs(run.Omega.values)
    return np.array([settled_speed(time, speed, end, hold) for end in ends])


def settled_speed(time: np.ndarray, speed: np.ndarray, end: float, hold: float) -> float:
    """Return the mean speed at the end of a hold; NaN if it still changes."""
    before, last = (
        speed[(time > end - quarters * hold / 4.0) & (time <= end - (quarters - 1) * hold / 4.0)]
        for quarters in (2, 1)
    )
    return float(last.mean()) if abs(last.mean() - before.mean()) < SETTLED else float("nan")
