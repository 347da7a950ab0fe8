"""Cluster irregular responses by single linkage of features that do not depend on the phase."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .settled_motion import Floats
from .settling import AttractorSettings

FEATURES = ("multiplicity", "impacts_per_period", "xi_rel_max", "mean", "deviation")


def irregular_clusters(rows: ArrayLike, settings: AttractorSettings) -> NDArray[np.intp]:
    """Cluster irregular responses' feature rows by single linkage; return a label per row.

    The distance is Euclidean: of the logarithm of the largest gap, of mean and deviation over it,
    and of the impacts a period times `count_weight`.
    """
    table = np.asarray(rows, dtype=float).reshape(-1, len(FEATURES))
    scale = np.maximum(np.abs(table[:, 2]), 1e-300)
    counts = settings.count_weight * table[:, 1]
    points = np.column_stack([np.log(scale), table[:, 3] / scale, table[:, 4] / scale, counts])
    return single_linkage(points, settings.alike_irregular)


def single_linkage(points: Floats, radius: float) -> NDArray[np.intp]:
    """Cluster points (n, d) by single linkage with a radius; return a label per point."""
    # memory grows with the number of points, not its square as in scipy.cluster.hierarchy.linkage
    labels = np.zeros(len(points), dtype=np.intp)
    left = np.arange(len(points))
    count = 0
    while len(left):
        waiting, left = [left[0]], left[1:]
        labels[waiting[0]] = count
        while waiting and len(left):
            near = np.linalg.norm(points[left] - points[waiting.pop()], axis=1) <= radius
            labels[left[near]] = count
            waiting.extend(left[near])
            left = left[~near]
        count += 1
    return labels
