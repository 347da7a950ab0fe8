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


class BlockGrowth(NamedTuple):
    """Logarithmic growth of a vector over successive blocks of matrices, and their durations."""

    growth: Floats  # logarithm of a vector's growth over each block
    durations: Floats  # of the blocks, in units of tau


def block_growth(matrices: Floats, times: Floats, end: float, blocks: int) -> BlockGrowth | None:
    """Return a vector's logarithmic growth over blocks of matrices; None if it becomes zero."""
    matrices = np.ascontiguousarray(matrices)
    count, rows = matrices.shape[:2]
    size = max(1, count // blocks)
    growth = np.empty(-(-count // size))
    data, out = matrices.ctypes.data, growth.ctypes.data
    if not exponent_library().find_growth(data, count, rows, size, out):
        return None
    return BlockGrowth(growth, np.diff(np.append(times[::size], end)))


def mean_growth_and_error(blocks: BlockGrowth, batches: int) -> tuple[float, float]:
    """Return the mean growth per unit of tau, and its standard error by batch means."""
    growth, durations = (np.ascontiguousarray(column) for column in blocks)
    mean, columns = np.empty(2), (growth.ctypes.data, durations.ctypes.data)
    exponent_library().find_average(*columns, len(growth), batches, mean.ctypes.data)
    return float(mean[0]), float(mean[1])


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
    matrices, _ = deviation_matrices_and_contacts(impacts, end, point)
    rank = CONTACT_RANK if impacts.sticks.any() else STATES
    exponents, errors = np.full(STATES, -math.inf), np.full(STATES, math.nan)
    before: Floats | None = None
    for order in range(1, rank + 1):
        volumes = block_growth(compound_matrices(matrices, order), impacts.time, end, blocks)
        if volumes is None:
            break
        growth = volumes.growth if before is None else volumes.growth - before
        before = volumes.growth
        exponents[order - 1], errors[order - 1] = mean_growth_and_error(
            volumes._replace(growth=growth), batches
        )
    return Spectrum(exponents, errors)


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
