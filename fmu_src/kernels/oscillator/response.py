"""The closed-form linear oscillator, (9)-(11).

The free part is ``x C(tau) + (v + D x) S(tau)`` with ``C = e^{-D tau} cos nu tau`` and ``S = e^{-D
tau} sin(nu tau)/nu``; c and v are the initial conditions (9) less the forced response. C and S go
over continuously into critical damping (``e^{-D tau}``, ``tau e^{-D tau}``) and overdamping (cosh,
sinh).
"""

from ..numerics.elementary import exp_decay, sincos_turns
from . import memory as at


def fundamental_solutions(m, b, tau):
    """Return C, S of (10) of oscillator ``b`` at ``tau`` >= 0, and its envelope ``e^{-r tau}``."""
    damping, nu_squared, nu = m[b + at.DAMPING], m[b + at.NU_SQUARED], m[b + at.NU]
    rate = m[b + at.ENVELOPE_RATE]
    if nu_squared > 0.0:
        decay = exp_decay(damping * tau)
        s, c = sincos_turns(m[b + at.NU_TURNS] * tau)
        return decay * c, decay * s / nu, decay if rate == damping else exp_decay(rate * tau)
    x = nu * tau
    if x < 0.5:  # sinh(x)/x by its series: the difference of exponentials would cancel
        y = x * x
        sinhc = 1.0 + y / 6.0 * (
            1.0
            + y / 20.0 * (1.0 + y / 42.0 * (1.0 + y / 72.0 * (1.0 + y / 110.0 * (1.0 + y / 156.0))))
        )
        half = 0.5 * x
        z = half * half
        root = half * (
            1.0
            + z / 6.0 * (1.0 + z / 20.0 * (1.0 + z / 42.0 * (1.0 + z / 72.0 * (1.0 + z / 110.0))))
        )
        decay = exp_decay(damping * tau)
        return decay * (1.0 + 2.0 * root * root), decay * tau * sinhc, exp_decay(rate * tau)
    slow = exp_decay(m[b + at.OMEGA_SQUARED] / (damping + nu) * tau)
    fast = exp_decay(2.0 * x)
    return 0.5 * slow * (1.0 + fast), 0.5 * slow * (1.0 - fast) / nu, exp_decay(rate * tau)


def cubic_value_and_rate(m, response, tau):
    """Return value and derivative of a cubic kept by value and derivatives at its start."""
    q1, q2, q3 = m[response + 1], m[response + 2], m[response + 3]
    value = m[response] + tau * (q1 + 0.5 * tau * (q2 + tau * q3 * (1.0 / 3.0)))
    return value, q1 + tau * (q2 + 0.5 * tau * q3)


def displacement_and_velocity(m, harmonic, cubic, tau, x, v, sine, cosine):  # inline
    """Return displacement and velocity (m, m/tau) of an oscillator (10); x, v: free part."""
    h_cos, h_sin = m[harmonic], m[harmonic + 1]
    q, q_dot = 0.0, 0.0
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        q, q_dot = cubic_value_and_rate(m, cubic, tau)
    forced = m[at.ETA] * (h_sin * cosine - h_cos * sine)
    return h_cos * cosine + h_sin * sine + q + x, forced + q_dot + v


def set_free_part(m, harmonic, free, cubic, x, v, sine, cosine):
    """Set the free part by the initial conditions (9): alpha_i and beta_i of (11)."""
    h_cos, h_sin = m[harmonic], m[harmonic + 1]
    q, q_dot = 0.0, 0.0
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        q, q_dot = m[cubic], m[cubic + 1]
    m[free] = x - (h_cos * cosine + h_sin * sine) - q
    m[free + 1] = v - m[at.ETA] * (h_sin * cosine - h_cos * sine) - q_dot
