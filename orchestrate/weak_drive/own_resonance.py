"""Compute the delaminated structure's resonance and the speed that divides its motions.

Without dampers and with e = 1 the halves and the box move freely from one impact to the next, even
in time about the middle of the flight. With the frequencies w and modes of the free system, scaled
to mass 1, and n the change of the gap in each mode, the impact turns all velocities round where
each amplitude is as n / (w sin(w pi/Omega)), and the gap closes at the flight's ends where

    sum n^2 cot(w pi/Omega) / w = 0.

The sum rises with Omega between any two of its poles, so each root is bracketed. The mode is that
with a positive gap between the two upper frequencies w. Its speed does not depend on the amplitude.
It is mostly that of the bonded structure, within a few thousandths; where the halves are unlike it
is another one. A clearance is left out: motions at the resonance are large compared with it.

Non-dimensional throughout: speeds over omega.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np

from ..model.drive import Drive
from ..model.structure import Structure
from . import averaged


@lru_cache(maxsize=64)
def elastic_resonance(structure: Structure, drive: Drive) -> float:
    """Compute the undamped resonance speed with one elastic impact a revolution."""
    from scipy.optimize import brentq

    w, n = free_modes_of_gap(structure, drive)
    turns = np.linspace(-1.0, 1.0, 401)[1:-1]  # half ones, from an impact to the next

    def gap_at_impact(Omega: float) -> float:
        return float((n**2 / (w * np.tan(w * np.pi / Omega))).sum())

    poles = (w[:, np.newaxis] / np.arange(1, 1 + int(w[-1] / w[-2]))).ravel()
    poles = np.unique(poles[(poles >= w[-2]) & (poles <= w[-1])])
    bonded, roots = averaged.bonded_resonance(structure, drive), []
    for low, high in pairwise(poles.tolist()):
        ends = low * (1.0 + 1e-9), high * (1.0 - 1e-9)  # not at the poles themselves
        if gap_at_impact(ends[0]) < 0.0 < gap_at_impact(ends[1]):
            root = float(brentq(gap_at_impact, *ends, xtol=1e-12))
            gaps = np.cos(np.outer(np.pi / root * turns, w)) @ (
                n**2 / (w * np.sin(w * np.pi / root))
            )
            if (gaps > 0.0).all() or (gaps < 0.0).all():  # whatever the sign of the mode
                roots.append(root)
    return min(roots, key=lambda root: abs(root - bonded), default=bonded)


def free_modes_of_gap(structure: Structure, drive: Drive) -> tuple[np.ndarray, np.ndarray]:
    """Compute the natural frequencies without contact, and each mode's change of gap."""
    from scipy.linalg import eigh

    beta, mu = drive.beta(structure), structure.mu
    masses = beta * np.array([1.0, mu])
    inertia = np.diag([*masses, 1.0 + masses.sum()])  # displacements in the box, and its own
    inertia[:2, 2] = inertia[2, :2] = masses
    springs = np.diag([beta, beta * structure.kappa, drive.Omega_b(structure) ** 2])
    squares, modes = eigh(springs, inertia)
    return np.sqrt(np.maximum(squares, 1e-6**2)), modes[1] - modes[0]  # of a box without springs


def lower_and_higher_resonance(structure: Structure, drive: Drive) -> tuple[float, float]:
    """Return the lower and the higher of the bonded and delaminated resonance speeds."""
    low, high = sorted(
        averaged.bonded_resonance(kind, drive) + resolved_resonance_shift(kind, drive)
        for kind in (structure.as_bonded(), structure.as_delaminated())
    )
    return low, high


def dividing_speed(structure: Structure, drive: Drive) -> float:
    """Return the speed over omega that divides motions below and beyond resonance."""
    shift = resolved_resonance_shift(structure, drive)
    return averaged.bonded_dividing_speed(structure, drive) + shift


def resonance_shift(structure: Structure, drive: Drive) -> float:
    """Return the structure's resonance speed minus the bonded one, over omega."""
    if structure.bonded:
        return 0.0
    return elastic_resonance(structure, drive) - averaged.bonded_resonance(structure, drive)


def resolved_resonance_shift(structure: Structure, drive: Drive) -> float:
    """Return the resonance shift if it exceeds fold range and resonance width, else 0."""
    distance = resonance_shift(structure, drive)
    folds = averaged.folds(structure, drive) if distance else []
    half = 0.5 * (folds[-1].Omega - folds[0].Omega) if folds else 0.0
    clear = abs(distance) > max(half, averaged.bonded_resonance_half_width(structure, drive))
    return distance if clear else 0.0
