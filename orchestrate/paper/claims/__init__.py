"""The paper's claims by section, each with a check against computed results."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from . import section1, section2, section3, section3_influence, section4, section5
from .claim import CLAIMS
from .results import Results

SECTIONS = (section1, section2, section3, section3_influence, section4, section5)  # enter claims


def check_all_claims(datasets: Mapping[str, xr.Dataset], full: bool = True) -> list[dict[str, str]]:
    """Check all claims against the computed datasets; return a row of texts for each."""
    results = Results(datasets, full)
    return [claim.row(results) for claim in CLAIMS]
