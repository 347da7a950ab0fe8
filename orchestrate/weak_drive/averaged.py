"""The averaged theory of the weak drive, bonded structure: motor against mean torque of vibration.

At a speed Omega the box answers the unbalance as a linear system does, y = Omega^2 H(i Omega)
S/M_t; the vibration's mean torque is T_v(Omega) = -epsilon Omega^4 Im H(i Omega) / 2, and the motor
gives it where eta0 = Omega + T_v/b. Where eta0 falls with Omega the motion is unstable: the branch
ends in folds, where the speed jumps. Non-dimensional throughout: time 1/omega, length S/M_t,
voltage eta0 = U/(K omega).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from ..structures.drive import Drive
from ..structures.structure import Structure


class Fold(NamedTuple):
    """Where a branch of stationary motions turns back.

    Attributes
    ----------
    eta0, Omega : float
        Voltage and speed.
    """

    eta0: float
    Omega: float


def mechanics(structure: Structure, drive: Drive) -> tuple[Polynomial, Polynomial, Polynomial]:
    """Springs and dampers of the masses, their inertia, and the box alone: polynomials in s."""
    beta, mu = drive.beta(structure), structure.mu
    damping = 2.0 * beta * (structure.D1 + mu * structure.D2)
    pull = Polynomial([beta * (1.0 + structure.kappa), damping])
    masses = Polynomial([0.0, 0.0, beta * (1.0 + mu)])
    omega_b = drive.Omega_b(structure)
    box = Polynomial([omega_b**2, 2.0 * drive.D_b(structure), 1.0])
    return pull, masses, box


def transfer(structure: Structure, drive: Drive, Omega: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """H of the box with the bonded masses, and their displacement from the box over the box's.

    Parameters
    ----------
    structure : Structure
    drive : Drive
    Omega : array_like
        Speed over omega.

    Returns
    -------
    H, ratio : ndarray of complex
    """
    s = 1j * np.asarray(Omega, dtype=float)
    pull, masses, box = (part(s) for part in mechanics(structure, drive))
    ratio = -masses / (masses + pull)
    return 1.0 / (box - pull * ratio), ratio


def no_load_speed(structure: Structure, drive: Drive, Omega: ArrayLike) -> np.ndarray:
    """The voltage eta0 that holds a speed, eta0 = Omega + T_v/b."""
    Omega = np.asarray(Omega, dtype=float)
    H, _ = transfer(structure, drive, Omega)
    torque = drive.epsilon * Omega**4 * H.imag / (2.0 * drive.b(structure))
    return np.asarray(Omega - torque)


def amplitude(structure: Structure, drive: Drive, Omega: ArrayLike) -> np.ndarray:
    """Amplitude of the masses relative to the box, in S/M_t."""
    H, ratio = transfer(structure, drive, Omega)
    return np.asarray(np.abs(np.asarray(Omega) ** 2 * H * ratio))


def resonance(structure: Structure, drive: Drive) -> float:
    """Speed over omega at which the bonded masses resonate in the box: its faster frequency."""
    pull, masses, box = mechanics(structure, drive)
    roots = (box * (pull + masses) + pull * masses).roots()
    return float(np.abs(roots).max())


def folds(structure: Structure, drive: Drive, low: float = 0.5, high: float = 3.0) -> list[Fold]:
    """Where the speed jumps: zeros of d eta0 / d Omega.

    Parameters
    ----------
    structure : Structure
    drive : Drive
    low, high : float
        Range of Omega; the box's own resonance lies below it.

    Returns
    -------
    list of Fold
        By speed: a jump up, where eta0 is largest, then a jump down, and so on; empty without
        folds.
    """
    numerator, denominator = slope(structure, drive)
    roots = numerator.roots()
    real = np.sort(roots.real[np.abs(roots.imag) < 1e-6 * np.abs(roots)])
    speeds = [polished(numerator, root) for root in real if low <= root <= high]
    return [Fold(float(no_load_speed(structure, drive, Omega)), Omega) for Omega in speeds]


def dividing_speed(structure: Structure, drive: Drive) -> float:
    """Speed over omega between stationary motions below and beyond the resonance.

    Half way between the speeds of the outer folds, where all motions are unstable; the resonance's
    speed where there are none.
    """
    ends = folds(structure, drive)
    if not ends:
        return resonance(structure, drive)
    return 0.5 * (ends[0].Omega + ends[-1].Omega)


def slope(structure: Structure, drive: Drive) -> tuple[Polynomial, Polynomial]:
    """The derivative d eta0 / d Omega as numerator and denominator, polynomials in Omega."""
    pull, masses, box = (on_the_axis(part) for part in mechanics(structure, drive))
    above, below = pull + masses, box * (pull + masses) + pull * masses
    torque = imaginary(above * conjugate(below)) * Polynomial([0.0, 0.0, 0.0, 0.0, 1.0])
    size = imaginary(1j * below * conjugate(below))  # |below|^2
    factor = drive.epsilon / (2.0 * drive.b(structure))
    return size**2 - factor * (torque.deriv() * size - torque * size.deriv()), size**2


def on_the_axis(polynomial: Polynomial) -> Polynomial:
    """A polynomial in s as one in Omega, with s = i Omega."""
    powers = 1j ** np.arange(len(polynomial.coef))
    return Polynomial(np.asarray(polynomial.coef, dtype=complex) * powers)


def conjugate(polynomial: Polynomial) -> Polynomial:
    """Conjugate of a polynomial for real arguments."""
    return Polynomial(polynomial.coef.conj())


def imaginary(polynomial: Polynomial) -> Polynomial:
    """Imaginary part of a polynomial for real arguments."""
    return Polynomial(polynomial.coef.imag)


def polished(polynomial: Polynomial, root: float) -> float:
    """A root, better by Newton's method."""
    derivative = polynomial.deriv()
    for _ in range(3):
        root -= polynomial(root) / derivative(root)
    return float(root)
