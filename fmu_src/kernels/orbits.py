"""Closed-form motion between impacts (10), and the equations of periodic orbits that it makes.

In the paper's units, over a flat memory: numbers of the motion, four linear oscillators (the
masses, both as one, both at the outer end of a stroke) in the layout of the kernel's own, then
tables. In the subset of Python that :mod:`fmu_src.export.translation` translates.
"""

from .numerics.elementary import TWO_PI, exp_decay, sincos_turns
from .oscillator import memory as at
from .oscillator.response import fundamental_solutions

NUMBERS = RATIO, RESTITUTION, SLOWER, SHARE_ONE, SHARE_TWO, BY_VELOCITY, BY_PLACE, IS_WALL, ROOM = (
    tuple(range(9))
)
# of an oscillator, behind what the closed form needs of it
BY_COSINE, BY_SINE, DRIVEN_BY, PUSHED_BY, OFFSET_BY, LOAD_BY, WIDTH = range(
    at.ENVELOPE_SINE, at.ENVELOPE_SINE + 7
)
OSCILLATORS = len(NUMBERS)
ROWS, SPAN, TABLE = range(OSCILLATORS + 4 * WIDTH, OSCILLATORS + 4 * WIDTH + 3)
IN_FLIGHT, AT_INNER, AT_OUTER = 0.0, 1.0, 2.0  # modes
NODE = 7  # phase, displacement, velocity, closing speed; mode after it; whether released; outer end
EQUATIONS = 4  # a segment
SPARE = 12  # numbers behind the last table, for work
LONGEST_TIME = 1e12  # in tau: an iteration that has gone astray
NOT_A_NUMBER = float("nan")


def write_free_flows(m, time):
    """Write, for rows (duration, mode), how the free part (x, v) of each mass turns."""
    count = int(m[ROWS])
    for i in range(count):
        row = TABLE + 2 * i
        write_free_flow(m, m[row], m[row + 1], TABLE + 2 * count + 8 * i)
    return 0


def write_steady_states(m, time):
    """Write, for rows (phase, mode), the states of the steady response."""
    count = int(m[ROWS])
    for i in range(count):
        row = TABLE + 2 * i
        sine, cosine = sincos_turns(m[row] / TWO_PI)
        write_steady_state(m, m[row + 1], cosine, sine, TABLE + 2 * count + 4 * i)
    return 0


def write_rates_of_states(m, time):
    """Write, for rows (phase, mode, state), the rates of the states, right-hand sides of (6)."""
    count = int(m[ROWS])
    for i in range(count):
        row = TABLE + 6 * i
        sine, _ = sincos_turns(m[row] / TWO_PI)
        write_rates(m, m[row + 1], sine, row + 2, TABLE + 6 * count + 4 * i)
    return 0


def write_later_states(m, time):
    """Write, for rows (start's phase, mode, later phase, state), the later state and its rates."""
    count = int(m[ROWS])
    for i in range(count):
        row, to = TABLE + 7 * i, TABLE + 7 * count + 8 * i
        write_state_at_end(m, m[row], m[row + 1], m[row + 2], row + 3, to, TABLE + 15 * count)
        sine, _ = sincos_turns(m[row + 2] / TWO_PI)
        write_rates(m, m[row + 1], sine, to, to + 4)
    return 0


def write_segment_equations(m, time):
    """Write each segment's residual, derivatives by both nodes, and states at begin and end."""
    count = int(m[ROWS])
    residual = TABLE + NODE * count
    before, after = residual + 4 * count, residual + 20 * count
    starts, arrivals, spare = residual + 36 * count, residual + 40 * count, residual + 44 * count
    for i in range(count):
        node, following, end = TABLE + NODE * i, TABLE + NODE * (i + 1), 0.0
        if i + 1 == count:
            following, end = TABLE, m[SPAN]
        end += m[following]
        write_state_after_node(m, node, starts + 4 * i)
        write_state_at_end(m, m[node], m[node + 4], end, starts + 4 * i, arrivals + 4 * i, spare)
        write_residual(m, following, arrivals + 4 * i, residual + 4 * i)
        write_derivatives_by_first_node(m, node, following, starts + 4 * i, before + 16 * i, spare)
        write_derivatives_by_last_node(
            m, node, following, end, arrivals + 4 * i, after + 16 * i, spare
        )
    return 0


def oscillator_slot(mode, mass):
    return OSCILLATORS + WIDTH * (mass if mode == IN_FLIGHT else int(mode) + 1)


