"""Taylor series of a flight from its start on the boundary.

The closed form gives the gap as a difference of displacements, to within their rounding; a flight
in chattering may be lower than that. The gap's own equation, ``g'' = -2 D_2 g' - omega_2^2 g + 2
(D_1 - D_2) xi_1' + (omega_1^2 - omega_2^2) xi_1`` from (6), gives its derivatives at the start
without any cancellation, and with them a short flight from start to end. Displacements count from
where the masses rest together: with a clearance, the preload is a constant in both equations.
"""

from . import memory as at
from .excitation import cubic_drive_derivatives, harmonic_drive_and_rate

# of a radian of the fastest change: from here on twelve terms leave more than the rounding
SHORT = 0.2
SHORTER = 0.02  # and eight terms
ENOUGH = 2e-8  # relative: the next step of Newton's method would be a small part of its square


def required_series_order(m, slope, curvature):
    """Return the order of a flight's series from gap velocity and acceleration; 4: not short."""
    if curvature >= 0.0:
        return 4
    angle = 2.0 * slope * m[at.RATE]
    if angle > SHORT * -curvature:
        return 4
    return 8 if angle <= SHORTER * -curvature else at.SERIES_LONGEST


def fifth_derivative_bound(m):
    """Return a bound of the gap's fifth derivative up to 0.3 of the fastest rate's radian after the
    start.

    With R the rate and ``Z = |xi_1| + |xi_1'|/R + |forcing|/R^2`` at the start, all growth up to
    there is below ``e^0.3 < 1.35``, so (6) gives ``|xi_1^(k)| <= (k + 1) R^k Z``, k = 2, 3, 4, to
    begin with 1.35 Z. The gap's own equation is driven by ``W = (|2 (D_1 - D_2)| R + |omega_1^2 -
    omega_2^2|) Z`` times as much; with ``V = gap'/R + 1.35 W/R^2`` its derivatives are below 1.35,
    1.35, 2.35, 4.1, 6.6 and 9.8 times ``R^k V``.
    """
    rate, part = m[at.RATE], m[at.RATE_INVERSE]
    b = at.OSCILLATOR_1 + at.DRIVE
    forcing = abs(m[b]) + abs(m[b + 1]) + abs(m[at.REST_1])
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        cubic_0, cubic_1, cubic_2, cubic_3 = cubic_drive_derivatives(m, at.OSCILLATOR_1, 0.0)
        growth = abs(cubic_1) + part * (abs(cubic_2) + part * abs(cubic_3))
        forcing += 1.35 * (abs(cubic_0) + part * growth)
    size = abs(m[at.SERIES_X]) + part * (abs(m[at.SERIES_X + 2]) + part * forcing)
    drive = (abs(m[at.FORCE_V]) * rate + abs(m[at.FORCE_X])) * size + abs(m[at.PRELOAD])
    if m[at.UNEQUAL] != 0.0:  # rarely
        gap_0, gap_1, gap_2, gap_3 = cubic_drive_derivatives(m, at.GAP, 0.0)
        drive += abs(m[at.GAP + at.DRIVE]) + abs(m[at.GAP + at.DRIVE + 1])
        drive += abs(gap_0) + part * (abs(gap_1) + part * (abs(gap_2) + part * abs(gap_3)))
    square = rate * rate
    return 10.0 * square * square * (m[at.SERIES_GAP + 2] + 1.35 * part * drive)


def set_series(m, x, v, slope, order):
    """Set derivatives of xi_1 and the gap from gap = 0, gap' = slope, up to an order."""
    m[at.SERIES_X] = x
    m[at.SERIES_X + 2] = v
    m[at.SERIES_GAP] = 0.0
    m[at.SERIES_GAP + 2] = slope
    if m[at.UNEQUAL] == 0.0:  # usually
        set_higher_derivatives(m, order, False)
    else:
        set_higher_derivatives(m, order, True)


def set_higher_derivatives(m, order, unequal):  # inline
    """Set the derivatives from the second on; ``unequal`` is a constant where this is called."""
    square = -m[at.ETA] * m[at.ETA]
    drive, drive_next = harmonic_drive_and_rate(m, at.OSCILLATOR_1, m[at.COSINE], m[at.SINE])
    c0, c1, c2, c3 = 0.0, 0.0, 0.0, 0.0
    apart, apart_next, g0, g1, g2, g3 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        c0, c1, c2, c3 = cubic_drive_derivatives(m, at.OSCILLATOR_1, 0.0)
    if unequal:
        apart, apart_next = harmonic_drive_and_rate(m, at.GAP, m[at.COSINE], m[at.SINE])
        g0, g1, g2, g3 = cubic_drive_derivatives(m, at.GAP, 0.0)
    for k in range(7):
        set_derivatives_of_order(m, k + 2, drive + c0)
        if unequal:
            m[at.SERIES_GAP + 2 * k + 4] += apart + g0
            apart, apart_next = apart_next, square * apart
            g0, g1, g2, g3 = g1, g2, g3, 0.0
        if k == 0 and m[at.PRELOAD] != 0.0:  # rarely
            m[at.SERIES_X + 4] -= m[at.REST_1]
            m[at.SERIES_GAP + 4] += m[at.PRELOAD]
        drive, drive_next = drive_next, square * drive
        c0, c1, c2, c3 = c1, c2, c3, 0.0
    if order > 8:
        for k in range(7, 11):
            set_derivatives_of_order(m, k + 2, drive)
            if unequal:
                m[at.SERIES_GAP + 2 * k + 4] += apart
                apart, apart_next = apart_next, square * apart
            drive, drive_next = drive_next, square * drive
    else:
        for k in range(9, at.SERIES_LONGEST + 1):
            m[at.SERIES_GAP + 2 * k] = 0.0


