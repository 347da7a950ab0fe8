"""Figures 8 and 9 alike: relative phase curves at typical frequencies of one region, each on its own scales."""

from .canvas import XI_REL, XI_REL_RATE, kind_of, relative
from .canvas import panels as make


def draw_grid(data):
    """One phase plane a frequency; returns the figure."""
    count = data.sizes["panel"]
    columns = 4
    figure, axes = make(-(-count // columns), columns, (13, 3.1 * -(-count // columns)))
    for index, plane in enumerate(axes[:count]):
        _, gap, rate = relative(data, index)
        plane.plot(gap, rate, "-k", linewidth=0.25, rasterized=True)
        plane.set_title(rf"$\eta = {float(data.eta[index]):.3f}$, {kind_of(data.multiplicity[index])}")
        plane.ticklabel_format(scilimits=(-2, 3))
    for plane in axes[count:]:
        plane.set_visible(False)
    for row in range(0, len(axes), columns):
        axes[row].set_ylabel(XI_REL_RATE)
    for plane in axes[-columns:]:
        plane.set_xlabel(XI_REL)
    return figure
