"""The event function of a state: positive inside it, its first root is the state's end.

In flight it is the gap ``xi_2 - xi_1`` (13), in permanent contact minus the contact force ``-f``
(19). Both are one kind of signal, a harmonic, a cubic and up to two decaying free parts, and so is
each derivative: written so, one root finder serves both, and every derivative is bounded in closed
form for all later times.
"""

from ..numerics.elementary import sincos_turns
from . import memory as at
from .response import bases, basis
from .series import gap_at


def free_derivative(m, b, c, w):
    """Coefficients of the derivative of ``c C + w S``."""
    damping = m[b + at.DAMPING]
    return w - damping * c, -(m[b + at.NU_SQUARED] * c + damping * w)


def set_gap(m):
    """Event function of a flight: ``xi_2 - xi_1``."""
    for i in range(2):
        m[at.EVENT_HARMONIC + i] = m[at.HARMONIC_2 + i] - m[at.HARMONIC_1 + i]
        m[at.EVENT_FREE_A + i] = -m[at.FREE_A + i]
        m[at.EVENT_FREE_B + i] = m[at.FREE_B + i]
    if m[at.CUBIC_PRESENT] != 0.0:
        for i in range(4):
            m[at.EVENT_CUBIC + i] = m[at.CUBIC_B + i] - m[at.CUBIC_A + i]
    set_bounds(m, at.BRANCH_1)


def set_contact_force(m):
    """Event function of permanent contact: minus the force of (18).

    ``-f = -2 (D1 - D2) xi_3' - (omega_1^2 - omega_2^2) xi_3``.
    """
    p, q = -m[at.FORCE_V], -m[at.FORCE_X]
    h_cos, h_sin, eta = m[at.HARMONIC_3], m[at.HARMONIC_3 + 1], m[at.ETA]
    m[at.EVENT_HARMONIC] = p * eta * h_sin + q * h_cos
    m[at.EVENT_HARMONIC + 1] = q * h_sin - p * eta * h_cos
    if m[at.CUBIC_PRESENT] != 0.0:
        for i in range(3):
            m[at.EVENT_CUBIC + i] = p * m[at.CUBIC_A + i + 1] + q * m[at.CUBIC_A + i]
        m[at.EVENT_CUBIC + 3] = q * m[at.CUBIC_A + 3]
    c, w = m[at.FREE_A], m[at.FREE_A + 1]
    c_dot, w_dot = free_derivative(m, at.BRANCH_3, c, w)
    m[at.EVENT_FREE_A] = p * c_dot + q * c
    m[at.EVENT_FREE_A + 1] = p * w_dot + q * w
    m[at.EVENT_FREE_B] = 0.0
    m[at.EVENT_FREE_B + 1] = 0.0
    set_bounds(m, at.BRANCH_3)


def set_bounds(m, branch_a):
    """Bounds of the fifth derivative: the steady part, and the free parts at tau = 0."""
    steady, a, b = bounds(m, branch_a, 5)
    m[at.BOUND] = steady
    m[at.BOUND + 1] = a
    m[at.BOUND + 2] = b


def bounds(m, branch_a, order):
    """Bounds of the event function's derivative of an order >= 4, at all later times.

    Steady part, and free parts A and B at tau = 0.
    """
    steady = abs(m[at.EVENT_HARMONIC]) + abs(m[at.EVENT_HARMONIC + 1])
    for _ in range(order):
        steady *= m[at.ETA]
    a = free_bound(m, branch_a, at.EVENT_FREE_A, order)
    b = free_bound(m, at.BRANCH_2, at.EVENT_FREE_B, order) if m[at.MODE] == at.FLIGHT else 0.0
    return steady, a, b


def free_bound(m, b, free, order):
    """Bound of a free part's derivative at tau = 0; it decays with the branch's envelope."""
    c, w = m[free], m[free + 1]
    for _ in range(order):
        c, w = free_derivative(m, b, c, w)
    return abs(c) + m[b + at.ENVELOPE_SINE] * abs(w)


