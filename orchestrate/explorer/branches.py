"""Convert branches of periodic orbits to the page's JSON: lines and bifurcations."""

from __future__ import annotations

import json
from itertools import pairwise
from typing import Any

import numpy as np

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
    """Return each sample's gaps above 0 as lines that end where the stability changes."""
    lines, all_stable = [], branch.stable.values == 1
    for samples in branch.xi_rel.transpose("sample", "point").values:
        kept = samples > 0.0
        x, gaps = branch["eta"].values.astype(float)[kept], samples[kept]
        stable = all_stable[kept]
        cuts = [0, *(np.flatnonzero(np.diff(stable)) + 1).tolist(), len(x)]
        for a, b in pairwise(cuts):
            part = slice(a, b + 1)
            if b > a:
                line = {"x": x[part].tolist(), "y": gaps[part].tolist(), "stable": bool(stable[a])}
                lines.append(line)
    return lines


def bifurcation_points(branch: xr.Dataset) -> list[dict[str, Any]]:
    if not branch.sizes.get("bifurcation"):
        return []
    names = flag_words(branch.bifurcation_kind.attrs)
    columns = (branch[f"bifurcation_{name}"].values for name in ("value", "kind", "xi_rel"))
    return [
        {"eta": float(value), "gap": float(np.max(gaps)), "kind": names[int(kind)]}
        for value, kind, gaps in zip(*columns, strict=True)
        if np.max(gaps) > 0.0
    ]
