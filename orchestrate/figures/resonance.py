"""Draw resonance curves: amplitude and acceleration, bonded against delaminated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .labels import title_from_attributes
from .marks import MAX_DISTINCT, MarkStyle, marker_keywords
from .overlay import Overlay
from .scales import AxisValues, acceleration_scale, axis_values, length_scale, varied_dimension
from .style import (
    BLACK,
    BLUE,
    GREY,
    RED,
    legend_below,
    set_title,
    styled,
    write_plain_numbers,
)
from .threshold import THRESHOLD, hide_infinite

COLOURS = {"delaminated": RED, "bonded": BLUE}
STYLES: dict[str, Any] = {  # down lies on up
    "up": {"linestyle": "-", "linewidth": 1.8, "alpha": 0.75},
    "down": {"linestyle": "--", "linewidth": 1.0},
}
JUMP_LINES: dict[str, Any] = {"up": ":", "down": (0, (6.0, 2.0, 1.0, 2.0))}
LAYOUT: list[Any] = [["x1_max", "x2_max"], ["a1_max", "a2_max"], ["x_rel_max", "x_rel_max"]]
NAMES = {
    "x1_max": "max $|x_1|$ in {}",
    "x2_max": "max $|x_2|$ in {}",
    "a1_max": r"max $|\ddot{{x}}_1 + \ddot{{y}}|$ in {}",
    "a2_max": r"max $|\ddot{{x}}_2 + \ddot{{y}}|$ in {}",
    "x_rel_max": "largest gap in {}",
}


LENGTHS = {"x1_max": "xi1_max", "x2_max": "xi2_max", "x_rel_max": "xi_rel_max"}  # of an orbit


@styled
def draw(data: xr.Dataset, title: str = "", overlay: Sequence[xr.Dataset] = ()) -> Figure:
    """Draw resonance curves with their peaks and jumps; return the figure."""
    figure = Figure(figsize=(9.6, 7.6), layout="constrained")
    rows = [row for row in LAYOUT if row[0] in data]
    if THRESHOLD in data:
        rows.append([THRESHOLD, THRESHOLD])
        figure.set_figheight(9.4)
    axes = figure.subplot_mosaic(rows, sharex=True)
    set_title(figure, title or title_from_attributes(data))
    parameter = varied_dimension(data[rows[0][0]])
    x = axis_values(data, parameter)
    branches = [Overlay(branch, data, parameter) for branch in overlay]
    for name, plane in axes.items():
        if name == THRESHOLD:
            draw_threshold(plane, data, x)
            continue
        draw_quantity(plane, data, data[name], x)
        draw_peaks(plane, data, name, parameter, x)
        if name in LENGTHS and branches:
            draw_overlay(plane, branches, name, display_unit(data, data[name])[0])
    if "x_rel_max" in axes and data.sizes.get("jump"):
        draw_jumps(axes["x_rel_max"], data, parameter, x)
    for name in (name for row in rows[-2:] for name in row):  # panels of two widths
        axes[name].tick_params(labelbottom=True)
        axes[name].set_xlabel(x.label)
    legend_below(figure, reversed(list(axes.values())), columns=6)
    return figure


def draw_overlay(axes: Axes, branches: Sequence[Overlay], name: str, factor: float) -> None:
    """Draw branches over the curves within their frequency range; bifurcations in the gap."""
    span = axes.get_xlim()
    for branch in branches:
        branch.draw(axes, LENGTHS[name], factor, (BLACK, BLACK))
        if name == "x_rel_max":
            branch.mark(axes, LENGTHS[name], factor)
    axes.set_xlim(span)


def draw_quantity(axes: Axes, data: xr.Dataset, values: xr.DataArray, x: AxisValues) -> None:
    """Draw one quantity's curves and list each structure's maximum; no gap if bonded."""
    name = str(values.name)
    factor, unit = display_unit(data, values)
    largest: dict[str, tuple[float, float]] = {}
    for words, part in curves_with_labels(values):
        curve = part.values / factor
        if np.nanmax(curve, initial=0.0) <= 0.0:
            continue
        structure = words.partition(", ")[0]
        style = STYLES[words.rpartition(", ")[2] if "direction" in values.dims else "up"]
        colour = COLOURS.get(structure, BLACK)
        axes.plot(x.values, curve, **style, color=colour, label=words)
        if len(x.values) <= MAX_DISTINCT // 4:
            axes.plot(x.values, curve, **marker_keywords(len(x.values), MarkStyle(colour, 0.6)))
        at = int(np.nanargmax(curve))
        largest[structure] = max(largest.get(structure, (0.0, 0.0)), (curve[at], x.values[at]))
    axes.set(yscale="log", ylabel=NAMES[name].format(unit))
    axes.margins(x=0.0, y=0.12)
    write_plain_numbers(axes)
    list_largest(axes, largest, unit, x)


def draw_threshold(axes: Axes, data: xr.Dataset, x: AxisValues) -> None:
    """Draw the box's acceleration and the threshold at which the gap opens or closes."""
    level = (data.amplitude * data.frequency**2).broadcast_like(data[THRESHOLD]).values
    factor, unit = acceleration_scale(data)
    threshold, event = hide_infinite(data[THRESHOLD]) / factor, data[THRESHOLD].attrs["event"]
    level = level / factor
    axes.plot(x.values, threshold, color=BLACK, linewidth=1.2, label=f"level at which it {event}")
    axes.plot(x.values, level, color=GREY, linewidth=1.2, linestyle="-.", label="level of the box")
    axes.fill_between(
        x.values, threshold, level, where=level >= threshold, color=GREY, alpha=0.25, linewidth=0.0
    )
    axes.set(yscale="log", ylabel=rf"peak $|\ddot{{y}}|$ in {unit}")
    axes.margins(x=0.0, y=0.12)
    write_plain_numbers(axes)


