"""Windows and limits read off a sweep: runs of neighbouring frequencies whose responses are of one kind."""

import numpy as np

from ..fmu import Instance
from ..sweep import Plan, respond

BEYOND = 1.0  # how far in eta a window is followed beyond the sweep's end
STEP = 0.001


def runs(flags):
    """First and last index of each run of true values, as a list of pairs."""
    padded = np.concatenate([[False], np.asarray(flags, dtype=bool), [False]])
    edges = np.flatnonzero(padded[1:] != padded[:-1])
    return [(int(first), int(after) - 1) for first, after in zip(edges[0::2], edges[1::2], strict=True)]


def longest(flags):
    """The longest run, as a pair of indices; None where there is none."""
    return max(runs(flags), key=lambda run: run[1] - run[0], default=None)


def simple(sweep, n):
    """Where responses have the period nT and one impact in it."""
    slack = 1.5 / sweep.sizes["sample"]  # of a count over a span that is no multiple of the period
    return (sweep.multiplicity.values == n) & (np.abs(sweep.impacts_per_period.values - 1.0 / n) <= slack)


def window(sweep, n):
    """First and last eta of the longest window of period nT with one impact in it, or None."""
    run = longest(simple(sweep, n))
    return None if run is None else (float(sweep.eta.values[run[0]]), float(sweep.eta.values[run[1]]))


def relative_peak(sweep, n):
    """Where the largest gap has its largest local maximum inside the window of period nT; None where it has none."""
    limits = window(sweep, n)
    if limits is None:
        return None
    part = sweep.sel(eta=slice(*limits))
    return summit(part.eta.values, part.xi_rel_max.values)


def summit(etas, gaps):
    """The eta of the largest local maximum that is not at an end, or None."""
    inside = np.flatnonzero((gaps[1:-1] > gaps[:-2]) & (gaps[1:-1] >= gaps[2:])) + 1
    return float(etas[inside[np.argmax(gaps[inside])]]) if len(inside) else None


def followed(fmu, panel, n):
    """Go on with a sweep from a panel upwards until the largest gap of the responses nT with one impact has passed a maximum.

    Parameters
    ----------
    fmu : Path
    panel : Panel
    n : int

    Returns
    -------
    eta : float
        Of the maximum.
    start : tuple of float
        The response's state there.
    """
    etas = np.round(panel.eta + STEP * np.arange(1, round(BEYOND / STEP)), 9)
    plan = Plan(panel.case, tuple(etas), 500, 80, 1e-2, "")
    start, best = panel.start, (panel.eta, panel.start, 0.0)
    with Instance(fmu) as instance:
        for eta in etas:
            response = respond(instance, plan, float(eta), start)
            start, gap = response.end, response.xi_rel_max
            if gap < 0.98 * best[2]:
                break
            if gap > best[2] and response.multiplicity == n and abs(response.impacts_per_period * n - 1.0) < 0.1:
                best = (float(eta), response.end, gap)
    return best[0], best[1]
