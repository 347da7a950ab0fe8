"""Coexisting attractors over the frequency ratio: what random starts lead to, and how many."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from .style import BLACK, RED, XI_REL, in_our_look, panels

TICKS = (0.5, 0.7, 1, 1.4, 2, 3, 5, 8)


@in_our_look
def draw(data: xr.Dataset) -> Figure:
    """Attractors, their size the share of starts that lead to them, and their number.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.attractors`.
    """
    figure, (top, bottom) = panels(2, 1, (12, 6.5), sharex=True, height_ratios=(3, 1))
    for index in range(data.sizes["attractor"]):
        part = data.isel(attractor=index)
        colours = np.where(part.multiplicity.values > 0, BLACK, RED)
        areas = 40.0 * part.share.values
        top.scatter(part.eta, part.xi_rel_max, areas, c=colours, linewidths=0, alpha=0.7)
    top.set(yscale="log", ylabel=rf"max {XI_REL}")
    bottom.step(data.eta, data.number, "-k", where="mid", linewidth=0.8)
    bottom.set(ylabel="attractors", xlabel=r"$\eta$", xscale="log", ylim=(0, None))
    bottom.minorticks_off()
    bottom.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
    return figure
