"""Branches of periodic orbits as lines over the diagram, and their bifurcations."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..flags import flag_words
from .shipped import READING

if TYPE_CHECKING:
    import xarray as xr


def overlay(found: xr.Dataset | None) -> dict[str, Any]:
    """Return lines and bifurcations of a branch as the page's JSON.

    Parameters
    ----------
    found : xarray.Dataset, optional
        Of :func:`orchestrate.branch` over ``eta``.

    Raises
    ------
    InputError
        Where it is over something else, or no branch.
    """
    if found is None:
        return {"branches": [], "bifurcations": []}
    if found.attrs.get("over") != "eta":
        over = found.attrs.get("over", "nothing")
        raise InputError(f"branches over {over}: expected a result of orchestrate.branch over eta")
    try:
        drawn = {"branches": lines(found), "bifurcations": bifurcations(found)}
        json.dumps(drawn, allow_nan=False)  # as the page reads it
        return drawn
    except READING as error:
        raise InputError(
            f"branches: a part is missing or of another kind ({error}); "
            "expected a result of orchestrate.branch over eta"
        ) from None


def lines(found: xr.Dataset) -> list[dict[str, Any]]:
    """Return the branch's parts of one stability, a line for each sample of an orbit."""
    stable = found.stable.values == 1
    return [
        {"x": along.tolist(), "y": gaps.tolist(), "stable": bool(flag)}
        for samples in found.xi_rel.transpose("sample", "point").values
        for along, gaps, flag in runs(found["eta"].values.astype(float), samples, stable)
    ]


def runs(
    along: NDArray[np.float64], gaps: NDArray[np.float64], stable: NDArray[np.bool_]
) -> list[tuple[NDArray[np.float64], NDArray[np.float64], bool]]:
    """Split a line by stability; return abscissas, gaps > 0 and stability of each part."""
    kept = gaps > 0.0
    along, gaps, stable = along[kept], gaps[kept], stable[kept]
    cuts = [0, *(np.flatnonzero(np.diff(stable)) + 1).tolist(), len(along)]
    return [
        (along[a : b + 1], gaps[a : b + 1], bool(stable[a]))
        for a, b in zip(cuts[:-1], cuts[1:], strict=True)
        if b > a
    ]


def bifurcations(found: xr.Dataset) -> list[dict[str, Any]]:
    """Return a branch's bifurcations, each with its place and its kind."""
    if not found.sizes.get("bifurcation"):
        return []
    kinds = found.bifurcation_kind
    names = flag_words(kinds.attrs)
    return [
        {
            "eta": float(value),
            "gap": float(np.max(gaps)),
            "kind": names[int(kind)],
        }
        for value, kind, gaps in zip(
            found.bifurcation_value.values,
            kinds.values,
            found.bifurcation_xi_rel.values,
            strict=True,
        )
        if np.max(gaps) > 0.0
    ]
