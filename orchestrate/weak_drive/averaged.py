"""Compute speed branch, folds and stability of the bonded weak drive by averaged theory.

At a speed Omega the box answers the unbalance as a linear system does, y = Omega^2 H(i Omega)
S/M_t; the vibration's mean torque is T_v(Omega) = -epsilon Omega^4 Im H(i Omega) / 2, and the motor
gives it where eta0 = Omega + T_v/b. Where eta0 falls with Omega the motion is unstable: the branch
ends in folds, where the speed jumps. It may be unstable elsewhere too: a slow disturbance of the
angle, psi exp(s t), is answered by the vibration at s +- i Omega, and so

    s^2 + b s / (1 + tau s) = epsilon ((G(s + i Omega) + G(s - i Omega)) / 4 - Re G(i Omega) / 2),

G(p) = p^4 H(p), tau = L omega / R_a. Where a pair of its roots passes the imaginary axis is a
Neimark-Sacker point. Non-dimensional throughout: time 1/omega, length S/M_t, voltage
eta0 = U/(K omega).
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from ..dynamics.bifurcation_kinds import Kind
from ..lazy import xr
from ..model.drive import Drive
from ..model.structure import Structure

FOLD, TORUS = Kind.FOLD.label, Kind.TORUS.label


class BifurcationPoint(NamedTuple):
    """Store a bifurcation point of the branch: voltage, speed, and fold or Neimark-Sacker."""

    eta0: float  # voltage
    Omega: float  # speed
    kind: str  # `"fold"` or `"Neimark-Sacker"`


def mechanical_polynomials(
    structure: Structure, drive: Drive
) -> tuple[Polynomial, Polynomial, Polynomial]:
    """Return the polynomials in s of masses' springs and dampers, masses' inertia, and box."""
    beta, mu = drive.beta(structure), structure.mu
    damping = 2.0 * beta * (structure.D1 + mu * structure.D2)
    pull = Polynomial([beta * (1.0 + structure.kappa), damping])
    masses = Polynomial([0.0, 0.0, beta * (1.0 + mu)])
    omega_b = drive.Omega_b(structure)
    box = Polynomial([omega_b**2, 2.0 * drive.D_b(structure), 1.0])
    return pull, masses, box


@lru_cache(maxsize=64)
def response_polynomials(structure: Structure, drive: Drive) -> tuple[Polynomial, Polynomial]:
    """Return numerator and denominator of H(s), from box force to box position."""
    pull, masses, box = mechanical_polynomials(structure, drive)
    return pull + masses, box * (pull + masses) + pull * masses


def transfer_functions(
    structure: Structure, drive: Drive, Omega: ArrayLike
) -> tuple[np.ndarray, np.ndarray]:
    """Return the transfer functions from box force to box position and from box to masses."""
    s = 1j * np.asarray(Omega, dtype=float)
    pull, masses, box = (part(s) for part in mechanical_polynomials(structure, drive))
    ratio = -masses / (masses + pull)
    return 1.0 / (box - pull * ratio), ratio


def stationary_voltage(structure: Structure, drive: Drive, Omega: ArrayLike) -> np.ndarray:
    """Return the voltage eta0 that holds the motor at each speed."""
    Omega = np.asarray(Omega, dtype=float)
    H, _ = transfer_functions(structure, drive, Omega)
    torque = drive.epsilon * Omega**4 * H.imag / (2.0 * drive.b(structure))
    return np.asarray(Omega - torque)


def relative_amplitude(structure: Structure, drive: Drive, Omega: ArrayLike) -> np.ndarray:
    """Return the masses' amplitude relative to the box at each speed, in units of S/M_t."""
    H, ratio = transfer_functions(structure, drive, Omega)
    return np.asarray(np.abs(np.asarray(Omega) ** 2 * H * ratio))


def bonded_resonance(structure: Structure, drive: Drive) -> float:
    """Return the speed over omega at which the bonded masses resonate in the box."""
    return float(np.abs(free_vibration_roots(structure, drive)).max())


