"""The force that would open the faces of a sound structure: pressed by more, they never part."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..constants import TURN
from ..laboratory.pieces import Floats
from ..model import Structure


def unit_opening_force(structure: Structure, frequency: ArrayLike) -> Floats:
    """Return the force between bonded faces under a unit acceleration of the box, N over m/s2."""
    w = TURN * np.asarray(frequency, dtype=float)
    m, k = structure.m1 + structure.m2, structure.k1 + structure.k2
    motion = -m / (k - w**2 * m + 1j * w * (structure.d1 + structure.d2))
    own = structure.k2 - w**2 * structure.m2 + 1j * w * structure.d2
    return np.asarray(np.abs(structure.m2 + own * motion))


def largest_unit_opening_force(structure: Structure, frequency: Floats) -> Floats:
    """Return the largest `unit_opening_force` around each frequency, half way to its neighbours."""
    ends = np.concatenate([frequency[:1], 0.5 * (frequency[1:] + frequency[:-1]), frequency[-1:]])
    around = np.linspace(ends[:-1], ends[1:], 201)
    return np.asarray(unit_opening_force(structure, around).max(axis=0))


def max_steady_sweep_rate(f: float, zeta: float) -> float:
    """Return the fastest linear sweep that shows a resonance as a steady sine does, Hz/s."""
    # ISO 7626-2; Gloth and Sinapius, Mech. Syst. Signal Process. 18 (2004) 1421: 54 f^2/Q^2 Hz/min
    return 54.0 * math.pow(2.0 * zeta * f, 2) / 60.0
