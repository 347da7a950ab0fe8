"""The states and their sequence (1): flight, permanent contact, glued.

A state begins with its initial conditions (9), from which its closed form and its event function
follow; it ends at the event function's first root, found once and kept. Communication points only
look at it. Which state follows is decided on the boundary by the gap, then its velocity, then the
first derivative that does not vanish.

With a clearance each state has its own origin of displacements, in which its equations have no
constant: a flight by the closed form the unloaded positions, all else the positions in which the
masses rest together. So neither a small motion in a wide gap nor one under a large preload loses
digits.
"""

from ..numerics.elementary import fraction_of_turn, sincos_turns
from ..numerics.first_root import INFINITE, clear_step_or_root
from . import memory as at
from .contact import first_nonzero_force_derivative, gap_acceleration
from .event_function import (
    begin_nodes,
    evaluate_event_function,
    event_derivative_bounds,
    event_rounding,
    is_event_function_constant,
    set_contact_event_function,
    set_flight_event_function,
    write_event_values,
)
from .excitation import (
    cubic_drive_derivatives,
    harmonic_drive_and_rate,
    mirror_system,
    set_cubic_response,
)
from .impact import (
    chattering_ends,
    common_velocity,
    record_impact,
    restitution_coefficient,
    velocities_after_impact,
)
from .nodes import BLOCK, phasors_at
from .response import displacement_and_velocity, set_free_part
from .roots import move_clear_from_node, root_accuracy, take_step
from .series import required_series_order, set_series, short_flight_duration, taylor_value

BRIEF = 1e-6  # of a radian of the fastest change: four terms of a Taylor series are exact
NARROWEST = 1e-6  # rounding of the gap, of the stroke: displacements of 1e8 strokes
FAINTEST = 2e-292  # m, about 2 to the -969: the last digits of less are below the normal numbers


def state_at(m, tau):
    """Return x1, v1, x2, v2 ``tau`` after the state's start, (10): m, and m per unit of tau."""
    if tau == 0.0:  # rarely
        # exactly what the state began with: a start from rest is at rest
        return m[at.BEGIN], m[at.BEGIN + 1], m[at.BEGIN + 2], m[at.BEGIN + 3]
    if m[at.SERIES] != 0.0:
        x1, v1 = taylor_value(m, at.SERIES_X, tau), taylor_value(m, at.SERIES_X + 2, tau)
        gap, slope = taylor_value(m, at.SERIES_GAP, tau), taylor_value(m, at.SERIES_GAP + 2, tau)
        return x1, v1, x1 + gap if gap > 0.0 else x1, v1 + slope
    x_a, v_a, x_b, v_b, cosine, sine = phasors_at(m, tau)
    return state_from_phasors(m, tau, x_a, v_a, x_b, v_b, cosine, sine)


def state_at_end(m):
    if m[at.MODE] == at.CONTACT and m[at.END] * m[at.RATE] < BRIEF:  # rarely
        x, v = state_after_brief_contact(m, m[at.END])
        return x, v, x, v
    if m[at.AT_END_NODE] == 0.0:
        return state_at(m, m[at.END])
    p = at.AT_END
    return state_from_phasors(m, m[at.END], m[p], m[p + 1], m[p + 2], m[p + 3], m[p + 4], m[p + 5])


def state_after_brief_contact(m, tau):
    """Return the motion just after contact by Taylor: the closed form rounds it away."""
    twice, square = 2.0 * m[at.OSCILLATOR_3 + at.DAMPING], m[at.OSCILLATOR_3 + at.OMEGA_SQUARED]
    drive, rate = harmonic_drive_and_rate(m, at.OSCILLATOR_3, m[at.COSINE], m[at.SINE])
    cubic = cubic_drive_derivatives(m, at.OSCILLATOR_3, 0.0)
    x, v = m[at.BEGIN], m[at.BEGIN + 1]
    x2 = (drive + cubic[0]) - (twice * v + square * x)
    x3 = (rate + cubic[1]) - (twice * x2 + square * v)
    x4 = (cubic[2] - m[at.ETA] * m[at.ETA] * drive) - (twice * x3 + square * x2)
    way = tau * (v + tau * (0.5 * x2 + tau * (x3 * (1.0 / 6.0) + tau * x4 * (1.0 / 24.0))))
    return x + way, v + tau * (x2 + tau * (0.5 * x3 + tau * x4 * (1.0 / 6.0)))