def free_part(m, b, c, w, C, S):
    """A free part and its first four derivatives: ``x'' = -2 D x' - omega^2 x``."""
    twice, square = 2.0 * m[b + at.DAMPING], m[b + at.OMEGA_SQUARED]
    c_dot, w_dot = free_derivative(m, b, c, w)
    x0 = c * C + w * S
    x1 = c_dot * C + w_dot * S
    x2 = -(twice * x1 + square * x0)
    x3 = -(twice * x2 + square * x1)
    return x0, x1, x2, x3, -(twice * x3 + square * x2)


def evaluate(m, tau):
    """The event function at ``tau``: value, four derivatives, and a bound of the fifth.

    The bound holds from there on.

    Returns
    -------
    h0, h1, h2, h3, h4, bound : float
    """
    m[at.WORK] += 1.0
    if m[at.SERIES] != 0.0:
        h0, h1, h2, h3, h4 = gap_at(m, tau)
        return h0, h1, h2, h3, h4, m[at.BOUND] + m[at.BOUND + 1] + m[at.BOUND + 2]
    if m[at.MODE] == at.FLIGHT:
        C_1, S_1, decay, C_2, S_2, decay_2 = bases(m, tau)
        h0, h1, h2, h3, h4 = free_part(
            m, at.BRANCH_1, m[at.EVENT_FREE_A], m[at.EVENT_FREE_A + 1], C_1, S_1
        )
        b0, b1, b2, b3, b4 = free_part(
            m, at.BRANCH_2, m[at.EVENT_FREE_B], m[at.EVENT_FREE_B + 1], C_2, S_2
        )
        h0, h1, h2, h3, h4 = h0 + b0, h1 + b1, h2 + b2, h3 + b3, h4 + b4
        bound = m[at.BOUND] + decay * m[at.BOUND + 1] + decay_2 * m[at.BOUND + 2]
    else:
        C_1, S_1, decay = basis(m, at.BRANCH_3, tau)
        h0, h1, h2, h3, h4 = free_part(
            m, at.BRANCH_3, m[at.EVENT_FREE_A], m[at.EVENT_FREE_A + 1], C_1, S_1
        )
        bound = m[at.BOUND] + decay * m[at.BOUND + 1]
    if m[at.FORCING] != 0.0:
        eta = m[at.ETA]
        s, c = sincos_turns(m[at.TURN] + m[at.ETA_TURNS] * tau)
        u0 = m[at.EVENT_HARMONIC] * c + m[at.EVENT_HARMONIC + 1] * s
        u1 = eta * (m[at.EVENT_HARMONIC + 1] * c - m[at.EVENT_HARMONIC] * s)
        square = eta * eta
        u2 = square * u0
        h0 += u0
        h1 += u1
        h2 -= u2
        h3 -= square * u1
        h4 += square * u2
    if m[at.CUBIC_PRESENT] != 0.0:
        q2, q3 = m[at.EVENT_CUBIC + 2], m[at.EVENT_CUBIC + 3]
        h0 += m[at.EVENT_CUBIC] + tau * (m[at.EVENT_CUBIC + 1] + 0.5 * tau * (q2 + tau * q3 / 3.0))
        h1 += m[at.EVENT_CUBIC + 1] + tau * (q2 + 0.5 * tau * q3)
        h2 += q2 + tau * q3
        h3 += q3
    return h0, h1, h2, h3, h4, bound


def rounding(m, tau):
    """What the event function's terms at ``tau`` may lose by rounding."""
    size = abs(m[at.EVENT_HARMONIC]) + abs(m[at.EVENT_HARMONIC + 1])
    branch_a = at.BRANCH_1 if m[at.MODE] == at.FLIGHT else at.BRANCH_3
    size += free_bound(m, branch_a, at.EVENT_FREE_A, 0) + free_bound(
        m, at.BRANCH_2, at.EVENT_FREE_B, 0
    )
    if m[at.CUBIC_PRESENT] != 0.0:
        power = 1.0
        for i in range(4):
            size += abs(m[at.EVENT_CUBIC + i]) * power
            power *= tau
    return 4e-15 * size
