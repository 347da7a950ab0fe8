"""Orbit diagrams (Figures 6, 10, 11): samples of the gap over a parameter, impacts below."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .labels import about
from .marks import Marks, draw_samples, draw_steps
from .scales import along, gaps, parameter_of
from .style import BLACK, BLUE, GREY, RED, in_our_look, legend_below, panels, say

MARKS = {"up": Marks(BLUE, 2.0, filled=False), "down": Marks(RED)}  # down lies on up
WIDTHS = {"up": 2.6, "down": 1.0}


@in_our_look
def draw(data: xr.Dataset, title: str = "", decades: int = 6) -> Figure:
    """Draw an orbit diagram in the paper's manner; all samples are in it.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.sweep`, in one direction or in both.
    title : str
        What is the same in the whole diagram; by default the structure.
    decades : int
        Of the gap's logarithmic axis, from the largest down; below them it is linear, down to 0.
    """
    figure, (top, bottom) = panels(2, 1, (9.6, 6.4), sharex=True, height_ratios=(3, 1))
    parameter = parameter_of(data.impacts_per_period)
    shown, label = gaps(data, data.xi_rel)
    x, name = along(data, parameter)
    low, high = float(x.min()), float(x.max())
    bottom.set_xlim((low, high) if high > low else (low - 0.5, high + 0.5))
    scale(top, shown.values, decades)
    both = "direction" in data.dims
    for way in map(str, data.direction.values) if both else ("",):
        part = {"direction": way} if both else {}
        samples = shown.sel(part).transpose(parameter, "sample").values
        draw_samples(top, x, samples, MARKS.get(way, Marks(BLACK)), way)
        impacts = data.impacts_per_period.sel(part).values
        colour = MARKS[way].colour if both else BLACK
        draw_steps(bottom, x, impacts, colour, WIDTHS.get(way, 0.8))
    scale_impacts(bottom, data.impacts_per_period.values)
    first, last = int(data.sample.values[0]), int(data.sample.values[-1])
    top.set_title(", ".join(filter(None, [title or about(data), f"$n = {first}(1){last}$"])))
    top.set_ylabel(f"{label}$(nT)$" if label.endswith("$") else f"{label}, at $t = nT$")
    bottom.set(ylabel="impacts per $T$", xlabel=name)
    if both:
        legend_below(figure, [top])
    return figure


def scale(axes: Axes, samples: np.ndarray, decades: int = 6) -> None:
    """A logarithmic axis of gaps that is linear in its lowest part, so that 0 is on it."""
    largest = float(samples.max(initial=0.0))
    if largest <= 0.0:
        axes.set_ylim(-0.05, 1.0)
        return
    least = float(samples.min())
    linear = 10.0 ** np.floor(np.log10(largest) - decades)
    if least > linear:
        axes.set_yscale("log")
        axes.set_ylim(least / 1.5, largest * 1.5)
        return
    axes.set_yscale("symlog", linthresh=linear, linscale=0.7)
    axes.set_ylim(-0.1 * linear, largest * 1.5)
    axes.axhspan(-0.1 * linear, linear, color=GREY, alpha=0.12, linewidth=0, zorder=0)
    beside = axes.get_yaxis_transform()
    place: Any = {"rotation": 90, "fontsize": 7, "color": GREY, "va": "center"}
    axes.text(1.004, 0.5 * linear, "linear", transform=beside, **place)


def scale_impacts(axes: Axes, impacts: np.ndarray) -> None:
    """An axis for numbers of impacts; words where there are none."""
    some = impacts[impacts > 0.0]
    if not some.size:
        axes.set_ylim(0.0, 1.0)
        say(axes, "no impacts")
    elif some.max() < 10.0 * some.min():
        axes.set_ylim(0.0, 1.1 * some.max())
    elif some.size < impacts.size:
        axes.set_yscale("symlog", linthresh=float(some.min()), linscale=0.5)
        axes.set_ylim(0.0, 1.3 * some.max())
    else:
        axes.set_yscale("log")
