"""Basins of attraction in a plane of starts."""

from __future__ import annotations

from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from .style import in_our_look, panels

COLOURS = ("#1b3a5c", "#e8a33d", "#5fa777", "#b8412f", "#8a6bb1")  # of the most frequent attractors
OTHER = "#cccccc"


@in_our_look
def draw(data: xr.Dataset, title: str = "", names: tuple[str, str] = ("", "")) -> Figure:
    """Draw the plane, each start in the colour of its attractor.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.basin`.
    title : str
    names : (str, str)
        Of both axes; by default those of the coordinates.
    """
    figure, (plane,) = panels(1, 1, (8, 6.5))
    y, x = map(str, data.attractor_of.dims)
    labels = data.attractor_of.where(data.attractor_of >= 0).values.clip(max=len(COLOURS))
    shades = ListedColormap([*COLOURS, OTHER])
    limits: Any = {"vmin": -0.5, "vmax": len(COLOURS) + 0.5}
    plane.pcolormesh(data[x], data[y], labels, cmap=shades, rasterized=True, **limits)
    label_attractors(plane, data)
    plane.set(xlabel=names[0] or x, ylabel=names[1] or y, title=title)
    plane.grid(False)
    plane.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1))
    return figure


def label_attractors(plane: Axes, data: xr.Dataset) -> None:
    """A line in the legend for each attractor that has a colour."""
    for index, colour in zip(range(data.sizes["attractor"]), COLOURS, strict=False):
        part = data.isel(attractor=index)
        n, impacts = int(part.multiplicity), float(part.impacts_per_period)
        kind = f"{n if n > 1 else ''}T" if n else "not periodic"
        gap, share = float(part.xi_rel_max), float(part.share)
        text = f"{kind}, {impacts:.2f} impacts per T, largest gap {gap:.3g}: {share:.1%}"
        plane.plot([], [], "s", color=colour, label=text)
