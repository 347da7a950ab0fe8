"""Draw a sweep as an orbit diagram (Figures 6, 10, 11): gap samples, impacts over a parameter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .labels import title_from_attributes
from .marks import MarkStyle, draw_samples, draw_steps
from .overlay import Overlay
from .scales import axis_values, displayed_gaps, gap_scale, varied_dimension
from .style import BLACK, BLUE, GREY, RED, legend_below, make_panels, styled, write_in_panel

MARKS = {"up": MarkStyle(BLUE, 2.0, filled=False), "down": MarkStyle(RED)}  # down lies on up
WIDTHS = {"up": 2.6, "down": 1.0}


@styled
def draw(
    data: xr.Dataset, title: str = "", decades: int = 6, overlay: Sequence[xr.Dataset] = ()
) -> Figure:
    """Draw an orbit diagram with all samples, as in the paper; return the figure."""
    figure, (top, bottom) = make_panels(2, 1, (9.6, 6.4), sharex=True, height_ratios=(3, 1))
    parameter = varied_dimension(data.impacts_per_period)
    branches = [Overlay(branch, data, parameter) for branch in overlay]
    (shown, label), (factor, _) = displayed_gaps(data, data.xi_rel), gap_scale(data, data.xi_rel)
    x, name = axis_values(data, parameter)
    low, high = float(x.min()), float(x.max())
    bottom.set_xlim((low, high) if high > low else (low - 0.5, high + 0.5))
    lines = [branch.gaps(factor).ravel() for branch in branches]
    set_gap_scale(top, np.concatenate([shown.values.ravel(), *lines]), decades)
    both = "direction" in data.dims
    marks = {} if branches else MARKS
    usual = MarkStyle(GREY if branches else BLACK)
    for direction in map(str, data.direction.values) if both else ("",):
        part = {"direction": direction} if both else {}
        samples = shown.sel(part).transpose(parameter, "sample").values
        draw_samples(top, x, samples, marks.get(direction, usual), "" if branches else direction)
        impacts = data.impacts_per_period.sel(part).values
        colour = MARKS[direction].colour if both else BLACK
        draw_steps(bottom, x, impacts, colour, WIDTHS.get(direction, 0.8))
    set_impact_scale(bottom, data.impacts_per_period.values)
    first, last = int(data.sample.values[0]), int(data.sample.values[-1])
    top.set_title(
        ", ".join(filter(None, [title or title_from_attributes(data), f"$n = {first}(1){last}$"]))
    )
    top.set_ylabel(f"{label}$(nT)$" if label.endswith("$") else f"{label}, at $t = nT$")
    bottom.set(ylabel="impacts per $T$", xlabel=name)
    for branch in branches:
        branch.draw(top, "xi_rel", factor)
        branch.mark(top, "xi_rel", factor)
    if both or branches:
        legend_below(figure, [top], columns=8 if branches else 4)
    return figure


def set_gap_scale(axes: Axes, samples: np.ndarray, decades: int = 6) -> None:
    """Set a logarithmic gap axis that is linear near 0, so that 0 is on it."""
    largest = float(samples.max(initial=0.0))
    if largest <= 0.0:
        axes.set_ylim(-0.05, 1.0)
        return
    minimum = float(samples.min())
    linear = 10.0 ** np.floor(np.log10(largest) - decades)
    if minimum > linear:
        axes.set_yscale("log")
        axes.set_ylim(minimum / 1.5, largest * 1.5)
        return
    axes.set_yscale("symlog", linthresh=linear, linscale=0.7)
    axes.set_ylim(-0.1 * linear, largest * 1.5)
    axes.axhspan(-0.1 * linear, linear, color=GREY, alpha=0.12, linewidth=0, zorder=0)
    transform = axes.get_yaxis_transform()
    text_style: Any = {"rotation": 90, "fontsize": 7, "color": GREY, "va": "center"}
    axes.text(1.004, 0.5 * linear, "linear", transform=transform, **text_style)


def set_impact_scale(axes: Axes, impacts: np.ndarray) -> None:
    """Set the axis of impacts per period; write "no impacts" if there are none."""
    above_zero = impacts[impacts > 0.0]
    if not above_zero.size:
        axes.set_ylim(0.0, 1.0)
        write_in_panel(axes, "no impacts")
    elif above_zero.max() < 10.0 * above_zero.min():
        axes.set_ylim(0.0, 1.1 * above_zero.max())
    elif above_zero.size < impacts.size:
        axes.set_yscale("symlog", linthresh=float(above_zero.min()), linscale=0.5)
        axes.set_ylim(0.0, 1.3 * above_zero.max())
    else:
        axes.set_yscale("log")
