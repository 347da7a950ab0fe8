"""What claims are checked against: the datasets by case, and what is read off them repeatedly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import xarray as xr

from ...dynamics.lyapunov import CHAOTIC, NEUTRAL
from ...dynamics.stable_windows import StableWindow
from ..cases import CASES
from ..largest import Largest, largest_of
from ..regions import Region, nearest_window, regions
from ..windows import runs

Edges = tuple[float, float]  # two neighbouring frequencies


class Shares(NamedTuple):
    """Responses between two frequencies.

    Attributes
    ----------
    chaotic, neutral : float
        Their shares.
    """

    chaotic: float
    neutral: float


class Limit(NamedTuple):
    """An exact limit of stability.

    Attributes
    ----------
    value : float
    kind : str
        What happens there.
    orbit : str
        mT/k: k impacts in m periods.
    """

    value: float
    kind: str
    orbit: str

    @property
    def digits(self) -> int:
        """Return the number of known digits: fewer at a loss of contact, which depends on gamma."""
        return 6 if "contact" in self.kind else 8


class Results:
    """Computed datasets.

    Parameters
    ----------
    datasets : mapping of xarray.Dataset
        By name.
    full : bool
        Whether at the full resolution.
    """

    def __init__(self, datasets: Mapping[str, xr.Dataset], full: bool = True) -> None:
        self._datasets = datasets
        self.full = full

    def window(self, case: str, orbit: str, inside: float) -> StableWindow:
        """Return the stable window of an orbit that holds a frequency, or is nearest to it."""
        return nearest_window(self.get("limits"), case, orbit, inside)

    def begins(self, case: str, orbit: str, inside: float) -> Limit:
        """Return the lower limit of the window that holds a frequency."""
        window = self.window(case, orbit, inside)
        return Limit(window.low, window.below, orbit)

    def ends(self, case: str, orbit: str, inside: float) -> Limit:
        """Return where an orbit's window ends, its upper edge, as a limit."""
        window = self.window(case, orbit, inside)
        return Limit(window.high, window.above, orbit)

    def regions(self, case: str) -> list[Region]:
        """Return those of :func:`..regions.regions` that hold frequencies of the sweep."""
        listed = regions(self.get("limits"), case)
        return [one for one in listed if between(self.exponent(case), *one[:2]).sizes["eta"] > 1]

    def largest(self, case: str, region: Region) -> Largest:
        """Return the largest exponent of a region, by a run of its own."""
        return largest_of(self.of("largest", case), region.name)

    def settled(self, case: str) -> xr.Dataset:
        """Return the dataset of the settled responses of a case's up-sweep."""
        return self.of("settled", case, "_up")

    def get(self, name: str) -> xr.Dataset:
        """Return a computed dataset of the paper's plan by its name."""
        return self._datasets[name]

    def of(self, kind: str, case: str, ending: str = "") -> xr.Dataset:
        """Return a dataset of one of the three cases, over eta upwards."""
        data = self._datasets[f"{kind}_{CASES[case].label()}{ending}"]
        return data.sortby("eta") if "eta" in data.dims else data

    def up(self, case: str) -> xr.Dataset:
        """Return the sweep upwards."""
        return self.of("orbit", case, "_up")

    def down(self, case: str) -> xr.Dataset:
        """Return the sweep downwards."""
        return self.of("orbit", case, "_down")

    def steady(self, case: str) -> xr.Dataset:
        """Return the up-sweep's responses, impact by impact."""
        return self.of("steady", case, "_up")

    def exponent(self, case: str) -> xr.Dataset:
        """Return largest Lyapunov exponents along the up-sweep."""
        return self.of("exponent", case)


def between(data: xr.Dataset, low: float, high: float) -> xr.Dataset:
    """Return the part of a dataset with low <= eta <= high."""
    return data.sel(eta=slice(low - 1e-9, high + 1e-9))


def impacts_in_response(data: xr.Dataset) -> np.ndarray:
    """Return the impacts in a response period; 0 where the response does not repeat.

    A sweep counts those of a response that has repeated over its own period: n times them is a
    whole number. Where that is undecided their mean over the samples may miss it a little.
    """
    n = data.multiplicity.values
    count = n * data.impacts_per_period.values
    slack = 1.5 * n / data.sizes["sample"]
    return np.where(
        (n > 0) & (np.abs(count - np.round(count)) <= slack), np.round(count), 0
    ).astype(int)


def kind(data: xr.Dataset, n: int, impacts: int) -> np.ndarray:
    """Return where responses have period nT and so many impacts in it."""
    return (data.multiplicity.values == n) & (impacts_in_response(data) == impacts)


def upper_edge(data: xr.Dataset, flags: np.ndarray, inside: float) -> Edges:
    """Return the last eta of the run of true flags that holds ``inside``, and the next one."""
    etas = data.eta.values
    index = int(np.abs(etas - inside).argmin())
    for first, last in runs(flags):
        if first <= index <= last:
            return float(etas[last]), float(etas[min(last + 1, len(etas) - 1)])
    return float("nan"), float("nan")


def lower_edge(data: xr.Dataset, flags: np.ndarray, inside: float) -> Edges:
    """Return the eta before the run of true flags that holds ``inside``, and its first one."""
    etas = data.eta.values
    index = int(np.abs(etas - inside).argmin())
    for first, last in runs(flags):
        if first <= index <= last:
            return float(etas[max(first - 1, 0)]), float(etas[first])
    return float("nan"), float("nan")


def longest_edges(data: xr.Dataset, flags: np.ndarray) -> tuple[Edges, Edges]:
    """Return lower and upper edge of the longest run of true flags, as two pairs."""
    first, last = max(runs(flags), key=lambda run: run[1] - run[0])
    etas = data.eta.values
    lower = float(etas[max(first - 1, 0)]), float(etas[first])
    return lower, (float(etas[last]), float(etas[min(last + 1, len(etas) - 1)]))


def shares(results: Results, case: str, low: float, high: float) -> Shares:
    """Return shares of settled responses between two frequencies that are chaotic, and neutral.

    One whose state repeats is periodic, whatever the sign of its exponent in a finite time.
    """
    part = between(results.exponent(case), low, high)
    repeats = between(results.settled(case), low, high).multiplicity.values > 0
    verdicts = part.verdict.values
    return Shares(
        chaotic=float(np.mean((verdicts == CHAOTIC) & ~repeats)),
        neutral=float(np.mean((verdicts == NEUTRAL) & ~repeats)),
    )
