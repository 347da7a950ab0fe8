"""Maps over frequency and another parameter: impacts, multiplicity, largest gap and impulse."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure

from .labels import symbol
from .style import in_our_look, panels

COLUMNS = {
    "impacts_per_period": "impacts per $T$",
    "multiplicity": "multiplicity",
    "xi_rel_max": r"max $\xi_{Rel}$",
    "impulse_max": "largest impulse",
}
SHADES = (
    *("#1f77b4", "#ff7f0e", "#2ca02c", "#9467bd", "#8c564b", "#e377c2", "#bcbd22"),  # 1 to 7
    *("#17becf", "#222222"),  # 8 and more, none
)
KINDS = ("1", "2", "3", "4", "5", "6", "7", "8+", "none")


@in_our_look
def draw(*maps: xr.Dataset) -> Figure:
    """One row of maps a dataset.

    Parameters
    ----------
    *maps : xarray.Dataset
        Of :func:`orchestrate.map`, over ``eta`` and another parameter; of ``COLUMNS`` those
        are drawn that all datasets have.
    """
    columns = [name for name in COLUMNS if all(name in data for data in maps)]
    figure, axes = panels(len(maps), len(columns), (3.75 * len(columns), 3.4 * len(maps)))
    for row, data in enumerate(maps):
        (parameter,) = map(str, set(data[columns[0]].dims) - {"eta"})
        for column, name in enumerate(columns):
            plane = axes[row * len(columns) + column]
            draw_map(plane, data[name].transpose(parameter, "eta"))
            plane.set_title(COLUMNS[name] if row == 0 else "")
            plane.set(ylabel="" if column else symbol(parameter), xlabel=r"$\eta$")
    return figure


def draw_map(plane: Axes, data: xr.DataArray) -> None:
    """One map with its colour bar; a parameter in equal ratios on a logarithmic axis."""
    parameter = data.dims[0]
    values, shades = shading(str(data.name), data.values)
    picture = plane.pcolormesh(data.eta, data[parameter], values, rasterized=True, **shades)
    bar = plane.figure.colorbar(picture, ax=plane)
    if data.name == "multiplicity":
        bar.set_ticks(range(1, 10), labels=KINDS)
    plane.set_yscale("log" if in_equal_ratios(data[parameter].values) else "linear")
    plane.grid(False)


def shading(name: str, values: np.ndarray) -> tuple[np.ndarray, dict[str, Any]]:
    """The values of a quantity as they are coloured, and how."""
    if name == "multiplicity":
        shown = np.where(values == 0, 9, np.minimum(values, 8))
        return shown, {"vmin": 0.5, "vmax": 9.5, "cmap": ListedColormap(SHADES)}
    if name == "impacts_per_period":
        return values, {"vmin": 0, "vmax": 10}
    return values, {"norm": LogNorm(*np.quantile(values[values > 0.0], (0.01, 1.0)))}


def in_equal_ratios(values: np.ndarray) -> bool:
    """Whether values grow by a factor from one to the next."""
    if len(values) < 3 or values[0] <= 0.0 or values[-1] <= values[0]:
        return False
    return bool(np.allclose(values, np.geomspace(values[0], values[-1], len(values))))