def state_from_phasors(m, tau, x_a, v_a, x_b, v_b, cosine, sine):  # inline
    if m[at.MODE] == at.FLIGHT:
        x1, v1 = displacement_and_velocity(
            m, at.HARMONIC_1, at.CUBIC_A, tau, x_a, v_a, sine, cosine
        )
        x2, v2 = displacement_and_velocity(
            m, at.HARMONIC_2, at.CUBIC_B, tau, x_b, v_b, sine, cosine
        )
        if x2 < x1 and m[at.GAP_OFFSET] == 0.0:  # by rounding, at the very end of a flight
            x1 = x2 = common_position(m, x1, x2)
        return x1, v1, x2, v2
    x3, v3 = displacement_and_velocity(m, at.HARMONIC_3, at.CUBIC_A, tau, x_a, v_a, sine, cosine)
    return x3, v3, x3, v3


def counts_from_unloaded_positions(m):  # inline
    """Return whether displacements count from unloaded positions, not from rest together."""
    return m[at.MODE] == at.FLIGHT and m[at.SERIES] == 0.0


def gap_between(m, tau, x1, x2):  # inline
    """Return the gap between the displacements of :func:`state_at`, >= 0."""
    gap = x2 - x1
    if m[at.GAP_OFFSET] != 0.0 and counts_from_unloaded_positions(m):  # rarely
        gap = m[at.BEGIN_GAP] if tau == 0.0 else gap + m[at.GAP_OFFSET]
        gap = gap if gap > 0.0 else 0.0
    return gap


def motion_as_importer_sees(m, x1, v1, x2, v2, gap):
    """Convert a motion to what an importer sees: mirrored back, inside wall and stroke."""
    if m[at.WALL] != 0.0:
        x2, v2 = 0.0, 0.0
    gap = min(gap, m[at.LIMIT])
    if m[at.SIDE] < 0.0:
        return 0.0 - x1, 0.0 - v1, 0.0 - x2, 0.0 - v2, m[at.LIMIT] - gap
    return x1, v1, x2, v2, gap


def displacements_from_unloaded(m, x1, x2):  # inline
    if m[at.GAP_OFFSET] != 0.0 and not counts_from_unloaded_positions(m):  # rarely
        x1, x2 = x1 + m[at.REST_1], x2 + m[at.REST_2]
    return x1, x2


def displacements_from_rest_together(m, x1, x2):
    if m[at.GAP_OFFSET] != 0.0 and counts_from_unloaded_positions(m):  # rarely
        x1, x2 = x1 - m[at.REST_1], x2 - m[at.REST_2]
    return x1, x2


def state_and_phase_at(m, tau):  # inline
    if tau != 0.0 and m[at.SERIES] == 0.0 and m[at.NODE_ETA] != 0.0:
        x_a, v_a, x_b, v_b, cosine, sine = phasors_at(m, tau)
        x1, v1, x2, v2 = state_from_phasors(m, tau, x_a, v_a, x_b, v_b, cosine, sine)
        return x1, v1, x2, v2, cosine, sine
    x1, v1, x2, v2 = state_at(m, tau)
    cosine, sine = m[at.COSINE], m[at.SINE]
    if tau != 0.0 and m[at.NODE_ETA] != 0.0:
        sine, cosine = sincos_turns(m[at.TURN] + m[at.ETA_TURNS] * tau)
    return x1, v1, x2, v2, cosine, sine


def touching_displacement(m, x):
    """Return the displacement of both masses where they touch: 0 for a wall."""
    return x if m[at.WALL] == 0.0 else 0.0


def side_number(m):
    return 1.5 - 0.5 * m[at.SIDE]


def common_position(m, x1, x2):
    """Return the centre of mass, where an impact puts both masses: they differ by rounding."""
    return (x1 + m[at.MU] * x2) * m[at.SHARE]


