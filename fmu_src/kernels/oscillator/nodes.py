"""The nodes of a state: phasors rotated by constants from node to node, by a polynomial between.

A free part is the pair of its displacement and velocity (x, v): an age t later it is ``((C + D S) x
+ S v, (C - D S) v - omega^2 S x)``, whatever the damping, with C and S of (10) at t. So is the
excitation the pair of its cosine and sine. Nodes lie at multiples of a spacing after the state's
start; from one to the next all pairs rotate by constants, and every 32 nodes they are recomputed
from the closed form, so that rounding does not grow. A pair at a node depends only on the node,
never on how it was reached.
"""

import math

from ..numerics.elementary import cosine_and_sinc, sincos_turns, small_decay
from . import memory as at
from .response import fundamental_solutions
from .secular import LONGEST_DRIVEN, grown_amplitude, initial_push, motion_of_grown_amplitude

ANGLE = 1.25  # of the fastest oscillation over a spacing: half of it is for the polynomials
STEEPEST = 0.65  # decay over half a spacing that small_decay serves
NEAR = 0.00390625  # of a radian of the fastest change: six terms of a Taylor series are exact
BLOCK = 32.0  # nodes from one renewal to the next
# nodes after which a state is rewritten: its angles and their rounding stay small
LONGEST = 1024.0
FASTEST_RATE = 1e36  # products of eight rates, as in the root finder, neither overflow nor vanish
FURTHEST = 4503599627370496.0  # 2**52 nodes, or turns: up to there each has its own number


def set_node_grid(m):
    """Set spacing and rotations of a segment, unless they are those of before."""
    eta = m[at.ETA] if m[at.SHAKEN] != 0.0 else 0.0
    if m[at.SPACING] != 0.0 and eta == m[at.NODE_ETA]:
        return
    m[at.NODE_ETA] = eta
    damping = max(m[at.OSCILLATOR_1 + at.DAMPING], m[at.OSCILLATOR_2 + at.DAMPING])
    m[at.RATE] = max(eta, m[at.FASTEST] + 2.0 * damping)  # 2 D/rate + (omega/rate)^2 <= 1
    m[at.RATE_INVERSE] = 1.0 / m[at.RATE]
    h = node_spacing(max(m[at.FASTEST], eta))
    sine, cosine = sincos_turns(m[at.ETA_TURNS] * h if eta != 0.0 else 0.0)
    m[at.NODE_COSINE] = cosine
    m[at.NODE_SINE] = sine
    if h == m[at.SPACING]:
        return
    m[at.SPACING] = h
    m[at.HALF_SPACING] = 0.5 * h
    square = h * h
    m[at.HERMITE] = h * 0.2
    m[at.HERMITE + 1] = square * 0.05
    m[at.HERMITE + 2] = square * square * square * (1.0 / 28800.0)
    m[at.STEEP] = 0.0
    set_rotation_constants(m, at.OSCILLATOR_1, h)
    set_rotation_constants(m, at.OSCILLATOR_2, h)
    set_rotation_constants(m, at.OSCILLATOR_3, h)


def node_spacing(fastest):
    """Return the spacing of nodes: ANGLE over the fastest frequency at most, eight bits long."""
    longest = ANGLE / fastest
    unit = 1.0
    while unit > longest:
        unit *= 0.5
    while 2.0 * unit <= longest:
        unit *= 2.0
    return math.floor(longest / unit * 128.0) * 0.0078125 * unit


def set_rotation_constants(m, b, h):
    """Set the rotation of one oscillator's free part over one spacing."""
    xx, xv, vx, vv = rotation_over(m, b, h)
    m[b + at.STEP_ON] = xx
    m[b + at.STEP_ON + 1] = vx
    m[b + at.STEP_ON + 2] = xv
    m[b + at.STEP_ON + 3] = vv
    if 0.5 * h * m[b + at.DAMPING] > STEEPEST:
        m[at.STEEP] = 1.0


def rotation_over(m, b, t):
    """Return four factors that turn a free part over ``t``: later x, then later v, by x and v."""
    C, S, _ = fundamental_solutions(m, b, t)
    damped = m[b + at.DAMPING] * S
    return C + damped, S, -m[b + at.OMEGA_SQUARED] * S, C - damped


