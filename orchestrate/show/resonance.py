"""Draw lines over the frequency: resonance curves, at one level or several, and thresholds."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from .colours import BLACK, DIRECTION_STYLES, GREY, STRUCTURES
from .kinds import BRANCHES, draws
from .labels import frequency_scale, title_from_attributes
from .lines import MAX_DISTINCT, MarkStyle, marker_keywords
from .overlay import place_over_responses
from .scales import (
    AxisValues,
    acceleration_scale,
    append_unit,
    axis_values,
    length_scale,
    varied_dimension,
)
from .style import add_figure_legend, draw_line, make_panels, set_plain_log_scale, set_title, styled

DIRECTION_LINES: dict[str, Any] = {  # down lies on up
    "up": {"linestyle": DIRECTION_STYLES["up"], "linewidth": 1.8, "alpha": 0.75},
    "down": {"linestyle": DIRECTION_STYLES["down"], "linewidth": 1.0},
}
JUMP_LINES: dict[str, Any] = {"up": ":", "down": (0, (6.0, 2.0, 1.0, 2.0))}
THRESHOLD, LOWEST = "threshold_acceleration", "lowest_threshold"
LAYOUT: list[Any] = [["x1_max", "x2_max"], ["a1_max", "a2_max"], ["x_rel_max", "x_rel_max"]]
LAYOUT += [[THRESHOLD, THRESHOLD]]
NAMES = {
    **{f"x{i}_max": f"max $|x_{i}|$" for i in "12"},
    **{f"a{i}_max": rf"max $|\ddot{{x}}_{i} + \ddot{{y}}|$" for i in "12"},
    "x_rel_max": "largest gap",
}
LENGTHS = {"x1_max": "xi1_max", "x2_max": "xi2_max", "x_rel_max": "xi_rel_max"}  # of an orbit


@draws("resonance", partner=BRANCHES)
@styled
def draw_resonance(data: xr.Dataset, title: str = "", overlay: Sequence[xr.Dataset] = ()) -> Figure:
    figure = Figure(figsize=(9.6, 9.4 if THRESHOLD in data else 7.6), layout="constrained")
    rows = [row for row in LAYOUT if row[0] in data]
    axes = figure.subplot_mosaic(rows, sharex=True)
    set_title(figure, title or title_from_attributes(data))
    parameter = varied_dimension(data[rows[0][0]])
    x = axis_values(data, parameter)
    branches = [place_over_responses(branch, data, parameter) for branch in overlay]
    for name, plane in axes.items():
        if name == THRESHOLD:
            draw_level_of_box(plane, data, x)
            continue
        draw_curves_of_quantity(plane, data, data[name], x)
        draw_peaks(plane, data, name, parameter, x)
        span = plane.get_xlim()
        for branch in branches if name in LENGTHS else ():
            factor = quantity_scale(data, data[name])[0]
            branch.draw_orbits(plane, LENGTHS[name], factor, (BLACK, BLACK))
            if name == "x_rel_max":
                branch.draw_bifurcations(plane, LENGTHS[name], factor)
            plane.set_xlim(span)
    texts, has_jumps = [], "x_rel_max" in axes and data.sizes.get("jump")
    for direction, style in JUMP_LINES.items() if has_jumps else ():
        jumps = data[f"jump_{parameter}"].where(data.jump_direction == direction, drop=True)
        positions = sorted(axis_position(float(jump), data[parameter], x) for jump in jumps)
        line: Any = {"linewidth": 0.8, "linestyle": style, "label": f"jump {direction}"}
        for at in positions:
            axes["x_rel_max"].axvline(at, color=BLACK, **line)
        if positions:
            texts.append(f"jump{'s' * (len(positions) > 1)} {direction} at {x.format(*positions)}")
    if texts:
        axes["x_rel_max"].set_title("; ".join(texts), fontsize=8)
    for plane in axes.values():  # panels of two widths
        plane.tick_params(labelbottom=True)
        plane.set_xlabel(x.label)
    add_figure_legend(figure, reversed(list(axes.values())), columns=6)
    return figure


def draw_curves_of_quantity(
    axes: Axes, data: xr.Dataset, values: xr.DataArray, x: AxisValues
) -> None:
    """Draw one quantity's curves and list each structure's maximum; no gap if bonded."""
    factor, unit = quantity_scale(data, values)
    largest: dict[str, tuple[float, float]] = {}
    for name in {"structure", "direction"} - set(values.dims):
        values = values.expand_dims({name: [""]})
    for structure, direction in product(values.structure.values, values.direction.values):
        curve = values.sel(structure=structure, direction=direction).values / factor
        if np.nanmax(curve, initial=0.0) <= 0.0:
            continue
        label = ", ".join(filter(None, [structure, direction]))
        colour = STRUCTURES.get(structure, BLACK)
        axes.plot(x.values, curve, **DIRECTION_LINES[direction or "up"], color=colour, label=label)
        if len(x.values) <= MAX_DISTINCT // 4:
            axes.plot(x.values, curve, **marker_keywords(len(x.values), MarkStyle(colour, 0.6)))
        top = int(np.nanargmax(curve))
        largest[structure] = max(largest.get(structure, (0.0, 0.0)), (curve[top], x.values[top]))
    axes.margins(x=0.0, y=0.12)
    set_plain_log_scale(axes)
    axes.set_ylabel(append_unit(NAMES[str(values.name)], unit))
    right = all(at < float(np.mean(axes.get_xlim())) for _, at in largest.values())
    style: Any = {"ha": "right" if right else "left", "va": "top", "fontsize": 7}
    for row, (structure, (value, at)) in enumerate(largest.items()):
        corner = (0.99 if right else 0.01, 0.97 - 0.075 * row)
        number = f"{value:.4g} {unit}".rstrip()
        text = f"{structure}: {number} at {x.format(at)}".lstrip(": ")
        colour = STRUCTURES.get(structure, BLACK)
        axes.text(*corner, text, color=colour, transform=axes.transAxes, **style)


def draw_level_of_box(axes: Axes, data: xr.Dataset, x: AxisValues) -> None:
    factor, unit = acceleration_scale(data)
    level = (data.amplitude * data.frequency**2).broadcast_like(data[THRESHOLD]).values / factor
    threshold = draw_threshold(axes, data, factor, "level at which it {}", 1.2)
    axes.plot(x.values, level, "-.", color=GREY, linewidth=1.2, label="level of the box")
    above: Any = {"where": level >= threshold, "color": GREY, "alpha": 0.25, "linewidth": 0.0}
    axes.fill_between(x.values, threshold, level, **above)
    axes.margins(x=0.0, y=0.12)
    set_plain_log_scale(axes)
    axes.set_ylabel(append_unit(r"peak $|\ddot{y}|$", unit))


def draw_threshold(
    axes: Axes, data: xr.Dataset, factor: float, words: str, width: float = 1.5
) -> np.ndarray:
    """Draw the level at which the gap opens or closes; return it, NaN where none does."""
    levels = data[THRESHOLD].values
    shown: np.ndarray = np.where(np.isfinite(levels), levels, np.nan) / factor
    x = axis_values(data, str(data[THRESHOLD].dims[0])).values
    event = data[THRESHOLD].attrs.get("event") or data.attrs["event"]
    mark = "o-" if shown.size < 2 else "-"
    draw_line(axes, x, shown, mark, BLACK, width, words.format(event))
    return shown


def quantity_scale(data: xr.Dataset, values: xr.DataArray) -> tuple[float, str]:
    if str(values.name).startswith("a"):
        return acceleration_scale(data)
    return length_scale(data, float(values.max()))


def draw_peaks(axes: Axes, data: xr.Dataset, name: str, parameter: str, x: AxisValues) -> None:
    factor, _ = quantity_scale(data, data[name])
    for i in range(data.sizes.get("peak", 0)):
        peak = data.isel(peak=i)
        if "peak_irregular" in data and bool(peak.peak_irregular):
            continue
        height = float(peak[f"peak_{name}"]) / factor
        if height > 0.0:
            colour = STRUCTURES.get(str(peak.peak_structure.values), BLACK)
            at = axis_position(float(peak[f"peak_{parameter}"]), data[parameter], x)
            axes.plot(at, height, "v", color=colour, markersize=6.0, markeredgecolor="white")


def axis_position(value: float, parameter: xr.DataArray, x: AxisValues) -> float:
    order = np.argsort(parameter.values)
    return float(np.interp(value, parameter.values[order], x.values[order]))


@draws("resonance_levels")
@styled
def draw_resonance_levels(data: xr.Dataset, title: str = "") -> Figure:
    count = 3 if THRESHOLD in data else 2
    words = title or title_from_attributes(data, ("amplitude", "frequency"))
    figure, axes = make_panels(count, 1, (8.4, 1.2 + 2.5 * count), words, sharex=True)
    level, (factor, unit) = data.level.values, acceleration_scale(data, "g")
    low, high = float(level.min()), float(level.max())
    part = np.zeros(len(level)) if low == high else np.asarray(LogNorm(low, high)(level))
    colours = mpl.colormaps["viridis_r"].resampled(256)(0.1 + 0.85 * part)  # light for low levels
    size = np.maximum(data.a1_max, data.a2_max).max("direction") / data.level
    gaps = data.x_rel_max.sel(structure="delaminated").max("direction")
    length, length_unit = length_scale(data, float(gaps.max()) or 1.0)
    x = axis_values(data, "frequency")
    for number, colour in enumerate(colours):
        label = f"{level[number] / factor:.4g} {unit}".rstrip() if len(level) <= 8 else None
        curve = size.isel(level=number).sel(structure="delaminated")
        draw_line(axes[0], x.values, curve, "-", colour, 1.4, label)
        draw_line(axes[1], x.values, gaps.isel(level=number) / length, "-", colour, 1.4)
    glued = size.isel(level=0).sel(structure="bonded")
    draw_line(axes[0], x.values, glued, "--", GREY, 1.0, "bonded, at each level")
    set_plain_log_scale(axes[0])
    axes[0].set_ylabel("largest acceleration\nbetween impacts\nover level")
    axes[1].set_ylabel(append_unit("largest gap", length_unit))
    axes[1].set_ylim(bottom=0.0)
    if THRESHOLD in data:
        draw_threshold(axes[2], data, factor, "level at which it first {}")
        mark_lowest_threshold(axes[2], data)
        for number, colour in enumerate(colours):
            axes[2].axhline(level[number] / factor, color=colour, linewidth=1.0)
        set_plain_log_scale(axes[2])
        axes[2].set_ylabel(append_unit("level of the box", unit))
    axes[-1].set_xlabel(x.label)
    axes[0].margins(x=0.0)
    add_figure_legend(figure, axes)
    return figure


@draws("contact_threshold")
@styled
def draw_contact_threshold(data: xr.Dataset, title: str = "") -> Figure:
    """Draw the level at which a structure first opens or touches over frequency, in g and Hz."""
    words = title or title_from_attributes(data, ("eta", "frequency"))
    figure, (plane,) = make_panels(1, 1, (6.4, 4.2), words)
    factor, unit = acceleration_scale(data, "g")
    level = draw_threshold(plane, data, factor, "it first {}")
    mark_lowest_threshold(plane, data)
    if np.nanmax(level, initial=0.0) > 0.0:
        set_plain_log_scale(plane)
    along = axis_values(data, str(data[THRESHOLD].dims[0])).label
    plane.set(xlabel=along, ylabel=append_unit("peak acceleration of the box", unit))
    plane.legend()
    return figure


def mark_lowest_threshold(axes: Axes, data: xr.Dataset) -> None:
    """Mark the lowest threshold of the range, which may lie between two frequencies."""
    if LOWEST not in data:
        return
    (factor, unit), (turn, word) = acceleration_scale(data, "g"), frequency_scale(data)
    place, level = float(data[f"{LOWEST}_frequency"]) / turn, float(data[LOWEST]) / factor
    where = f"at {place:.5g} {word}" if word != "eta" else rf"at $\eta$ = {place:.5g}"
    label = " ".join(filter(None, (f"lowest: {level:.3g}", unit, where)))
    axes.plot(place, level, "o", color=BLACK, markersize=4.0, linestyle="none", label=label)
