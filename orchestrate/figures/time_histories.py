"""Draw the gap over time for several responses, with the excitation below (Figure 7)."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from .curve_data import relative_motion
from .labels import format_period
from .style import BLACK, BLUE, XI_REL, make_panels, styled


@styled
def draw(data: xr.Dataset) -> Figure:
    """Draw the gap over periods of the excitation, a panel per response, and sin(eta tau)."""
    count, turns = data.sizes["panel"], np.zeros(1)
    figure, axes = make_panels(count + 1, 1, (8.5, 1.6 * (count + 1)), sharex=True)
    for index, plane in enumerate(axes[:count]):
        eta = float(data.eta[index])
        tau, gap, _ = relative_motion(data, index)
        turns = tau * eta / (2.0 * np.pi)
        plane.plot(turns, gap, "-", color=BLACK, linewidth=0.9)
        kind = f"{format_period(index + 1)}-periodic, one impact in a response period"
        plane.set(ylabel=XI_REL, title=rf"$\eta = {eta:.3f}$: {kind}")
        plane.ticklabel_format(axis="y", scilimits=(-2, 3))
    axes[-1].plot(turns, np.sin(2.0 * np.pi * turns), "-", color=BLUE, linewidth=0.9)
    axes[-1].set(ylabel=r"$\sin\eta\tau$", xlabel=r"$\tau/T$", xlim=(0, round(turns[-1])))
    return figure