def oscillator_of_part_a(m):
    """Return the first slot of the linear oscillator that free part A belongs to."""
    return at.OSCILLATOR_1 if m[at.MODE] == at.FLIGHT else at.OSCILLATOR_3


def max_nodes(m):
    """Return the number of nodes after which the present state is rewritten."""
    return LONGEST if m[at.SECULAR] == 0.0 else LONGEST_DRIVEN


def is_too_fast(m):
    """Return whether the fastest change is too fast for derivatives to be numbers."""
    return not m[at.RATE] <= FASTEST_RATE


def is_countable(m, tau):
    """Return whether nodes and turns can be counted up to an age: every look-up of a node ends."""
    return tau < FURTHEST * m[at.SPACING] and m[at.ETA_TURNS] * tau < FURTHEST


def start_nodes(m):
    """Set the first interval of a state that begins: phasors at its start and one spacing later."""
    m[at.NODE] = 0.0
    m[at.LEFT_AGE] = 0.0
    m[at.RIGHT_AGE] = m[at.SPACING]
    for i in range(2):
        m[at.LEFT + i] = m[at.FREE_A + i]
        m[at.LEFT + 2 + i] = m[at.FREE_B + i]
    m[at.LEFT + 4] = m[at.COSINE]
    m[at.LEFT + 5] = m[at.SINE]
    set_right_phasors(m, at.LEFT)


def set_right_phasors(m, node):
    x, v, x_b, v_b, cosine, sine = phasors_at_next_node(
        m, False, m[node], m[node + 1], m[node + 2], m[node + 3], m[node + 4], m[node + 5]
    )
    write_phasors(m, at.RIGHT, x, v, x_b, v_b, cosine, sine)


def write_phasors(m, slot, x, v, x_b, v_b, cosine, sine):
    m[slot] = x
    m[slot + 1] = v
    m[slot + 2] = x_b
    m[slot + 3] = v_b
    m[slot + 4] = cosine
    m[slot + 5] = sine


def is_plain_flight(m):
    """Return whether a harmonic alone drives the present flight, off any resonance."""
    return m[at.MODE] == at.FLIGHT and m[at.SECULAR] == 0.0 and m[at.CUBIC_PRESENT] == 0.0


def phasors_at_next_node(m, is_plain, x, v, x_b, v_b, cosine, sine):  # inline
    if not is_plain and m[at.SECULAR] != 0.0:  # rarely
        return free_parts_at_next_node(m, x, v, x_b, v_b, cosine, sine)
    a = (at.OSCILLATOR_1 if is_plain else oscillator_of_part_a(m)) + at.STEP_ON
    b = at.OSCILLATOR_2 + at.STEP_ON
    return (
        x * m[a] + v * m[a + 2],
        x * m[a + 1] + v * m[a + 3],
        x_b * m[b] + v_b * m[b + 2],
        x_b * m[b + 1] + v_b * m[b + 3],
        cosine * m[at.NODE_COSINE] - sine * m[at.NODE_SINE],
        sine * m[at.NODE_COSINE] + cosine * m[at.NODE_SINE],
    )


def is_block_start(node):
    return math.floor(node * (1.0 / BLOCK)) * BLOCK == node


def advance_interval(m):
    m[at.NODE] += 1.0
    m[at.LEFT_AGE] = m[at.RIGHT_AGE]
    m[at.RIGHT_AGE] = (m[at.NODE] + 1.0) * m[at.SPACING]
    for i in range(6):
        m[at.LEFT + i] = m[at.RIGHT + i]
    if is_block_start(m[at.NODE] + 1.0):  # rarely
        set_right_phasors_from_closed_form(m, m[at.NODE] + 1.0)
    else:
        set_right_phasors(m, at.RIGHT)


def set_right_phasors_from_closed_form(m, node):
    """Set the phasors of the right node to those of ``node`` from the closed form."""
    x, v, x_b, v_b, cosine, sine = phasors_from_closed_form(m, node * m[at.SPACING])
    write_phasors(m, at.RIGHT, x, v, x_b, v_b, cosine, sine)


