"""A saved state that came from outside, made whole again: what follows from other numbers is
computed, not read.

Its checksum says that it was not damaged, not who made it. So everything that the parameters, the
inputs of the segment and the present state's beginning decide is made anew, with the bits that it
had; what cannot be made anew is checked. Whatever the numbers were, what is left is an instance
that runs.
"""

import math

from ..numerics.elementary import sincos_turns
from ..numerics.first_root import INFINITE
from . import memory as at
from .contact import first_nonzero_derivative
from .event_function import evaluate, event_rounding, is_constant, set_node_values
from .excitation import begin_cubic, begin_segment
from .motion import begin_common, begin_flight, set_phase
from .nodes import BLOCK, FURTHEST, LONGEST, is_too_fast, seek_interval
from .parameters import derive
from .secular import clear_secular
from .series import set_series, short_flight_duration

SLACK = 1e-9  # relative: sums of many roundings are far smaller, another state is not
CLOSE = 1e-14  # relative: sums of a few roundings
ROOT = 1e-6  # what an event function may be at its root, relative to its terms
MOST_INPUT, MOST_FREQUENCY = 1e100, 1e24  # as declared


def refuse_slot(m, slot, complaint):
    """Record which slot is wrong, and why, and return FORGED."""
    m[at.TARGET] = m[slot]
    m[at.WORK] = slot
    m[at.REPORT] = complaint
    return at.FORGED


def restore(m, time):
    """Check a memory that was read, and compute what follows from other numbers; it began at
    ``time`` (s).

    The variables have been checked against their ranges.

    Returns
    -------
    int
        OK, FORGED with what is wrong in WORK, TARGET and REPORT, or TOO_FAST.
    """
    m[at.START_TIME] = time
    clear_scratch(m)
    for i in range(at.SIZE):
        if m[i] - m[i] != 0.0 and not may_be_infinite(m, i):
            return refuse_slot(m, i, at.NOT_A_NUMBER)
    clear_secular(m)
    derive(m)
    code = restore_segment(m)
    if code == at.OK:
        code = check_whole_numbers(m)
    if code == at.OK:
        code = check_phase(m)
    if code == at.OK:
        code = check_times(m)
    if code == at.OK:
        code = check_beginning(m)
    if code != at.OK:
        return code
    code = restore_short_flight(m) if m[at.SERIES] != 0.0 else restore_state(m)
    if code != at.OK:
        return code
    clear_scratch(m)
    return at.OK


def clear_scratch(m):
    """Set to zero what a step writes before it reads it."""
    for i in range(at.WORK, at.WORK_LIMIT + 1):
        m[i] = 0.0
    m[at.TARGET] = 0.0
    m[at.REPORT] = 0.0
    m[at.STOP_AT_IMPACT] = 0.0
    m[at.STOPPED] = 0.0
    for i in range(6):
        m[at.POINT + i] = 0.0
    for i in range(at.RATES, at.CUBIC_SET):
        m[i] = 0.0


def may_be_infinite(m, slot):
    """Return whether a slot need not have a finite number: it is computed anew, or may be infinite
    in a valid state.
    """
    if at.OMEGA <= slot <= at.NODE_SINE and not (
        at.SEGMENT_INPUTS <= slot < at.CUBIC_ON or slot == at.CUBIC_AGE
    ):
        return True
    if at.SERIES_X <= slot < at.STEP:
        return True
    return m[slot] > 0.0 and (slot == at.CLEAR or slot == at.END or slot == at.REMAINDER)


def restore_segment(m):
    """Compute the excitation's constants from the inputs that the segment was made of; whether an
    input of the cubic was set since stays as it was.
    """
    for i in range(6):
        value = m[at.SEGMENT_INPUTS + i]
        if abs(value) > MOST_INPUT or (i == 1 and (value < 0.0 or value > MOST_FREQUENCY)):
            return refuse_slot(m, at.SEGMENT_INPUTS + i, at.NO_INPUT)
    age = m[at.CUBIC_AGE]
    if age < 0.0 or age > (1.0 + SLACK) * m[at.ORIGIN]:
        return refuse_slot(m, at.CUBIC_AGE, at.NO_AGE)
    inputs = swap_inputs(m, segment_inputs(m))
    begin_cubic(m)
    begin_segment(m)
    swap_inputs(m, inputs)
    m[at.CUBIC_AGE] = age
    return at.TOO_FAST if is_too_fast(m) else at.OK


def segment_inputs(m):
    """Return the inputs that the segment was made of."""
    i = at.SEGMENT_INPUTS
    return m[i], m[i + 1], m[i + 2], m[i + 3], m[i + 4], m[i + 5]


def swap_inputs(m, values):
    """Set all six inputs and return those before."""
    i = at.BOX_AMPLITUDE
    before = m[i], m[i + 1], m[i + 2], m[i + 3], m[i + 4], m[i + 5]
    m[i], m[i + 1], m[i + 2], m[i + 3], m[i + 4], m[i + 5] = values
    return before


