"""Draw lines over a parameter: sweeps, branches, exponents, attractors and jump voltages.

A quantity is drawn as steps or as a line, and what several samples share a value as marks.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, PercentFormatter

from ..flags import flag_words
from . import style
from .colours import BESIDES_RED, BLACK, BLUE, DIRECTIONS, GREY, RED, STRUCTURES
from .kinds import BRANCHES, MORE, draws
from .labels import branch_title, format_voltage, orbit_label, title_from_attributes
from .overlay import DrawnBranch, place_over_responses
from .scales import (
    axis_values,
    displayed_gaps,
    gap_scale_and_label,
    parameter_scale_and_label,
    varied_dimension,
)
from .style import add_figure_legend, draw_line, make_panels, styled

MAX_DISTINCT = 600  # values along an axis at which marks can be distinguished
DECADES = 6  # of a logarithmic axis of gaps, at most
CELLS = (1500, 750)  # of a panel, for samples that lie on each other
SHADES = ((1, 0.35), (3, 0.6), (8, 1.0))  # from this number of samples in a cell on: opacity
VERDICTS = {1: (RED, "o"), 0: (BLUE, "s"), -1: (BLACK, ".")}  # chaotic, neutral, periodic
IRREGULAR, OTHER = "irregular", "other periodic"


class MarkStyle(NamedTuple):
    """Colour, size and filling of marks at values."""

    colour: str
    size: float = 1.0  # over the usual size
    filled: bool = True


def marker_keywords(count: int, marks: MarkStyle) -> dict[str, Any]:
    """Return Matplotlib's line and marker keywords for ``count`` values side by side."""
    style = {"linestyle": "none", "color": marks.colour}
    if count > MAX_DISTINCT and marks.size <= 1.0:
        return {**style, "marker": ","}
    if count > MAX_DISTINCT:
        return {**style, "marker": "s", "markersize": marks.size, "markeredgewidth": 0.0}
    size = float(np.clip(400.0 / count, 1.6, 5.0)) * marks.size
    if marks.filled:
        return {**style, "marker": "o", "markersize": size, "markeredgewidth": 0.0}
    return {**style, "marker": "o", "markersize": size, "markerfacecolor": "none"}


def cell_index(axis: Axis, values: np.ndarray, count: int) -> np.ndarray:
    """Return in which of ``count`` equal parts of an axis each value lies."""
    change = axis.get_transform().transform
    first, last = change(axis.get_view_interval())
    position = (change(values.ravel()) - first) * (count / (last - first))
    return position.clip(0.0, count - 1.0).astype(np.intp).reshape(values.shape)


