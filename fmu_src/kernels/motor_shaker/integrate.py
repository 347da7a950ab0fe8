"""A communication step in sub-steps of Dormand and Prince's formula, as long as its error allows.

Sub-steps restart at each communication point, because the force on the box may be a new cubic
there; only the length that the tolerance allowed is remembered. Everything remembered is part of
the state, so a run that is resumed gives the same bits.
"""

import math

from ..numerics.elementary import TWO_PI, fraction_of_turn
from . import memory as at
from .equations import write_rates
from .tableau import DEVIATION_3, DEVIATION_5, NODES, WHOLE, write_rate_sums

TOLERANCE = 1e-12  # of each sub-step, relative to the states' scales
# the longest sub-step, whatever the estimate: it could be blind to what goes round in between
RADIANS = 1.0
SAFETY, SMALLEST, LARGEST = 0.9, 0.2, 5.0  # change of length from one sub-step to the next
TINY, MANY = 1e-300, 1e6


def compute_stages(m, t, h):
    """Compute a sub-step's stages, ``t`` after the force was set; its end is in NEXT."""
    for s in range(at.STATES):
        m[at.STAGE + s] = m[at.STATE + s]
    write_rates(m, 0, t)
    for stage in range(1, at.STAGES):
        write_rate_sums(m, stage - 1, at.STAGE)
        for s in range(at.STATES):
            m[at.STAGE + s] = m[at.STATE + s] + h * m[at.STAGE + s]
        write_rates(m, stage, t + NODES[stage] * h)
    write_rate_sums(m, WHOLE, at.NEXT)
    for s in range(at.STATES):
        m[at.NEXT + s] = m[at.STATE + s] + h * m[at.NEXT + s]
    m[at.WORK] += at.STAGES


def error_scale(m, state, h):
    """Return a state's scale of error: its size, and what the others make of it in the sub-step."""
    size = max(abs(m[at.STATE + state]), abs(m[at.NEXT + state]))
    speed = max(abs(m[at.STATE + at.ROTATION_SPEED]), abs(m[at.NEXT + at.ROTATION_SPEED]))
    arm = m[at.UNBALANCE] / m[at.BOX_MASS]
    if state == at.POSITION:
        return size + arm + h * max(abs(m[at.STATE + at.VELOCITY]), abs(m[at.NEXT + at.VELOCITY]))
    if state == at.VELOCITY:
        frequency = math.sqrt(m[at.BOX_STIFFNESS] / m[at.BOX_MASS])
        return (
            size
            + arm * speed
            + frequency * max(abs(m[at.STATE + at.POSITION]), abs(m[at.NEXT + at.POSITION]))
        )
    if state == at.ROTATION:
        return 1.0
    if state == at.CURRENT:
        return size + abs(m[at.VOLTAGE]) / m[at.ARMATURE_RESISTANCE]
    return size


def squared_error(m, row, h):
    """Return the squared difference of two orders, over what is allowed; uses STAGE."""
    write_rate_sums(m, row, at.STAGE)
    total = 0.0
    for state in range(at.CONTROLLED):
        error = m[at.STAGE + state] * h / (TOLERANCE * error_scale(m, state, h) + TINY)
        total += error * error
    return total


def error_ratio(m, h):
    """Return the error over what is allowed: Hairer's combination of orders 5 and 3."""
    sum_5, sum_3 = squared_error(m, DEVIATION_5, h), squared_error(m, DEVIATION_3, h)
    if sum_5 == 0.0:
        return 0.0
    return sum_5 / math.sqrt((sum_5 + 0.01 * sum_3) * at.CONTROLLED)


def accept_substep(m):
    turned = m[at.NEXT + at.ROTATION]
    for state in range(at.STATES):
        m[at.STATE + state] = m[at.NEXT + state]
    m[at.STATE + at.ROTATION] = 0.0
    m[at.TURN] = fraction_of_turn(m[at.TURN] + turned / TWO_PI)
    part = turned + m[at.ANGLE_LOW]
    total = m[at.ANGLE] + part
    m[at.ANGLE_LOW] = part - (total - m[at.ANGLE])
    m[at.ANGLE] = total


def next_length_factor(ratio):
    """Return the next sub-step's length over this one's: the eighth root of 1 over the error."""
    if ratio < 1e-8:
        return LARGEST
    change = SAFETY / math.sqrt(math.sqrt(math.sqrt(ratio)))
    return min(LARGEST, max(SMALLEST, change))


def integrate_step(m, length):
    """Integrate ``length`` seconds; return OK, or why not, with the time reached in REPORT."""
    t, age = 0.0, m[at.TIME] - m[at.FORCE_TIME]
    while t < length:
        left = length - t
        fastest = math.sqrt(m[at.BOX_STIFFNESS] / m[at.BOX_MASS]) + abs(
            m[at.STATE + at.ROTATION_SPEED]
        )
        h = min(left, m[at.HINT]) if m[at.HINT] > 0.0 else left
        h = RADIANS / fastest if h * fastest > RADIANS else h
        if h < left < MANY * h:  # equal parts, so that no short one is left over at the end
            h = left / -math.floor(-left / h)
        # what the time really grows by: a million roundings add up
        h = left if h == left else (t + h) - t
        m[at.REPORT] = t
        if m[at.WORK] >= m[at.WORK_LIMIT]:
            return at.UNFINISHED
        compute_stages(m, age + t, h)
        ratio = error_ratio(m, h)
        if ratio <= 1.0:
            accept_substep(m)
            t = length if h == left else t + h
            m[at.HINT] = h * next_length_factor(ratio)
        elif h <= 1e-14 * length:
            return at.NOT_FINITE
        else:
            m[at.HINT] = (
                h * min(1.0, next_length_factor(ratio)) if ratio - ratio == 0.0 else h * SMALLEST
            )
    return at.OK