def is_whole(m, slot, highest):
    """Return whether a slot has a whole number from 0 to ``highest``."""
    value = m[slot]
    return 0.0 <= value <= highest and value == math.floor(value)


def check_whole_numbers(m):
    """Check mode, counts and orders; return OK or FORGED."""
    if not is_whole(m, at.MODE, 2.0) or (m[at.MODE] == at.GLUED) != (m[at.BONDED] != 0.0):
        return refuse_slot(m, at.MODE, at.NO_MODE)
    if not is_whole(m, at.CUBIC_SET, 1.0):
        return refuse_slot(m, at.CUBIC_SET, at.NO_COUNT)
    if not is_whole(m, at.END_KIND, 2.0):
        return refuse_slot(m, at.END_KIND, at.NO_END_KIND)
    if m[at.SERIES] != 0.0 and m[at.SERIES] != 8.0 and m[at.SERIES] != at.SERIES_LONGEST:
        return refuse_slot(m, at.SERIES, at.NO_SERIES)
    if not is_whole(m, at.ROTATIONS, BLOCK):
        return refuse_slot(m, at.ROTATIONS, at.NO_COUNT)
    most = FURTHEST if m[at.CLEAR] == INFINITE else LONGEST - 1.0  # never written anew, or so late
    if not is_whole(m, at.NODE, most):
        return refuse_slot(m, at.NODE, at.NO_COUNT)
    if m[at.AT_END_NODE] != 0.0 and m[at.AT_END_NODE] != m[at.NODE] + 1.0:
        return refuse_slot(m, at.AT_END_NODE, at.NO_COUNT)
    return at.OK


def check_phase(m):
    """Check that the phase and its cosine and sine belong together; return OK or FORGED."""
    turn = m[at.TURN]
    if not 0.0 <= turn < 1.0:
        return refuse_slot(m, at.TURN, at.NO_PHASE)
    sine, cosine = sincos_turns(turn)
    if abs(m[at.SINE] - sine) > SLACK:
        return refuse_slot(m, at.SINE, at.NO_PHASE)
    if abs(m[at.COSINE] - cosine) > SLACK:
        return refuse_slot(m, at.COSINE, at.NO_PHASE)
    if m[at.ROTATIONS] == 0.0:
        set_phase(m, turn)
    unit = m[at.PHASE_COSINE] * m[at.PHASE_COSINE] + m[at.PHASE_SINE] * m[at.PHASE_SINE]
    if not abs(unit - 1.0) <= SLACK:
        return refuse_slot(m, at.PHASE_COSINE, at.NO_PHASE)
    return at.OK


def check_times(m):
    """Check that the present state began before the communication point and ends after it; return
    OK or FORGED.
    """
    omega, origin = m[at.OMEGA], m[at.ORIGIN]
    slack = SLACK * (omega * (abs(m[at.TIME]) + abs(m[at.START_TIME])) + origin)
    age = (omega * (m[at.TIME] - m[at.START_TIME]) - origin) - m[at.ORIGIN_LOW]
    if m[at.TIME] < m[at.START_TIME]:
        return refuse_slot(m, at.TIME, at.NO_TIME)
    if abs(m[at.ORIGIN_LOW]) > SLACK * origin:
        return refuse_slot(m, at.ORIGIN_LOW, at.NO_TIME)
    if not -slack <= age < FURTHEST * m[at.SPACING]:
        return refuse_slot(m, at.ORIGIN, at.NO_TIME)
    if m[at.STEP] < 0.0:
        return refuse_slot(m, at.STEP, at.NO_TIME)
    if m[at.CLEAR] < 0.0 or age > m[at.CLEAR] + slack:
        return refuse_slot(m, at.CLEAR, at.NO_TIME)
    if m[at.END] < 0.0 or age > m[at.END] + slack:
        return refuse_slot(m, at.END, at.NO_TIME)
    if (m[at.END_KIND] == at.END_OPEN) != (m[at.END] == INFINITE):
        return refuse_slot(m, at.END, at.NO_TIME)
    return at.OK


def check_beginning(m):
    """Check that the masses are where the state may begin, and the outputs where they may be;
    return OK or FORGED.
    """
    x1, v1, x2, v2 = m[at.BEGIN], m[at.BEGIN + 1], m[at.BEGIN + 2], m[at.BEGIN + 3]
    flight = m[at.MODE] == at.FLIGHT
    together = not flight or m[at.SERIES] != 0.0
    if together and x2 != x1:
        return refuse_slot(m, at.BEGIN + 2, at.NO_GAP)
    if not gap_fits(m, x1, x2, m[at.BEGIN_GAP], together):
        return refuse_slot(m, at.BEGIN_GAP, at.NO_GAP)
    if (not flight and v2 != v1) or (m[at.SERIES] != 0.0 and v2 <= v1):
        return refuse_slot(m, at.BEGIN + 3, at.NO_GAP)
    if m[at.GAP_OFFSET] == 0.0 and m[at.X2] < m[at.X1]:
        return refuse_slot(m, at.X2, at.NO_GAP)
    if not gap_fits(m, m[at.X1], m[at.X2], m[at.X_REL], False):
        return refuse_slot(m, at.X_REL, at.NO_GAP)
    if m[at.SERIES] != 0.0 and not flight:
        return refuse_slot(m, at.SERIES, at.NO_SERIES)
    return at.OK


