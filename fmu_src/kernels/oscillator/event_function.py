"""The event function of a state: positive inside it, its first root is the state's end.

In flight it is the gap ``xi_2 - xi_1`` (13), in permanent contact minus the contact force ``-f``
(19). Both are one kind of signal, a harmonic, a cubic and up to two decaying free parts, and so is
each derivative: written so, one root finder serves both, and every derivative is bounded in closed
form for all later times. A clearance adds a constant to the signal, none to its derivatives.
"""

from ..numerics.first_root import INFINITE
from . import memory as at
from .excitation import cubic_drive_derivatives
from .nodes import (
    free_part_higher_derivatives,
    max_nodes,
    oscillator_of_part_a,
    phasors_at,
    start_nodes,
    write_phasors,
)
from .parameters import are_halves_nearly_equal
from .secular import (
    driven_derivative_bound,
    driven_event_bound,
    event_drive,
    event_drive_bound,
    set_event_drive,
)
from .series import gap_and_derivatives

AHEAD = 5.0  # spacings from an evaluation on for which its bound holds


def set_flight_event_function(m):
    m[at.EVENT_OFFSET] = m[at.GAP_OFFSET]
    for i in range(2):
        m[at.EVENT_HARMONIC + i] = m[at.HARMONIC_2 + i] - m[at.HARMONIC_1 + i]
        m[at.EVENT_FREE_A + i] = -m[at.FREE_A + i]
        m[at.EVENT_FREE_B + i] = m[at.FREE_B + i]
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        for i in range(4):
            m[at.EVENT_CUBIC + i] = m[at.CUBIC_B + i] - m[at.CUBIC_A + i]
    if m[at.SECULAR] != 0.0:  # rarely
        set_event_drive(m)


def set_contact_event_function(m):
    """Set the event function of contact, -f (18)."""
    m[at.EVENT_OFFSET] = -m[at.PRELOAD]
    p, q = -m[at.FORCE_V], -m[at.FORCE_X]
    h_cos, h_sin, eta = m[at.HARMONIC_3], m[at.HARMONIC_3 + 1], m[at.ETA]
    m[at.EVENT_HARMONIC] = (p * eta * h_sin + q * h_cos) - m[at.GAP + at.DRIVE]
    m[at.EVENT_HARMONIC + 1] = (q * h_sin - p * eta * h_cos) - m[at.GAP + at.DRIVE + 1]
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        for i in range(3):
            m[at.EVENT_CUBIC + i] = p * m[at.CUBIC_A + i + 1] + q * m[at.CUBIC_A + i]
        m[at.EVENT_CUBIC + 3] = q * m[at.CUBIC_A + 3]
        if m[at.UNEQUAL] != 0.0:  # rarely
            g0, g1, g2, g3 = cubic_drive_derivatives(m, at.GAP, 0.0)
            m[at.EVENT_CUBIC] -= g0
            m[at.EVENT_CUBIC + 1] -= g1
            m[at.EVENT_CUBIC + 2] -= g2
            m[at.EVENT_CUBIC + 3] -= g3
    x, v = force_phasor(m, m[at.FREE_A], m[at.FREE_A + 1])
    m[at.EVENT_FREE_A] = x
    m[at.EVENT_FREE_A + 1] = v
    m[at.EVENT_FREE_B] = 0.0
    m[at.EVENT_FREE_B + 1] = 0.0
    if m[at.SECULAR] != 0.0:  # rarely
        set_event_drive(m)


def is_event_function_constant(m):
    """Return whether the event function is a constant > 0: at rest, or two oscillators alike."""
    if m[at.EVENT_OFFSET] <= 0.0 or m[at.SECULAR] != 0.0:
        return False
    size = abs(m[at.EVENT_HARMONIC]) + abs(m[at.EVENT_HARMONIC + 1])
    for i in range(2):
        size += abs(m[at.EVENT_FREE_A + i]) + abs(m[at.EVENT_FREE_B + i])
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        for i in range(4):
            size += abs(m[at.EVENT_CUBIC + i])
    return size == 0.0


