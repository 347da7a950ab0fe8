"""What claims are checked against: the computed datasets by case, and what is read off them more than once."""

import numpy as np

from ...lyapunov import CHAOTIC, QUASI_PERIODIC
from ..resolution import CASES
from ..windows import runs


class Results:
    """Computed datasets.

    Parameters
    ----------
    datasets : dict of xarray.Dataset
        By name.
    """

    def __init__(self, datasets):
        self._datasets = datasets

    def get(self, name):
        """A dataset by name."""
        return self._datasets[name]

    def of(self, kind, case, ending=""):
        """A dataset of one of the three cases, over eta upwards."""
        data = self._datasets[f"{kind}_{CASES[case].label()}{ending}"]
        return data.sortby("eta") if "eta" in data.dims else data

    def up(self, case):
        """The sweep upwards."""
        return self.of("orbit", case, "_up")

    def down(self, case):
        """The sweep downwards."""
        return self.of("orbit", case, "_down")

    def steady(self, case):
        """The up-sweep's responses, impact by impact."""
        return self.of("steady", case, "_up")

    def exponent(self, case):
        """Largest Lyapunov exponents along the up-sweep."""
        return self.of("exponent", case)


def between(data, low, high):
    """The part of a dataset with low <= eta <= high."""
    return data.sel(eta=slice(low - 1e-9, high + 1e-9))


def impacts_in_response(data):
    """Impacts in a response period, rounded; 0 where the response is not periodic or its impacts do not repeat."""
    n = data.multiplicity.values
    count = n * data.impacts_per_period.values
    slack = 1.5 * n / data.sizes["sample"]
    return np.where((n > 0) & (np.abs(count - np.round(count)) <= slack), np.round(count), 0).astype(int)


def kind(data, n, impacts):
    """Where responses have period nT and so many impacts in it."""
    return (data.multiplicity.values == n) & (impacts_in_response(data) == impacts)


def upper_edge(data, flags, inside):
    """The last eta of the run of true flags that holds ``inside``, and the next one."""
    etas = data.eta.values
    index = int(np.abs(etas - inside).argmin())
    for first, last in runs(flags):
        if first <= index <= last:
            return float(etas[last]), float(etas[min(last + 1, len(etas) - 1)])
    return float("nan"), float("nan")


def lower_edge(data, flags, inside):
    """The eta before the run of true flags that holds ``inside``, and its first one."""
    etas = data.eta.values
    index = int(np.abs(etas - inside).argmin())
    for first, last in runs(flags):
        if first <= index <= last:
            return float(etas[max(first - 1, 0)]), float(etas[first])
    return float("nan"), float("nan")


def longest_edges(data, flags):
    """Lower and upper edge of the longest run of true flags, as two pairs."""
    first, last = max(runs(flags), key=lambda run: run[1] - run[0])
    etas = data.eta.values
    lower = float(etas[max(first - 1, 0)]), float(etas[first])
    return lower, (float(etas[last]), float(etas[min(last + 1, len(etas) - 1)]))


def shares(exponents, low, high):
    """Shares of chaotic and of neutral responses between two frequencies, the largest exponent and its standard error."""
    part = between(exponents, low, high)
    verdicts, top = part.verdict.values, int(part.exponent.values.argmax())
    chaotic, neutral = np.mean(verdicts == CHAOTIC), np.mean(verdicts == QUASI_PERIODIC)
    return chaotic, neutral, float(part.exponent[top]), float(part.error[top]), float(part.eta[top])