def gap_fits(m, x1, x2, gap, together):
    """Return whether a gap is that between two displacements: with a clearance, but for rounding,
    and both from the unloaded positions unless they are ``together``.
    """
    offset = 0.0 if together else m[at.GAP_OFFSET]
    slack = CLOSE * (abs(x1) + abs(x2) + abs(offset)) if offset != 0.0 else 0.0
    return gap >= 0.0 and abs(gap - ((x2 - x1) + offset)) <= slack


def restore_short_flight(m):
    """Compute a short flight from its beginning; what is left of the state before it stays."""
    x1, v1, v2 = m[at.BEGIN], m[at.BEGIN + 1], m[at.BEGIN + 3]
    order = int(m[at.SERIES])
    for i in range(at.SERIES_X, at.STEP):
        m[i] = 0.0
    set_series(m, x1, v1, v2 - v1, order)
    duration = short_flight_duration(m, order) if m[at.SERIES_GAP + 4] < 0.0 else 0.0
    if not duration > 0.0:
        return refuse_slot(m, at.SERIES, at.NO_SERIES)
    m[at.CLEAR] = duration
    m[at.END] = duration
    m[at.END_KIND] = at.END_EVENT
    return at.OK


def restore_state(m):
    """Compute free parts, event function and nodes from the state's beginning, and take over how
    far the walk came.

    The walk's place in the state is read: it says how far no event was found.
    """
    clear, end, kind, remainder = m[at.CLEAR], m[at.END], m[at.END_KIND], m[at.REMAINDER]
    node, at_end_node = m[at.NODE], m[at.AT_END_NODE]
    left = m[at.LEFT_VALUES], m[at.LEFT_VALUES + 1], m[at.LEFT_VALUES + 2]
    for i in range(at.SERIES_X, at.STEP):
        m[i] = 0.0
    x1, v1, x2, v2 = m[at.BEGIN], m[at.BEGIN + 1], m[at.BEGIN + 2], m[at.BEGIN + 3]
    if m[at.MODE] == at.FLIGHT:
        begin_flight(m, x1, v1, x2, v2, m[at.BEGIN_GAP])
    else:
        begin_common(m, m[at.MODE], x1, v1)
    if node > 0.0:
        seek_interval(m, node * m[at.SPACING])
        set_node_values(m, at.LEFT_VALUES, at.LEFT, m[at.LEFT_AGE])
        set_node_values(m, at.RIGHT_VALUES, at.RIGHT, m[at.RIGHT_AGE])
    elif m[at.MODE] == at.CONTACT:  # a beginning on the boundary was decided, not evaluated
        m[at.LEFT_VALUES], m[at.LEFT_VALUES + 1], m[at.LEFT_VALUES + 2] = left
    m[at.REMAINDER] = remainder
    m[at.CLEAR], m[at.END], m[at.END_KIND] = clear, end, kind
    m[at.AT_END_NODE] = at_end_node
    return check_end(m)


def check_end(m):
    """Check that the walk can have come to where it stands, and that the end is one; return OK or
    FORGED.
    """
    clear, end, kind = m[at.CLEAR], m[at.END], m[at.END_KIND]
    if clear == INFINITE:
        forever = (
            m[at.MODE] == at.GLUED
            or is_constant(m)
            or (
                m[at.MODE] == at.CONTACT
                and first_nonzero_derivative(m, m[at.BEGIN], m[at.BEGIN + 1], 1)[0] < 0
            )
        )
        return at.OK if forever else refuse_slot(m, at.CLEAR, at.NO_TIME)
    if m[at.MODE] == at.GLUED or clear > m[at.RIGHT_AGE]:
        return refuse_slot(m, at.CLEAR, at.NO_TIME)
    if kind == at.END_RENEWAL and end != m[at.RIGHT_AGE]:
        return refuse_slot(m, at.END, at.NO_TIME)
    if kind == at.END_EVENT:
        if end > m[at.RIGHT_AGE] + SLACK * m[at.SPACING]:
            return refuse_slot(m, at.END, at.NO_TIME)
        h0, _, _, _, _, _ = evaluate(m, end)
        if not abs(h0) <= ROOT * (2.5e14 * event_rounding(m, end)):
            return refuse_slot(m, at.END, at.NO_EVENT)
    return at.OK
