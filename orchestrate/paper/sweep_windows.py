"""Find windows and their peaks in a sweep: runs of frequencies with one kind of response."""

from __future__ import annotations

import numpy as np
import xarray as xr


def runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """Return first and last index of each run of true values."""
    padded = np.concatenate([[False], np.asarray(flags, dtype=bool), [False]])
    edges = np.flatnonzero(padded[1:] != padded[:-1])
    return [
        (int(first), int(after) - 1) for first, after in zip(edges[0::2], edges[1::2], strict=True)
    ]


def longest_run(flags: np.ndarray) -> tuple[int, int] | None:
    """Return first and last index of the longest run of true values; None without any."""
    return max(runs(flags), key=lambda run: run[1] - run[0], default=None)


def window(sweep: xr.Dataset, n: int) -> tuple[float, float] | None:
    """Return first and last eta of the longest window nT with one impact; None without one."""
    slack = 1.5 / sweep.sizes["sample"]  # of a count over a span that is no multiple of the period
    one_impact = np.abs(sweep.impacts_per_period.values - 1.0 / n) <= slack
    run = longest_run((sweep.multiplicity.values == n) & one_impact)
    etas = sweep.eta.values
    return None if run is None else (float(etas[run[0]]), float(etas[run[1]]))


def relative_peak(sweep: xr.Dataset, n: int) -> float | None:
    """Return the eta of the gap's largest local maximum in the window nT; None without one."""
    limits = window(sweep, n)
    if limits is None:
        return None
    part = sweep.sel(eta=slice(*limits))
    etas, gaps = part.eta.values, part.xi_rel_max.values
    inside = np.flatnonzero((gaps[1:-1] > gaps[:-2]) & (gaps[1:-1] >= gaps[2:])) + 1
    return float(etas[inside[np.argmax(gaps[inside])]]) if len(inside) else None
