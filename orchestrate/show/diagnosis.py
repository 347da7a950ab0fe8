"""Draw a diagnosis: measured orders over fits, signs over noise floors, a test's plan."""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ..units import in_display_units
from .analysis import note_curves_below_axis
from .colours import BESIDES_RED, BLACK, BLUE, GREEN, GREY, ORANGE, RED
from .kinds import draws
from .labels import expand_title
from .scales import label_with_unit, typeset_array_unit
from .style import add_figure_legend, draw_line, make_panels, set_plain_log_scale, styled

SENSOR_TITLES = {"acceleration1": "sensor 1", "acceleration2": "sensor 2", "motor": "motor"}
FITS = (BLUE, ORANGE, GREEN)  # of the delaminated, of the best sound structure, of the bonded one
PARTED, BONDED = "delaminated", "bonded"  # names of hypotheses begin so
FEWEST_DECADES = (0.2, 10.0)  # of the signs' axis, at least
AT_BAR: Any = {"xytext": (3, 0), "textcoords": "offset points", "va": "center"}
AT_BAR |= {"fontsize": 7, "zorder": 4}


@draws("signs")
@styled
def draw_signs(data: xr.Dataset, title: str = "") -> Figure:
    """Draw delamination signs as bars relative to noise and to a sound structure's values."""
    known = (data.exceeds >= 0).any("channel")
    left_out = [str(text) for text in data.meaning.values[~known.values]]
    title, data = title or expand_title(str(data.attrs["title"])), data.isel(sign=known)
    size = (8.0, 1.6 + 0.32 * max(data.sizes["sign"], 1))
    figure, (axes,) = make_panels(1, 1, size, title)
    ratio = (data.value / np.fmax(data.floor, data.sound_highest)).where(data.exceeds >= 0)
    channels = [str(channel) for channel in data.channel.values]
    share, signs = 0.8 / len(channels), np.arange(data.sizes["sign"])
    limit = float(data.attrs["factor"])
    for number, channel in enumerate(channels):
        positions = signs + share * (number - 0.5 * (len(channels) - 1))
        values, label = ratio.sel(channel=channel).values, SENSOR_TITLES.get(channel, channel)
        colour = BESIDES_RED[number % len(BESIDES_RED)]
        axes.barh(positions, np.nan_to_num(values), share, color=colour, label=label)
        own = data.value.sel(channel=channel).values
        for y, length, value in zip(positions, values, own, strict=True):
            there = np.isfinite(length)
            text, shade = (f"{value:.3g}", BLACK) if there else ("not in this record", GREY)
            x = float(length) if there and length > limit else limit  # lines are left of it
            axes.annotate(text, (x, y), color=shade, **AT_BAR)
    lines: Any = {"linewidth": 1.0, "zorder": 3}
    axes.axvline(1.0, color=GREY, label="noise and a sound structure", **lines)
    axes.axvline(limit, color=RED, linestyle="--", label="from here it stands out", **lines)
    high = max(float(np.nanmax(ratio.values, initial=1.0)), FEWEST_DECADES[1])
    axes.set(xscale="log", xlim=(FEWEST_DECADES[0], 4.0 * high))
    axes.set_yticks(signs, [str(text) for text in data.meaning.values])
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("sign over what noise and a sound structure show of it")
    lacking = textwrap.fill(f"not in this record: {', '.join(left_out)}", 100)
    add_figure_legend(figure, [axes], 4, title=lacking if left_out else None)
    return figure


@draws("plan_test")
@styled
def draw_test_plan(data: xr.Dataset, title: str = "") -> Figure:
    title = title or expand_title(str(data.attrs["title"]))
    figure, (axes,) = make_panels(1, 1, (8.0, 3.8), title)
    data = in_display_units(data)
    right = data.decides.values > 0
    rows = (("guess", data.heard, BLUE), ("sound twin", data.sound_heard, ORANGE))
    for words, values, colour in rows:
        draw_line(axes, data.level, values, "-", colour, 1.1, words)
    axes.plot(data.level[right], data.heard[right], "o", color=GREEN, label="both verdicts right")
    axes.axhline(
        float(data.threshold), color=RED, linewidth=1.0, label="from here something strikes"
    )
    # of one level the first word stands
    both = {float(data.second_level): "second", float(data.recommended_level): "recommended"}
    for level, words in both.items():
        axes.axvline(level, color=GREY, linestyle="--", linewidth=1.0)
        place: Any = {"xycoords": ("data", "axes fraction"), "fontsize": 7, "rotation": 90}
        axes.annotate(f" {words}", (level, 0.02), **place)
    axes.set(xscale="log", yscale="log", ylabel="strikes over the limit of noise")
    axes.set_xlabel(label_with_unit("level of the box", data.level))
    add_figure_legend(figure, [axes], 4)
    return figure


