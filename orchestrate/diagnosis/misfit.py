"""The soft misfit of residuals, and these as a linear model around a minimum, from a cloud.

Impacts that come or stay away make residuals rugged: differences over small steps are those of
single impacts. Over a cloud of points they average out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ..laboratory.pieces import Floats

Bounds = Mapping[str, tuple[float, float]]
SOFT_LIMIT = 3.0  # residuals above count by their size, not its square: a jump may be a window off


def soft_l1_loss(residuals: Floats) -> Floats:
    """Return the soft l1 loss: squares of small residuals, sizes of large ones."""
    return np.asarray(2.0 * SOFT_LIMIT**2 * (np.sqrt(1.0 + (residuals / SOFT_LIMIT) ** 2) - 1.0))


def misfit(residuals: Floats) -> float:
    """Return the square root of the mean soft l1 loss of the residuals."""
    return math.sqrt(float(np.mean(soft_l1_loss(residuals))))


@dataclass(frozen=True)
class LinearModel:
    """Hold a linear model of the residuals: ``residuals + slopes (values - here)``."""

    residuals: Floats
    slopes: Floats
    best: dict[str, float]  # numbers of the point of the cloud with the smallest misfit, and
    lowest: float  # that misfit
    # deviations of the cloud's points from the regression: single impacts that come or stay away
    scatter: Floats

    @classmethod
    def fit_to_cloud(
        cls,
        residuals: Callable[[Mapping[str, float]], Floats],
        bounds: Bounds,
        values: Mapping[str, float],
        covariance: Floats,
        seed: int,
        points: int,
    ) -> LinearModel:
        """Compute residuals at a cloud of ``points`` a fitted number, and their regression."""
        count = len(values)
        rng = np.random.default_rng([20_241, seed])
        sizes, axes = np.linalg.eigh(covariance)
        normal = rng.standard_normal((points * count, count))
        normal -= normal.mean(axis=0)
        offsets = (normal * np.sqrt(np.maximum(sizes, 0.0))) @ axes.T
        here = np.array(list(values.values()))
        low, high = np.array([bounds[name] for name in values]).T
        places = np.clip(here + offsets, low, high)
        named = [dict(zip(values, place, strict=True)) for place in places.tolist()]
        rows = np.stack([residuals(one) for one in named])
        basis = np.column_stack([np.ones(len(places)), places - here])
        solution = np.linalg.lstsq(basis, rows.reshape(len(rows), -1), rcond=None)[0]
        shape = rows.shape[1:]
        sizes_of_rows = [misfit(row) for row in rows]
        number = int(np.argmin(sizes_of_rows))
        slopes = solution[1:].T.reshape(*shape, count)
        residuals_here = solution[0].reshape(shape)
        free = max(len(places) - basis.shape[1], 1)
        scatter = (rows.reshape(len(rows), -1) - basis @ solution) * np.sqrt(len(places) / free)
        return cls(residuals_here, slopes, named[number], sizes_of_rows[number], scatter)

    @property
    def weighted_slopes(self) -> Floats:
        """Slopes times the weights of the soft loss, one row a residual."""
        weights = 1.0 / np.sqrt(1.0 + (self.residuals / SOFT_LIMIT) ** 2)  # loss over plain squares
        return (self.slopes * weights[..., np.newaxis]).reshape(-1, self.slopes.shape[-1])

    @property
    def normal_matrix(self) -> Floats:
        """Matrix ``J'WJ`` of the normal equations."""
        return self.weighted_slopes.T @ self.slopes.reshape(-1, self.slopes.shape[-1])

    @property
    def minus_inverse_normal_matrix(self) -> Floats:
        """Matrix ``-(J'WJ)^-1``, from changes of ``J'W residuals`` to shifts of the minimum."""
        information = self.normal_matrix
        size = np.sqrt(np.maximum(np.diag(information), 1e-300))
        scaled = information / np.outer(size, size)
        return -np.linalg.pinv(scaled, hermitian=True, rcond=1e-9) / np.outer(size, size)

    def cloud_covariance(self) -> Floats:
        """Return the covariance of a cloud over which the squares grow by 30 %."""
        squares = float(np.sum(self.residuals.ravel() ** 2))
        inverse = -self.minus_inverse_normal_matrix
        return np.asarray(inverse * 0.3 * squares / len(inverse))

    def damped_minima(self, bounds: Bounds, values: Mapping[str, float]) -> list[dict[str, float]]:
        """Return the model's minimum within the bounds, for each damping from none to much."""
        information, slope = self.normal_matrix, self.weighted_slopes.T @ self.residuals.ravel()
        size = np.diag(np.maximum(np.diag(information), 1e-300))
        found = []
        for damping in (0.0, 0.01, 0.1, 1.0):
            step = np.linalg.lstsq(information + damping * size, -slope, rcond=1e-12)[0]
            moved = zip(values.items(), step.tolist(), strict=True)
            found.append({name: clip(value + s, bounds[name]) for (name, value), s in moved})
        return found


def clip(value: float, bounds: tuple[float, float]) -> float:
    return float(min(max(value, bounds[0]), bounds[1]))
