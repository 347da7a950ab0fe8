"""The paper's claims, section by section, each checked against what was computed."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from . import section3, section3_influence, section4, section5
from .results import Results

CLAIMS = (*section3.CLAIMS, *section3_influence.CLAIMS, *section4.CLAIMS, *section5.CLAIMS)


def table(datasets: Mapping[str, xr.Dataset]) -> list[dict[str, str]]:
    """All claims with what was found, as texts.

    Parameters
    ----------
    datasets : mapping of xarray.Dataset
        By name.
    """
    results = Results(datasets)
    return [claim.row(results) for claim in CLAIMS]