def bonded_resonance_half_width(structure: Structure, drive: Drive) -> float:
    roots = free_vibration_roots(structure, drive)
    return float(-roots[np.argmax(np.abs(roots))].real)


def free_vibration_roots(structure: Structure, drive: Drive) -> np.ndarray:
    """Return the complex eigenvalues of free vibration of bonded masses and box, over omega."""
    return np.asarray(response_polynomials(structure, drive)[1].roots())


def eta_between_box_and_bonded_resonance(structure: Structure, drive: Drive) -> float:
    """Return the speed over omega that divides the box's own resonance from the bonded one."""
    # least torque between both: folds below are of the box's own resonance, folds above are not
    frequencies = np.abs(free_vibration_roots(structure, drive))
    high = float(frequencies.max())
    # a slower resonance of the box is far away
    speeds = np.linspace(max(float(frequencies.min()), 0.1 * high), high, 2001)
    return float(speeds[np.argmin(stationary_voltage(structure, drive, speeds) - speeds)])


def folds(structure: Structure, drive: Drive) -> list[BifurcationPoint]:
    """Find the folds of the averaged branch, where the speed jumps (Sommerfeld effect)."""
    numerator, _ = slope_polynomials(structure, drive)
    roots = numerator.roots()
    real = np.sort(roots.real[np.abs(roots.imag) < 1e-6 * np.abs(roots)])
    low = eta_between_box_and_bonded_resonance(structure, drive)
    speeds = [polish_root(numerator, root) for root in real if root >= low]
    return [
        BifurcationPoint(float(stationary_voltage(structure, drive, w)), w, FOLD) for w in speeds
    ]


def bonded_dividing_speed(structure: Structure, drive: Drive) -> float:
    """Return the speed over omega that divides motions below and beyond the resonance."""
    # half way between the outer folds, where all motions are unstable; else the resonance's speed
    ends = folds(structure, drive)
    if not ends:
        return bonded_resonance(structure, drive)
    return 0.5 * (ends[0].Omega + ends[-1].Omega)


def slope_polynomials(structure: Structure, drive: Drive) -> tuple[Polynomial, Polynomial]:
    """Return numerator and denominator of the slope d eta0 / d Omega as polynomials in Omega."""
    above, below = (  # with s = i Omega
        Polynomial(np.asarray(part.coef, dtype=complex) * 1j ** np.arange(len(part.coef)))
        for part in response_polynomials(structure, drive)
    )
    conjugate = Polynomial(below.coef.conj())
    torque = Polynomial((above * conjugate).coef.imag) * Polynomial([0.0, 0.0, 0.0, 0.0, 1.0])
    size = Polynomial((1j * below * conjugate).coef.imag)  # |below|^2
    factor = drive.epsilon / (2.0 * drive.b(structure))
    return size**2 - factor * (torque.deriv() * size - torque * size.deriv()), size**2


def growth_rates(structure: Structure, drive: Drive, Omega: float) -> np.ndarray:
    """Return a motion's complex growth rates of slow disturbances, the fastest growing first."""
    numerator, below = response_polynomials(structure, drive)
    above = numerator * Polynomial([0.0, 0.0, 0.0, 0.0, 1.0])
    at = 1j * Omega
    top, bottom = (part(Polynomial([at, 1.0])) for part in (above, below))
    other_top, other_bottom = (Polynomial(part.coef.conj()) for part in (top, bottom))
    lag = drive.armature_inductance / drive.armature_resistance * structure.omega
    late = Polynomial([1.0, lag])
    still = 0.5 * complex(above(at) / below(at)).real
    free = Polynomial([0.0, 0.0, 1.0]) * late + Polynomial([0.0, drive.b(structure)])
    polynomial = (free + drive.epsilon * still * late) * bottom * other_bottom
    driven = 0.25 * drive.epsilon * late * (top * other_bottom + other_top * bottom)
    roots = Polynomial((polynomial - driven).coef.real[1:]).roots()
    return np.asarray(roots[np.argsort(-roots.real)])