def force_phasor(m, x, v):
    """Return the free part of -f (18), value and derivative, from that of the displacement."""
    p, q = -m[at.FORCE_V], -m[at.FORCE_X]
    return p * v + q * x, p * free_acceleration(m, at.OSCILLATOR_3, x, v) + q * v


def free_acceleration(m, b, x, v):
    return -(2.0 * m[b + at.DAMPING] * v + m[b + at.OMEGA_SQUARED] * x)


def event_derivative_bounds(m, order):
    """Return bounds of a derivative (order >= 4) from now on: steady part, free A and B."""
    steady = abs(m[at.EVENT_HARMONIC]) + abs(m[at.EVENT_HARMONIC + 1])
    for _ in range(order):
        steady *= m[at.ETA]
    if m[at.SECULAR] != 0.0:  # rarely
        steady += driven_event_bound(m, order, max_nodes(m) * m[at.SPACING])
    a = free_part_bound(m, oscillator_of_part_a(m), at.EVENT_FREE_A, order)
    b = (
        free_part_bound(m, at.OSCILLATOR_2, at.EVENT_FREE_B, order)
        if m[at.MODE] == at.FLIGHT
        else 0.0
    )
    return steady, a, b


def free_part_bound(m, b, free, order):
    """Return a bound of a free part's derivative of an order, from the state's start on."""
    x, v = m[free], m[free + 1]
    for _ in range(order):
        x, v = v, free_acceleration(m, b, x, v)
    return envelope_bound(m, b, x, v)


def envelope_bound(m, b, x, v):
    """Return a bound of a free part from the present values ``x``, ``v`` on."""
    return abs(x) + m[b + at.ENVELOPE_SINE] * abs(v + m[b + at.DAMPING] * x)


def begin_nodes(m):
    start_nodes(m)
    write_event_values(m, at.RIGHT_VALUES, at.RIGHT, m[at.RIGHT_AGE])
    set_remainder(m)


def write_event_values(m, slot, node, tau):
    """Write the event function and two derivatives at a node to ``slot`` and the two after it."""
    h0, h1, h2 = event_values(
        m, False, m[node], m[node + 1], m[node + 2], m[node + 3], m[node + 4], m[node + 5], tau
    )
    m[slot] = h0
    m[slot + 1] = h1
    m[slot + 2] = h2


def set_remainder(m):
    """Set how far the quintic between two nodes may be wrong until the state is rewritten."""
    steady = abs(m[at.EVENT_HARMONIC]) + abs(m[at.EVENT_HARMONIC + 1])
    square = m[at.NODE_ETA] * m[at.NODE_ETA]
    bound = steady * (square * square * square)
    time = max_nodes(m) * m[at.SPACING]
    driven = 0.0
    if m[at.SECULAR] != 0.0:  # rarely
        driven = driven_event_bound(m, 6, time)
    x, v = m[at.LEFT], m[at.LEFT + 1]
    if m[at.MODE] == at.FLIGHT:
        x_b, v_b = m[at.LEFT + 2], m[at.LEFT + 3]
        apart = (
            bound
            + sixth_derivative_bound(m, at.OSCILLATOR_2, x_b, v_b)
            + sixth_derivative_bound(m, at.OSCILLATOR_1, x, v)
        )
        apart += driven
        if are_halves_nearly_equal(m):  # rarely
            apart = min(apart, bound + free_difference_bound(m, 6, x, v, x_b, v_b, time))
        bound = apart
    else:
        x, v = force_phasor(m, x, v)
        bound += sixth_derivative_bound(m, at.OSCILLATOR_3, x, v) + driven
    remainder = bound * m[at.HERMITE + 2]
    m[at.REMAINDER] = remainder if remainder < INFINITE else INFINITE


def sixth_derivative_bound(m, b, x, v):
    """Return a bound of the sixth derivative of a free part from now on."""
    sixth = b + at.SIXTH
    return envelope_bound(
        m, b, m[sixth] * x + m[sixth + 1] * v, m[sixth + 2] * x + m[sixth + 3] * v
    )


