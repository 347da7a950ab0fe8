"""Permanent contact: its force (18) and the side on which a state begins, (19)-(20).

On the boundary, both masses together at one velocity, the sign of f decides: pressed together or
pulled apart. Where f vanishes, the first of its derivatives that does not vanish decides.
"Vanishes" means: below the rounding of the terms it is made of.
"""

from . import memory as at
from .excitation import cubic_drive_derivatives, drive_and_rate_at

ROUNDING = 1e-14
# with a cubic forcing, from rest, some derivative of f up to the fifth does not vanish, or all do
HIGHEST = 5


def gap_acceleration(m, x, v, cosine, sine, tau):  # inline
    """Return f of (18) with both masses ``x`` from where they rest together; negative: pressed."""
    force = m[at.FORCE_V] * v + m[at.FORCE_X] * x
    if m[at.PRELOAD] != 0.0:  # rarely
        force += m[at.PRELOAD]
    if m[at.UNEQUAL] != 0.0:  # rarely
        drive, _ = drive_and_rate_at(m, at.GAP, cosine, sine, tau)
        force += drive
    return force


def first_nonzero_force_derivative(m, x, v, lowest):
    """Return order >= ``lowest`` (-1: none) and value of f's first derivative that is not 0."""
    sine, cosine = m[at.SINE], m[at.COSINE]
    d_cos, d_sin = m[at.OSCILLATOR_3 + at.DRIVE], m[at.OSCILLATOR_3 + at.DRIVE + 1]
    c0, c1, c2, c3 = cubic_drive_derivatives(m, at.OSCILLATOR_3, 0.0)
    g_cos, g_sin = m[at.GAP + at.DRIVE], m[at.GAP + at.DRIVE + 1]
    g0, g1, g2, g3 = cubic_drive_derivatives(m, at.GAP, 0.0)
    eta, twice = m[at.ETA], 2.0 * m[at.OSCILLATOR_3 + at.DAMPING]
    square = m[at.OSCILLATOR_3 + at.OMEGA_SQUARED]
    low, low_size, high, high_size = x, abs(x), v, abs(v)
    for order in range(HIGHEST + 1):
        if order >= lowest:
            value = m[at.FORCE_V] * high + m[at.FORCE_X] * low
            size = abs(m[at.FORCE_V]) * high_size + abs(m[at.FORCE_X]) * low_size
            if order == 0 and m[at.PRELOAD] != 0.0:  # rarely
                value += m[at.PRELOAD]
                size += abs(m[at.PRELOAD])
            if m[at.UNEQUAL] != 0.0:  # rarely
                value += (g_cos * cosine + g_sin * sine) + g0
                size += abs(g_cos) + abs(g_sin) + abs(g0)
            if abs(value) > ROUNDING * size:
                return order, value
        drive, drive_size = (d_cos * cosine + d_sin * sine) + c0, abs(d_cos) + abs(d_sin) + abs(c0)
        d_cos, d_sin = eta * d_sin, -eta * d_cos
        c0, c1, c2, c3 = c1, c2, c3, 0.0
        g_cos, g_sin = eta * g_sin, -eta * g_cos
        g0, g1, g2, g3 = g1, g2, g3, 0.0
        low, high = high, drive - twice * high - square * low
        low_size, high_size = high_size, drive_size + twice * high_size + square * low_size
    return -1, 0.0