@draws("detect", "fit")
@styled
def draw_orders_and_fits(data: xr.Dataset, title: str = "") -> Figure:
    data = in_display_units(data)
    if "hypothesis" not in data.dims:  # a single fit
        fitted = {name: data[name] for name in ("fitted", "misfit", "misfit_at") if name in data}
        one = xr.Dataset(fitted).drop_vars("hypothesis", errors="ignore")
        name = str(data.attrs.get("hypothesis", "fit"))
        data = data.drop_vars(list(fitted)).merge(one.expand_dims(hypothesis=[name]))
    channels = [str(channel) for channel in data.channel.values]
    rows, columns = data.sizes["order"], len(channels)
    size, title = (1.5 + 6.0 * columns, 0.9 + 1.9 * rows), title or data.attrs.get("title", "")
    figure, axes = make_panels(rows, columns, size, str(title), sharex=True)
    shown = names_of_best_fits(data)
    for place, plane in enumerate(axes):
        at = data.isel(order=place // columns).sel(channel=channels[place % columns])
        plane.plot(at.frequency, at.measured, ".", color=BLACK, markersize=3.0, label="measured")
        curves = {name: at.fitted.sel(hypothesis=name).values for name in shown}
        if "floor" in at:
            draw_line(plane, at.frequency, at.floor, "-", GREY, 0.8, "floor")
            curves["floor"] = at.floor.values
        for number, name in enumerate(shown):
            line: Any = {"color": FITS[number], "zorder": 3.0 - 0.1 * number}
            plane.plot(at.frequency, curves[name], linewidth=1.1, label=name, **line)
        plane.set_yscale("log")
        known = at.measured.values[at.measured.values > 0.0]
        if len(known):  # the decades of what was measured
            plane.set_ylim(0.3 * np.quantile(known, 0.02), 3.0 * known.max())
        note_curves_below_axis(
            plane, {name: [y] for name, y in curves.items() if np.isfinite(y).any()}
        )
        if place % columns == 0:
            plane.set_ylabel(f"order {float(at.order):g}\nin {typeset_array_unit(data.measured)}")
        if place < columns:
            plane.set_title(SENSOR_TITLES.get(channels[place], channels[place]))
    for plane in axes[-columns:]:
        plane.set_xlabel(label_with_unit("frequency of the excitation", data.frequency))
    add_figure_legend(figure, axes, 3)
    return figure


def names_of_best_fits(data: xr.Dataset) -> list[str]:
    order = np.argsort(data.misfit.values, kind="stable")
    ordered = [str(name) for name in data.hypothesis.values[order]]
    parted = [name for name in ordered if name.startswith(PARTED)][:1]
    sound = [name for name in ordered if not name.startswith(PARTED)]
    return [*parted, *dict.fromkeys([*sound[:1], *(name for name in sound if name == BONDED)])]


@styled
def draw_misfit(data: xr.Dataset) -> Figure:
    figure, (axes,) = make_panels(1, 1, (8.0, 3.4))
    data = in_display_units(data)
    for colour, name in zip(FITS, names_of_best_fits(data), strict=False):
        one = data.sel(hypothesis=name)
        words = f"{name}: {float(one.misfit):.3g}"
        draw_line(axes, one.frequency, one.misfit_at, "-", colour, 1.0, words)
    axes.axhline(1.0, color=GREY, linewidth=0.8)
    set_plain_log_scale(axes)
    across = label_with_unit("frequency of the excitation", data.frequency)
    axes.set(xlabel=across, ylabel="misfit over its usual size")
    add_figure_legend(figure, [axes], 2)
    return figure
