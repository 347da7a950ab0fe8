"""Compute how fast disturbances of a held motion grow, by its Floquet multipliers.

Newton's method begins at the state of the run and keeps its voltage, so that it finds the motion
that is held, if that repeats after one of `TURNS` revolutions, or none. A settled state is so close
to the motion that the Jacobian there usually is the motion's own.
"""

from __future__ import annotations

import math

import numpy as np

from ..constants import TURN
from ..dynamics.closed_form import Floats
from ..dynamics.continuation import SOLVER_ERRORS, NoConvergenceError, newton_step, unit_vector
from . import averaged
from .run import MotorRun
from .shooting import Shooter

TURNS = (1, 2, 3, 4)  # revolutions after which a motion may repeat
STEPS = 24  # of a revolution
NEAR = 0.2  # of the amplitude, of the voltage and of the speed: largest distance of the motion
CLOSE = 1e-3  # the same from where the Jacobian is made
ITERATIONS = 4  # of Newton's method
CLEAR = 0.3  # of the widest gap: a period begins where it is wider, far from impacts


def growth_rate(run: MotorRun, voltage: float, speed: float) -> float:
    """Return the rate, 1/s, at which disturbances grow (V, rad/s), or NaN; the run is over then."""
    if speed < 0.0:  # the shooter's motors turn forward
        return math.nan
    structure, drive = run.job.structure, run.job.drive
    omega = structure.omega
    length = float(averaged.relative_amplitude(structure, drive, speed / omega)) * drive.length
    shooter = Shooter((run.oscillator, run.drive), structure, drive, 1, STEPS, length)
    shooter.angle = run.master["angle"] % TURN
    shooter.define_unknowns(structure.bonded or run.master.motion.x_rel == 0.0)
    ends = [voltage / shooter.volts, speed / omega]
    unknowns = np.append(shooter.scaled_state(run.master), ends)
    try:
        period = shooter.observe_period(unknowns)
        if period.start_clearance < CLEAR or period.in_contact != shooter.in_contact:
            unknowns = shooter.shift_start(unknowns, period.clearest_step, period.in_contact)
        for turns in TURNS:
            shooter.set_revolutions(turns)
            if np.abs(shooter.residual(unknowns)).max() < NEAR:
                return math.log(largest_multiplier(shooter, unknowns)) * speed / (turns * TURN)
    except SOLVER_ERRORS:
        pass
    finally:
        shooter.close()
    return math.nan


def largest_multiplier(shooter: Shooter, guess: Floats) -> float:
    normal, offset = unit_vector(len(guess), -2), np.zeros_like(guess)
    for _ in range(ITERATIONS):
        jacobian = shooter.compute_jacobian(guess + offset)
        offset, step = newton_step(shooter, guess, offset, normal, jacobian)
        if not np.abs(offset).max() < NEAR:
            break
        if np.abs(step).max() < CLOSE:
            return float(abs(shooter.floquet_multipliers()[0]))
    raise NoConvergenceError("Newton's method went too far")
