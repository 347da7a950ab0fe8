"""Coexisting attractors over a parameter: what random starts lead to, and how many."""

from __future__ import annotations

from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from .labels import about
from .marks import FEW
from .scales import along, gaps, parameter_of
from .style import BLACK, RED, entitle, in_our_look, legend_below, panels

WIDE = 4.0  # a parameter that grows by more is shown in equal ratios
KINDS = ((BLACK, "o", "periodic"), (RED, "D", "not periodic"))


@in_our_look
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Attractors, their size the share of starts that lead to them, and their number.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.attractors`.
    title : str
        By default the structure.
    """
    figure, (top, bottom) = panels(2, 1, (9.6, 5.4), sharex=True, height_ratios=(3, 1))
    entitle(figure, title or about(data))
    parameter = parameter_of(data.number)
    x, name = along(data, parameter)
    shown, label = gaps(data, data.xi_rel_max)
    for index in range(data.sizes["attractor"]):
        part = data.isel(attractor=index)
        for colour, marker, _ in KINDS:
            style: Any = {"marker": marker, "linewidths": 0, "alpha": 0.7}
            here = (part.multiplicity.values > 0) == (colour == BLACK)
            areas = 4.0 + 36.0 * part.share.values[here]
            place = x[here], shown.isel(attractor=index).values[here]
            top.scatter(*place, areas, c=colour, **style)
    for colour, marker, word in KINDS:
        top.plot([], [], marker, color=colour, markersize=5, label=word)
    top.set(yscale="log", ylabel=f"largest {label}")
    if float(shown.max()) < 10.0 * float(shown.min()):  # no whole decade: plain numbers
        top.yaxis.set_minor_formatter("{x:g}")
    style = "-k" if len(x) > FEW // 4 else "-k."
    bottom.step(x, data.number, style, where="mid", markersize=3, linewidth=1.0)
    bottom.set(ylabel="attractors", xlabel=name, ylim=(0, None))
    bottom.yaxis.set_major_locator(MaxNLocator(integer=True))
    if len(x) > 1 and x.min() > 0.0 and x.max() > WIDE * x.min():
        in_ratios(bottom)
    legend_below(figure, [top], title="larger: more starts lead there")
    return figure


def in_ratios(axes: Axes) -> None:
    """A logarithmic parameter with plain numbers."""
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