def fundamental_solutions_at_any_time(m, b, time):
    """Return C and S of (10), also before the start."""
    late = abs(time)
    if not late < LONGEST_TIME:  # rarely
        return NOT_A_NUMBER, NOT_A_NUMBER
    c, s, _ = fundamental_solutions(m, b, late)
    if time >= 0.0:
        return c, s
    grown = 1.0 / max(exp_decay(2.0 * m[b + at.DAMPING] * late), 1e-300)
    return c * grown, -s * grown


def write_free_flow(m, time, mode, to):
    """Write the four factors of the free part of each mass over a time; a wall forgets them."""
    for mass in range(2):
        place = to + 4 * mass
        if m[IS_WALL] != 0.0 and (mass == 1 or mode != IN_FLIGHT):
            for k in range(4):
                m[place + k] = 0.0
        elif mass == 1 and mode != IN_FLIGHT:
            for k in range(4):
                m[place + k] = m[to + k]
        else:
            b = oscillator_slot(IN_FLIGHT, mass) if mode == IN_FLIGHT else OSCILLATORS + 2 * WIDTH
            c, s = fundamental_solutions_at_any_time(m, b, time)
            damped = m[b + at.DAMPING] * s
            m[place] = c + damped
            m[place + 1] = s
            m[place + 2] = -m[b + at.OMEGA_SQUARED] * s
            m[place + 3] = c - damped


def write_steady_state(m, mode, cosine, sine, to):
    for mass in range(2):
        b = oscillator_slot(mode, mass)
        m[to + mass] = m[b + BY_COSINE] * cosine + m[b + BY_SINE] * sine + m[b + OFFSET_BY]
        m[to + 2 + mass] = m[RATIO] * (m[b + BY_SINE] * cosine - m[b + BY_COSINE] * sine)
    if mode == AT_OUTER:
        m[to + 1] += m[ROOM]


def write_rates(m, mode, sine, state, to):
    for mass in range(2):
        b = oscillator_slot(mode, mass)
        x, v = m[state + mass], m[state + 2 + mass]
        rate = sine * m[b + DRIVEN_BY] + m[b + PUSHED_BY] - 2.0 * m[b + at.DAMPING] * v
        m[to + mass] = v
        m[to + 2 + mass] = rate - m[b + at.OMEGA_SQUARED] * x + m[b + LOAD_BY]
    if mode == AT_OUTER:
        m[to + 3] = m[to + 2]


def parting_direction(m, node):
    """Return the sign of the gap's acceleration that parts the masses at a node."""
    return -1.0 if m[node + 6] != 0.0 else 1.0


def gap_at_node(m, node):
    return m[ROOM] if m[node + 6] != 0.0 else 0.0


def is_flight_after_impact(m, node):
    return m[node + 4] == IN_FLIGHT and m[node + 5] == 0.0


def write_state_after_node(m, node, to):
    """Write the state just after a node (15)."""
    speed = 0.0
    if is_flight_after_impact(m, node):
        speed = m[RESTITUTION] * m[node + 3] / (1.0 + m[SLOWER] * m[node + 3])
    speed *= parting_direction(m, node)
    m[to] = m[node + 1]
    m[to + 1] = m[node + 1] + gap_at_node(m, node)
    m[to + 2] = m[node + 2] - m[SHARE_TWO] * speed
    m[to + 3] = m[node + 2] + m[SHARE_ONE] * speed


def write_state_at_end(m, phase, mode, end, start, to, flows):
    """Write the state at an end from that at a phase, and how its free parts turn until there."""
    write_free_flow(m, (end - phase) / m[RATIO], mode, flows)
    sine, cosine = sincos_turns(phase / TWO_PI)
    write_steady_state(m, mode, cosine, sine, to)
    x1, v1 = m[start] - m[to], m[start + 2] - m[to + 2]
    x2, v2 = m[start + 1] - m[to + 1], m[start + 3] - m[to + 3]
    sine, cosine = sincos_turns(end / TWO_PI)
    write_steady_state(m, mode, cosine, sine, to)
    m[to] += m[flows] * x1 + m[flows + 1] * v1
    m[to + 2] += m[flows + 2] * x1 + m[flows + 3] * v1
    m[to + 1] += m[flows + 4] * x2 + m[flows + 5] * v2
    m[to + 3] += m[flows + 6] * x2 + m[flows + 7] * v2


