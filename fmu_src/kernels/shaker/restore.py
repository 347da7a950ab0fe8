"""A saved state that came from outside, made whole again.

Its checksum says that it was not damaged, not who made it. What is integrated can be anything
finite; all that follows from it or from the parameters is computed anew.
"""

from . import memory as at
from .equations import begin_force
from .outputs import write_outputs
from .stepper import REGULAR, check_finite


def refuse_slot(m, slot, complaint):
    """Record which slot is wrong, and why, and return FORGED."""
    m[at.TARGET] = m[slot]
    m[at.WORK] = slot
    m[at.REPORT] = complaint
    return at.FORGED


def restore(m, time):
    """Check a memory that was read, and compute what follows from other numbers; it began at
    ``time`` (s).

    The variables have been checked against their ranges. Outputs are those for the inputs as they
    are.

    Returns
    -------
    int
        OK, or FORGED with what is wrong in WORK, TARGET and REPORT, or another code of
        :mod:`.memory`.
    """
    for i in range(at.RATES, at.STATE):
        m[i] = 0.0
    for i in range(at.UNBALANCE, at.SIZE):
        m[i] = 0.0
    for i in range(at.SIZE):
        if m[i] - m[i] != 0.0:
            return refuse_slot(m, i, at.NOT_A_NUMBER)
    unbalance = m[at.UNBALANCE_MASS] * m[at.UNBALANCE_RADIUS]
    m[at.UNBALANCE] = unbalance
    if not m[at.BOX_MASS] * m[at.ROTOR_INERTIA] >= REGULAR * unbalance * unbalance:
        m[at.REPORT] = REGULAR * unbalance * unbalance / m[at.BOX_MASS]
        return at.INERTIA
    if m[at.TIME] < time:
        return refuse_slot(m, at.TIME, at.NO_TIME)
    if not 0.0 <= m[at.TURN] < 1.0:
        return refuse_slot(m, at.TURN, at.NO_PHASE)
    if m[at.STATE + at.ROTATION] != 0.0:
        return refuse_slot(m, at.STATE + at.ROTATION, at.NO_PHASE)
    if not time <= m[at.FORCE_TIME] <= m[at.TIME]:
        return refuse_slot(m, at.FORCE_TIME, at.NO_TIME)
    if m[at.FORCE_SET] != 0.0 and m[at.FORCE_SET] != 1.0:
        return refuse_slot(m, at.FORCE_SET, at.NO_FLAG)
    if m[at.HINT] < 0.0:
        return refuse_slot(m, at.HINT, at.NO_TIME)
    if abs(m[at.ANGLE_LOW]) > 1e-9 * (1.0 + abs(m[at.ANGLE])):
        return refuse_slot(m, at.ANGLE_LOW, at.NO_PHASE)
    begin_force(m)
    write_outputs(m)
    return check_finite(m)
