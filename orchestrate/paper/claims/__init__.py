"""The paper's claims, section by section, each checked against what was computed."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from . import section1, section2, section3, section3_influence, section4, section5
from .claim import CLAIMS
from .results import Results

SECTIONS = (section1, section2, section3, section3_influence, section4, section5)  # enter claims


def table(datasets: Mapping[str, xr.Dataset], full: bool = True) -> list[dict[str, str]]:
    """Return all claims with what was found, as texts.

    Parameters
    ----------
    datasets : mapping of xarray.Dataset
        By name.
    full : bool
        Whether at the full resolution; else what it takes is not decided.
    """
    results = Results(datasets, full)
    return [claim.row(results) for claim in CLAIMS]
