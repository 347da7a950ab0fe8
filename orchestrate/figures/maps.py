"""Draw maps over two parameters: impacts, multiplicity, largest gap, impulse, exponent."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from ..units import length_of_ratio, omega_of, units_of
from .labels import gap_name, si_prefix, title_from_attributes
from .scales import axis_values, has_frequency_unit, length_scale
from .style import (
    BLACK,
    GREEN,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    XI_REL,
    YELLOW,
    make_panels,
    set_title,
    styled,
)

FREQUENCIES = ("eta", "frequency")

COLUMNS = {
    "impacts_per_period": "impacts per $T$",
    "multiplicity": "multiplicity",
    "xi_rel_max": f"largest {XI_REL}",
    "impulse_max": r"largest impulse over $m_1 \omega a \eta^2$",
    "exponent": r"$\lambda$ per unit of $\tau$",
}
SHADES = (
    *("#dfe6ee", SKY, GREEN, YELLOW, ORANGE, RED, PURPLE),  # 1 to 7
    *("#7a4a1e", BLACK),  # 8 and more, none
)
KINDS = ("1", "2", "3", "4", "5", "6", "7", "8+", "not\nperiodic")
NOTHING = "#d9d9d9"  # no impacts


@styled
def draw(*maps: xr.Dataset, title: str = "") -> Figure:
    """Draw maps over two parameters, one row per dataset; return the figure."""
    columns = [name for name in COLUMNS if all(name in data for data in maps)]
    size = (max(3.1 * len(columns), 4.5), 0.4 + 2.8 * len(maps))
    figure, axes = make_panels(len(maps), len(columns), size)
    set_title(figure, title or (title_from_attributes(maps[0]) if len(maps) == 1 else ""))
    for row, data in enumerate(maps):
        first, second = map(str, data[columns[0]].dims)
        up, right = (second, first) if first in FREQUENCIES else (first, second)
        for column, name in enumerate(columns):
            plane = axes[row * len(columns) + column]
            sides = axis_values(data, right), axis_values(data, up)
            values, label = shown_values(data, name)
            draw_map(plane, values.transpose(up, right), sides[0].values, sides[1].values)
            words = "" if column or title or len(maps) == 1 else title_from_attributes(data)
            plane.set_title("\n".join(filter(None, [words, label])))
            plane.set(ylabel="" if column else sides[1].label, xlabel=sides[0].label)
    return figure


def shown_values(data: xr.Dataset, name: str) -> tuple[xr.DataArray, str]:
    """Return a quantity and its label; gaps and impulses in SI, or in the unit asked for.

    They stay ratios where neither the structure is in SI nor a unit of length is asked for.
    """
    in_si = has_frequency_unit(data) or units_of(data).length
    unit = length_of_ratio(data) if name in ("xi_rel_max", "impulse_max") and in_si else None
    if unit is None:
        return data[name], COLUMNS[name]
    if name == "impulse_max":  # over m1 omega a eta^2
        impulses = (data[name] * unit * float(data.attrs["m1"]) * omega_of(data)).rename(name)
        factor, letter = si_prefix(float(impulses.max()))
        return impulses / factor, f"largest impulse in {letter}N s"
    lengths = (data[name] * unit).rename(name)
    factor, letter = length_scale(data, float(lengths.max()))
    return lengths / factor, f"largest {gap_name(data)} in {letter}m"


def draw_map(plane: Axes, data: xr.DataArray, x: np.ndarray, y: np.ndarray) -> None:
    """Draw one map with its colour bar; a y axis in equal ratios becomes logarithmic."""
    values, shades = colour_scale(str(data.name), data.values)
    picture = plane.pcolormesh(x, y, values, rasterized=True, **shades)
    bar = plane.figure.colorbar(picture, ax=plane)
    if data.name == "multiplicity":
        bar.set_ticks(range(1, 10), labels=KINDS)
        bar.ax.minorticks_off()
    if data.name == "impacts_per_period":
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        bar.ax.yaxis.set_major_formatter("{x:g}")
        bar.ax.minorticks_off()
    if np.ma.is_masked(values):
        plane.set_facecolor(NOTHING)
        bar.ax.set_xlabel("grey: none", fontsize=7)
    plane.set_yscale("log" if is_geometric(y) else "linear")
    plane.grid(False)


def colour_scale(name: str, values: np.ndarray) -> tuple[np.ndarray, dict[str, Any]]:
    """Return a quantity's values for colouring, and colour map and norm as keywords."""
    if name == "multiplicity":
        shown = np.where(values == 0, 9, np.minimum(values, 8))
        return shown, {"vmin": 0.5, "vmax": 9.5, "cmap": ListedColormap(SHADES)}
    if name == "exponent":
        reach = float(np.nanmax(np.abs(values)))
        return values, {"vmin": -reach, "vmax": reach, "cmap": "PuOr_r"}
    above_zero = values[values > 0.0]
    shown = np.ma.masked_less_equal(values, 0.0)
    return shown, {"norm": LogNorm(above_zero.min(), above_zero.max()) if above_zero.size else None}


def is_geometric(values: np.ndarray) -> bool:
    """Return whether values grow by a constant factor from one to the next."""
    if len(values) < 3 or values[0] <= 0.0 or values[-1] <= values[0]:
        return False
    return bool(np.allclose(values, np.geomspace(values[0], values[-1], len(values))))
