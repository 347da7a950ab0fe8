"""What claims are checked against: the datasets by case, and what is read off them repeatedly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import xarray as xr

from ...dynamics.lyapunov import CHAOTIC, NEUTRAL
from ..cases import CASES
from ..windows import runs

Edges = tuple[float, float]  # two neighbouring frequencies


class Shares(NamedTuple):
    """Responses between two frequencies.

    Attributes
    ----------
    chaotic, neutral : float
        Their shares.
    exponent, error, eta : float
        The largest exponent, its standard error, and where it is.
    """

    chaotic: float
    neutral: float
    exponent: float
    error: float
    eta: float


class Results:
    """Computed datasets.

    Parameters
    ----------
    datasets : mapping of xarray.Dataset
        By name.
    """

    def __init__(self, datasets: Mapping[str, xr.Dataset]) -> None:
        self._datasets = datasets

    def get(self, name: str) -> xr.Dataset:
        """A dataset by name."""
        return self._datasets[name]

    def of(self, kind: str, case: str, ending: str = "") -> xr.Dataset:
        """A dataset of one of the three cases, over eta upwards."""
        data = self._datasets[f"{kind}_{CASES[case].label()}{ending}"]
        return data.sortby("eta") if "eta" in data.dims else data

    def up(self, case: str) -> xr.Dataset:
        """The sweep upwards."""
        return self.of("orbit", case, "_up")

    def down(self, case: str) -> xr.Dataset:
        """The sweep downwards."""
        return self.of("orbit", case, "_down")

    def steady(self, case: str) -> xr.Dataset:
        """The up-sweep's responses, impact by impact."""
        return self.of("steady", case, "_up")

    def exponent(self, case: str) -> xr.Dataset:
        """Largest Lyapunov exponents along the up-sweep."""
        return self.of("exponent", case)


def between(data: xr.Dataset, low: float, high: float) -> xr.Dataset:
    """The part of a dataset with low <= eta <= high."""
    return data.sel(eta=slice(low - 1e-9, high + 1e-9))


def impacts_in_response(data: xr.Dataset) -> np.ndarray:
    """Impacts in a response period; 0 where the state or the number of impacts does not repeat."""
    n = data.multiplicity.values
    count = n * data.impacts_per_period.values
    slack = 1.5 * n / data.sizes["sample"]
    return np.where(
        (n > 0) & (np.abs(count - np.round(count)) <= slack), np.round(count), 0
    ).astype(int)


def kind(data: xr.Dataset, n: int, impacts: int) -> np.ndarray:
    """Where responses have period nT and so many impacts in it."""
    return (data.multiplicity.values == n) & (impacts_in_response(data) == impacts)


def upper_edge(data: xr.Dataset, flags: np.ndarray, inside: float) -> Edges:
    """The last eta of the run of true flags that holds ``inside``, and the next one."""
    etas = data.eta.values
    index = int(np.abs(etas - inside).argmin())
    for first, last in runs(flags):
        if first <= index <= last:
            return float(etas[last]), float(etas[min(last + 1, len(etas) - 1)])
    return float("nan"), float("nan")


def lower_edge(data: xr.Dataset, flags: np.ndarray, inside: float) -> Edges:
    """The eta before the run of true flags that holds ``inside``, and its first one."""
    etas = data.eta.values
    index = int(np.abs(etas - inside).argmin())
    for first, last in runs(flags):
        if first <= index <= last:
            return float(etas[max(first - 1, 0)]), float(etas[first])
    return float("nan"), float("nan")


def longest_edges(data: xr.Dataset, flags: np.ndarray) -> tuple[Edges, Edges]:
    """Lower and upper edge of the longest run of true flags, as two pairs."""
    first, last = max(runs(flags), key=lambda run: run[1] - run[0])
    etas = data.eta.values
    lower = float(etas[max(first - 1, 0)]), float(etas[first])
    return lower, (float(etas[last]), float(etas[min(last + 1, len(etas) - 1)]))


def shares(exponents: xr.Dataset, low: float, high: float) -> Shares:
    """Chaotic and neutral responses between two frequencies, and the largest exponent."""
    part = between(exponents, low, high)
    verdicts, top = part.verdict.values, int(part.exponent.values.argmax())
    return Shares(
        chaotic=np.mean(verdicts == CHAOTIC),
        neutral=np.mean(verdicts == NEUTRAL),
        exponent=float(part.exponent[top]),
        error=float(part.standard_error[top]),
        eta=float(part.eta[top]),
    )
