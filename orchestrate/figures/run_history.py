"""Draw a coupled run over time: speed, voltage, amplitude, impacts and power."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from ..units import as_shown, scale_of
from .powers import POWER_REVOLUTIONS, draw_powers, mean_powers
from .scales import label_with_unit
from .style import BLUE, GREY, make_panels, set_title, styled
from .weak_drive import COLOURS, format_passage

ROWS = {
    "speed": "mean speed",
    "voltage": "voltage",
    "amplitude": "amplitude of $x_1$",
    "impacts": "impacts in a revolution",
}


@styled
def draw(runs: Mapping[str, xr.Dataset], resonance: float, title: str = "") -> Figure:
    """Draw coupled runs over time, one column per structure; return the figure."""
    count, rows = len(runs), len(ROWS) + 1
    figure, axes = make_panels(rows, count, (6.5 * count, 2.6 * rows), sharex=True, sharey="row")
    shown = {name: as_shown(data) for name, data in runs.items()}
    for column, (name, data) in enumerate(shown.items()):
        column_axes = axes[column::count]
        for panel, what in zip(column_axes, ROWS, strict=False):
            points: Any = {"color": COLOURS.get(name, BLUE), "linewidth": 1.0}
            style = "." if what == "impacts" else "-"
            panel.plot(data.time, data[what], style, markersize=2.5, **points)
        column_axes[0].axhline(
            resonance / scale_of(data, "rad/s")[0],
            color=GREY,
            linewidth=1.0,
            linestyle="--",
            label="resonance",
        )
        column_axes[0].set_title(f"{name}: {format_passage(data)}")
        time = data.time.values
        middle = 0.5 * (time[POWER_REVOLUTIONS:] + time[:-POWER_REVOLUTIONS])
        draw_powers(column_axes[-1], middle, mean_powers(data))
        column_axes[-1].set_xlabel("time in s")
    *first, impacts, power = axes[::count]
    for panel, what in zip(first, ROWS, strict=False):
        panel.set_ylabel(label_with_unit(ROWS[what], data[what]))
    impacts.set_ylabel(ROWS["impacts"])
    power.set_ylabel("power in W")
    axes[0].legend(loc="best")
    axes[(rows - 1) * count].legend(loc="best", fontsize=7)
    set_title(figure, title)
    return figure
