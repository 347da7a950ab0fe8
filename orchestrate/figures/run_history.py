"""A run whose voltage is no ramp: speed, voltage, amplitude, impacts and power over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .style import GREY, panels, styled
from .weak_drive import COLOURS, POWER_REVOLUTIONS, SINKS

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
            points: Any = {"color": COLOURS.get(name, "C0"), "linewidth": 1.0}
            style = "." if what == "impacts" else "-"
            panel.plot(data.time, data[what], style, markersize=2.5, **points)
        column_axes[0].axhline(
            resonance, color=GREY, linewidth=1.0, linestyle="--", label="resonance"
        )
        column_axes[0].set_title(f"{name}: {outcome(data)}")
        draw_powers(column_axes[-1], data)
        column_axes[-1].set_xlabel("time in s")
    for panel, label in zip(axes[::count], (*ROWS.values(), "power in W"), strict=True):
        panel.set_ylabel(label)
    axes[0].legend(loc="best")
    axes[(rows - 1) * count].legend(loc="best", fontsize=7)
    if title:
        figure.suptitle(title)
    return figure


def outcome(data: xr.Dataset) -> str:
    """Format whether the resonance is passed."""
    passed = float(data.passage_time)
    if np.isfinite(passed):
        return f"beyond the resonance from {passed:.4g} s on"
    return "the resonance is not passed"


def draw_powers(axes: Axes, data: xr.Dataset) -> None:
    """Draw where the motor's power goes."""
    time = data.time.values
    span, middle = (
        time[POWER_REVOLUTIONS:] - time[:-POWER_REVOLUTIONS],
        0.5 * (time[POWER_REVOLUTIONS:] + time[:-POWER_REVOLUTIONS]),
    )

    def power(account: str) -> np.ndarray:
        values = data[account].values
        return np.asarray((values[POWER_REVOLUTIONS:] - values[:-POWER_REVOLUTIONS]) / span)

    axes.plot(middle, power("motor"), "k", linewidth=1.6, label="motor")
    for account, label in SINKS.items():
        axes.plot(middle, power(account), linewidth=1.0, label=label)
    axes.plot(middle, power("stored"), color=GREY, linewidth=1.0, label="stored")
