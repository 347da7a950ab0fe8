"""Draw relative phase curves at many frequencies (Figures 8 and 9)."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from .curve_data import relative_motion
from .labels import format_period
from .style import XI_REL, XI_REL_RATE, make_panels, styled


@styled
def draw(data: xr.Dataset, columns: int = 4) -> Figure:
    """Draw a grid of relative phase planes, one per response, each on its own scales."""
    count = data.sizes["panel"]
    rows = -(-count // columns)
    figure, axes = make_panels(rows, columns, (2.7 * columns, 2.6 * rows))
    for index, plane in enumerate(axes[:count]):
        _, gap, rate = relative_motion(data, index)
        plane.plot(gap, rate, "-k", linewidth=0.15, rasterized=True)
        kind = format_period(int(data.multiplicity[index]))
        plane.set_title(rf"$\eta = {float(data.eta[index]):.3f}$, {kind}")
        plane.ticklabel_format(scilimits=(-2, 3))
    for plane in axes[count:]:
        plane.set_visible(False)
    for plane in axes[::columns]:
        plane.set_ylabel(XI_REL_RATE)
    for plane in axes[-columns:]:
        plane.set_xlabel(XI_REL)
    return figure
