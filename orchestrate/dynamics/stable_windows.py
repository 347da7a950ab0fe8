"""Where along a branch its orbits are stable: the exact limits, and what happens there."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..flags import flag_words

if TYPE_CHECKING:
    import xarray as xr


class StableWindow(NamedTuple):
    """A stable part of a branch.

    Attributes
    ----------
    low, high : float
        The parameter at its ends.
    below, above : str
        Kinds of the bifurcations there, or why the branch was followed no further.
    """

    low: float
    high: float
    below: str
    above: str


def stable_windows(branch: xr.Dataset) -> list[StableWindow]:
    """Return the stable parts of a branch, in the order along it.

    Parameters
    ----------
    branch : xarray.Dataset
        Of :func:`orchestrate.branch`.

    Examples
    --------
    >>> from orchestrate.structures import Structure
    >>> from orchestrate.dynamics.branches import branch
    >>> found = branch(Structure.nondimensional(), eta=2.6, limits=(2.5, 2.7))
    >>> stable_windows(found)[0].high.__round__(8), stable_windows(found)[0].above
    (2.64796105, 'Neimark-Sacker')
    """
    over = branch[branch.attrs["over"]].values
    order = np.argsort(branch.bifurcation_place.values)
    places = [0.0, *branch.bifurcation_place.values[order], branch.sizes["point"] - 1.0]
    values = [over[0], *branch.bifurcation_value.values[order], over[-1]]
    names = kind_names(branch)
    kinds = [names[kind] for kind in branch.bifurcation_kind.values[order].tolist()]
    reasons = [branch.attrs["first_end"], *kinds, branch.attrs["last_end"]]
    ends = list(zip(map(float, values), reasons, strict=True))
    windows = []
    for i, (first, last) in enumerate(zip(places[:-1], places[1:], strict=True)):
        inside = branch.stable.values[int(np.ceil(first + 1e-9)) : int(np.floor(last - 1e-9)) + 1]
        if inside.size and inside.all():
            (low, below), (high, above) = sorted(ends[i : i + 2])
            windows.append(StableWindow(low, high, below, above))
    return windows


def kind_names(branch: xr.Dataset) -> dict[int, str]:
    """Return the names of the kinds of bifurcations by number."""
    return flag_words(branch.bifurcation_kind.attrs)
