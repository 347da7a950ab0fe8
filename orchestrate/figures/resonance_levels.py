"""Draw resonance curves at several excitation levels, with the opening threshold."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from .labels import title_from_attributes
from .scales import acceleration_scale, axis_values, length_scale
from .style import BLACK, GREY, legend_below, make_panels, set_title, styled, write_plain_numbers
from .threshold import THRESHOLD, hide_infinite, mark_lowest

FEW = 8  # levels that have a legend entry each; more have a colour bar


@styled
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw acceleration over level, gap and threshold over frequency; return the figure."""
    rows = ["acceleration", "gap", *(["threshold"] if THRESHOLD in data else [])]
    figure, axes = make_panels(len(rows), 1, (8.4, 1.2 + 2.5 * len(rows)), sharex=True)
    plane = dict(zip(rows, axes, strict=True))
    set_title(figure, title or title_from_attributes(data, ("amplitude", "frequency")))
    draw_accelerations(plane["acceleration"], data)
    draw_gaps(plane["gap"], data)
    if "threshold" in plane:
        draw_threshold(plane["threshold"], data)
    axes[-1].set_xlabel(axis_values(data, "frequency").label)
    axes[0].margins(x=0.0)
    legend_below(figure, axes)
    return figure


def level_colours(data: xr.Dataset) -> list[Any]:
    """Return a colour for each level, light for low levels."""
    levels = data.level.values
    shades = mpl.colormaps["viridis_r"].resampled(256)
    low, high = float(levels.min()), float(levels.max())
    part = np.zeros(len(levels)) if low == high else LogNorm(low, high)(levels)
    return [shades(0.1 + 0.85 * float(each)) for each in part]


def draw_accelerations(axes: Axes, data: xr.Dataset) -> None:
    """Draw the larger mass acceleration over level: one curve where the response is linear."""
    size = np.maximum(data.a1_max, data.a2_max).max("direction") / data.level
    factor, unit = acceleration_scale(data, "g")
    x = axis_values(data, "frequency").values
    for level, colour in zip(data.level.values, level_colours(data), strict=True):
        label = f"{level / factor:.4g} {unit}" if data.sizes["level"] <= FEW else None
        curve = size.sel(level=level, structure="delaminated")
        axes.plot(x, curve, color=colour, linewidth=1.4, label=label)
    glued = size.isel(level=0).sel(structure="bonded")
    style: Any = {"color": GREY, "linewidth": 1.0, "linestyle": "--"}
    axes.plot(x, glued, label="bonded, at each level", **style)
    axes.set(yscale="log", ylabel="largest acceleration between\nimpacts over level, in g/g")
    write_plain_numbers(axes)


def draw_gaps(axes: Axes, data: xr.Dataset) -> None:
    """Draw the largest gap over frequency for each level; of up and down the larger."""
    gaps = data.x_rel_max.sel(structure="delaminated").max("direction")
    factor, letter = length_scale(data, float(gaps.max()) or 1.0)
    x = axis_values(data, "frequency").values
    for level, colour in zip(data.level.values, level_colours(data), strict=True):
        axes.plot(x, gaps.sel(level=level) / factor, color=colour, linewidth=1.4)
    axes.set_ylabel(f"largest gap in {letter}m")
    axes.set_ylim(bottom=0.0)


def draw_threshold(axes: Axes, data: xr.Dataset) -> None:
    """Draw the level at which the structure first opens or touches, and the levels asked for."""
    factor, unit = acceleration_scale(data, "g")
    threshold, event = hide_infinite(data[THRESHOLD]) / factor, data[THRESHOLD].attrs["event"]
    axes.plot(
        axis_values(data, "frequency").values,
        threshold,
        color=BLACK,
        label=f"level at which it first {event}",
    )
    mark_lowest(axes, data)
    for level, colour in zip(data.level.values, level_colours(data), strict=True):
        axes.axhline(level / factor, color=colour, linewidth=1.0)
    axes.set(yscale="log", ylabel=f"level of the box in {unit}")
    write_plain_numbers(axes)
