"""Select one panel's points from a dataset of the paper's curves.

Variables along ``point``: ``tau``, ``state`` (xi_1, xi_2, xi_1', xi_2'), ``kind`` (of the three
states of Figure 5) and ``panel_of``; along ``panel``: ``e``, ``D``, ``eta`` and ``multiplicity``.
"""

from __future__ import annotations

import numpy as np
import xarray as xr


def select_panel(data: xr.Dataset, panel: int) -> xr.Dataset:
    """Return the points of one panel."""
    return data.isel(point=data.panel_of.values == panel)


def relative_motion(data: xr.Dataset, panel: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time tau, gap xi_Rel and its velocity along one panel's curve."""
    part = select_panel(data, panel)
    state = part.state.values
    return part.tau.values, state[:, 1] - state[:, 0], state[:, 3] - state[:, 2]
