"""A motion in time: both masses, the gap with its impacts, and the contact force."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from .style import BLACK, BLUE, GREY, RED, in_our_look, panels


@in_our_look
def draw(data: xr.Dataset, title: str = "", bonded: xr.Dataset | None = None) -> Figure:
    """Draw a motion over the periods of the excitation.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.simulate`.
    title : str
        What moves.
    bonded : xarray.Dataset, optional
        The same of the bonded structure, drawn beside it.
    """
    figure, (top, middle, bottom) = panels(3, 1, (12, 8), sharex=True, height_ratios=(2, 2, 1))
    turns = data.periods_done.values
    top.plot(turns, data.x1, color=BLUE, linewidth=1.0, label="$x_1$")
    top.plot(turns, data.x2, "--", color=RED, linewidth=1.0, label="$x_2$")
    if bonded is not None:
        label = "$x_1 = x_2$, bonded"
        top.plot(bonded.periods_done, bonded.x1, color=GREY, linewidth=1.0, label=label)
    top.set(ylabel="displacement in m", title=title)
    top.legend(loc="upper right")
    middle.plot(turns, data.x_rel, color=BLACK, linewidth=1.0)
    at = np.interp(data.impact_time.values, data.time.values, turns)
    label = f"{data.sizes['impact']} impacts"
    middle.plot(at, np.zeros_like(at), "|", color=RED, markersize=8, label=label)
    middle.set_ylabel("gap $x_2 - x_1$ in m")
    middle.legend(loc="upper right")
    bottom.plot(turns, data.contact_force, color=GREY, linewidth=1.0)
    bottom.set(ylabel="contact force in N", xlabel="$t/T$", xlim=(turns[0], turns[-1]))
    return figure