def draw_samples(
    axes: Axes, x: np.ndarray, samples: np.ndarray, marks: MarkStyle, label: str = ""
) -> None:
    """Draw samples over their parameter, darker where many coincide; set scales before."""
    gaps, each = samples.ravel(), samples.shape[1]
    style = {**marker_keywords(len(x), marks), "rasterized": True}
    if len(x) <= MAX_DISTINCT:
        axes.plot(np.repeat(x, each), gaps, **style, alpha=0.8, label=label)
        return
    columns, rows = CELLS
    column, row = cell_index(axes.xaxis, x, columns), cell_index(axes.yaxis, samples, rows)
    cell = (column[:, None] * rows + row).ravel()
    # one sample of each occupied cell of the panel, and how many lie there
    chosen, count = np.full(columns * rows, -1), np.bincount(cell, minlength=columns * rows)
    chosen[cell] = np.arange(len(cell))
    chosen, count = chosen[count > 0], count[count > 0]
    ends = [*(minimum for minimum, _ in SHADES[1:]), np.inf]
    for (minimum, opacity), end in zip(SHADES, ends, strict=True):
        of_shade = chosen[(count >= minimum) & (count < end)]
        axes.plot(x[of_shade // each], gaps[of_shade], **style, alpha=opacity)
    size: Any = {"marker": "s", "markersize": 5.0, "linestyle": "none", "color": marks.colour}
    axes.plot([], [], **size, label=label)


def draw_steps(axes: Axes, x: np.ndarray, values: np.ndarray, colour: str, width: float) -> None:
    """Draw a piecewise constant quantity as steps, with marks where values are few."""
    order = np.argsort(x, kind="stable")
    axes.plot(x[order], values[order], color=colour, linewidth=width, drawstyle="steps-mid")
    if len(x) <= MAX_DISTINCT:
        axes.plot(x, values, **marker_keywords(len(x), MarkStyle(colour, 0.7)))


DIRECTION_MARKS = {  # down lies on up
    "up": MarkStyle(DIRECTIONS["up"], 2.0, filled=False),
    "down": MarkStyle(DIRECTIONS["down"]),
}


@draws("sweep", partner=BRANCHES)
@styled
def draw_sweep(data: xr.Dataset, title: str = "", overlay: Sequence[xr.Dataset] = ()) -> Figure:
    """Draw an orbit diagram with all samples (Figures 6, 10, 11), and the impacts below it."""
    figure, (top, bottom) = make_panels(2, 1, (9.6, 6.4), sharex=True, height_ratios=(3, 1))
    parameter = varied_dimension(data.impacts_per_period)
    branches = [place_over_responses(branch, data, parameter) for branch in overlay]
    shown, label = displayed_gaps(data, data.xi_rel)
    factor, _ = gap_scale_and_label(data, data.xi_rel)
    x, name = axis_values(data, parameter)
    low, high = float(x.min()), float(x.max())
    bottom.set_xlim((low, high) if high > low else (low - 0.5, high + 0.5))
    lines = [branch.gaps_at_phase_0(factor).ravel() for branch in branches]
    set_gap_axis_scale(top, np.concatenate([shown.values.ravel(), *lines]))
    both = "direction" in data.dims
    usual = MarkStyle(GREY if branches else BLACK)
    for direction in map(str, data.direction.values) if both else ("",):
        part = {"direction": direction} if both else {}
        samples = shown.sel(part).transpose(parameter, "sample").values
        marks = usual if branches else DIRECTION_MARKS.get(direction, usual)
        draw_samples(top, x, samples, marks, "the sweep" if branches else direction)
        impacts = data.impacts_per_period.sel(part).values
        width = {"up": 2.6, "down": 1.0}.get(direction, 0.8)
        draw_steps(bottom, x, impacts, DIRECTIONS.get(direction, BLACK), width)
    set_impact_axis_scale(bottom, data.impacts_per_period.values)
    samples_shown = f"$n = {int(data.sample.values[0])}(1){int(data.sample.values[-1])}$"
    words = title or title_from_attributes(data)
    top.set_title(", ".join(filter(None, [words, samples_shown])))
    top.set_ylabel(f"{label}$(nT)$" if label.endswith("$") else f"{label}, at $t = nT$")
    bottom.set(ylabel="impacts per $T$", xlabel=name)
    for branch in branches:
        branch.draw_orbits(top, "xi_rel", factor)
        branch.draw_bifurcations(top, "xi_rel", factor)
    if both or branches:
        add_figure_legend(figure, [top], columns=8 if branches else 4)
    return figure


def set_gap_axis_scale(axes: Axes, samples: np.ndarray) -> None:
    """Set a logarithmic gap axis that is linear near 0, so that 0 is on it."""
    largest = float(samples.max(initial=0.0))
    if largest <= 0.0:
        axes.set_ylim(-0.05, 1.0)
        return
    minimum = float(samples.min())
    linear = 10.0 ** np.floor(np.log10(largest) - DECADES)
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


def set_impact_axis_scale(axes: Axes, impacts: np.ndarray) -> None:
    """Choose a linear, symlog or log axis for impacts per period; write "no impacts" if none."""
    above_zero = impacts[impacts > 0.0]
    if not above_zero.size:
        axes.set_ylim(0.0, 1.0)
        style.write_in_empty_panel(axes, "no impacts")
    elif above_zero.max() < 10.0 * above_zero.min():
        axes.set_ylim(0.0, 1.1 * above_zero.max())
    elif above_zero.size < impacts.size:
        axes.set_yscale("symlog", linthresh=float(above_zero.min()), linscale=0.5)
        axes.set_ylim(0.0, 1.3 * above_zero.max())
    else:
        axes.set_yscale("log")


@draws("branch", partner=MORE)
@styled
def draw_branch(*branches: xr.Dataset, title: str = "") -> Figure:
    name = str(branches[0].attrs["over"])
    figure, (plane,) = make_panels(1, 1, (9.6, 5.8), title or branch_title(branches[0], [name]))
    factor, gap = gap_scale_and_label(branches[0], branches[0].xi_rel)
    unit, label = parameter_scale_and_label(branches[0], name)
    drawn = [DrawnBranch(branch, unit) for branch in branches]
    gaps = [branch.gaps_at_phase_0(factor).ravel() for branch in drawn]
    set_gap_axis_scale(plane, np.concatenate(gaps))
    at = np.concatenate([branch[name].values for branch in branches]) / unit
    low, high = float(at.min()), float(at.max())
    edge = 0.01 * (high - low)  # room for markers at the ends
    words = f"{gap}, at $t = nT$" if factor else rf"{style.XI_REL}$(nT)$"
    plane.set(xlabel=label, ylabel=words, xlim=(low - edge, high + edge))
    for one in drawn:
        one.draw_orbits(plane, "xi_rel", factor)
        one.draw_bifurcations(plane, "xi_rel", factor)
    add_figure_legend(figure, [plane], columns=8)
    return figure


@draws("lyapunov", partner=MORE)
@styled
def draw_lyapunov(*cases: xr.Dataset, title: str = "") -> Figure:
    size = (9.6, 0.6 + 2.2 * len(cases))
    figure, axes = make_panels(len(cases), 1, size, sharex=True, sharey=True)
    minimum = min(float(data.exponent.min()) for data in cases)
    lowest = min(max(1.2 * minimum, -0.1), -0.01)
    axes[0].set_ylim(lowest, max(0.05, *(1.2 * float(data.exponent.max()) for data in cases)))
    titles = [title] if title else map(title_from_attributes, cases)
    for plane, data, words in zip(axes, cases, titles, strict=True):
        names = flag_words(data.verdict.attrs)
        x, label = axis_values(data, varied_dimension(data.exponent))
        dot = float(np.clip(1000.0 / len(x), 2.0, 4.0))
        for verdict, (colour, shape) in VERDICTS.items():
            of = data.verdict.values == verdict
            exponent, error = data.exponent.values[of], data.standard_error.values[of]
            marks: Any = {"fmt": shape, "color": colour, "markersize": dot, "linewidth": 0.7}
            plane.errorbar(x[of], exponent, yerr=error, label=names[verdict], **marks)
        below = data.exponent.values < lowest
        if below.any():
            edge = plane.get_xaxis_transform()
            marks = {"color": BLACK, "markersize": 4, "label": f"periodic, below {lowest:.2g}"}
            plane.plot(x[below], np.full(below.sum(), 0.02), "v", transform=edge, **marks)
        plane.axhline(0.0, color="0.5", linewidth=0.8)
        plane.set(ylabel=r"$\lambda$ per unit of $\tau$", title=words)
    axes[-1].set_xlabel(label)
    add_figure_legend(figure, axes, 6, title="bars: one standard error")
    return figure


@draws("attractors")
@styled
def draw_attractors(data: xr.Dataset, title: str = "") -> Figure:
    title = title or title_from_attributes(data)
    heights: Any = {"sharex": True, "height_ratios": (3, 2, 1)}
    figure, (top, middle, bottom) = make_panels(3, 1, (9.6, 7.2), title, **heights)
    data = data.sortby(varied_dimension(data.number))
    x, name = axis_values(data, varied_dimension(data.number))
    shown, label = displayed_gaps(data, data.xi_rel_max)
    kinds, words = orbit_colours_and_labels(data)
    for index in range(data.sizes["attractor"]):
        part = data.isel(attractor=index)
        exists = words[:, index] != ""
        for panel, values in ((top, shown.isel(attractor=index)), (middle, part.share)):
            draw_attractor(panel, x, values.where(exists).values, words[:, index], kinds)
    for word in filter(None, dict.fromkeys(words.ravel())):
        marker = "D-" if word == IRREGULAR else "o-"
        top.plot([], [], marker, color=kinds[word], markersize=3.5, label=word)
    top.set(yscale="log", ylabel=f"largest {label}")
    if float(shown.max()) < 10.0 * float(shown.min()):  # no whole decade: plain numbers
        top.yaxis.set_minor_formatter("{x:g}")
    middle.set(ylabel="share of random starts", ylim=(-0.04, 1.04))
    middle.yaxis.set_major_formatter(PercentFormatter(1.0))
    line = "-k" if len(x) > MAX_DISTINCT // 4 else "-k."
    bottom.step(x, data.number, line, where="mid", markersize=3, linewidth=1.0)
    bottom.set(ylabel="attractors", xlabel=name, ylim=(0, float(data.number.max()) + 0.5))
    bottom.yaxis.set_major_locator(MaxNLocator(integer=True))
    if len(x) > 1 and x.min() > 0.0 and x.max() > 4.0 * x.min():
        bottom.set_xscale("log")
        bottom.xaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0)))
        bottom.xaxis.set_major_formatter("{x:g}")
        bottom.xaxis.set_minor_formatter(NullFormatter())
    add_figure_legend(figure, [top], columns=5)
    return figure