def free_difference_bound(m, order, x, v, x_b, v_b, time):
    """Return a bound of a derivative of both free parts' difference, for a ``time`` from now on.

    Each derivative of ``xi_2 - xi_1`` moves as oscillator 2, driven by what differs, ``2 (D_1 -
    D_2) xi_1' + (omega_1^2 - omega_2^2) xi_1`` and the drives; where both move nearly as one, the
    sum of both bounds is far above it.
    """
    for _ in range(order):
        x, v = v, free_acceleration(m, at.OSCILLATOR_1, x, v)
        x_b, v_b = v_b, free_acceleration(m, at.OSCILLATOR_2, x_b, v_b)
    size = envelope_bound(m, at.OSCILLATOR_1, x, v)
    change = envelope_bound(m, at.OSCILLATOR_1, v, free_acceleration(m, at.OSCILLATOR_1, x, v))
    own = envelope_bound(m, at.OSCILLATOR_2, x_b - x, v_b - v)
    if m[at.SECULAR] != 0.0:  # rarely
        size += driven_derivative_bound(m, at.OSCILLATOR_1, order, time)
        change += driven_derivative_bound(m, at.OSCILLATOR_1, order + 1, time)
        damped = m[at.OSCILLATOR_2 + at.DAMPING] * event_drive_bound(m, order)
        sine = m[at.OSCILLATOR_2 + at.ENVELOPE_SINE] * (event_drive_bound(m, order + 1) + damped)
        own += event_drive_bound(m, order) + sine
    drive = abs(m[at.FORCE_V]) * change + abs(m[at.FORCE_X]) * size
    if m[at.SECULAR] != 0.0 and m[at.UNEQUAL] != 0.0:  # rarely
        apart = abs(m[at.GAP + at.DRIVE]) + abs(m[at.GAP + at.DRIVE + 1])
        for _ in range(order):
            apart *= m[at.ETA]
        drive += apart
    return own + m[at.OSCILLATOR_2 + at.ENVELOPE_SINE] * time * drive + 4e-15 * size


def event_values(m, is_plain, x, v, x_b, v_b, cosine, sine, tau):  # inline
    """Return the event function and two derivatives from all phasors."""
    if is_plain or m[at.MODE] == at.FLIGHT:
        h0, h1 = x_b - x, v_b - v
        h2 = free_acceleration(m, at.OSCILLATOR_2, x_b, v_b) - free_acceleration(
            m, at.OSCILLATOR_1, x, v
        )
    else:
        h0, h1 = force_phasor(m, x, v)
        h2 = free_acceleration(m, at.OSCILLATOR_3, h0, h1)
    if not is_plain and m[at.SECULAR] != 0.0:  # rarely
        h1 += event_drive(m, 1, cosine, sine)
        h2 += event_drive(m, 2, cosine, sine)
    eta = m[at.NODE_ETA]
    u = m[at.EVENT_HARMONIC] * cosine + m[at.EVENT_HARMONIC + 1] * sine
    h0 += u
    h1 += eta * (m[at.EVENT_HARMONIC + 1] * cosine - m[at.EVENT_HARMONIC] * sine)
    h2 -= eta * eta * u
    if m[at.EVENT_OFFSET] != 0.0:  # rarely
        h0 += m[at.EVENT_OFFSET]
    if not is_plain and m[at.CUBIC_PRESENT] != 0.0:  # rarely
        q0, q1, q2 = event_cubic_values(m, tau)
        h0, h1, h2 = h0 + q0, h1 + q1, h2 + q2
    return h0, h1, h2


def event_cubic_values(m, tau):
    """Return the event function's cubic and two derivatives at ``tau``."""
    q1, q2, q3 = m[at.EVENT_CUBIC + 1], m[at.EVENT_CUBIC + 2], m[at.EVENT_CUBIC + 3]
    value = m[at.EVENT_CUBIC] + tau * (q1 + 0.5 * tau * (q2 + tau * q3 * (1.0 / 3.0)))
    return value, q1 + tau * (q2 + 0.5 * tau * q3), q2 + tau * q3


