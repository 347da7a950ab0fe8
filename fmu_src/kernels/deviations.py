"""How small deviations of a motion grow from impact to impact, written once for Python and C.

The saltation matrix of an impact includes that the deviated motion impacts earlier or later (di
Bernardo et al., Piecewise-smooth Dynamical Systems, 2008, 2.5). Where chattering ends in permanent
contact the deviation of the gap dies; at a release nothing jumps (19).

In the subset of Python that :mod:`fmu_src.export.translation` translates, over the oscillator's
memory, for its constants and certified roots; tables follow.
"""

from .numerics.elementary import fraction_of_turn, sincos_turns
from .oscillator import memory as at
from .oscillator.excitation import begin_segment, drive_and_rate_at, mirror_system
from .oscillator.impact import common_velocity
from .oscillator.motion import begin_state, set_phase
from .oscillator.parameters import derive_constants
from .oscillator.response import fundamental_solutions
from .oscillator.roots import walk_to_event

# impacts, the end of the span in s; then of each impact a row, a matrix, and how long contact
# lasts, in tau
IMPACTS, SPAN_END, TABLES = at.SIZE, at.SIZE + 1, at.SIZE + 2
# a row: time, state after the impact, closing speed, whether contact follows
TIME, X1, X2, V1, V2, CLOSING, STICKS, ROW = range(8)
STATES = 4
OF_X1, OF_X2, OF_V1, OF_V2 = 0, 4, 8, 12  # rows of a matrix, each over x1, x2, v1, v2
SMALLEST = 1e-300  # closing speed: a grazing impact has none, its matrix is very large instead
WORK = 1e7  # evaluations until a release is given up


def write_deviation_matrices(m, time):
    """Write each impact's matrix to the next one's deviation, m and m/tau; and contact times."""
    m[at.SIDE] = 1.0
    derive_constants(m)
    m[at.CUBIC_SET] = 1.0
    begin_segment(m)
    count = int(m[IMPACTS])
    for i in range(count):
        row, matrix = TABLES + ROW * i, TABLES + ROW * count + STATES * STATES * i
        end = m[SPAN_END]
        if i + 1 < count:
            end = m[row + ROW + TIME]
        left, touching = m[at.OMEGA] * (end - m[row + TIME]), 0.0
        mirror_to_impact_side(m, row)
        write_saltation_matrix(m, row, matrix)
        if m[row + STICKS] != 0.0:
            touching = contact_duration(m, row, left)
            multiply_by_free_flow(m, matrix, at.OSCILLATOR_3, at.OSCILLATOR_3, touching)
        multiply_by_free_flow(m, matrix, at.OSCILLATOR_1, at.OSCILLATOR_2, left - touching)
        m[TABLES + (ROW + STATES * STATES) * count + i] = touching
    return 0


def mirror_to_impact_side(m, row):
    """Go over to the system, or its mirror image, in which an impact is at the inner end."""
    gap = m[row + X2] - m[row + X1] + m[at.CLEARANCE]
    side = 1.0 if 2.0 * gap < m[at.LIMIT] else -1.0
    if side != m[at.SIDE]:  # rarely
        mirror_system(m)


