"""The entry points: initialise once, then advance from one communication point to the next.

An instance is one flat memory.
"""

import math

from ..numerics.elementary import TWO_PI, fraction_of_turn
from . import memory as at
from .equations import restart_force_cubic
from .integrate import integrate_step
from .outputs import write_outputs

WORK_BASE = 100000.0  # evaluations of the right-hand side a step may take whatever its length,
WORK_RATE = 200.0  # and for each radian of box, rotor or no-load speed,
WORK_MOST = 1e7  # and at the very most: about a second, compiled; EVALUATION_LIMIT may allow less
# of the fastest decay's time constant: no sub-step is longer, the formula is not stable beyond
STABLE = 8.0
REGULAR = 1.000001  # M J over S^2, at least: the rotor is not all unbalance, nor the box all rotor


def initialize(m, time):
    """Begin at ``time`` (s) from parameters, start values and inputs; return a code of memory."""
    for i in range(at.BOX_POSITION, at.EVALUATION_LIMIT):
        m[i] = 0.0
    for i in range(at.TIME, at.SIZE):
        m[i] = 0.0
    m[at.TIME] = time
    m[at.FORCE_TIME] = time
    m[at.TARGET] = time
    code = restore(m, time)
    if code != at.OK:
        return code
    m[at.STATE + at.POSITION] = m[at.POSITION_START]
    m[at.STATE + at.VELOCITY] = m[at.VELOCITY_START]
    m[at.STATE + at.ROTATION_SPEED] = m[at.SPEED_START]
    m[at.STATE + at.CURRENT] = m[at.CURRENT_START]
    m[at.ANGLE] = m[at.ANGLE_START]
    m[at.TURN] = fraction_of_turn(m[at.ANGLE_START] / TWO_PI)
    write_outputs(m)
    return check_finite(m)


def restore(m, time):
    """Compute what follows from the parameters, of a saved memory too; ``time`` is not used."""
    unbalance = m[at.UNBALANCE_MASS] * m[at.UNBALANCE_RADIUS]
    m[at.UNBALANCE] = unbalance
    if not m[at.BOX_MASS] * m[at.ROTOR_INERTIA] >= REGULAR * unbalance * unbalance:
        m[at.REPORT] = REGULAR * unbalance * unbalance / m[at.BOX_MASS]
        return at.INERTIA
    return at.OK


def advance(m, time):
    """Advance to ``time`` (s); after another code than OK the memory is to be thrown away."""
    restart_force_cubic(m)
    before = m[at.TIME]
    length = time - before
    fastest = math.sqrt(m[at.BOX_STIFFNESS] / m[at.BOX_MASS]) + abs(m[at.STATE + at.ROTATION_SPEED])
    if m[at.MOTOR_CONSTANT] > 0.0:
        fastest += abs(m[at.VOLTAGE]) / m[at.MOTOR_CONSTANT]
    m[at.TARGET] = time
    m[at.WORK] = 0.0
    allowed = min(WORK_MOST, WORK_BASE + WORK_RATE * fastest * max(length, 0.0))
    m[at.WORK_LIMIT] = min(allowed, m[at.EVALUATION_LIMIT])
    too_many = at.LIMITED if m[at.WORK_LIMIT] < allowed else at.UNFINISHED
    least = at.STAGES / STABLE * fastest_decay_rate(m) * length
    if least > m[at.WORK_LIMIT]:
        m[at.WORK] = least
        m[at.REPORT] = before
        return too_many
    code = integrate_step(m, length)
    m[at.REPORT] += before
    if code != at.OK:
        return too_many if code == at.UNFINISHED else code
    m[at.TIME] = time
    m[at.EVALUATIONS] = m[at.WORK]
    write_outputs(m)
    return check_finite(m)


def fastest_decay_rate(m):
    """Return the largest decay rate, 1/s: of damper, armature or, without inductance, the rotor."""
    constant, resistance = m[at.MOTOR_CONSTANT], m[at.ARMATURE_RESISTANCE]
    if m[at.ARMATURE_INDUCTANCE] > 0.0:
        motor = resistance / m[at.ARMATURE_INDUCTANCE]
    else:
        motor = constant * constant / resistance / m[at.ROTOR_INERTIA]
    return max(motor, m[at.BOX_DAMPING] / m[at.BOX_MASS])


def refresh(m, time):
    """Write the outputs for the inputs as they are now; ``time`` is not used."""
    restart_force_cubic(m)
    write_outputs(m)
    return check_finite(m)


def check_finite(m):
    """Return OK, or NOT_FINITE if an output is no finite number."""
    total = 0.0
    for i in range(at.BOX_POSITION, at.TIME):
        total += m[i]
    return at.OK if total - total == 0.0 else at.NOT_FINITE