def free_part_derivatives(m, b, x, v):
    """Return a free part, its first four derivatives and a bound of the fifth from now on."""
    x2, x3, x4, x5, x6 = free_part_higher_derivatives(m, b, x, v)
    return x, v, x2, x3, x4, envelope_bound(m, b, x5, x6)


def evaluate_event_function(m, tau):  # inline
    """Evaluate at ``tau``: value, four derivatives, a bound of the fifth for AHEAD spacings."""
    m[at.WORK] += 1.0
    if m[at.SERIES] != 0.0:  # rarely
        h0, h1, h2, h3, h4 = gap_and_derivatives(m, tau)
        return h0, h1, h2, h3, h4, m[at.SERIES_BOUND]
    x, v, x_b, v_b, cosine, sine = phasors_at(m, tau)
    write_phasors(m, at.POINT, x, v, x_b, v_b, cosine, sine)
    time = AHEAD * m[at.SPACING]
    driven = 0.0
    if m[at.SECULAR] != 0.0:  # rarely
        driven = driven_event_bound(m, 5, time)
    if m[at.MODE] == at.FLIGHT:
        a0, a1, a2, a3, a4, bound_a = free_part_derivatives(m, at.OSCILLATOR_1, x, v)
        h0, h1, h2, h3, h4, bound = free_part_derivatives(m, at.OSCILLATOR_2, x_b, v_b)
        h0, h1, h2, h3, h4, bound = h0 - a0, h1 - a1, h2 - a2, h3 - a3, h4 - a4, bound + bound_a
        bound += driven
        if are_halves_nearly_equal(m):  # rarely
            bound = min(bound, free_difference_bound(m, 5, x, v, x_b, v_b, time))
    else:
        x, v = force_phasor(m, x, v)
        h0, h1, h2, h3, h4, bound = free_part_derivatives(m, at.OSCILLATOR_3, x, v)
        bound += driven
    if m[at.SECULAR] != 0.0:  # rarely
        h1 += event_drive(m, 1, cosine, sine)
        h2 += event_drive(m, 2, cosine, sine)
        h3 += event_drive(m, 3, cosine, sine)
        h4 += event_drive(m, 4, cosine, sine)
    if m[at.SHAKEN] != 0.0:  # usually
        eta = m[at.NODE_ETA]
        square = eta * eta
        h_cos, h_sin = m[at.EVENT_HARMONIC], m[at.EVENT_HARMONIC + 1]
        u0 = h_cos * cosine + h_sin * sine
        u1 = eta * (h_sin * cosine - h_cos * sine)
        u2 = square * u0
        h0, h1, h2, h3, h4 = h0 + u0, h1 + u1, h2 - u2, h3 - square * u1, h4 + square * u2
        bound += (abs(h_cos) + abs(h_sin)) * (square * square * eta)
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        q0, q1, q2 = event_cubic_values(m, tau)
        h0, h1, h2, h3 = h0 + q0, h1 + q1, h2 + q2, h3 + m[at.EVENT_CUBIC + 3]
    if m[at.EVENT_OFFSET] != 0.0:  # rarely
        h0 += m[at.EVENT_OFFSET]
    return h0, h1, h2, h3, h4, bound


def event_rounding(m, tau):
    """Return a bound of the rounding error of the event function at ``tau``."""
    size = abs(m[at.EVENT_HARMONIC]) + abs(m[at.EVENT_HARMONIC + 1]) + abs(m[at.EVENT_OFFSET])
    size += free_part_bound(m, oscillator_of_part_a(m), at.EVENT_FREE_A, 0) + free_part_bound(
        m, at.OSCILLATOR_2, at.EVENT_FREE_B, 0
    )
    if m[at.SECULAR] != 0.0:  # rarely
        size += driven_event_bound(m, 0, tau)
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        power = 1.0
        for i in range(4):
            size += abs(m[at.EVENT_CUBIC + i]) * power
            power *= tau
    return 4e-15 * size
