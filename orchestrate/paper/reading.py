"""Read datasets: runs of one kind of response, their edges, windows, regions between windows."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr

from ..dynamics.stable_windows import StableWindow
from ..flags import runs_of_true

Edges = tuple[float, float]  # two neighbouring frequencies
NOWHERE = float("nan"), float("nan")
LAST = 8.0  # of the paper's range
WINDOWS = {  # an eta inside of each
    **{"T, contact": 0.4, "T/2": 1.05, "T/1": 2.0},
    **{"2T/1": 4.2, "3T/1": 6.3, "4T/1": 8.0},
}


def between(data: xr.Dataset, low: float, high: float) -> xr.Dataset:
    """Return the part of a dataset with low <= eta <= high."""
    return data.sel(eta=slice(low - 1e-9, high + 1e-9))


def edges_of_run(data: xr.Dataset, run: tuple[int, int] | None) -> tuple[Edges, Edges]:
    """Return lower and upper edge of a run, each as the two etas it lies between."""
    if run is None:
        return NOWHERE, NOWHERE
    (first, last), etas = run, data.eta.values
    lower = float(etas[max(first - 1, 0)]), float(etas[first])
    return lower, (float(etas[last]), float(etas[min(last + 1, len(etas) - 1)]))


def edges_of_run_around(data: xr.Dataset, flags: np.ndarray, eta: float) -> tuple[Edges, Edges]:
    """Return lower and upper edge of the run of true flags around a frequency."""
    index = int(np.abs(data.eta.values - eta).argmin())
    there = (run for run in runs_of_true(flags) if run[0] <= index <= run[1])
    return edges_of_run(data, next(there, None))


def edges_of_longest_run(data: xr.Dataset, flags: np.ndarray) -> tuple[Edges, Edges]:
    """Return lower and upper edge of the longest run of true flags."""
    longest = max(runs_of_true(flags), key=lambda run: run[1] - run[0], default=None)
    return edges_of_run(data, longest)


def impacts_in_response(data: xr.Dataset) -> np.ndarray:
    """Return each response's impacts in its own period; 0 if it does not repeat."""
    n = data.multiplicity.values
    count = n * data.impacts_per_period.values
    slack = 1.5 * n / data.sizes.get("sample", 201)
    whole = (n > 0) & (np.abs(count - np.round(count)) <= slack)
    return np.where(whole, np.round(count), 0).astype(int)


def is_on_orbit(data: xr.Dataset, orbit: str) -> np.ndarray:
    """Return a Boolean array: responses on the orbit mT/k, k impacts in m periods."""
    n, impacts = orbit.split("T/")
    return (data.multiplicity.values == int(n or 1)) & (impacts_in_response(data) == int(impacts))


class ImpactRun(NamedTuple):
    """Adjacent frequencies with T-periodic responses of the same number of impacts."""

    impacts: int
    low: float
    high: float

    def format(self) -> str:
        return f"{self.impacts} ({self.low:.3f} to {self.high:.3f})"


def impact_runs(data: xr.Dataset) -> list[ImpactRun]:
    """Return the runs of T-periodic responses with impacts, by rising eta, one a number."""
    etas = data.eta.values
    counts = np.where(data.multiplicity.values == 1, impacts_in_response(data), 0)
    ends = np.flatnonzero(np.diff(counts, append=-1))
    begins = np.append(0, ends[:-1] + 1)
    listed = zip(counts[begins].tolist(), etas[begins], etas[ends], strict=True)
    return [ImpactRun(count, float(low), float(high)) for count, low, high in listed if count > 0]


def successive_impact_numbers(data: xr.Dataset) -> list[int]:
    """Return the numbers of impacts of T-periodic responses, each change of the number once."""
    numbers = [run.impacts for run in impact_runs(data)]
    return [a for a, b in zip(numbers, [0, *numbers], strict=False) if a != b]


def strictly_decreases(numbers: list[int]) -> bool:
    """Return whether each number is less than the one before; there must be two."""
    return len(numbers) > 1 and all(a > b for a, b in itertools.pairwise(numbers))


def window_edges(sweep: xr.Dataset) -> list[tuple[Edges, Edges]]:
    """Return the edges of the longest window nT with one impact, for n = 1 to 4."""
    orbits = [f"{n if n > 1 else ''}T/1" for n in range(1, 5)]
    return [edges_of_longest_run(sweep, is_on_orbit(sweep, orbit)) for orbit in orbits]


def are_windows_separated(sweep: xr.Dataset) -> list[bool]:
    """Return of each two successive windows nT whether irregular responses lie between them."""
    edges = window_edges(sweep)
    gaps = ((a[1][1], b[0][0]) for a, b in itertools.pairwise(edges))
    return [
        low <= high and bool((between(sweep, low, high).multiplicity.values == 0).any())
        for low, high in gaps
    ]


def relative_peak_eta(sweep: xr.Dataset, n: int) -> float | None:
    """Return the eta of the gap's largest local maximum in the window nT; None without one."""
    (_, low), (high, _) = window_edges(sweep)[n - 1]
    if not low <= high:
        return None
    part = sweep.sel(eta=slice(low, high))
    etas, gaps = part.eta.values, part.xi_rel_max.values
    inside = np.flatnonzero((gaps[1:-1] > gaps[:-2]) & (gaps[1:-1] >= gaps[2:])) + 1
    return float(etas[inside[np.argmax(gaps[inside])]]) if len(inside) else None


class Region(NamedTuple):
    """Frequencies of a window, or between two windows, which are named then."""

    low: float
    high: float
    name: str

    @property
    def is_window(self) -> bool:
        """Whether one orbit is stable in the whole region."""
        return " to " not in self.name


def list_regions(window_at: Callable[[str, float], StableWindow]) -> list[Region]:
    """Return windows and the regions between them, up to eta = 8, by the windows' exact limits."""
    (contact, eta), *others = WINDOWS.items()
    last, label = window_at(contact, eta).high, "contact"
    regions = []
    for orbit, eta in others:
        limits = window_at(orbit, eta)
        regions.append(Region(last, limits.low, f"{label} to {orbit}"))
        regions.append(Region(limits.low, min(limits.high, LAST), orbit))
        last, label = limits.high, orbit
    return regions