def write_saltation_matrix(m, row, matrix):
    """Write ``R + (F+ - R F-) n^T/(n F-)`` of an impact; in contact, both to their centre."""
    side, one, two = m[at.SIDE], m[at.SHARE], m[at.MU] * m[at.SHARE]
    if m[at.WALL] != 0.0:  # infinitely heavy
        two = 1.0
    for i in range(STATES):
        for k in range(STATES):
            m[matrix + STATES * i + k] = 0.0
            if i == k:
                m[matrix + STATES * i + k] = 1.0
    if m[row + STICKS] != 0.0:
        for i in range(STATES):
            first = 2 * int(i / 2)
            m[matrix + STATES * i + first] = one
            m[matrix + STATES * i + first + 1] = two
        return
    closing, slope = m[row + CLOSING] / m[at.OMEGA], m[at.E_SLOPE] * m[at.OMEGA]
    slower = 1.0 / (1.0 + slope * closing)
    rate = 1.0 + m[at.E] * slower * slower  # of the gap's velocity, by the closing speed
    m[matrix + OF_V1 + 2] = 1.0 - two * rate
    m[matrix + OF_V1 + 3] = two * rate
    m[matrix + OF_V2 + 2] = one * rate
    m[matrix + OF_V2 + 3] = 1.0 - one * rate
    x1, x2 = side * m[row + X1], side * m[row + X2]
    v1, v2 = side * m[row + V1] / m[at.OMEGA], side * m[row + V2] / m[at.OMEGA]
    common = common_velocity(m, v1, v2)
    b1, b2 = common + two * closing, common - one * closing
    sine, cosine = sincos_turns(fraction_of_turn(m[at.ETA_TURNS] * m[at.OMEGA] * m[row + TIME]))
    drive_1, _ = drive_and_rate_at(m, at.OSCILLATOR_1, cosine, sine, 0.0)
    drive_2, _ = drive_and_rate_at(m, at.OSCILLATOR_2, cosine, sine, 0.0)
    after_1 = oscillator_acceleration(m, at.OSCILLATOR_1, drive_1, x1, v1)
    after_2 = oscillator_acceleration(m, at.OSCILLATOR_2, drive_2, x2, v2)
    before_1 = oscillator_acceleration(m, at.OSCILLATOR_1, drive_1, x1, b1)
    before_2 = oscillator_acceleration(m, at.OSCILLATOR_2, drive_2, x2, b2)
    scale = 1.0 / max(closing, SMALLEST)
    add_jump_times_normal(m, matrix + OF_X1, (v1 - b1) * scale)
    add_jump_times_normal(m, matrix + OF_X2, (v2 - b2) * scale)
    jump_1 = after_1 - m[matrix + OF_V1 + 2] * before_1 - m[matrix + OF_V1 + 3] * before_2
    jump_2 = after_2 - m[matrix + OF_V2 + 2] * before_1 - m[matrix + OF_V2 + 3] * before_2
    add_jump_times_normal(m, matrix + OF_V1, jump_1 * scale)
    add_jump_times_normal(m, matrix + OF_V2, jump_2 * scale)


def oscillator_acceleration(m, b, drive, x, v):
    """Return the right-hand side of (6), displacements from the unloaded spring."""
    return drive - 2.0 * m[b + at.DAMPING] * v - m[b + at.OMEGA_SQUARED] * x


def add_jump_times_normal(m, slot, jump):
    """Add what a row of the matrix jumps by, times the normal (-1, 1, 0, 0)."""
    m[slot] += jump
    m[slot + 1] -= jump


def contact_duration(m, row, span):
    """Return how long contact after an impact lasts, in tau, at most a span."""
    set_phase(m, m[at.ETA_TURNS] * m[at.OMEGA] * m[row + TIME])
    side = m[at.SIDE]
    x, v = side * m[row + X1] - m[at.REST_1], side * m[row + V1] / m[at.OMEGA]
    m[at.MODE] = at.FLIGHT
    m[at.WORK] = 0.0
    m[at.WORK_LIMIT] = WORK
    begin_state(m, x, v, x, v, 0.0, 0)
    if m[at.MODE] != at.CONTACT:
        return 0.0
    walk_to_event(m, span)
    return min(m[at.END], span)


def multiply_by_free_flow(m, matrix, oscillator_1, oscillator_2, time):
    """Multiply a matrix by the free flow of both masses over a time, (10); a wall has none."""
    for mass in range(2):
        b = oscillator_2
        if mass == 0:
            b = oscillator_1
        c, s, _ = fundamental_solutions(m, b, time)
        damping, square = m[b + at.DAMPING], m[b + at.OMEGA_SQUARED]
        here = 0.0 if mass == 1 and m[at.WALL] != 0.0 else 1.0
        for k in range(STATES):
            x, v = here * m[matrix + STATES * mass + k], here * m[matrix + STATES * (mass + 2) + k]
            m[matrix + STATES * mass + k] = (c + damping * s) * x + s * v
            m[matrix + STATES * (mass + 2) + k] = (c - damping * s) * v - square * s * x
