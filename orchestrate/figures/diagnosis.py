"""Draw a diagnosis: measured orders over fits, signs over noise floors, a test's plan."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ..units import as_shown
from .analysis import note_hidden
from .labels import plain_title
from .scales import label_with_unit, typeset_array_unit
from .style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    legend_below,
    make_panels,
    set_title,
    styled,
)

CHANNELS = {"acceleration1": "sensor 1", "acceleration2": "sensor 2", "motor": "motor"}
COLOURS = (BLUE, ORANGE, GREEN, PURPLE, SKY)
FITS = (BLUE, ORANGE, GREEN)  # of the delaminated, of the best sound structure, of the bonded one
PARTED, BONDED = "delaminated", "bonded"  # names of hypotheses begin so
LIMIT = 2.0  # times what noise and a sound structure show, from which a sign stands out
FEWEST_DECADES = (0.2, 10.0)  # of the signs' axis, at least
HEIGHT = 0.8  # of all bars of a sign


@styled
def draw_signs(data: xr.Dataset, title: str = "") -> Figure:
    """Draw delamination signs as bars relative to noise and to a sound structure's values."""
    signs = [str(sign) for sign in data.sign.values]
    figure, (axes,) = make_panels(1, 1, (8.0, 1.6 + 0.32 * len(signs)))
    usual = np.fmax(data.floor, data.sound_highest)
    ratio = (data.value / usual).where(data.exceeds >= 0)
    channels = [str(channel) for channel in data.channel.values]
    share = HEIGHT / len(channels)
    for number, channel in enumerate(channels):
        positions = np.arange(len(signs)) + share * (number - 0.5 * (len(channels) - 1))
        values = ratio.sel(channel=channel).values
        label = CHANNELS.get(channel, channel)
        colour = COLOURS[number % len(COLOURS)]
        axes.barh(positions, np.nan_to_num(values), share, color=colour, label=label)
        write_values(axes, positions, values, data.value.sel(channel=channel).values)
    lines: Any = {"linewidth": 1.0, "zorder": 3}
    axes.axvline(1.0, color=GREY, label="noise and a sound structure", **lines)
    axes.axvline(LIMIT, color=RED, linestyle="--", label="from here it stands out", **lines)
    high = max(float(np.nanmax(ratio.values, initial=1.0)), FEWEST_DECADES[1])
    axes.set(xscale="log", xlim=(FEWEST_DECADES[0], 4.0 * high))
    axes.set_yticks(np.arange(len(signs)), [str(text) for text in data.meaning.values])
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("sign over what noise and a sound structure show of it")
    legend_below(figure, [axes], 4)
    set_title(figure, title or plain_title(str(data.attrs["title"])))
    return figure


def write_values(axes: Axes, place: np.ndarray, ratios: np.ndarray, values: np.ndarray) -> None:
    """Write each sign's own value at the end of its bar, or that the record lacks it."""
    for y, ratio, value in zip(place, ratios, values, strict=True):
        known = np.isfinite(ratio)
        text = f"{value:.3g}" if known else "not in this record"
        x = float(ratio) if known and ratio > LIMIT else LIMIT  # lines are left of it
        offset: Any = {"xytext": (3, 0), "textcoords": "offset points", "zorder": 4}
        colour = BLACK if known else GREY
        axes.annotate(text, (x, y), va="center", fontsize=7, color=colour, **offset)


@styled
def draw_plan(data: xr.Dataset, title: str = "") -> Figure:
    """Draw over frequency and level where a test would show a delamination; return the figure."""
    size = (8.0, 6.2)
    figure, (plane, below) = make_panels(2, 1, size, sharex=True, height_ratios=(1.5, 1.0))
    data = as_shown(data)
    limit = float(data.threshold)
    if data.sizes["level"] > 1:
        draw_map(figure, plane, data, limit)
    else:
        draw_distances(plane, data, limit)
    for number, level in enumerate(data.level.values):
        line: Any = {"color": COLOURS[number % len(COLOURS)], "linewidth": 1.1}
        force = data.closing_force.isel(level=number)
        label = f"at {level:.3g} {typeset_array_unit(data.level)}"
        below.semilogy(data.frequency, force, label=label, **line)
    across = label_with_unit("frequency of the box", data.frequency)
    below.set(xlabel=across, ylabel="preload that keeps\nit shut, in N")
    legend_below(figure, [plane, below], 4)
    set_title(figure, title or plain_title(str(data.attrs["title"])))
    return figure


def draw_map(figure: Figure, plane: Axes, data: xr.Dataset, limit: float) -> None:
    """Draw the distance by orders 2 and 3 over frequency and level, with the recommended sweep."""
    values = data.distance_harmonics
    top = max(float(values.max()), 10.0 * limit)
    norm = LogNorm(1e-4 * top, top)
    shown = np.maximum(values, 1e-4 * top)
    mesh = plane.pcolormesh(
        data.frequency, data.level, shown, norm=norm, shading="nearest", rasterized=True
    )
    plane.plot(
        data.frequency, data.smallest_level, color=RED, linewidth=1.6, label="level that counts"
    )
    first, last = float(data.recommended_first), float(data.recommended_last)
    level = float(data.recommended_level)
    plane.add_patch(
        Rectangle(
            (first, level / 1.12),
            last - first,
            level * (1.12 - 1.0 / 1.12),
            fill=False,
            edgecolor=BLACK,
            linewidth=1.6,
            label="recommended sweep",
        )
    )
    plane.set(yscale="log", ylabel=label_with_unit("level of the box", data.level))
    plane.set_ylim(float(data.level.min()) / 1.3, float(data.level.max()) * 1.3)
    plane.grid(visible=False)
    words = "difference by orders 2 and 3\nin standard deviations of the noise"
    figure.colorbar(mesh, ax=plane, label=words, aspect=20)


