"""Draw jump voltages over ramp rates, with the lines extrapolated to rate 0."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from .style import make_panels, set_title, styled
from .weak_drive import COLOURS

EXPONENT = 2.0 / 3.0


@styled
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw jump voltages over the ramp rate, one panel per direction; return the figure.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.jump_voltages`.
    title : str
    """
    known = np.isfinite(data.voltage).any(["rate", "structure"])
    jumps = [str(jump) for jump in data.jump.values if known.sel(jump=jump)] or ["up"]
    figure, axes = make_panels(1, len(jumps), (6.0 * len(jumps), 4.5))
    lag = data.rate.values**EXPONENT
    for panel, jump in zip(axes, jumps, strict=True):
        for structure in map(str, data.structure.values):
            at = data.sel(jump=jump, structure=structure)
            colour, end = COLOURS[structure], float(at.jumps)
            panel.plot(lag, at.voltage, "o", color=colour, markersize=4)
            if np.isfinite(end):
                error = float(at.standard_error)
                text = f"{structure}: {end:.4f} V"
                text += f" ± {error:.1g}" if np.isfinite(error) else ""
                finite = np.isfinite(at.voltage.values)
                order = np.argsort(lag[finite])
                through = np.append(end, at.voltage.values[finite][order])
                line: Any = {"color": colour, "linewidth": 1.0, "label": text}
                panel.plot(np.append(0.0, lag[finite][order]), through, "-", **line)
                panel.errorbar(0.0, end, np.nan_to_num(error), fmt="s", color=colour, capsize=3)
        if panel.get_legend_handles_labels()[0]:
            panel.legend(loc="best", title="at rate 0")
        elif known.sel(jump=jump):
            for structure in map(str, data.structure.values):
                panel.plot([], [], "o", color=COLOURS[structure], markersize=4, label=structure)
            panel.legend(loc="best", title="too few rates for rate 0")
        else:
            in_the_middle: Any = {"transform": panel.transAxes, "ha": "center", "va": "center"}
            panel.text(0.5, 0.5, f"no jump {jump}", **in_the_middle)
            panel.set(xticks=[], yticks=[])
        panel.set(xlabel="rate$^{2/3}$ in (V/s)$^{2/3}$", ylabel="voltage in V")
        panel.set_title(f"jump {jump}")
    set_title(figure, title)
    return figure
