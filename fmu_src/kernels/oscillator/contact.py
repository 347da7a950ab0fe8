"""Permanent contact: its force (18) and the side on which a state begins, (19)-(20).

On the boundary, both masses together at one velocity, the sign of f decides: pressed together or
pulled apart. Where f vanishes, the first of its derivatives that does not vanish decides.
"Vanishes" means: below the rounding of the terms it is made of.
"""

from . import memory as at
from .excitation import cubic_at

ROUNDING = 1e-14
# with a cubic forcing, from rest, some derivative of f up to the fifth does not vanish, or all do
HIGHEST = 5


def gap_acceleration(m, x, v):
    """Return f of (18), the gap's acceleration at displacement ``x`` of both masses from where they
    rest together, and common velocity ``v``; negative where they are pressed together.
    """
    force = m[at.FORCE_V] * v + m[at.FORCE_X] * x
    if m[at.PRELOAD] != 0.0:  # rarely
        force += m[at.PRELOAD]
    return force


def forcing_derivative(m, order, sine, cosine, cubic):
    """Return a derivative of the right-hand side of (6), and the size of the terms it is made
    of.
    """
    size = m[at.FORCING]
    for _ in range(order):
        size *= m[at.ETA]
    value = size * (sine if order % 2 == 0 else cosine)
    if order % 4 >= 2:
        value = -value
    if order == 0:
        part = cubic[0]
    elif order == 1:
        part = cubic[1]
    elif order == 2:
        part = cubic[2]
    elif order == 3:
        part = cubic[3]
    else:
        part = 0.0
    return value + part, abs(size) + abs(part)


def first_nonzero_derivative(m, x, v, lowest):
    """Return the first derivative of f, from order ``lowest`` on, that does not vanish from (x, v)
    on.

    Returns
    -------
    order : int
        -1 where all vanish.
    value : float
        The derivative, 0 where all vanish.
    """
    sine, cosine = m[at.SINE], m[at.COSINE]
    cubic = cubic_at(m, m[at.CUBIC_AGE])
    twice = 2.0 * m[at.OSCILLATOR_3 + at.DAMPING]
    square = m[at.OSCILLATOR_3 + at.OMEGA_SQUARED]
    low, low_size, high, high_size = x, abs(x), v, abs(v)
    for order in range(HIGHEST + 1):
        if order >= lowest:
            value = m[at.FORCE_V] * high + m[at.FORCE_X] * low
            size = abs(m[at.FORCE_V]) * high_size + abs(m[at.FORCE_X]) * low_size
            if order == 0 and m[at.PRELOAD] != 0.0:  # rarely
                value += m[at.PRELOAD]
                size += abs(m[at.PRELOAD])
            if abs(value) > ROUNDING * size:
                return order, value
        drive, drive_size = forcing_derivative(m, order, sine, cosine, cubic)
        low, high = high, drive - twice * high - square * low
        low_size, high_size = high_size, drive_size + twice * high_size + square * low_size
    return -1, 0.0
