"""Access to the computed datasets for the checks of claims, by case and kind."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import xarray as xr

from ...dynamics.lyapunov import CHAOTIC, NEUTRAL
from ...dynamics.stable_windows import StableWindow
from ..cases import CASES
from ..largest_exponents import LargestExponent, largest_exponent
from ..regions import Region, list_regions, nearest_window
from ..sweep_windows import runs

Edges = tuple[float, float]  # two neighbouring frequencies


class Shares(NamedTuple):
    """Shares of responses between two frequencies that are chaotic, and neutral."""

    # their shares
    chaotic: float
    neutral: float


class Limit(NamedTuple):
    """An exact limit of stability: frequency, kind of bifurcation, orbit."""

    value: float
    kind: str  # what happens there
    orbit: str  # mT/k: k impacts in m periods

    @property
    def digits(self) -> int:
        """Number of digits that are sure: fewer at a loss of contact, which depends on gamma."""
        return 6 if "contact" in self.kind else 8


class Results:
    """The paper's computed datasets, with access by case."""

    def __init__(self, datasets: Mapping[str, xr.Dataset], full: bool = True) -> None:
        self._datasets = datasets
        self.full = full

    def window(self, case: str, orbit: str, inside: float) -> StableWindow:
        """Return the stable window of an orbit around a frequency, or nearest to it."""
        return nearest_window(self.get("limits"), case, orbit, inside)

    def lower_limit(self, case: str, orbit: str, inside: float) -> Limit:
        """Return the lower limit of an orbit's stable window around a frequency."""
        window = self.window(case, orbit, inside)
        return Limit(window.low, window.below, orbit)

    def upper_limit(self, case: str, orbit: str, inside: float) -> Limit:
        """Return the upper limit of an orbit's stable window around a frequency."""
        window = self.window(case, orbit, inside)
        return Limit(window.high, window.above, orbit)

    def regions(self, case: str) -> list[Region]:
        """Return a case's frequency regions that hold more than one frequency of the sweep."""
        listed = list_regions(self.get("limits"), case)
        return [one for one in listed if between(self.exponent(case), *one[:2]).sizes["eta"] > 1]

    def largest_exponent(self, case: str, region: Region) -> LargestExponent:
        """Return a region's largest exponent, decided by a long run of its own."""
        return largest_exponent(self.dataset_of_case("largest", case), region.name)

    def settled(self, case: str) -> xr.Dataset:
        """Return a case's dataset of up-sweep responses run on until they repeat."""
        return self.dataset_of_case("settled", case, "_up")

    def get(self, name: str) -> xr.Dataset:
        """Return a dataset by its job's name."""
        return self._datasets[name]

    def dataset_of_case(self, kind: str, case: str, ending: str = "") -> xr.Dataset:
        """Return the dataset of one kind for one case, sorted by eta."""
        data = self._datasets[f"{kind}_{CASES[case].label()}{ending}"]
        return data.sortby("eta") if "eta" in data.dims else data

    def up(self, case: str) -> xr.Dataset:
        """Return a case's sweep upwards."""
        return self.dataset_of_case("orbit", case, "_up")

    def down(self, case: str) -> xr.Dataset:
        """Return a case's sweep downwards."""
        return self.dataset_of_case("orbit", case, "_down")

    def impact_statistics(self, case: str) -> xr.Dataset:
        """Return a case's impact statistics of the up-sweep's responses."""
        return self.dataset_of_case("steady", case, "_up")

    def exponent(self, case: str) -> xr.Dataset:
        """Return a case's largest Lyapunov exponents along the up-sweep."""
        return self.dataset_of_case("exponent", case)


def between(data: xr.Dataset, low: float, high: float) -> xr.Dataset:
    """Return the part of a dataset with low <= eta <= high."""
    return data.sel(eta=slice(low - 1e-9, high + 1e-9))


def impacts_in_response(data: xr.Dataset) -> np.ndarray:
    """Return each response's impacts in its own period; 0 if it does not repeat.

    A sweep counts those of a response that has repeated over its own period: n times them is a
    whole number. Where that is undecided their mean over the samples may miss it a little.
    """
    n = data.multiplicity.values
    count = n * data.impacts_per_period.values
    slack = 1.5 * n / data.sizes["sample"]
    return np.where(
        (n > 0) & (np.abs(count - np.round(count)) <= slack), np.round(count), 0
    ).astype(int)


def etas_where_sweeps_differ(results: Results, case: str, low: float, high: float) -> np.ndarray:
    """Return the frequencies between two at which up- and down-sweep differ in their impacts."""
    up, down = results.up(case), results.down(case)
    etas = up.eta.values
    differ = impacts_in_response(up) != impacts_in_response(down)
    return etas[differ & (etas > low) & (etas < high)]


def is_orbit(data: xr.Dataset, n: int, impacts: int) -> np.ndarray:
    """Return a Boolean array: responses with period nT and ``impacts`` impacts in it."""
    return (data.multiplicity.values == n) & (impacts_in_response(data) == impacts)


def upper_edge(data: xr.Dataset, flags: np.ndarray, inside: float) -> Edges:
    """Return the last eta of the run of true flags around ``inside``, and the next eta."""
    etas = data.eta.values
    index = int(np.abs(etas - inside).argmin())
    for first, last in runs(flags):
        if first <= index <= last:
            return float(etas[last]), float(etas[min(last + 1, len(etas) - 1)])
    return float("nan"), float("nan")


def lower_edge(data: xr.Dataset, flags: np.ndarray, inside: float) -> Edges:
    """Return the eta before the run of true flags around ``inside``, and its first eta."""
    etas = data.eta.values
    index = int(np.abs(etas - inside).argmin())
    for first, last in runs(flags):
        if first <= index <= last:
            return float(etas[max(first - 1, 0)]), float(etas[first])
    return float("nan"), float("nan")


def longest_edges(data: xr.Dataset, flags: np.ndarray) -> tuple[Edges, Edges]:
    """Return lower and upper edge of the longest run of true flags, each as two etas."""
    first, last = max(runs(flags), key=lambda run: run[1] - run[0])
    etas = data.eta.values
    lower = float(etas[max(first - 1, 0)]), float(etas[first])
    return lower, (float(etas[last]), float(etas[min(last + 1, len(etas) - 1)]))


def irregular_shares(results: Results, case: str, low: float, high: float) -> Shares:
    """Return the chaotic and neutral shares of settled responses between two frequencies.

    One whose state repeats is periodic, whatever the sign of its exponent in a finite time.
    """
    part = between(results.exponent(case), low, high)
    repeats = between(results.settled(case), low, high).multiplicity.values > 0
    verdicts = part.verdict.values
    return Shares(
        chaotic=float(np.mean((verdicts == CHAOTIC) & ~repeats)),
        neutral=float(np.mean((verdicts == NEUTRAL) & ~repeats)),
    )