def move_origin(m, tau):
    """Move the origin of time by ``tau``, (5), without losing digits over millions of states."""
    advance_origin(m, tau)
    set_phase(m, m[at.TURN] + m[at.ETA_TURNS] * tau)


def advance_origin(m, tau):
    total = m[at.ORIGIN] + tau
    part = total - m[at.ORIGIN]
    error = (m[at.ORIGIN] - (total - part)) + (tau - part)
    low = m[at.ORIGIN_LOW] + error
    m[at.ORIGIN] = total + low
    m[at.ORIGIN_LOW] = low - (m[at.ORIGIN] - total)
    m[at.CUBIC + at.AGE] += tau
    if m[at.UNEQUAL] != 0.0:  # rarely
        m[at.CUBIC_1 + at.AGE] += tau
        m[at.CUBIC_2 + at.AGE] += tau


def move_origin_to_end(m):
    """Move the origin to the state's end; rotate the phase, recompute it after a block."""
    turns = m[at.ROTATIONS] + m[at.AT_END_NODE] + 1.0
    if m[at.AT_END_NODE] == 0.0 or m[at.NODE_ETA] == 0.0 or turns > BLOCK:
        m[at.ROTATIONS] = 0.0
        move_origin(m, m[at.END])
        return
    m[at.ROTATIONS] = turns
    advance_origin(m, m[at.END])
    m[at.TURN] = fraction_of_turn(m[at.TURN] + m[at.ETA_TURNS] * m[at.END])
    m[at.COSINE] = m[at.AT_END + 4]
    m[at.SINE] = m[at.AT_END + 5]


def set_phase(m, turns):
    m[at.TURN] = fraction_of_turn(turns)
    sine, cosine = sincos_turns(m[at.TURN])
    m[at.SINE] = sine
    m[at.COSINE] = cosine


def begin_state(m, x1, v1, x2, v2, gap, lowest):
    """Begin the state that follows; ``lowest`` is 1 at a release, where f is known to vanish."""
    if m[at.MODE] == at.GLUED:  # rarely
        begin_contact_or_glued(m, at.GLUED, x1, v1)
        m[at.CLEAR] = INFINITE
        return
    if gap > 0.0:
        begin_flight(m, x1, v1, x2, v2, gap)
        return
    x = common_position(m, x1, x2) if x2 < x1 else touching_displacement(m, x1)
    begin_touching_state(m, x, v1, v2, lowest)


def begin_touching_state(m, x, v1, v2, lowest):
    """Begin the state that follows a touch at ``x`` from where the masses rest together."""
    if v1 > v2:
        v1, v2 = record_impact_and_collide(m, x, v1, v2)
    if v2 > v1:  # usually
        begin_after_impact(m, x, v1, v2)
        return
    order, value = first_nonzero_force_derivative(m, x, v1, lowest)
    if value > 0.0:
        x1, x2 = displacements_of_touching_faces(m, x)
        begin_flight(m, x1, v1, x2, v1, 0.0)
        leave_boundary(m, order + 2, value)
        return
    if m[at.MODE] == at.FLIGHT:
        m[at.CONTACT_COUNT] += 1.0
    begin_contact_or_glued(m, at.CONTACT, x, v1)
    leave_boundary(m, order, -value)


def record_impact_and_collide(m, x, v1, v2):
    """Count an impact and return the velocities after it, both the same where chattering ends."""
    closing = v1 - v2
    m[at.IMPACT_SIDE] = side_number(m)
    common = common_velocity(m, v1, v2)
    time = m[at.START_TIME] + (m[at.ORIGIN] + m[at.ORIGIN_LOW]) / m[at.OMEGA]
    e = restitution_coefficient(m, closing)
    sticks = chattering_ends(m, e * closing, gap_acceleration_at_start(m, x, common))
    record_impact(m, time, closing, e, sticks)
    return (common, common) if sticks else velocities_after_impact(m, v1, v2, e)


def gap_acceleration_at_start(m, x, v):  # inline
    return gap_acceleration(m, x, v, m[at.COSINE], m[at.SINE], 0.0)


def displacements_of_touching_faces(m, x):
    if m[at.GAP_OFFSET] != 0.0:  # rarely
        return x + m[at.REST_1], x + m[at.REST_2]
    return x, x


