"""Growth under products of matrices: the largest Lyapunov exponent, or all four; the dimension.

The sum of the k largest exponents is the growth of a volume, carried along by compound matrices,
the k-rowed minors (Temam, Infinite-Dimensional Dynamical Systems, 1997, V.2). The state is taken
once a period: no exponent is zero for the direction of time.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import NamedTuple

import numpy as np

from ..fmu import Impacts
from ..model import Structure
from ..response.questions import Point
from .closed_form import Floats
from .variational import deviation_matrices_and_contacts, exponent_library

STATES = 4
CONTACT_RANK = 2  # of a matrix where permanent contact begins


class Spectrum(NamedTuple):
    """Four Lyapunov exponents per unit of tau, the largest first, and their standard errors."""

    exponents: Floats
    errors: Floats


def compound_matrices(matrices: Floats, order: int) -> Floats:
    """Return compound matrices (all minors of an order), which map volume elements."""
    if order == 1:
        return matrices
    chosen = np.array(list(combinations(range(matrices.shape[-1]), order)))
    parts = matrices[:, chosen[:, None, :, None], chosen[None, :, None, :]]
    return np.asarray(np.linalg.det(parts))


def lyapunov_spectrum(
    impacts: Impacts, end: float, point: Point, blocks: int, batches: int
) -> Spectrum:
    """Return the exponents by non-dimensional impacts up to ``end``: -inf beyond the rank."""
    library, times = exponent_library(), impacts.time
    matrices, _ = deviation_matrices_and_contacts(impacts, end, point)
    rank = CONTACT_RANK if impacts.sticks.any() else STATES
    size = max(1, len(times) // blocks)  # of a block
    durations = np.diff(np.append(times[::size], end))
    spectrum, before = unknown_spectrum(-math.inf), np.zeros_like(durations)
    for order in range(1, rank + 1):
        volumes = np.ascontiguousarray(compound_matrices(matrices, order))
        growth, mean_and_error = np.empty_like(durations), np.empty(2)  # growth: logarithmic
        counts = *volumes.shape[:2], size
        if not library.find_growth(volumes.ctypes.data, *counts, growth.ctypes.data):
            break  # it becomes zero
        more, before = growth - before, growth
        columns = more.ctypes.data, durations.ctypes.data, len(more)
        library.find_average(*columns, batches, mean_and_error.ctypes.data)
        spectrum.exponents[order - 1], spectrum.errors[order - 1] = mean_and_error
    return spectrum


def unknown_spectrum(exponent: float = math.nan) -> Spectrum:
    """Return four times an exponent, without errors."""
    return Spectrum(np.full(STATES, exponent), np.full(STATES, math.nan))


def bonded_spectrum(structure: Structure) -> Spectrum:
    """Return the exact spectrum of a bonded structure: damped common motion (10), gap -inf."""
    damping, square = structure.D3, (1.0 + structure.kappa) / (1.0 + structure.mu)
    excess = complex(damping**2 - square) ** 0.5
    exponents = np.full(STATES, -math.inf)
    exponents[:CONTACT_RANK] = (-damping + excess.real, -damping - excess.real)
    return Spectrum(exponents, np.where(np.isfinite(exponents), 0.0, math.nan))


def kaplan_yorke_dimension(exponents: Floats) -> float:
    """Return the Kaplan-Yorke (Lyapunov) dimension from exponents in descending order."""
    # Kaplan and Yorke, in Lecture Notes in Mathematics 730, 1979
    if np.isnan(exponents).any():
        return math.nan
    sums = np.cumsum(exponents)
    whole = int(np.count_nonzero(np.logical_and.accumulate(sums >= 0.0)))
    if whole in (0, len(exponents)):
        return float(whole)
    return whole + float(sums[whole - 1] / -exponents[whole])
