"""Relative phase curves at many frequencies (Figures 8 and 9), each on its own scales."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from .curve_data import relative
from .labels import kind_of
from .style import XI_REL, XI_REL_RATE, panels, styled


@styled
def draw(data: xr.Dataset, columns: int = 4) -> Figure:
    """Draw one phase plane per response.

    Parameters
    ----------
    data : xarray.Dataset
        Curves, see :mod:`.curve_data`.
    columns : int
    """
    count = data.sizes["panel"]
    rows = -(-count // columns)
    figure, axes = panels(rows, columns, (2.7 * columns, 2.6 * rows))
    for index, plane in enumerate(axes[:count]):
        _, gap, rate = relative(data, index)
        plane.plot(gap, rate, "-k", linewidth=0.15, rasterized=True)
        kind = kind_of(int(data.multiplicity[index]))
        plane.set_title(rf"$\eta = {float(data.eta[index]):.3f}$, {kind}")
        plane.ticklabel_format(scilimits=(-2, 3))
    for plane in axes[count:]:
        plane.set_visible(False)
    for plane in axes[::columns]:
        plane.set_ylabel(XI_REL_RATE)
    for plane in axes[-columns:]:
        plane.set_xlabel(XI_REL)
    return figure
