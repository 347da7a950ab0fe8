"""Displacement and acceleration of one mass, derivatives and a bound: what their maxima need.

The derivatives follow from displacement and velocity by the equation of motion (6), whatever the
state; the fifth is bounded by the free part's envelope and the forced amplitudes. The acceleration
is the absolute one, as an accelerometer on the mass reads it between impacts: relative to the box
less the box's forcing, ``-2 D xi' - omega^2 xi`` and what a force adds.
"""

from . import memory as at
from .event_function import AHEAD, envelope_bound
from .excitation import cubic_drive_derivatives, harmonic_drive_and_rate
from .motion import displacements_from_unloaded, state_and_phase_at
from .nodes import free_part_higher_derivatives
from .response import displacement_and_velocity
from .secular import driven_derivative_bound


def evaluate_motion_signal(m, slot, sign, tau):
    """Evaluate the signal of a maximum's slot: value, four derivatives, bound of the fifth."""
    m[at.WORK] += 1.0
    second = slot == at.X2_MAX or slot == at.A2_MAX
    b, harmonic, cubic = at.OSCILLATOR_3, at.HARMONIC_3, at.CUBIC_A
    if m[at.MODE] == at.FLIGHT:
        b, harmonic, cubic = at.OSCILLATOR_1, at.HARMONIC_1, at.CUBIC_A
        if second:
            b, harmonic, cubic = at.OSCILLATOR_2, at.HARMONIC_2, at.CUBIC_B
    x1, v1, x2, v2, cosine, sine = state_and_phase_at(m, tau)
    place_1, place_2 = displacements_from_unloaded(m, x1, x2)
    x, v, place = x1, v1, place_1
    if second:
        x, v, place = x2, v2, place_2
    if m[at.MODE] == at.FLIGHT:
        x = place
    twice, square = 2.0 * m[b + at.DAMPING], m[b + at.OMEGA_SQUARED]
    f0, f1, f2, f3 = forcing_derivatives(m, b, tau, cosine, sine)
    h2 = f0 - (twice * v + square * x)
    h3 = f1 - (twice * h2 + square * v)
    h4 = f2 - (twice * h3 + square * h2)
    fifth, sixth = later_derivative_bounds(m, b, harmonic, cubic, tau, x, v, cosine, sine)
    if slot < at.A1_MAX:
        return sign * place, sign * v, sign * h2, sign * h3, sign * h4, fifth
    h5 = f3 - (twice * h4 + square * h3)
    unit = -sign * m[at.OMEGA] * m[at.OMEGA]
    if m[at.UNEQUAL] != 0.0:  # rarely
        later = twice * sixth + square * fifth
        return absolute_acceleration_derivatives(
            m, b, unit, tau, cosine, sine, (h2, h3, h4, h5), later
        )
    return (
        unit * (twice * v + square * x),
        unit * (twice * h2 + square * v),
        unit * (twice * h3 + square * h2),
        unit * (twice * h4 + square * h3),
        unit * (twice * h5 + square * h4),
        abs(unit) * (twice * sixth + square * fifth),
    )


def absolute_acceleration_derivatives(m, b, unit, tau, cosine, sine, derivatives, later):
    """Return the absolute acceleration, four derivatives and a bound of the fifth."""
    h2, h3, h4, h5 = derivatives
    twice, square = 2.0 * m[b + at.DAMPING], m[b + at.OMEGA_SQUARED]
    eta = m[at.ETA]
    fourth = eta * eta * eta * eta
    g0, g1, g2, g3 = forcing_derivatives(m, at.BOX, tau, cosine, sine)
    own, _ = harmonic_drive_and_rate(m, b, cosine, sine)
    box, _ = harmonic_drive_and_rate(m, at.BOX, cosine, sine)
    h6 = fourth * own - (twice * h5 + square * h4)
    apart = abs(m[b + at.DRIVE] - m[at.BOX + at.DRIVE])
    apart += abs(m[b + at.DRIVE + 1] - m[at.BOX + at.DRIVE + 1])
    return (
        -unit * (h2 - g0),
        -unit * (h3 - g1),
        -unit * (h4 - g2),
        -unit * (h5 - g3),
        -unit * (h6 - fourth * box),
        abs(unit) * (later + fourth * eta * apart),
    )


def forcing_derivatives(m, b, tau, cosine, sine):
    """Return the forcing of (6) and its first three derivatives at an age of the state."""
    eta = m[at.ETA]
    f0, f1 = harmonic_drive_and_rate(m, b, cosine, sine)
    f2, f3 = -eta * eta * f0, -eta * eta * f1
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        q0, q1, q2, q3 = cubic_drive_derivatives(m, b, tau)
        f0, f1, f2, f3 = f0 + q0, f1 + q1, f2 + q2, f3 + q3
    return f0, f1, f2, f3


def later_derivative_bounds(m, b, harmonic, cubic, tau, x, v, cosine, sine):
    """Return bounds of the displacement's fifth and sixth derivative from an age on."""
    if m[at.SERIES] != 0.0:  # rarely
        rate, part = m[at.RATE], m[at.RATE_INVERSE]
        f0, f1, f2, f3 = forcing_derivatives(m, b, tau, cosine, sine)
        growth = abs(f0) + part * (abs(f1) + part * (abs(f2) + part * abs(f3)))
        size = abs(x) + part * (abs(v) + 1.35 * part * growth)
        fifth = 1.35 * 6.0 * rate * rate * rate * rate * rate * size
        return fifth, fifth * rate * (7.0 / 6.0)
    x_forced, v_forced = displacement_and_velocity(m, harmonic, cubic, tau, 0.0, 0.0, sine, cosine)
    _, _, _, x5, x6 = free_part_higher_derivatives(m, b, x - x_forced, v - v_forced)
    x7 = -(2.0 * m[b + at.DAMPING] * x6 + m[b + at.OMEGA_SQUARED] * x5)
    eta = m[at.NODE_ETA]
    steady = (abs(m[harmonic]) + abs(m[harmonic + 1])) * (eta * eta * eta * eta * eta)
    fifth, sixth = (
        envelope_bound(m, b, x5, x6) + steady,
        envelope_bound(m, b, x6, x7) + steady * eta,
    )
    if m[at.SECULAR] != 0.0:  # rarely
        time = AHEAD * m[at.SPACING]
        fifth, sixth = (
            fifth + driven_derivative_bound(m, b, 5, time),
            sixth + driven_derivative_bound(m, b, 6, time),
        )
    return fifth, sixth
