"""All four Lyapunov exponents of a response, and the Kaplan-Yorke dimension of its attractor.

The sum of the k largest exponents is the growth of a k-dimensional volume. Volumes are carried
along by compound matrices: those of the k-rowed minors of the matrices that carry a deviation
(Temam, Infinite-Dimensional Dynamical Systems, 1997, section V.2). So each sum is the largest
exponent of a product of its own, and no small exponent has to be found beside a large one.

The state is (xi_1, xi_2, xi_1', xi_2') once an excitation period: no exponent is zero for the
direction of time. Where permanent contact begins the gap and its rate are forgotten, the matrices
have rank two, and the third and the fourth exponent are minus infinity.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import NamedTuple

import numpy as np

from ..access import Impacts
from ..response.questions import Point
from ..structures import Structure
from .closed_form import Floats
from .lyapunov_growth import block_growth, growth_by_batch_means
from .variational import impact_matrices

STATES = 4
CONTACT_RANK = 2  # of a matrix where permanent contact begins


class Spectrum(NamedTuple):
    """Four Lyapunov exponents per unit of tau, the largest first, and their standard errors."""

    exponents: Floats
    errors: Floats

    @property
    def dimension(self) -> float:
        """Kaplan-Yorke dimension of the attractor in the stroboscopic section."""
        return kaplan_yorke_dimension(self.exponents)


def compound_matrices(matrices: Floats, order: int) -> Floats:
    """Return compound matrices (all minors of an order), which map volume elements.

    Examples
    --------
    >>> compound_matrices(np.array([np.diag([2.0, 3.0, 5.0])]), 2)[0].diagonal().round(12).tolist()
    [6.0, 10.0, 15.0]
    """
    if order == 1:
        return matrices
    chosen = np.array(list(combinations(range(matrices.shape[-1]), order)))
    parts = matrices[:, chosen[:, None, :, None], chosen[None, :, None, :]]
    return np.asarray(np.linalg.det(parts))


def lyapunov_spectrum(
    impacts: Impacts, end: float, point: Point, blocks: int, batches: int
) -> Spectrum:
    """Return all four exponents and their errors, from a response's impacts in a span."""
    matrices = impact_matrices(impacts, end, point)
    rank = CONTACT_RANK if impacts.sticks.any() else STATES
    exponents, errors = np.full(STATES, -math.inf), np.full(STATES, math.nan)
    before: Floats | None = None
    for order in range(1, rank + 1):
        volumes = block_growth(compound_matrices(matrices, order), impacts.time, end, blocks)
        if volumes is None:
            break
        growth = volumes.growth if before is None else volumes.growth - before
        before = volumes.growth
        exponents[order - 1], errors[order - 1] = growth_by_batch_means(
            volumes._replace(growth=growth), batches
        )
    return Spectrum(exponents, errors)


def spectrum_without_impacts(structure: Structure) -> Spectrum:
    """Return the exact spectrum of a bonded structure: damped common motion (10), gap -inf.

    The gap is no state of it: two exponents are minus infinity.
    """
    damping, square = structure.D3, (1.0 + structure.kappa) / (1.0 + structure.mu)
    excess = complex(damping**2 - square) ** 0.5
    exponents = np.full(STATES, -math.inf)
    exponents[:CONTACT_RANK] = (-damping + excess.real, -damping - excess.real)
    return Spectrum(exponents, np.where(np.isfinite(exponents), 0.0, math.nan))


def kaplan_yorke_dimension(exponents: Floats) -> float:
    """Return the Kaplan-Yorke (Lyapunov) dimension from exponents in descending order.

    The number of exponents, the largest first, whose sum is not negative, and the part of the next
    one that makes the sum zero (Kaplan and Yorke, in Lecture Notes in Mathematics 730, 1979).

    Examples
    --------
    >>> kaplan_yorke_dimension(np.array([0.5, -1.0, -2.0]))
    1.5
    >>> kaplan_yorke_dimension(np.array([-0.1, -0.2]))
    0.0
    """
    if np.isnan(exponents).any():
        return math.nan
    sums = np.cumsum(exponents)
    whole = int(np.count_nonzero(np.logical_and.accumulate(sums >= 0.0)))
    if whole in (0, len(exponents)):
        return float(whole)
    return whole + float(sums[whole - 1] / -exponents[whole])
