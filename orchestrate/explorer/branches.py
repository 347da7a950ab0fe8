"""Convert branches of periodic orbits to the page's JSON: lines and bifurcations."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..flags import flag_words
from ..lazy import xr
from ..running.provenance import describe_dataset
from .sweep_data import READING


def branch_json(branch: xr.Dataset | None) -> dict[str, Any]:
    if branch is None:
        return {"branches": [], "bifurcations": []}
    if branch.attrs.get("over") != "eta":
        over = f" over {branch.attrs['over']}" if "over" in branch.attrs else ""
        text = f"{describe_dataset(branch)}{over}; expected a result of orchestrate.branch over eta"
        raise InputError(f"branches: {text}")
    try:
        drawn = {"branches": branch_lines(branch), "bifurcations": bifurcation_points(branch)}
        json.dumps(drawn, allow_nan=False)  # as the page reads it
        return drawn
    except READING as error:
        raise InputError(
            f"branches: a part is missing or of another kind ({error}); "
            "expected a result of orchestrate.branch over eta"
        ) from None


def branch_lines(branch: xr.Dataset) -> list[dict[str, Any]]:
    stable = branch.stable.values == 1
    return [
        {"x": x.tolist(), "y": gaps.tolist(), "stable": bool(flag)}
        for samples in branch.xi_rel.transpose("sample", "point").values
        for x, gaps, flag in split_by_stability(branch["eta"].values.astype(float), samples, stable)
    ]


def split_by_stability(
    x: NDArray[np.float64], gaps: NDArray[np.float64], stable: NDArray[np.bool_]
) -> list[tuple[NDArray[np.float64], NDArray[np.float64], bool]]:
    """Split a line at changes of stability; return abscissas, gaps > 0 and a flag for each part."""
    kept = gaps > 0.0
    x, gaps, stable = x[kept], gaps[kept], stable[kept]
    cuts = [0, *(np.flatnonzero(np.diff(stable)) + 1).tolist(), len(x)]
    return [
        (x[a : b + 1], gaps[a : b + 1], bool(stable[a]))
        for a, b in zip(cuts[:-1], cuts[1:], strict=True)
        if b > a
    ]


def bifurcation_points(branch: xr.Dataset) -> list[dict[str, Any]]:
    if not branch.sizes.get("bifurcation"):
        return []
    kinds = branch.bifurcation_kind
    names = flag_words(kinds.attrs)
    return [
        {"eta": float(value), "gap": float(np.max(gaps)), "kind": names[int(kind)]}
        for value, kind, gaps in zip(
            branch.bifurcation_value.values,
            kinds.values,
            branch.bifurcation_xi_rel.values,
            strict=True,
        )
        if np.max(gaps) > 0.0
    ]
