"""Draw basins of attraction in a plane of start states."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from ..units import omega_of, scale_of, units_of
from .labels import (
    format_length,
    gap_name,
    orbit_label,
    symbol,
    title_from_attributes,
    typeset_unit,
)
from .style import BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, XI_REL, make_panels, set_title, styled

COLOURS = (BLUE, ORANGE, GREEN, PURPLE, RED)  # of the most frequent attractors
OTHER = "#bbbbbb"
STATE = ("x1", "x2", "v1", "v2")


@styled
def draw(data: xr.Dataset, title: str = "", names: tuple[str, str] = ("", "")) -> Figure:
    """Draw basins: each start in the colour of the attractor it leads to; return the figure."""
    figure, (plane,) = make_panels(1, 1, (6.4, 5.6))
    y, x = map(str, data.attractor_of.dims)
    labels = data.attractor_of.where(data.attractor_of >= 0).values.clip(max=len(COLOURS))
    shades = ListedColormap([*COLOURS, OTHER])
    limits: Any = {"vmin": -0.5, "vmax": len(COLOURS) + 0.5}
    (right, x_label), (up, y_label) = (coordinate_scale(data, name) for name in (x, y))
    plane.pcolormesh(data[x] / right, data[y] / up, labels, cmap=shades, rasterized=True, **limits)
    label_attractors(plane, data)
    mark_attractors(plane, data)
    plane.set(xlabel=names[0] or x_label, ylabel=names[1] or y_label)
    plane.grid(False)
    by_ratio = "eta" in data.coords and not units_of(data).frequency  # else the title has it
    eta = [rf"$\eta$ = {float(data.eta):.4g}"] if by_ratio else []
    set_title(figure, title or ", ".join([title_from_attributes(data, ("eta", x, y)), *eta]))
    figure.legend(loc="outside lower left")
    return figure


def coordinate_scale(data: xr.Dataset, name: str) -> tuple[float, str]:
    """Return the divisor to display units and the axis label of a coordinate of the plane."""
    unit = "m/s" if name.startswith("v") else "m"
    if name == "phase":
        return 1.0, symbol(name)
    factor, word = scale_of(data, unit)
    words = gap_name(data) if name == "x_rel" else symbol(name).rpartition(" in ")[0]
    return factor, f"{words} in {typeset_unit(word)}"


def mark_attractors(plane: Axes, data: xr.Dataset) -> None:
    """Mark a state of each attractor by a cross, projected on the plane."""
    y, x = map(str, data.attractor_of.dims)
    if "state" not in data or "phase" in (x, y):
        return
    columns = dict(zip(STATE, data.state.values.T, strict=True))
    columns |= {"x_rel": gap_from_states(data, columns), "v_rel": columns["v2"] - columns["v1"]}
    right, up = (coordinate_scale(data, name)[0] for name in (x, y))
    limits = plane.get_xlim(), plane.get_ylim()
    style: Any = {
        "color": "white",
        "markeredgecolor": BLACK,
        "markersize": 8.0,
        "linestyle": "none",
    }
    for index in range(data.sizes["attractor"]):
        colour = COLOURS[index] if index < len(COLOURS) else OTHER
        style["markerfacecolor"] = colour
        position = columns[x][index] / right, columns[y][index] / up
        plane.plot(*position, "X", **style)
    plane.set(xlim=limits[0], ylim=limits[1])
    plane.plot([], [], "X", **{**style, "markerfacecolor": "white"}, label="states on them")


def gap_from_states(data: xr.Dataset, columns: dict[str, np.ndarray]) -> np.ndarray:
    """Return the gap between the faces, m, of states given as a dict of coordinate arrays."""
    clearance = 0.0 if data.attrs.get("bonded") else float(data.attrs.get("clearance", 0.0))
    gap: np.ndarray = columns["x2"] - columns["x1"] + clearance
    return gap


def gap_text(data: xr.Dataset, gap: float) -> str:
    """Format a gap over a eta^2, as a length where a unit of length is asked for."""
    if not (units_of(data).length and {"amplitude", "frequency"} <= set(data.attrs)):
        return f"{XI_REL} = {gap:.3g}"
    eta = float(data.attrs["frequency"]) / omega_of(data)
    return f"gap = {format_length(data, gap * float(data.attrs['amplitude']) * eta**2)}"


def label_attractors(plane: Axes, data: xr.Dataset) -> None:
    """Add a legend with period, impacts and share of each coloured attractor."""
    for index, colour in zip(range(data.sizes["attractor"]), COLOURS, strict=False):
        part = data.isel(attractor=index)
        n, impacts = float(part.multiplicity), float(part.impacts_per_period)
        kind = orbit_label(n, impacts) or f"not periodic, {impacts:.2f} impacts per T"
        gap, share = float(part.xi_rel_max), float(part.share)
        text = f"{share:.1%}: {kind}, largest {gap_text(data, gap)}"
        plane.plot([], [], "s", color=colour, label=text)
    rest = data.share.values[len(COLOURS) :].sum()
    if rest:
        words = f"{rest:.1%}: {data.sizes['attractor'] - len(COLOURS)} others"
        plane.plot([], [], "s", color=OTHER, label=words)
    if (data.attractor_of.values < 0).any():  # in no share
        words = "no states: the gap would be below 0"
        plane.plot([], [], "s", color="white", markeredgecolor=OTHER, label=words)