def neimark_sacker_points(structure: Structure, drive: Drive) -> list[BifurcationPoint]:
    """Find the Neimark-Sacker points, where a slow oscillation of the speed starts to grow."""
    from scipy.optimize import brentq

    def hurwitz_product(Omega: float) -> float:
        roots = growth_rates(structure, drive, Omega)
        sums = np.add.outer(roots, roots)[np.triu_indices(len(roots), 1)]
        return float(np.prod(-sums / np.abs(sums).max()).real)

    peak = bonded_resonance(structure, drive)
    low = eta_between_box_and_bonded_resonance(structure, drive)
    speeds = np.linspace(max(0.8 * peak, low), 1.5 * peak, 151)
    signs = np.sign([hurwitz_product(Omega) for Omega in speeds])
    points = []
    for i in np.flatnonzero(signs[1:] != signs[:-1]):
        Omega = float(brentq(hurwitz_product, speeds[i], speeds[i + 1], xtol=1e-12))
        roots = growth_rates(structure, drive, Omega)
        pairs = roots[np.abs(roots.imag) > 1e-9]
        if np.abs(pairs.real).min() < 1e-6:  # no two real ones of opposite signs
            voltage = float(stationary_voltage(structure, drive, Omega))
            points.append(BifurcationPoint(voltage, Omega, TORUS))
    return points


def stability_limits(
    structure: Structure, drive: Drive
) -> tuple[BifurcationPoint | None, BifurcationPoint | None]:
    """Return where stable motions end below the resonance and begin beyond it, if anywhere."""
    points, stable = bifurcations_and_stable_parts(structure, drive)
    if not points:
        return None, None
    ends = [point for point in points if point.kind != TORUS]
    first, last = (ends[0], ends[-1]) if ends else (points[-1], points[0])
    below = [i for i in range(points.index(first) + 1) if stable[i]]
    beyond = [i for i in range(points.index(last) + 1, len(stable)) if stable[i]]
    return (points[below[-1]] if below else None, points[beyond[0] - 1] if beyond else None)


def bifurcations_and_stable_parts(
    structure: Structure, drive: Drive
) -> tuple[list[BifurcationPoint], list[bool]]:
    """Return all folds and Neimark-Sacker points by speed, and whether parts between are stable."""
    speed = bonded_resonance(structure, drive)
    torus = neimark_sacker_points(structure, drive)
    points = sorted([*folds(structure, drive), *torus], key=lambda point: point.Omega)
    speeds = [point.Omega for point in points]
    between = [0.5 * (low + high) for low, high in pairwise(speeds)]
    middles = [0.99 * speeds[0], *between, 1.01 * speeds[-1]] if points else [speed]
    return points, [bool(growth_rates(structure, drive, Omega)[0].real < 0.0) for Omega in middles]


def stationary_curve(structure: Structure, drive: Drive) -> xr.Dataset:
    Omega = np.linspace(0.3, 3.0, 20001)
    volts = stationary_voltage(structure, drive, Omega) * drive.volts(structure)
    points, stable = bifurcations_and_stable_parts(structure, drive)
    part = np.searchsorted([point.Omega for point in points], Omega)
    amplitudes = relative_amplitude(structure, drive, Omega) * drive.length
    curves = {
        "voltage": ("speed", volts, {"units": "V"}),
        "amplitude": ("speed", amplitudes, {"units": "m"}),
        "stable": ("speed", np.array(stable)[part]),
    }
    speed = ("speed", Omega * structure.omega, {"units": "rad/s"})
    return xr.Dataset(curves, {"speed": speed}, structure.parameters())


def polish_root(polynomial: Polynomial, root: float) -> float:
    derivative = polynomial.deriv()
    value, slope = polynomial(root), derivative(root)
    for _ in range(3):
        if slope == 0.0:  # a double root: companion matrices have it as well as it can be had
            break
        better = root - value / slope
        left = polynomial(better)
        if not abs(left) < abs(value):
            break
        root, value, slope = better, left, derivative(better)
    return float(root)
