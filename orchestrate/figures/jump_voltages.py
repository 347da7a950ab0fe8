"""Draw jump voltages over ramp rates, with the lines extrapolated to rate 0."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .labels import format_voltage
from .style import make_panels, set_title, styled
from .weak_drive import COLOURS

EXPONENT = 2.0 / 3.0
TOO_FEW = "too few rates for rate 0"


@styled
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw jump voltages over the ramp rate, one panel per direction; return the figure."""
    known = np.isfinite(data.voltage).any(["rate", "structure"])
    jumps = [str(jump) for jump in data.jump.values if known.sel(jump=jump)] or ["up"]
    figure, axes = make_panels(1, len(jumps), (6.0 * len(jumps), 4.5))
    for panel, jump in zip(axes, jumps, strict=True):
        part = data.sel(jump=jump)
        for structure in map(str, data.structure.values):
            draw_structure(panel, part.sel(structure=structure), structure)
        if known.sel(jump=jump):
            extrapolated = bool(np.isfinite(part.jumps).any())
            panel.legend(loc="best", title="at rate 0" if extrapolated else TOO_FEW)
        else:
            in_the_middle: Any = {"transform": panel.transAxes, "ha": "center", "va": "center"}
            panel.text(0.5, 0.5, f"no jump {jump}", **in_the_middle)
            panel.set(xticks=[], yticks=[])
        panel.set(xlabel="rate$^{2/3}$ in (V/s)$^{2/3}$", ylabel="voltage in V")
        panel.set_title(f"jump {jump}")
    set_title(figure, title)
    return figure


def draw_structure(panel: Axes, data: xr.Dataset, structure: str) -> None:
    """Draw one structure's voltages of one jump and, where it is known, the line to rate 0."""
    lag, colour, end = data.rate.values**EXPONENT, COLOURS[structure], float(data.jumps)
    finite = np.isfinite(data.voltage.values)
    points: Any = {"color": colour, "markersize": 4}
    if not np.isfinite(end):
        count = int(finite.sum())
        text = (
            f"{structure}: {count} rate{'s' * (count != 1)}" if count else f"{structure}: no jump"
        )
        panel.plot(lag, data.voltage, "o", label=text, **points)
        return
    panel.plot(lag, data.voltage, "o", **points)
    error = float(data.standard_error)
    order = np.argsort(lag[finite])
    through = np.append(end, data.voltage.values[finite][order])
    text = f"{structure}: {format_voltage(end, error)}"
    line: Any = {"color": colour, "linewidth": 1.0, "label": text}
    panel.plot(np.append(0.0, lag[finite][order]), through, "-", **line)
    panel.errorbar(0.0, end, np.nan_to_num(error), fmt="s", color=colour, capsize=3)
