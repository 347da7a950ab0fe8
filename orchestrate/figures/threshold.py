"""Draw the excitation level at which a structure first opens or touches."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .labels import title_from_attributes
from .scales import acceleration_scale, axis_values, frequency_scale
from .style import BLACK, make_panels, set_title, styled, write_plain_numbers

THRESHOLD = "threshold_acceleration"
LOWEST = "lowest_threshold"


def hide_infinite(threshold: xr.DataArray) -> np.ndarray:
    """Return a threshold with NaN where no level opens or closes the gap."""
    return np.where(np.isfinite(threshold.values), threshold.values, np.nan)


@styled
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw the threshold level over frequency, in g and Hz; return the figure."""
    figure, (plane,) = make_panels(1, 1, (6.4, 4.2))
    set_title(figure, title or title_from_attributes(data, ("eta", "frequency")))
    factor, unit = acceleration_scale(data, "g")
    level = hide_infinite(data[THRESHOLD]) / factor
    x = axis_values(data, str(data[THRESHOLD].dims[0]))
    mark = "o-" if level.size < 2 else "-"
    plane.plot(x.values, level, mark, color=BLACK, label=f"it first {data.attrs['event']}")
    mark_lowest(plane, data)
    if np.nanmax(level, initial=0.0) > 0.0:
        plane.set_yscale("log")
        write_plain_numbers(plane)
    plane.set(xlabel=x.label, ylabel=f"peak acceleration of the box in {unit}")
    plane.legend()
    return figure


def mark_lowest(axes: Axes, data: xr.Dataset) -> None:
    """Mark the lowest threshold of the range, which may lie between two frequencies."""
    if LOWEST not in data:
        return
    (factor, unit), (turn, word) = acceleration_scale(data, "g"), frequency_scale(data)
    place, level = float(data[f"{LOWEST}_frequency"]) / turn, float(data[LOWEST]) / factor
    where = f"at {place:.5g} {word}" if word != "eta" else rf"at $\eta$ = {place:.5g}"
    style: Any = {"color": BLACK, "markersize": 4.0, "linestyle": "none"}
    axes.plot(place, level, "o", label=f"lowest: {level:.3g} {unit} {where}", **style)