def phasors_from_closed_form(m, age):
    cosine, sine, x_b, v_b = m[at.COSINE], m[at.SINE], 0.0, 0.0
    if m[at.NODE_ETA] != 0.0:  # usually
        sine, cosine = sincos_turns(m[at.TURN] + m[at.ETA_TURNS] * age)
    phases = m[at.COSINE], m[at.SINE], cosine, sine
    x, v = driven_free_part_after(
        m, oscillator_of_part_a(m), m[at.FREE_A], m[at.FREE_A + 1], age, phases
    )
    if m[at.MODE] == at.FLIGHT:
        x_b, v_b = driven_free_part_after(
            m, at.OSCILLATOR_2, m[at.FREE_B], m[at.FREE_B + 1], age, phases
        )
    return x, v, x_b, v_b, cosine, sine


def free_part_after(m, b, x, v, t):
    """Return a free part a time ``t`` later, from the closed form."""
    xx, xv, vx, vv = rotation_over(m, b, t)
    return x * xx + v * xv, x * vx + v * vv


def driven_free_part_after(m, b, x, v, t, phases):
    """Return :func:`free_part_after`, driven near resonance by ``phases`` (before and after)."""
    if m[b + at.DRIVEN] == 0.0:  # usually
        return free_part_after(m, b, x, v, t)
    old_cosine, old_sine, cosine, sine = phases
    x, v = free_part_after(m, b, x, v - initial_push(m, b, old_cosine, old_sine), t)
    h_cos, h_sin, d_cos, d_sin = grown_amplitude(m, b, t)
    x_driven, v_driven = motion_of_grown_amplitude(m, h_cos, h_sin, d_cos, d_sin, cosine, sine)
    return x + x_driven, v + v_driven


def free_parts_at_next_node(m, x, v, x_b, v_b, old_cosine, old_sine):
    cosine = old_cosine * m[at.NODE_COSINE] - old_sine * m[at.NODE_SINE]
    sine = old_sine * m[at.NODE_COSINE] + old_cosine * m[at.NODE_SINE]
    phases = old_cosine, old_sine, cosine, sine
    x, v = free_part_at_next_node(m, oscillator_of_part_a(m), x, v, phases)
    x_b, v_b = free_part_at_next_node(m, at.OSCILLATOR_2, x_b, v_b, phases)
    return x, v, x_b, v_b, cosine, sine


def free_part_at_next_node(m, b, x, v, phases):
    """Return a free part at the next node, by the matrix of a spacing, driven if it grows."""
    step = b + at.STEP_ON
    if m[b + at.DRIVEN] == 0.0:  # usually
        return x * m[step] + v * m[step + 2], x * m[step + 1] + v * m[step + 3]
    old_cosine, old_sine, cosine, sine = phases
    v -= initial_push(m, b, old_cosine, old_sine)
    g = b + at.STEP_GROWTH
    x_driven, v_driven = motion_of_grown_amplitude(
        m, m[g], m[g + 1], m[g + 2], m[g + 3], cosine, sine
    )
    return (x * m[step] + v * m[step + 2] + x_driven, x * m[step + 1] + v * m[step + 3] + v_driven)


def move_to_interval_at(m, tau):
    node = math.floor(tau / m[at.SPACING]) * 1.0
    if node * m[at.SPACING] > tau:
        node -= 1.0
    block = math.floor(node * (1.0 / BLOCK)) * BLOCK
    if node < m[at.NODE] or block > m[at.NODE]:
        if block == 0.0:  # usually
            start_nodes(m)
        else:
            m[at.NODE] = block - 1.0
            m[at.RIGHT_AGE] = block * m[at.SPACING]
            set_right_phasors_from_closed_form(m, block)
            advance_interval(m)
    while m[at.NODE] < node:
        advance_interval(m)


def phasors_at(m, tau):  # inline
    """Return x_a, v_a, x_b, v_b, cosine, sine at an age, from the nearer node."""
    if tau < m[at.LEFT_AGE] or tau > m[at.RIGHT_AGE]:  # rarely
        move_to_interval_at(m, tau)
    node, t = at.LEFT, tau - m[at.LEFT_AGE]
    if t > m[at.HALF_SPACING]:
        node, t = at.RIGHT, tau - m[at.RIGHT_AGE]
    cosine, sine = m[node + 4], m[node + 5]
    if m[at.NODE_ETA] != 0.0:  # usually
        angle = m[at.NODE_ETA] * t
        c, s = cosine_and_sinc(angle * angle)
        s *= angle
        cosine, sine = cosine * c - sine * s, sine * c + cosine * s
    if m[at.STEEP] == 0.0 and m[at.SECULAR] == 0.0:  # usually
        x_a, v_a, x_b, v_b = free_parts_near_node(m, node, t)
    else:
        x_a, v_a, x_b, v_b = free_parts_by_functions(m, tau, cosine, sine)
    return x_a, v_a, x_b, v_b, cosine, sine


