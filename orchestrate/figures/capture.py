"""The capture map: which voltages pass the resonance from rest, which are captured."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .style import BLACK, GREY, in_our_look, panels

PASSED = "tab:green"


@in_our_look
def draw(maps: Mapping[str, xr.Dataset], title: str = "") -> Figure:
    """Draw capture maps, one a column.

    Parameters
    ----------
    maps : mapping of xarray.Dataset
        Of :func:`orchestrate.capture`, by what they are, such as ``"bonded"``.
    title : str
    """
    figure, axes = panels(1, len(maps), (5.5 * len(maps), 4.5), sharex=True, sharey=True)
    for panel, (name, data) in zip(axes, maps.items(), strict=True):
        over = {str(dim) for dim in data.passes.dims} - {"voltage"}
        panel.set_title(name)
        panel.set_xlabel("voltage switched on, in V")
        if over:
            draw_map(panel, data, over.pop())
        else:
            draw_line(panel, data)
        panel.legend(loc="best")
        panel.label_outer()
    if title:
        figure.suptitle(title)
    return figure


def draw_map(axes: Axes, data: xr.Dataset, over: str) -> None:
    """Passed and captured over voltage and parameter, and the border."""
    volts, values = np.meshgrid(data.voltage.values, data[over].values)
    passed = data.passes.transpose(over, "voltage").values > 0
    mark: Any = {"s": 22, "linewidths": 0.8}
    captured = "captured"
    axes.scatter(volts[~passed], values[~passed], marker="x", color=GREY, label=captured, **mark)
    axes.scatter(volts[passed], values[passed], color=PASSED, label="passes", **mark)
    axes.plot(data.border, data[over], "-", color=BLACK, linewidth=1.2, label="border")
    unit = str(data[over].attrs["units"])
    axes.set_ylabel(over.replace("_", " ") + ("" if unit == "1" else f" in {unit}"))


def draw_line(axes: Axes, data: xr.Dataset) -> None:
    """Time of the passage over the voltage."""
    passed = data.passes.values > 0
    volts = data.voltage.values
    axes.plot(volts[passed], data.passage_time.values[passed], "o-", color=PASSED, label="passes")
    low: Any = {"transform": axes.get_xaxis_transform(), "clip_on": False}
    captured = "captured"
    axes.plot(
        volts[~passed], np.full((~passed).sum(), 0.02), "x", color=GREY, label=captured, **low
    )
    border = float(data.border)
    if np.isfinite(border):
        axes.axvline(border, color=BLACK, linewidth=1.0, label=f"border, {border:.4f} V")
    axes.set_ylabel("time of the passage in s")
    axes.set_ylim(0.0, 1.2 * float(data.passage_time.max().fillna(1.0)))
