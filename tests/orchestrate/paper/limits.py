"""Stability limits as the job of the paper gives them, for tests of what reads them."""

from __future__ import annotations

import numpy as np
import xarray as xr


def make_limits(case, windows):
    """Return the dataset of ``LimitsJob`` for one case, of windows by orbit: (low, high)."""
    low, high = np.transpose(list(windows.values()))
    columns = {"low": low, "high": high, "orbit": list(windows)}
    same = {"below": "fold", "above": "fold", "case": case}
    columns |= {name: [word] * len(low) for name, word in same.items()}
    return xr.Dataset({name: ("window", values) for name, values in columns.items()})