def display_unit(data: xr.Dataset, values: xr.DataArray) -> tuple[float, str]:
    """Return the divisor from SI and the display unit of a quantity."""
    if str(values.name).startswith("a"):
        return acceleration_scale(data)
    factor, letter = length_scale(data, float(values.max()))
    return factor, f"{letter}m"


def curves_with_labels(values: xr.DataArray) -> list[tuple[str, xr.DataArray]]:
    """Return each structure's and direction's curve, with its legend label."""
    curves = [("", values)]
    for name in ("structure", "direction"):
        if name in values.dims:
            curves = [
                (", ".join(filter(None, [words, str(value)])), part.sel({name: value}))
                for words, part in curves
                for value in values[name].values
            ]
    return curves


def draw_peaks(axes: Axes, data: xr.Dataset, name: str, parameter: str, x: AxisValues) -> None:
    """Draw a triangle on each resonance peak, except where responses are irregular."""
    if not data.sizes.get("peak"):
        return
    factor, _ = display_unit(data, data[name])
    for i in range(data.sizes["peak"]):
        peak = data.isel(peak=i)
        if "peak_irregular" in data and bool(peak.peak_irregular):
            continue
        height = float(peak[f"peak_{name}"]) / factor
        if height > 0.0:
            colour = COLOURS.get(str(peak.peak_structure.values), BLACK)
            at = axis_position(float(peak[f"peak_{parameter}"]), data[parameter], x)
            axes.plot(at, height, "v", color=colour, markersize=6.0, markeredgecolor="white")


def draw_jumps(axes: Axes, data: xr.Dataset, parameter: str, x: AxisValues) -> None:
    """Draw a line at each jump of the gap; list their frequencies above the panel."""
    texts = []
    for direction, style in JUMP_LINES.items():
        jumps = data[f"jump_{parameter}"].where(data.jump_direction == direction, drop=True)
        positions = sorted(axis_position(float(jump), data[parameter], x) for jump in jumps)
        for at in positions:
            axes.axvline(at, color=BLACK, linewidth=0.8, linestyle=style, label=f"jump {direction}")
        if positions:
            texts.append(f"jump{'s' * (len(positions) > 1)} {direction} at {x.text(*positions)}")
    if texts:
        axes.set_title("; ".join(texts), fontsize=8)


def axis_position(value: float, parameter: xr.DataArray, x: AxisValues) -> float:
    """Return a parameter's value in the unit of the axis."""
    order = np.argsort(parameter.values)
    return float(np.interp(value, parameter.values[order], x.values[order]))


def list_largest(
    axes: Axes, largest: Mapping[str, tuple[float, float]], unit: str, x: AxisValues
) -> None:
    """Write each structure's largest value and its frequency into a panel's corner."""
    middle = float(np.mean(axes.get_xlim()))
    right = all(at < middle for _, at in largest.values())
    for row, (structure, (value, at)) in enumerate(largest.items()):
        style: Any = {"ha": "right" if right else "left", "va": "top", "fontsize": 7}
        corner = (0.99 if right else 0.01, 0.97 - 0.075 * row)
        text = f"{structure}: {value:.4g} {unit} at {x.text(at)}".lstrip(": ")
        colour = COLOURS.get(structure, BLACK)
        axes.text(*corner, text, color=colour, transform=axes.transAxes, **style)
