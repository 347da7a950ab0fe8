"""Draw coexisting attractors over a parameter: largest gap, share of starts, number."""

from __future__ import annotations

from collections import Counter
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, PercentFormatter

from .labels import orbit_label, title_from_attributes
from .marks import MAX_DISTINCT
from .scales import axis_values, displayed_gaps, varied_dimension
from .style import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    YELLOW,
    legend_below,
    make_panels,
    set_title,
    styled,
)

MIN_LOG_RATIO = 4.0  # a parameter that grows by more is shown in equal ratios
COLOURS = (BLUE, ORANGE, GREEN, PURPLE, SKY, YELLOW)  # of the most frequent kinds of orbits
IRREGULAR, OTHER = "irregular", "other periodic"
MAX_MARKED = 60  # values up to which each has a mark; of more, those alone have one


class AttractorStyle(NamedTuple):
    """Marker and line style of attractors of one kind (period and impacts)."""

    colour: str
    marker: str


@styled
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw attractors over a parameter: largest gap, share of starts and number; return the
    figure.
    """
    figure, axes = make_panels(3, 1, (9.6, 7.2), sharex=True, height_ratios=(3, 2, 1))
    top, middle, bottom = axes
    set_title(figure, title or title_from_attributes(data))
    data = data.sortby(varied_dimension(data.number))
    x, name = axis_values(data, varied_dimension(data.number))
    shown, label = displayed_gaps(data, data.xi_rel_max)
    kinds, words = styles_by_kind(data)
    used = {word: kinds[word] for word in dict.fromkeys(words.ravel()) if word}
    for index in range(data.sizes["attractor"]):
        part = data.isel(attractor=index)
        exists = words[:, index] != ""
        for panel, values in ((top, shown.isel(attractor=index)), (middle, part.share)):
            draw_attractor(panel, x, values.where(exists).values, words[:, index], kinds)
    for word, (colour, marker) in used.items():
        top.plot([], [], marker, linestyle="-", color=colour, markersize=3.5, label=word)
    top.set(yscale="log", ylabel=f"largest {label}")
    if float(shown.max()) < 10.0 * float(shown.min()):  # no whole decade: plain numbers
        top.yaxis.set_minor_formatter("{x:g}")
    middle.set(ylabel="share of random starts", ylim=(-0.04, 1.04))
    middle.yaxis.set_major_formatter(PercentFormatter(1.0))
    style = "-k" if len(x) > MAX_DISTINCT // 4 else "-k."
    bottom.step(x, data.number, style, where="mid", markersize=3, linewidth=1.0)
    bottom.set(ylabel="attractors", xlabel=name, ylim=(0, float(data.number.max()) + 0.5))
    bottom.yaxis.set_major_locator(MaxNLocator(integer=True))
    if len(x) > 1 and x.min() > 0.0 and x.max() > MIN_LOG_RATIO * x.min():
        use_log_scale(bottom)
    legend_below(figure, [top], columns=5)
    return figure


def styles_by_kind(data: xr.Dataset) -> tuple[dict[str, AttractorStyle], np.ndarray]:
    """Return a dict of styles by kind, most frequent first, and each attractor's kind."""
    n, rate = data.multiplicity.values, data.impacts_per_period.values
    words = np.full(n.shape, "", dtype=object)
    for index in zip(*np.nonzero(np.isfinite(n)), strict=True):
        words[index] = orbit_label(n[index], rate[index]) or IRREGULAR
    counts = Counter(word for word in words.ravel() if word and word != IRREGULAR)
    frequent = [word for word, _ in counts.most_common(len(COLOURS))]
    rare = np.isin(words, [*frequent, IRREGULAR, ""], invert=True)
    words[rare] = OTHER
    kinds = {
        word: AttractorStyle(colour, "o") for word, colour in zip(frequent, COLOURS, strict=False)
    }
    kinds |= {OTHER: AttractorStyle(GREY, "o"), IRREGULAR: AttractorStyle(RED, "D")}
    return kinds, words.astype(str)


def draw_attractor(
    panel: Axes,
    x: np.ndarray,
    values: np.ndarray,
    words: np.ndarray,
    kinds: dict[str, AttractorStyle],
) -> None:
    """Draw one attractor's values over the parameter, coloured by its kind at each value."""
    panel.plot(x, values, "-", color="#c8c8c8", linewidth=0.8, zorder=1.5)
    for word in dict.fromkeys(words[words != ""]):
        of_kind = np.where(words == word, values, np.nan)
        panel.plot(x, of_kind, "-", color=kinds[word].colour, linewidth=1.4)
        marked = (
            of_kind if len(x) <= MAX_MARKED else np.where(is_isolated(of_kind), of_kind, np.nan)
        )
        style: Any = {"color": kinds[word].colour, "markersize": 3.5, "markeredgewidth": 0.0}
        panel.plot(x, marked, kinds[word].marker, **style)


def is_isolated(values: np.ndarray) -> np.ndarray:
    """Return a Boolean array: values without a neighbour to which a line could be drawn."""
    exists = np.concatenate([[False], np.isfinite(values), [False]])
    result: np.ndarray = exists[1:-1] & ~exists[:-2] & ~exists[2:]
    return result


def use_log_scale(axes: Axes) -> None:
    """Set a logarithmic x axis with plain numbers."""
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
