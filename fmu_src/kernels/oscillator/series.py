"""Taylor series of a flight from its start on the boundary.

The closed form gives the gap as a difference of displacements, to within their rounding; a flight
in chattering may be lower than that. The gap's own equation, ``g'' = -2 D_2 g' - omega_2^2 g + 2
(D_1 - D_2) xi_1' + (omega_1^2 - omega_2^2) xi_1`` from (6), gives its derivatives at the start
without any cancellation, and with them a short flight from start to end.
"""

from . import memory as at
from .excitation import cubic_at

# of a radian of the fastest change: from here on twelve terms leave more than the rounding
SHORT = 0.2
SHORTER = 0.02  # and eight terms
ENOUGH = 1e-9  # relative: the next step of Newton's method would be its square


def series_order(m, slope, curvature):
    """How many terms a flight needs that begins with a gap velocity and acceleration.

    4 where it is not short.
    """
    if curvature >= 0.0:
        return 4
    fastest = max(
        m[at.ETA],
        m[at.FASTEST] + 2.0 * max(m[at.BRANCH_1 + at.DAMPING], m[at.BRANCH_2 + at.DAMPING]),
    )
    angle = 2.0 * slope * fastest
    if angle > SHORT * -curvature:
        return 4
    return 8 if angle <= SHORTER * -curvature else at.SERIES_LONGEST


def set_series(m, x, v, slope, order):
    """Coefficients of xi_1 and of the gap from ``gap = 0, gap' = slope``.

    At displacement ``x`` and velocity ``v`` of mass 1.
    """
    m[at.SERIES_X] = x
    m[at.SERIES_X + 1] = v
    m[at.SERIES_GAP] = 0.0
    m[at.SERIES_GAP + 1] = slope
    m[at.SERIES_DRIVE] = m[at.FORCING] * m[at.SINE]
    m[at.SERIES_DRIVE + 1] = m[at.FORCING] * m[at.ETA] * m[at.COSINE]
    twice_1, square_1 = 2.0 * m[at.BRANCH_1 + at.DAMPING], m[at.BRANCH_1 + at.OMEGA_SQUARED]
    twice_2, square_2 = 2.0 * m[at.BRANCH_2 + at.DAMPING], m[at.BRANCH_2 + at.OMEGA_SQUARED]
    force_v, force_x = m[at.FORCE_V], m[at.FORCE_X]
    eta_squared = m[at.ETA] * m[at.ETA]
    cubic_0, cubic_1, cubic_2, cubic_3 = 0.0, 0.0, 0.0, 0.0
    if m[at.CUBIC_PRESENT] != 0.0:
        cubic_0, cubic_1, cubic_2, cubic_3 = cubic_at(m, m[at.SEGMENT_AGE])
        cubic_2, cubic_3 = 0.5 * cubic_2, cubic_3 / 6.0
    for k in range(order - 1):
        drive = m[at.SERIES_DRIVE + k] + cubic_0
        cubic_0, cubic_1, cubic_2, cubic_3 = cubic_1, cubic_2, cubic_3, 0.0
        rate = k + 1.0
        part = 1.0 / (rate * (rate + 1.0))
        x_k, x_dot = m[at.SERIES_X + k], rate * m[at.SERIES_X + k + 1]
        g_k, g_dot = m[at.SERIES_GAP + k], rate * m[at.SERIES_GAP + k + 1]
        m[at.SERIES_X + k + 2] = (drive - (twice_1 * x_dot + square_1 * x_k)) * part
        m[at.SERIES_GAP + k + 2] = (
            (force_v * x_dot + force_x * x_k) - (twice_2 * g_dot + square_2 * g_k)
        ) * part
        m[at.SERIES_DRIVE + k + 2] = -eta_squared * part * m[at.SERIES_DRIVE + k]


def short_flight(m, order, bound):
    """Duration of a short flight, where it is certain; else 0.

    Its gap is concave throughout, so it has one root.

    Parameters
    ----------
    m : flat memory
        With the series.
    order : int
        Of the series.
    bound : float
        Of the gap's fifth derivative.
    """
    g1, g2 = m[at.SERIES_GAP + 1], m[at.SERIES_GAP + 2]
    g3, g4 = m[at.SERIES_GAP + 3], m[at.SERIES_GAP + 4]
    root = -g1 / g2
    longest = 1.5 * root
    highest = 6.0 * g3 if g3 > 0.0 else 0.0
    bent = (12.0 * g4 if g4 > 0.0 else 0.0) + bound * longest * (1.0 / 6.0)
    if 2.0 * g2 + longest * (highest + longest * bent) >= 0.0:
        return 0.0
    root -= root * root * g3 / (g2 + 2.0 * root * g3)
    for _ in range(8):  # Newton's method for gap/tau, which falls
        value, slope = 0.0, 0.0
        for k in range(order, 0, -1):
            slope = slope * root + value
            value = value * root + m[at.SERIES_GAP + k]
        step = value / slope
        root -= step
        if root <= 0.0 or root >= longest:
            return 0.0
        if abs(step) <= ENOUGH * root:
            return root
    return root


def polynomial(m, series, tau):
    """Value and first derivative of a series."""
    value, slope = 0.0, 0.0
    for k in range(int(m[at.SERIES]), -1, -1):
        slope = slope * tau + value
        value = value * tau + m[series + k]
    return value, slope


def gap_at(m, tau):
    """The gap and its first four derivatives."""
    h0, h1, h2, h3, h4 = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(int(m[at.SERIES]), -1, -1):
        h4 = h4 * tau + h3
        h3 = h3 * tau + h2
        h2 = h2 * tau + h1
        h1 = h1 * tau + h0
        h0 = h0 * tau + m[at.SERIES_GAP + k]
    return h0, h1, 2.0 * h2, 6.0 * h3, 24.0 * h4
