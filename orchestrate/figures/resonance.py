"""Resonance curves: amplitude and acceleration of both masses, bonded against delaminated."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .labels import about
from .marks import FEW, Marks, mark
from .scales import Along, along, parameter_of, prefix
from .style import BLACK, BLUE, RED, entitle, in_our_look, legend_above

COLOURS = {"delaminated": RED, "bonded": BLUE}
STYLES: dict[str, Any] = {  # down lies on up
    "up": {"linestyle": "-", "linewidth": 1.8, "alpha": 0.75},
    "down": {"linestyle": "--", "linewidth": 1.0},
}
PLACES: list[Any] = [["x1_max", "x2_max"], ["a1_max", "a2_max"], ["x_rel_max", "x_rel_max"]]
NAMES = {
    "x1_max": "max $|x_1|$ in {}m",
    "x2_max": "max $|x_2|$ in {}m",
    "a1_max": r"max $|\ddot{{x}}_1 + \ddot{{y}}|$ in m/s$^2$",
    "a2_max": r"max $|\ddot{{x}}_2 + \ddot{{y}}|$ in m/s$^2$",
    "x_rel_max": "largest gap in {}m",
}


@in_our_look
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw resonance curves, with the largest value of each marked.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.resonance`: ``x1_max``, ``x2_max``, ``x_rel_max`` in m and
        ``a1_max``, ``a2_max`` in m/s2 over the frequency and, where there are several,
        ``structure`` and ``direction``.
    title : str
        What is shaken; by default the structure and the excitation.
    """
    figure = Figure(figsize=(12, 9), layout="constrained")
    rows = [row for row in PLACES if row[0] in data]
    axes = figure.subplot_mosaic(rows, sharex=True)
    entitle(figure, title or about(data))
    x = along(data, parameter_of(data[rows[0][0]]))
    for name, plane in axes.items():
        draw_quantity(plane, data[name], x)
    for name in rows[-1]:
        axes[name].set_xlabel(x.label)
    legend_above(figure, axes.values(), columns=6)
    return figure


def draw_quantity(axes: Axes, values: xr.DataArray, x: Along) -> None:
    """One quantity's curves; of the bonded structure no gap."""
    name = str(values.name)
    length = name.startswith("x")
    factor, letter = prefix(float(values.max())) if length else (1.0, "")
    peaks, places = [], []
    for words, part in curves(values):
        curve = part.values / factor
        if np.nanmax(curve, initial=0.0) <= 0.0:
            continue
        structure = words.partition(", ")[0]
        style = STYLES[words.rpartition(", ")[2] if "direction" in values.dims else "up"]
        colour = COLOURS.get(structure, BLACK)
        axes.plot(x.values, curve, **style, color=colour, label=words)
        if len(x.values) <= FEW // 4:
            axes.plot(x.values, curve, **mark(len(x.values), Marks(colour, 0.6)))
        at = int(np.nanargmax(curve))
        axes.plot(x.values[at], curve[at], "v", color=colour, markersize=5.0)
        peaks.append((f"{words}: {curve[at]:.4g} at {x.values[at]:.5g}".lstrip(": "), colour))
        places.append(x.values[at])
    axes.set(yscale="log", ylabel=NAMES[name].format(letter))
    axes.margins(x=0.0, y=0.12)
    list_peaks(axes, peaks, np.mean(places) < np.mean(axes.get_xlim()) if places else True)


def curves(values: xr.DataArray) -> list[tuple[str, xr.DataArray]]:
    """Each structure's and each direction's curve, with its words for the legend."""
    found = [("", values)]
    for name in ("structure", "direction"):
        if name in values.dims:
            found = [
                (", ".join(filter(None, [words, str(value)])), part.sel({name: value}))
                for words, part in found
                for value in values[name].values
            ]
    return found


def list_peaks(axes: Axes, peaks: Sequence[tuple[str, str]], right: bool) -> None:
    """The largest value of each curve with its place, in the corner away from them."""
    for row, (text, colour) in enumerate(peaks):
        style: Any = {"ha": "right" if right else "left", "va": "top", "fontsize": 7}
        place = (0.99 if right else 0.01, 0.97 - 0.075 * row)
        axes.text(*place, text, color=colour, transform=axes.transAxes, **style)