def set_phasors_at_near_end(m, age):
    """Set the phasors at an end so near that six Taylor terms leave less than 1e-17."""
    if age * m[at.RATE] > NEAR or m[at.SECULAR] != 0.0:  # rarely
        return
    p = at.POINT
    x, v = free_part_by_series(m, oscillator_of_part_a(m), m[p], m[p + 1], age)
    # zeros but in a flight
    x_b, v_b = free_part_by_series(m, at.OSCILLATOR_2, m[p + 2], m[p + 3], age)
    angle = m[at.NODE_ETA] * age
    square = angle * angle
    c = 1.0 - square * (0.5 - square * (1.0 / 24.0))
    s = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)))
    cosine, sine = m[p + 4], m[p + 5]
    write_phasors(m, at.AT_END, x, v, x_b, v_b, cosine * c - sine * s, sine * c + cosine * s)
    m[at.AT_END_NODE] = m[at.NODE] + 1.0


def free_part_higher_derivatives(m, b, x, v):
    twice, square = 2.0 * m[b + at.DAMPING], m[b + at.OMEGA_SQUARED]
    x2 = -(twice * v + square * x)
    x3 = -(twice * x2 + square * v)
    x4 = -(twice * x3 + square * x2)
    x5 = -(twice * x4 + square * x3)
    return x2, x3, x4, x5, -(twice * x5 + square * x4)


def free_part_by_series(m, b, x, v, t):
    x2, x3, x4, x5, x6 = free_part_higher_derivatives(m, b, x, v)
    half, t2 = 0.5 * t, t * t
    x += t * (
        v + half * x2 + t2 * ((x3 * (1.0 / 6.0) + t * x4 * (1.0 / 24.0)) + t2 * x5 * (1.0 / 120.0))
    )
    v += t * (
        x2 + half * x3 + t2 * ((x4 * (1.0 / 6.0) + t * x5 * (1.0 / 24.0)) + t2 * x6 * (1.0 / 120.0))
    )
    return x, v


def free_parts_by_functions(m, tau, cosine, sine):
    """Return both free parts where one decays steeply or grows, by elementary functions."""
    t, p = tau - m[at.LEFT_AGE], at.LEFT
    phases = m[p + 4], m[p + 5], cosine, sine
    x_a, v_a = driven_free_part_after(m, oscillator_of_part_a(m), m[p], m[p + 1], t, phases)
    if m[at.MODE] != at.FLIGHT:
        return x_a, v_a, 0.0, 0.0
    x_b, v_b = driven_free_part_after(m, at.OSCILLATOR_2, m[p + 2], m[p + 3], t, phases)
    return x_a, v_a, x_b, v_b


def free_parts_near_node(m, node, t):  # inline
    """Return both free parts at a time ``t`` from a node, at most half a spacing."""
    decay = small_decay(m[oscillator_of_part_a(m) + at.DAMPING] * t)
    if m[at.MODE] != at.FLIGHT:
        x_a, v_a = free_part_near_node(m, at.OSCILLATOR_3, node, t, decay)
        return x_a, v_a, 0.0, 0.0
    decay_b = decay
    if m[at.OSCILLATOR_1 + at.DAMPING] != m[at.OSCILLATOR_2 + at.DAMPING]:  # rarely
        decay_b = small_decay(m[at.OSCILLATOR_2 + at.DAMPING] * t)
    x_a, v_a = free_part_near_node(m, at.OSCILLATOR_1, node, t, decay)
    x_b, v_b = free_part_near_node(m, at.OSCILLATOR_2, node + 2, t, decay_b)
    return x_a, v_a, x_b, v_b


def free_part_near_node(m, b, free, t, decay):  # inline
    """Return a free part a time ``t`` from its node, in which it decays by ``e^{-D t}``."""
    x, v = m[free], m[free + 1]
    cosine, sine = cosine_and_sinc(m[b + at.NU_SQUARED] * t * t)
    C, S = decay * cosine, decay * sine * t
    damped = m[b + at.DAMPING] * S
    return (C + damped) * x + S * v, (C - damped) * v - m[b + at.OMEGA_SQUARED] * S * x