def begin_flight(m, x1, v1, x2, v2, gap):
    set_flight(m, x1, v1, x2, v2, gap)
    slope = v2 - v1
    m[at.LEFT_VALUES] = gap
    m[at.LEFT_VALUES + 1] = slope
    x = x1 if m[at.GAP_OFFSET] == 0.0 else x1 - m[at.REST_1]
    m[at.LEFT_VALUES + 2] = (
        gap_acceleration_at_start(m, x, v1)
        - 2.0 * m[at.OSCILLATOR_2 + at.DAMPING] * slope
        - m[at.OSCILLATOR_2 + at.OMEGA_SQUARED] * gap
    )


def set_flight(m, x1, v1, x2, v2, gap):
    """Begin a flight from unloaded positions; its event function is the gap."""
    m[at.MODE] = at.FLIGHT
    sine, cosine = m[at.SINE], m[at.COSINE]
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        set_cubic_response(m, at.OSCILLATOR_1, at.CUBIC_A)
        set_cubic_response(m, at.OSCILLATOR_2, at.CUBIC_B)
    set_free_part(m, at.HARMONIC_1, at.FREE_A, at.CUBIC_A, x1, v1, sine, cosine)
    set_free_part(m, at.HARMONIC_2, at.FREE_B, at.CUBIC_B, x2, v2, sine, cosine)
    set_flight_event_function(m)
    if m[at.LIMIT] < INFINITE and event_rounding(m, 0.0) > NARROWEST * m[at.LIMIT]:  # rarely
        m[at.NARROW] = 1.0
    set_initial_conditions(m, x1, v1, x2, v2, gap)
    begin_nodes(m)
    if is_event_function_constant(m):  # rarely
        m[at.CLEAR] = INFINITE


def begin_contact_or_glued(m, mode, x, v):
    """Begin permanent contact or the glued state; the event function is -f of (18)."""
    m[at.MODE] = mode
    sine, cosine = m[at.SINE], m[at.COSINE]
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        set_cubic_response(m, at.OSCILLATOR_3, at.CUBIC_A)
    set_free_part(m, at.HARMONIC_3, at.FREE_A, at.CUBIC_A, x, v, sine, cosine)
    set_contact_event_function(m)
    set_initial_conditions(m, x, v, x, v, 0.0)
    begin_nodes(m)
    write_event_values(m, at.LEFT_VALUES, at.LEFT, 0.0)
    if is_event_function_constant(m):  # rarely
        m[at.CLEAR] = INFINITE


def set_initial_conditions(m, x1, v1, x2, v2, gap):
    """Set a new state's initial conditions; its end is not known yet."""
    m[at.SERIES] = 0.0
    m[at.AT_END_NODE] = 0.0
    m[at.BEGIN] = x1
    m[at.BEGIN + 1] = v1
    m[at.BEGIN + 2] = x2
    m[at.BEGIN + 3] = v2
    m[at.BEGIN_GAP] = gap
    m[at.CLEAR] = 0.0
    m[at.END] = INFINITE
    m[at.END_KIND] = at.END_OPEN


def begin_after_impact(m, x, v1, v2):
    """Begin the flight after an impact; a short flight's end is computed at once."""
    slope = v2 - v1
    curvature = gap_acceleration_at_start(m, x, v1)
    curvature -= 2.0 * m[at.OSCILLATOR_2 + at.DAMPING] * slope
    order = required_series_order(m, slope, curvature)
    if order > 4:
        set_series(m, x, v1, slope, order)
        duration = short_flight_duration(m, order)
        if duration > 0.0 and slope * duration < m[at.LIMIT]:
            m[at.MODE] = at.FLIGHT
            set_initial_conditions(m, x, v1, x, v2, 0.0)
            m[at.SERIES] = order
            m[at.CLEAR] = duration
            m[at.END] = duration
            m[at.END_KIND] = at.END_EVENT
            return
    x1, x2 = displacements_of_touching_faces(m, x)
    set_flight(m, x1, v1, x2, v2, 0.0)
    if not skip_clear_start(m, slope, curvature):  # rarely
        set_series(m, x, v1, slope, 8)
        take_first_step(m, slope, curvature, m[at.SERIES_GAP + 6], m[at.SERIES_GAP + 8])