def draw_distances(plane: Axes, data: xr.Dataset, limit: float) -> None:
    """Draw the distances by orders 1 to 3 over frequency, at the first level."""
    at = data.isel(level=0)
    plane.semilogy(at.frequency, at.distance_harmonics, color=BLUE, label="orders 2 and 3")
    plane.semilogy(at.frequency, at.distance_first, color=ORANGE, label="order 1")
    plane.axhline(limit, color=RED, linewidth=1.0, label="from here it counts")
    plane.axvspan(
        float(at.recommended_first), float(at.recommended_last), color=GREY, alpha=0.15, zorder=0
    )
    plane.set_ylabel("difference in standard\ndeviations of the noise")


@styled
def draw_detect(data: xr.Dataset, title: str = "") -> Figure:
    """Draw a record's orders over frequency with those of the fits, one column per sensor."""
    data = with_hypothesis_dimension(as_shown(data))
    channels = [str(channel) for channel in data.channel.values]
    orders = [float(order) for order in data.order.values]
    rows, columns = len(orders), len(channels)
    figure, axes = make_panels(rows, columns, (1.5 + 6.0 * columns, 0.9 + 1.9 * rows), sharex=True)
    shown = best_fits(data)
    for place, (order, channel) in enumerate((n, name) for n in orders for name in channels):
        plane = axes[place]
        at = data.sel(order=order, channel=channel)
        plane.plot(at.frequency, at.measured, ".", color=BLACK, markersize=3.0, label="measured")
        if "floor" in at:
            plane.plot(at.frequency, at.floor, color=GREY, linewidth=0.8, label="floor")
        for number, name in enumerate(shown):
            line: Any = {
                "color": FITS[number % len(FITS)],
                "linewidth": 1.1,
                "zorder": 3.0 - 0.1 * number,
            }
            plane.plot(at.frequency, at.fitted.sel(hypothesis=name), label=name, **line)
        plane.set_yscale("log")
        limit_decades(plane, at.measured.values)
        note_curves_below(plane, at, shown)
        if place % columns == 0:
            plane.set_ylabel(f"order {order:g}\nin {typeset_array_unit(data.measured)}")
        if place < columns:
            plane.set_title(CHANNELS.get(channel, channel))
    for plane in axes[-columns:]:
        plane.set_xlabel(label_with_unit("frequency of the excitation", data.frequency))
    legend_below(figure, axes, 3)
    set_title(figure, title or str(data.attrs.get("title", "")))
    return figure


def note_curves_below(plane: Axes, data: xr.Dataset, shown: list[str]) -> None:
    """Write into a panel which fits, or whether the floor, lie below its axis."""
    curves = {name: data.fitted.sel(hypothesis=name).values for name in shown}
    if "floor" in data:
        curves["floor"] = data.floor.values
    note_hidden(plane, {name: [y] for name, y in curves.items() if np.isfinite(y).any()})


def with_hypothesis_dimension(data: xr.Dataset) -> xr.Dataset:
    """Return a result with the dimension ``hypothesis``, added if it has a single fit."""
    if "hypothesis" in data.dims:
        return data
    fitted = {name: data[name] for name in ("fitted", "misfit", "misfit_at") if name in data}
    name = str(data.attrs.get("hypothesis", "fit"))
    return data.drop_vars(list(fitted)).merge(
        xr.Dataset(fitted).drop_vars("hypothesis", errors="ignore").expand_dims(hypothesis=[name])
    )


def best_fits(data: xr.Dataset) -> list[str]:
    """Return the names of the fits to draw: best delaminated, best sound, and bonded."""
    order = np.argsort(data.misfit.values, kind="stable")
    ordered = [str(name) for name in data.hypothesis.values[order]]
    parted = [name for name in ordered if name.startswith(PARTED)][:1]
    sound = [name for name in ordered if not name.startswith(PARTED)]
    return [*parted, *dict.fromkeys([*sound[:1], *(name for name in sound if name == BONDED)])]


def limit_decades(plane: Axes, values: np.ndarray) -> None:
    """Limit a logarithmic y axis to the decades of the measured values."""
    known = values[np.isfinite(values) & (values > 0.0)]
    if len(known):
        plane.set_ylim(0.3 * np.quantile(known, 0.02), 3.0 * known.max())


@styled
def draw_misfit(data: xr.Dataset, title: str = "") -> Figure:
    """Draw each fit's misfit to the record over frequency; return the figure."""
    figure, (axes,) = make_panels(1, 1, (8.0, 3.4))
    data = as_shown(data)
    for number, name in enumerate(best_fits(data)):
        one = data.sel(hypothesis=name)
        line: Any = {"color": FITS[number % len(FITS)], "linewidth": 1.0}
        words = f"{name}: {float(one.misfit):.3g}"
        axes.semilogy(one.frequency, one.misfit_at, label=words, **line)
    axes.axhline(1.0, color=GREY, linewidth=0.8)
    across = label_with_unit("frequency of the excitation", data.frequency)
    axes.set(xlabel=across, ylabel="misfit over its usual size")
    legend_below(figure, [axes], 2)
    set_title(figure, title or str(data.attrs.get("title", "")))
    return figure
