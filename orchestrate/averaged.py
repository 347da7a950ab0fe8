"""The averaged theory of the weak drive, bonded structure: the motor's torque line against the mean torque of the vibration.

At a speed Omega the box answers the unbalance as a linear system does, y = Omega^2 H(i Omega) S/M_t; the vibration's mean torque is
T_v(Omega) = -epsilon Omega^4 Im H(i Omega) / 2, and the motor gives it where eta0 = Omega + T_v/b. Where eta0 falls with Omega the
motion is unstable: the branch ends in folds, where the speed jumps. Non-dimensional throughout, see :mod:`.setups`.
"""

import numpy as np


def transfer(setup, Omega):
    """H of the box with the bonded masses on it, and the masses' displacement from the box over the box's.

    Parameters
    ----------
    setup : Setup
    Omega : ndarray

    Returns
    -------
    H, ratio : ndarray of complex
    """
    s = 1j * np.asarray(Omega, dtype=float)
    mass = setup.beta * (1.0 + setup.mu)
    damping = 2.0 * setup.D * setup.beta * (1.0 + setup.damping_ratio * setup.mu)
    pull = damping * s + setup.beta * (1.0 + setup.kappa)
    ratio = -mass * s**2 / (mass * s**2 + pull)
    return 1.0 / (s**2 + 2.0 * setup.D_b * s + setup.Omega_b**2 - pull * ratio), ratio


def no_load_speed(setup, Omega):
    """The voltage eta0 that holds a speed, eta0 = Omega + T_v/b."""
    Omega = np.asarray(Omega, dtype=float)
    H, _ = transfer(setup, Omega)
    return Omega - setup.epsilon * Omega**4 * H.imag / (2.0 * setup.b)


def amplitude(setup, Omega):
    """Amplitude of the masses relative to the box, in S/M_t."""
    H, ratio = transfer(setup, Omega)
    return np.abs(np.asarray(Omega) ** 2 * H * ratio)


def folds(setup, low=0.5, high=3.0, count=2_000_001):
    """Where the speed jumps.

    Parameters
    ----------
    setup : Setup
    low, high : float
        Range of Omega.
    count : int

    Returns
    -------
    list of (float, float)
        eta0 and Omega at the top (jump up) and at the bottom (jump down) of the unstable branch; empty without one.
    """
    Omega = np.linspace(low, high, count)
    eta0 = no_load_speed(setup, Omega)
    falling = np.flatnonzero(np.diff(eta0) < 0.0)
    return [(float(eta0[i]), float(Omega[i])) for i in (falling[0], falling[-1] + 1)] if falling.size else []