def write_gap_centre_and_closing_speed(m, node, state, to, stride):
    """Write gap, centre (x, v) and closing speed of a state before a node."""
    x1, x2, v1, v2 = m[state], m[state + 1], m[state + 2], m[state + 3]
    m[to] = x2 - x1
    m[to + stride] = m[SHARE_ONE] * x1 + m[SHARE_TWO] * x2
    m[to + 2 * stride] = m[SHARE_ONE] * v1 + m[SHARE_TWO] * v2
    m[to + 3 * stride] = parting_direction(m, node) * (v1 - v2)


def write_residual(m, node, arrival, to):
    """Write what is left of a segment's equations at the node that it ends in."""
    apart = gap_at_node(m, node)
    write_gap_centre_and_closing_speed(m, node, arrival, to, 1)
    m[to] -= apart
    m[to + 1] -= m[SHARE_TWO] * apart + m[node + 1]
    m[to + 2] -= m[node + 2]
    m[to + 3] -= m[node + 3]
    if m[node + 5] != 0.0:
        sine, _ = sincos_turns(m[node] / TWO_PI)
        m[to] = contact_force(m, node, sine)
        m[to + 3] = m[node + 3]


def contact_force(m, node, sine):
    """Return the contact force f (18) at a node, from mass 1 at an end; < 0: pressed."""
    one, two = OSCILLATORS, OSCILLATORS + WIDTH
    load = m[two + LOAD_BY] + (m[two + PUSHED_BY] - m[one + PUSHED_BY])
    load -= m[two + at.OMEGA_SQUARED] * gap_at_node(m, node)
    rate = m[BY_VELOCITY] * m[node + 2] + m[BY_PLACE] * m[node + 1]
    return parting_direction(m, node) * (
        rate + (m[two + DRIVEN_BY] - m[one + DRIVEN_BY]) * sine + load
    )


def write_derivatives_by_first_node(m, node, following, start, to, flows):
    """Write the derivatives of a segment's equations by the node that it begins at."""
    sine, _ = sincos_turns(m[node] / TWO_PI)
    shift = flows + 8
    for unknown in range(EQUATIONS):
        for k in range(4):
            m[shift + k] = 0.0
        if unknown == 0:
            write_rates(m, m[node + 4], sine, start, shift)
            for k in range(4):
                m[shift + k] = -m[shift + k] / m[RATIO]
        elif unknown < 3:
            m[shift + 2 * unknown - 2] = 1.0
            m[shift + 2 * unknown - 1] = 1.0
        elif is_flight_after_impact(m, node):
            slower = 1.0 / (1.0 + m[SLOWER] * m[node + 3])
            rate = parting_direction(m, node) * m[RESTITUTION] * slower * slower
            m[shift + 2] = -rate * m[SHARE_TWO]
            m[shift + 3] = rate * m[SHARE_ONE]
        for mass in range(2):
            x, v, factor = m[shift + mass], m[shift + 2 + mass], flows + 4 * mass
            m[shift + mass] = m[factor] * x + m[factor + 1] * v
            m[shift + 2 + mass] = m[factor + 2] * x + m[factor + 3] * v
        write_gap_centre_and_closing_speed(m, following, shift, to + unknown, EQUATIONS)
        if m[following + 5] != 0.0:
            m[to + unknown] = 0.0
            m[to + 3 * EQUATIONS + unknown] = 0.0


def write_derivatives_by_last_node(m, node, following, end, arrival, to, spare):
    """Write the derivatives of a segment's equations by the node that it ends in."""
    sine, cosine = sincos_turns(end / TWO_PI)
    for k in range(16):
        m[to + k] = 0.0
    write_rates(m, m[node + 4], sine, arrival, spare)
    write_gap_centre_and_closing_speed(m, following, spare, to, EQUATIONS)
    for k in range(EQUATIONS):
        m[to + EQUATIONS * k] /= m[RATIO]
        if k > 0:
            m[to + EQUATIONS * k + k] = -1.0
    if m[following + 5] != 0.0:
        sign, one, two = parting_direction(m, following), OSCILLATORS, OSCILLATORS + WIDTH
        m[to] = sign * (m[two + DRIVEN_BY] - m[one + DRIVEN_BY]) * cosine
        m[to + 1] = sign * m[BY_PLACE]
        m[to + 2] = sign * m[BY_VELOCITY]
        m[to + 12] = 0.0
        m[to + 15] = 1.0
