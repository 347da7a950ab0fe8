"""Draw the unstable manifold of a saddle: gap rate over gap at phase 0."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from .labels import title_from_attributes
from .scales import length_scale
from .style import BLACK, BLUE, RED, legend_below, make_panels, set_title, styled

COLOURS = {"+": BLUE, "-": RED}
WORDS = {"+": "where the gap grows from the saddle on", "-": "where it falls"}


@styled
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw both sides of a manifold, broken where it is discontinuous; return the figure."""
    figure, (plane,) = make_panels(1, 1, (7.4, 5.6))
    factor, letter = length_scale(data, float(data.x_rel.max()))
    pace, speed_letter = length_scale(data, float(abs(data.v_rel).max()))
    for side in map(str, data.side.values):
        part = data.sel(side=side)
        (line,) = plane.plot(part.x_rel / factor, part.v_rel / pace, label=WORDS[side])
        line.set(color=COLOURS[side], linewidth=0.8)
    gap, rate = (data.x_rel[0, 0] / factor, data.v_rel[0, 0] / pace)
    plane.plot(gap, rate, "+", color=BLACK, markersize=9, linestyle="none", label="saddle")
    plane.set(xlabel=f"gap in {letter}m", ylabel=f"gap velocity in {speed_letter}m/s")
    set_title(figure, title or title_from_attributes(data))
    legend_below(figure, [plane])
    return figure