def orbit_colours_and_labels(data: xr.Dataset) -> tuple[dict[str, str], np.ndarray]:
    n, rate = data.multiplicity.values, data.impacts_per_period.values
    words = np.full(n.shape, "", dtype=object)
    for index in zip(*np.nonzero(np.isfinite(n)), strict=True):
        words[index] = orbit_label(n[index], rate[index]) or IRREGULAR
    counts = Counter(word for word in words.ravel() if word and word != IRREGULAR)
    frequent = [word for word, _ in counts.most_common(len(BESIDES_RED))]
    words[np.isin(words, [*frequent, IRREGULAR, ""], invert=True)] = OTHER
    colours = dict(zip(frequent, BESIDES_RED, strict=False))
    return {**colours, OTHER: GREY, IRREGULAR: RED}, words.astype(str)


def draw_attractor(
    panel: Axes, x: np.ndarray, values: np.ndarray, labels: np.ndarray, colours: dict[str, str]
) -> None:
    panel.plot(x, values, "-", color="#c8c8c8", linewidth=0.8, zorder=1.5)
    for word in dict.fromkeys(labels[labels != ""]):
        of_kind = np.where(labels == word, values, np.nan)
        draw_line(panel, x, of_kind, "-", colours[word], 1.4)
        there = np.isfinite(np.concatenate([[np.nan], of_kind, [np.nan]]))
        alone = there[1:-1] & ~there[:-2] & ~there[2:]  # to which no line leads
        marked = of_kind if len(x) <= 60 else np.where(alone, of_kind, np.nan)
        marker = "D" if word == IRREGULAR else "o"
        panel.plot(x, marked, marker, color=colours[word], markersize=3.5, markeredgewidth=0.0)


