"""Masses, stiffnesses and dampers to the paper's numbers: omega, mu (2), omega_i (7), D_i (8).

With a clearance the springs hold each other where the masses touch: with both masses at
``REST_1`` and ``REST_2`` from the unloaded positions, the springs balance and the masses are
together. Motions in contact count from there: their equation is the one without a clearance.
"""

import math

from ..numerics.elementary import TWO_PI
from ..numerics.first_root import INFINITE
from . import memory as at

# relative difference below which two quotients of parameters are equal but for rounding
SAME = 1e-15
# difference of the oscillators' constants below which their gap is bounded by its own oscillator
ALIKE = 1e-4


def derive_constants(m):
    """Compute the derived constants of ``m`` from its parameters."""
    omega = math.sqrt(m[at.K1] / m[at.M1])  # (2)
    mu = m[at.M2] / m[at.M1]
    kappa = m[at.K2] / m[at.K1]
    damping_1 = m[at.D1] / (2.0 * omega * m[at.M1])  # (8)
    damping_2 = m[at.D2] / (2.0 * omega * m[at.M2])
    damping_3 = (m[at.D1] + m[at.D2]) / (2.0 * omega * (m[at.M1] + m[at.M2]))
    omega_2_squared = kappa / mu  # (7); omega_1 = 1
    # two oscillators that are alike must not part or touch by rounding
    if abs(omega_2_squared - 1.0) <= SAME:
        omega_2_squared = 1.0
    if abs(damping_2 - damping_1) <= SAME * damping_1:
        damping_2 = damping_1
    m[at.OMEGA] = omega
    m[at.MU] = mu
    m[at.SHARE] = 1.0 / (1.0 + mu)
    m[at.REDUCED_MASS] = m[at.M2] * m[at.SHARE]
    m[at.FORCE_V] = 2.0 * (damping_1 - damping_2)  # (18)
    m[at.FORCE_X] = 1.0 - omega_2_squared
    set_oscillator_constants(m, at.OSCILLATOR_1, damping_1, 1.0)
    set_oscillator_constants(m, at.OSCILLATOR_2, damping_2, omega_2_squared)
    set_oscillator_constants(m, at.OSCILLATOR_3, damping_3, (1.0 + kappa) / (1.0 + mu))
    m[at.SPACING] = 0.0  # the nodes are to be reset
    m[at.FASTEST] = max(1.0, math.sqrt(omega_2_squared))  # omega_3 lies between
    m[at.STICKING_TIME] = m[at.GAMMA] * (1.0 - m[at.E]) / m[at.FASTEST]
    if m[at.WALL] != 0.0:  # rarely
        set_wall_constants(m)
    m[at.LIMIT] = m[at.STROKE] if m[at.STROKE] > 0.0 and m[at.BONDED] == 0.0 else INFINITE
    set_side_constants(m)


def set_wall_constants(m):
    """Make mass 2 a rigid wall: tuned like mass 1, and infinitely heavy."""
    damping = m[at.OSCILLATOR_1 + at.DAMPING]
    set_oscillator_constants(m, at.OSCILLATOR_2, damping, 1.0)
    set_oscillator_constants(m, at.OSCILLATOR_3, damping, 1.0)
    m[at.FORCE_V] = 0.0
    m[at.FORCE_X] = 0.0
    m[at.SHARE] = 0.0
    m[at.REDUCED_MASS] = m[at.M1]
    m[at.FASTEST] = 1.0
    m[at.STICKING_TIME] = m[at.GAMMA] * (1.0 - m[at.E])


def set_side_constants(m):
    """Set what has another sign or size in the mirrored system; a wall is driven by nothing."""
    side, mu, kappa = m[at.SIDE], m[at.M2] / m[at.M1], m[at.K2] / m[at.K1]
    clearance = m[at.CLEARANCE] if m[at.BONDED] == 0.0 else 0.0
    if side < 0.0:  # rarely
        clearance = m[at.LIMIT] - clearance
    m[at.GAP_OFFSET] = clearance
    one = side / m[at.K1]  # omega^2 m1 = k1
    set_drive_shares(m, at.BOX, side, 0.0, 0.0)
    set_drive_shares(m, at.OSCILLATOR_1, side, one, 0.0)
    if m[at.WALL] != 0.0:  # rarely
        m[at.REST_1] = clearance
        m[at.REST_2] = 0.0
        m[at.PRELOAD] = clearance
        set_drive_shares(m, at.OSCILLATOR_2, 0.0, 0.0, 0.0)
        set_drive_shares(m, at.OSCILLATOR_3, 0.0, 0.0, 0.0)
        set_drive_shares(m, at.GAP, -side, -one, 0.0)
        return
    m[at.REST_1] = clearance * (kappa / (1.0 + kappa))
    m[at.REST_2] = -clearance / (1.0 + kappa)
    square = m[at.OSCILLATOR_2 + at.OMEGA_SQUARED]
    m[at.PRELOAD] = clearance * square * ((1.0 + mu) / (1.0 + kappa))
    two, both = side / (m[at.K1] * mu), side / (m[at.K1] * (1.0 + mu))
    set_drive_shares(m, at.OSCILLATOR_2, side, 0.0, two)
    set_drive_shares(m, at.OSCILLATOR_3, side, both, both)
    set_drive_shares(m, at.GAP, 0.0, -one, two)


def set_drive_shares(m, b, box, force_1, force_2):
    m[b + at.SHARES] = box
    m[b + at.SHARES + 1] = force_1
    m[b + at.SHARES + 2] = force_2


def are_halves_nearly_equal(m):
    return abs(m[at.FORCE_V]) + abs(m[at.FORCE_X]) < ALIKE


def set_oscillator_constants(m, b, damping, omega_squared):
    """Set the constants of one linear oscillator: under-, critically and overdamped alike.

    The envelope (rate r, factor s) bounds both basis functions for all ``t >= 0``: ``|e^{-D t} cos
    nu t| <= e^{-r t}`` and ``|e^{-D t} sin(nu t)/nu| <= s e^{-r t}``, with cosh and sinh beyond
    critical damping. Near the critical damping ``1/nu`` says nothing; there ``t e^{-D t/4} <= 4/(e
    D)`` does.
    """
    omega_i = math.sqrt(omega_squared)
    nu_squared = (omega_i - damping) * (omega_i + damping)  # (11)
    nu = math.sqrt(abs(nu_squared))
    if nu_squared > 0.0 and 4.0 * nu > damping:
        rate, sine = damping, 1.0 / nu
    elif 4.0 * nu > damping:
        # the slower exponent, D - sqrt(D^2 - omega_i^2)
        rate, sine = omega_squared / (damping + nu), 0.5 / nu
    else:
        rate, sine = 0.5 * damping, 1.4715177646857693 / damping  # 4/e
    m[b + at.DAMPING] = damping
    m[b + at.OMEGA_SQUARED] = omega_squared
    m[b + at.NU_SQUARED] = nu_squared
    m[b + at.NU] = nu
    m[b + at.NU_TURNS] = nu / TWO_PI
    m[b + at.ENVELOPE_RATE] = rate
    m[b + at.ENVELOPE_SINE] = sine
    for i in range(2):
        x, v = 1.0 - i, 1.0 * i
        for _ in range(6):
            x, v = v, -(2.0 * damping * v + omega_squared * x)
        m[b + at.SIXTH + i] = x
        m[b + at.SIXTH + 2 + i] = v
