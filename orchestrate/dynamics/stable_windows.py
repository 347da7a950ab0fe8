"""Stable parameter intervals of a branch dataset, with the bifurcations that bound them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..flags import flag_words
from ..lazy import xr


class StableWindow(NamedTuple):
    """A parameter interval with a stable orbit, and the bifurcations at both of its ends."""

    # the parameter at its ends
    low: float
    high: float
    # kinds of the bifurcations there, or why the branch was followed no further
    below: str
    above: str


def stable_windows(branch: xr.Dataset) -> list[StableWindow]:
    """Return the parameter intervals of a branch dataset that are stable by the multipliers.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.branches import branch
    >>> found = branch(Structure.nondimensional(), eta=2.6, limits=(2.5, 2.7))
    >>> stable_windows(found)[0].high.__round__(8), stable_windows(found)[0].above
    (2.64796105, 'Neimark-Sacker')
    """
    over = branch[branch.attrs["over"]].values
    order = np.argsort(branch.bifurcation_place.values)
    places = [0.0, *branch.bifurcation_place.values[order], branch.sizes["point"] - 1.0]
    values = [over[0], *branch.bifurcation_value.values[order], over[-1]]
    names = flag_words(branch.bifurcation_kind.attrs)
    kinds = [names[kind] for kind in branch.bifurcation_kind.values[order].tolist()]
    reasons = [branch.attrs["first_end"], *kinds, branch.attrs["last_end"]]
    ends = list(zip(map(float, values), reasons, strict=True))
    windows = []
    for i, (first, last) in enumerate(zip(places[:-1], places[1:], strict=True)):
        inner = slice(int(np.ceil(first + 1e-9)), int(np.floor(last - 1e-9)) + 1)
        inside = branch.stability.values[inner]
        if inside.size and inside.all():
            (low, below), (high, above) = sorted(ends[i : i + 2])
            windows.append(StableWindow(low, high, below, above))
    return windows
