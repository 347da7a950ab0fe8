"""Responses from many starts, told apart into attractors."""

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage

from .sweep import Plan, respond

FEATURES = ("multiplicity", "impacts_per_period", "xi_rel_max", "mean", "deviation")
SAMPLES = 48  # periods looked at
SLOW = 300  # periods dropped at least, times eta: a decay e^{-D tau} with D = 0.005 by a factor of ten thousand
COUNTS = 0.2  # weight of the impacts per period: a count over the samples may be off by one
REGULAR, IRREGULAR = 0.02, 0.25  # features of one attractor differ by less, relatively: periodic responses, others


def features(instance, case, eta, start, settle):
    """What tells a settled response apart, by ``FEATURES``: none of it depends on the phase at which it is looked at.

    Parameters
    ----------
    instance : Instance
    case : Case
    eta : float
    start : tuple of float
        State at phase 0.
    settle : int
        Periods dropped.
    """
    response = respond(instance, Plan(case, (), settle, SAMPLES, 1e-2, ""), eta, start)
    n, samples = response.multiplicity, response.xi_rel
    in_period = n * response.impacts_per_period
    if abs(in_period - round(in_period)) > n / SAMPLES:  # the state nearly repeats, its impacts do not
        n = 0
    return [n, response.impacts_per_period, response.xi_rel_max, samples.mean(), samples.std()]


def settling(settle, eta):
    """Periods to drop from a start far from the response: ``settle`` at least, and more where periods are short."""
    return max(settle, round(SLOW * eta))


def clusters(rows):
    """Labels 0, 1, ... of attractors, the most frequent first.

    Parameters
    ----------
    rows : ndarray, shape (n, 5)
        Features of responses. Periodic ones belong together where multiplicity and impacts agree and the rest within 2 per cent; others by
        25 per cent, since their means are taken over few periods.

    Returns
    -------
    ndarray of int, shape (n,)
    """
    rows = np.asarray(rows, dtype=float)
    labels, scale = np.zeros(len(rows), dtype=int), np.maximum(np.abs(rows[:, 2]), 1e-300)
    shape = np.column_stack([np.log(scale), rows[:, 3] / scale, rows[:, 4] / scale])
    for n in np.unique(rows[:, 0]):
        which = np.flatnonzero(rows[:, 0] == n)
        points = np.column_stack([shape[which], COUNTS * rows[which, 1]])
        found = fcluster(linkage(points, "single"), REGULAR if n else IRREGULAR, "distance") if len(which) > 1 else np.ones(1, dtype=int)
        labels[which] = labels.max() + found
    names, positions, sizes = np.unique(labels, return_inverse=True, return_counts=True)
    rank = np.empty(len(names), dtype=int)
    rank[np.argsort(-sizes, kind="stable")] = np.arange(len(names))
    return rank[positions]
