"""A run whose voltage is no ramp: speed, voltage, amplitude, impacts and power over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from .powers import POWER_REVOLUTIONS, draw_powers, mean_powers
from .style import BLUE, GREY, panels, set_title, styled
from .weak_drive import COLOURS, outcome

ROWS = {
    "speed": "mean speed in rad/s",
    "voltage": "voltage in V",
    "amplitude": "amplitude of $x_1$ in m",
    "impacts": "impacts in a revolution",
}


@styled
def draw(runs: Mapping[str, xr.Dataset], resonance: float, title: str = "") -> Figure:
    """Draw runs over time, one per column.

    Parameters
    ----------
    runs : mapping of xarray.Dataset
        Of :func:`orchestrate.couple`, by what they are, such as ``"bonded"``.
    resonance : float
        Speed between motions below and beyond the resonance, rad/s.
    title : str
        What is shown: set, volts, controller.
    """
    count, rows = len(runs), len(ROWS) + 1
    figure, axes = panels(rows, count, (6.5 * count, 2.6 * rows), sharex=True, sharey="row")
    for column, (name, data) in enumerate(runs.items()):
        column_axes = axes[column::count]
        for panel, what in zip(column_axes, ROWS, strict=False):
            points: Any = {"color": COLOURS.get(name, BLUE), "linewidth": 1.0}
            style = "." if what == "impacts" else "-"
            panel.plot(data.time, data[what], style, markersize=2.5, **points)
        column_axes[0].axhline(
            resonance, color=GREY, linewidth=1.0, linestyle="--", label="resonance"
        )
        column_axes[0].set_title(f"{name}: {outcome(data)}")
        time = data.time.values
        middle = 0.5 * (time[POWER_REVOLUTIONS:] + time[:-POWER_REVOLUTIONS])
        draw_powers(column_axes[-1], middle, mean_powers(data))
        column_axes[-1].set_xlabel("time in s")
    for panel, label in zip(axes[::count], (*ROWS.values(), "power in W"), strict=True):
        panel.set_ylabel(label)
    axes[0].legend(loc="best")
    axes[(rows - 1) * count].legend(loc="best", fontsize=7)
    set_title(figure, title)
    return figure