def set_derivatives_of_order(m, k, drive):
    """Set the derivatives of order k from the two before and the forcing's of order k - 2."""
    one, two = at.OSCILLATOR_1, at.OSCILLATOR_2
    i = 2 * k
    x, v = m[at.SERIES_X + i - 4], m[at.SERIES_X + i - 2]
    gap, slope = m[at.SERIES_GAP + i - 4], m[at.SERIES_GAP + i - 2]
    m[at.SERIES_X + i] = drive - (2.0 * m[one + at.DAMPING] * v + m[one + at.OMEGA_SQUARED] * x)
    m[at.SERIES_GAP + i] = (m[at.FORCE_V] * v + m[at.FORCE_X] * x) - (
        2.0 * m[two + at.DAMPING] * slope + m[two + at.OMEGA_SQUARED] * gap
    )


def short_flight_duration(m, order):
    """Return a short flight's duration if it is certain (a concave gap has one root), else 0."""
    g = at.SERIES_GAP
    c1, c2, c3, c4 = m[g + 2], m[g + 4] * 0.5, m[g + 6] * (1.0 / 6.0), m[g + 8] * (1.0 / 24.0)
    part = 1.0 / c2
    root = -c1 * part
    longest = 1.5 * root
    bound = fifth_derivative_bound(m)
    m[at.SERIES_BOUND] = bound
    bent = (12.0 * c4 if c4 > 0.0 else 0.0) + bound * longest * (1.0 / 6.0)
    if 2.0 * c2 + longest * ((6.0 * c3 if c3 > 0.0 else 0.0) + longest * bent) >= 0.0:
        return 0.0
    # the quartic's root by reversion of its series
    a, b = c3 * part * root, c4 * part * root * root
    root *= (1.0 - a) + ((2.0 * a * a - b) + 5.0 * a * (b - a * a))
    c5, c6 = m[g + 10] * (1.0 / 120.0), m[g + 12] * (1.0 / 720.0)
    c7, c8 = m[g + 14] * (1.0 / 5040.0), m[g + 16] * (1.0 / 40320.0)
    for _ in range(8):  # Newton's method for gap/tau, which falls
        t2 = root * root
        t4 = t2 * t2
        value = ((c1 + c2 * root) + t2 * (c3 + c4 * root)) + t4 * (
            (c5 + c6 * root) + t2 * (c7 + c8 * root)
        )
        slope = ((c2 + 2.0 * c3 * root) + t2 * (3.0 * c4 + 4.0 * c5 * root)) + t4 * (
            5.0 * c6 + 6.0 * c7 * root
        )
        if order > 8:
            value += t4 * t4 * series_tail(m, g + 18, root)
        step = value / slope
        root -= step
        if root <= 0.0 or root >= longest:
            return 0.0
        if abs(step) <= ENOUGH * root:
            return root
    return root


def series_tail(m, first, tau):
    """Return the terms nine to twelve of ``gap/tau``, over ``tau^8``."""
    d9, d10 = m[first] * (1.0 / 362880.0), m[first + 2] * (1.0 / 3628800.0)
    d11, d12 = m[first + 4] * (1.0 / 39916800.0), m[first + 6] * (1.0 / 479001600.0)
    return (d9 + d10 * tau) + tau * tau * (d11 + d12 * tau)


def taylor_value(m, first, tau):
    t2 = tau * tau
    t4 = t2 * t2
    value = (m[first] + tau * m[first + 2]) + t2 * (
        m[first + 4] * 0.5 + tau * m[first + 6] * (1.0 / 6.0)
    )
    value += t4 * (
        (m[first + 8] * (1.0 / 24.0) + tau * m[first + 10] * (1.0 / 120.0))
        + t2 * (m[first + 12] * (1.0 / 720.0) + tau * m[first + 14] * (1.0 / 5040.0))
    )
    if m[at.SERIES] > 8.0:
        value += (
            t4
            * t4
            * (
                (m[first + 16] * (1.0 / 40320.0) + tau * m[first + 18] * (1.0 / 362880.0))
                + t2
                * (m[first + 20] * (1.0 / 3628800.0) + tau * m[first + 22] * (1.0 / 39916800.0))
            )
        )
    return value


def gap_and_derivatives(m, tau):
    h0, h1, h2, h3, h4 = 0.0, 0.0, 0.0, 0.0, 0.0
    power = 1.0  # tau^k/k!
    for k in range(int(m[at.SERIES]) + 1):
        h0 += power * m[at.SERIES_GAP + 2 * k]
        h1 += power * m[at.SERIES_GAP + 2 * k + 2]
        h2 += power * m[at.SERIES_GAP + 2 * k + 4]
        h3 += power * m[at.SERIES_GAP + 2 * k + 6]
        h4 += power * m[at.SERIES_GAP + 2 * k + 8]
        power *= tau / (k + 1.0)
    return h0, h1, h2, h3, h4