def draw_jump_voltages_over(data: xr.Dataset, parameter: str, title: str) -> Figure:
    known = data.jumps.notnull().any(["structure", parameter])
    jumps = [str(jump) for jump in data.jump.values if known.sel(jump=jump)] or ["up"]
    figure, axes = make_panels(1, len(jumps), (6.0 * len(jumps), 4.5), title)
    factor, label = parameter_scale_and_label(data, parameter)
    for panel, jump in zip(axes, jumps, strict=True):
        for structure in map(str, data.structure.values):
            at = data.sel(jump=jump, structure=structure)
            bars: Any = {"yerr": at.standard_error, "color": STRUCTURES[structure], "capsize": 3.0}
            panel.errorbar(data[parameter] / factor, at.jumps, fmt="o-", label=structure, **bars)
        panel.set(xlabel=label, ylabel="voltage at rate 0 in V")
        panel.set_title(f"jump {jump}")
    add_figure_legend(figure, axes)
    return figure


@draws("jump_voltages")
@styled
def draw_jump_voltages(data: xr.Dataset, title: str = "") -> Figure:
    if others := {str(dim) for dim in data.jumps.dims} - {"structure", "jump"}:
        return draw_jump_voltages_over(data, others.pop(), title)
    known = np.isfinite(data.voltage).any(["rate", "structure"])
    jumps = [str(jump) for jump in data.jump.values if known.sel(jump=jump)] or ["up"]
    figure, axes = make_panels(1, len(jumps), (6.0 * len(jumps), 4.5), title)
    for panel, jump in zip(axes, jumps, strict=True):
        part = data.sel(jump=jump)
        for structure in map(str, data.structure.values):
            at = part.sel(structure=structure)
            lag, end, colour = at.rate.values ** (2.0 / 3.0), float(at.jumps), STRUCTURES[structure]
            finite = np.isfinite(at.voltage.values)
            count = int(finite.sum())
            nothing = "undecided" if at.decided.item() == "undecided" else "no jump"
            words = f"{count} rate{'s' * (count != 1)}" if count else nothing
            label = None if np.isfinite(end) else f"{structure}: {words}"
            panel.plot(lag, at.voltage, "o", color=colour, markersize=4, label=label)
            if np.isfinite(end):  # the line to rate 0
                error, order = float(at.standard_error), np.argsort(lag[finite])
                through = np.append(end, at.voltage.values[finite][order])
                label = f"{structure}: {format_voltage(end, error)}"
                x = np.append(0.0, lag[finite][order])
                draw_line(panel, x, through, "-", colour, 1.0, label)
                panel.errorbar(0.0, end, np.nan_to_num(error), fmt="s", color=colour, capsize=3)
        if known.sel(jump=jump):
            extrapolated = bool(np.isfinite(part.jumps).any())
            words = "at rate 0" if extrapolated else "too few rates for rate 0"
            panel.legend(loc="best", title=words)
        else:
            undecided = (part.decided == "undecided").any()
            style.write_in_empty_panel(panel, f"{'undecided' if undecided else 'no jump'} {jump}")
            panel.set(xticks=[])
        panel.set(xlabel="rate$^{2/3}$ in (V/s)$^{2/3}$", ylabel="voltage in V")
        panel.set_title(f"jump {jump}")
    return figure
