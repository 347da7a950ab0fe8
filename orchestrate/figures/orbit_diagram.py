"""Orbit diagrams (Figures 6, 10, 11): samples of the gap over a parameter, impacts below."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .labels import symbol
from .style import BLACK, RED, XI_REL, in_our_look, panels

LOWEST = 1e-5  # of the logarithmic axis: what is smaller is not shown
COLOURS = {"up": BLACK, "down": RED}


@in_our_look
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw an orbit diagram in the paper's manner.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.sweep`, in one direction or in both.
    title : str
        What is the same in the whole diagram.
    """
    figure, (top, bottom) = panels(2, 1, (12, 8), sharex=True, height_ratios=(3, 1))
    (parameter,) = map(str, set(data.impacts_per_period.dims) - {"direction"})
    both = "direction" in data.dims
    for direction in map(str, data.direction.values) if both else ("up",):
        part = data.sel(direction=direction) if both else data
        draw_sweep(top, bottom, part.sortby(parameter), COLOURS[direction], direction)
    scale(top, data.xi_rel.values)
    first, last = int(data.sample.values[0]), int(data.sample.values[-1])
    shown = ", ".join(filter(None, [title, f"$n = {first}(1){last}$"]))
    top.set(ylabel=rf"{XI_REL}$(nT)$", title=shown)
    bottom.set(ylabel="impacts per $T$", xlabel=symbol(parameter), yscale="log")
    low, high = float(data[parameter].min()), float(data[parameter].max())
    bottom.set_xlim(low, high if high > low else low + 1e-3)
    if both:
        top.legend(markerscale=20)
    return figure


def draw_sweep(top: Axes, bottom: Axes, data: xr.Dataset, colour: str, label: str) -> None:
    """One direction's samples and impacts, a pixel each."""
    (parameter,) = map(str, data.impacts_per_period.dims)
    samples = data.xi_rel.transpose(parameter, "sample").values
    along = np.repeat(data[parameter].values, samples.shape[1])
    gaps = np.where(samples > 0.0, samples, np.nan).ravel()
    top.plot(along, gaps, ",", color=colour, alpha=0.6, rasterized=True, label=label)
    bottom.plot(data[parameter], data.impacts_per_period, ",", color=colour, rasterized=True)


def scale(axes: Axes, samples: np.ndarray) -> None:
    """A logarithmic axis for the gaps that are not zero."""
    axes.set_yscale("log")
    shown = samples[samples > 0.0]
    if shown.size:
        axes.set_ylim(max(shown.min(), LOWEST) / 1.5, shown.max() * 1.5)