def skip_clear_start(m, h1, h2):
    """Move CLEAR past the part without root of an interval that starts on the boundary, if any."""
    m[at.LEFT_VALUES] = 0.0
    m[at.LEFT_VALUES + 1] = h1
    m[at.LEFT_VALUES + 2] = h2
    return move_clear_from_node(m)


def take_first_step(m, h1, h2, h3, h4):
    """Take one certified step from a start on the boundary, or find the root."""
    _, _, _, _, _, bound = evaluate_event_function(m, 0.0)
    reach = m[at.RIGHT_AGE]
    step, found = clear_step_or_root(0.0, h1, h2, h3, h4, bound, 0.0, reach, root_accuracy(m, 0.0))
    take_step(m, 0.0, reach, step, found, (0.0, h1, h2, h3, h4, bound))


def leave_boundary(m, order, value):
    """Leave the boundary; ``order``, ``value``: first derivative that is not 0, (-1: none)."""
    if order == 0:
        return
    if order < 0:
        m[at.CLEAR] = INFINITE
        return
    _, _, h2, h3, h4, _ = evaluate_event_function(m, 0.0)
    if order <= 2:
        h1, h2 = (value, h2) if order == 1 else (0.0, value)
        if not skip_clear_start(m, h1, h2):
            take_first_step(m, h1, h2, h3, h4)
        return
    bound = event_derivative_bound(m, order + 1)
    # value s^k/k! - bound s^(k+1)/(k+1)! > 0 for s < (k+1) value/bound; half of it, to be clear of
    # zero
    step = 0.5 * (order + 1) * value / bound if bound > 0.0 else INFINITE
    step = min(step, m[at.RIGHT_AGE])
    while m[at.MODE] == at.FLIGHT and bound_after_step(step, order, value) >= m[at.LIMIT]:  # rarely
        step *= 0.5
    m[at.CLEAR] = step


def bound_after_step(step, order, value):
    """Return a bound of a function after a step, its derivative adding half at most."""
    size = 1.5 * value
    for k in range(order):
        size *= step / (k + 1.0)
    return size


def event_derivative_bound(m, order):
    """Return a bound of the event function's derivative of an order over the whole state."""
    steady, a, b = event_derivative_bounds(m, order)
    return steady + a + b


def end_state(m):
    m[at.WORK] += 1.0
    x1, v1, x2, v2 = state_at_end(m)
    event = m[at.END_KIND] != at.END_RENEWAL
    gap = gap_between(m, m[at.END], x1, x2)
    flight = m[at.MODE] == at.FLIGHT
    if m[at.END_KIND] == at.END_OTHER:  # rarely
        mirror_system(m)
        x1, v1, x2, v2 = -x1, -v1, -x2, -v2
    if has_died_away(m, x1, v1, x2, v2):  # rarely
        x1 = v1 = x2 = v2 = 0.0
        gap = max(m[at.GAP_OFFSET], 0.0)
    elif event and flight:  # usually
        x1, x2 = displacements_from_rest_together(m, x1, x2)
        move_origin_to_end(m)
        begin_touching_state(m, touching_displacement(m, common_position(m, x1, x2)), v1, v2, 0)
        return
    elif gap <= 0.0:
        x1, x2 = displacements_from_rest_together(m, x1, x2)
    move_origin_to_end(m)
    begin_state(m, x1, v1, x2, v2, gap, 1 if event and not flight else 0)


def has_died_away(m, x1, v1, x2, v2):
    """Return whether a motion that nothing drives is too small for its digits: it is at rest then.

    An undriven motion may decay for ever. Among the subnormal numbers no walk would end: what
    rounding takes there is as large as the motion.
    """
    if m[at.SHAKEN] != 0.0 or m[at.CUBIC_PRESENT] != 0.0:
        return False
    if m[at.GAP_OFFSET] > FAINTEST and not counts_from_unloaded_positions(m):
        return False  # together, but not at rest
    return max(abs(x1), abs(v1)) < FAINTEST and max(abs(x2), abs(v2)) < FAINTEST
