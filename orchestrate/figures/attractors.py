"""Coexisting attractors over a parameter: continued, matched, and how many starts lead to each."""

from __future__ import annotations

from collections import Counter
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, PercentFormatter

from .labels import about, orbit_label
from .marks import FEW
from .scales import along, gaps, parameter_of
from .style import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    YELLOW,
    entitle,
    in_our_look,
    legend_below,
    panels,
)

WIDE = 4.0  # a parameter that grows by more is shown in equal ratios
COLOURS = (BLUE, ORANGE, GREEN, PURPLE, SKY, YELLOW)  # of the most frequent kinds of orbits
IRREGULAR, OTHER = "irregular", "other periodic"
MARKED = 60  # values up to which each has a mark; of more, those alone have one


class Kind(NamedTuple):
    """How attractors of one kind are drawn."""

    colour: str
    marker: str


@in_our_look
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Attractors by their largest gap, the share of starts that lead to each, and their number.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.attractors`.
    title : str
        By default the structure.
    """
    figure, axes = panels(3, 1, (9.6, 7.2), sharex=True, height_ratios=(3, 2, 1))
    top, middle, bottom = axes
    entitle(figure, title or about(data))
    data = data.sortby(parameter_of(data.number))
    x, name = along(data, parameter_of(data.number))
    shown, label = gaps(data, data.xi_rel_max)
    kinds, words = kinds_of(data)
    used = {word: kinds[word] for word in dict.fromkeys(words.ravel()) if word}
    for index in range(data.sizes["attractor"]):
        part = data.isel(attractor=index)
        there = words[:, index] != ""
        for panel, values in ((top, shown.isel(attractor=index)), (middle, part.share)):
            draw_attractor(panel, x, values.where(there).values, words[:, index], kinds)
    for word, (colour, marker) in used.items():
        top.plot([], [], marker, linestyle="-", color=colour, markersize=3.5, label=word)
    top.set(yscale="log", ylabel=f"largest {label}")
    if float(shown.max()) < 10.0 * float(shown.min()):  # no whole decade: plain numbers
        top.yaxis.set_minor_formatter("{x:g}")
    middle.set(ylabel="share of random starts", ylim=(-0.04, 1.04))
    middle.yaxis.set_major_formatter(PercentFormatter(1.0))
    style = "-k" if len(x) > FEW // 4 else "-k."
    bottom.step(x, data.number, style, where="mid", markersize=3, linewidth=1.0)
    bottom.set(ylabel="attractors", xlabel=name, ylim=(0, float(data.number.max()) + 0.5))
    bottom.yaxis.set_major_locator(MaxNLocator(integer=True))
    if len(x) > 1 and x.min() > 0.0 and x.max() > WIDE * x.min():
        in_ratios(bottom)
    legend_below(figure, [top], columns=5)
    return figure


def kinds_of(data: xr.Dataset) -> tuple[dict[str, Kind], np.ndarray]:
    """Kinds of attractors with their styles, the most frequent first, and each one's kind; an
    empty string where an attractor does not exist.
    """
    n, rate = data.multiplicity.values, data.impacts_per_period.values
    words = np.full(n.shape, "", dtype=object)
    for place in zip(*np.nonzero(np.isfinite(n)), strict=True):
        words[place] = orbit_label(n[place], rate[place]) or IRREGULAR
    counts = Counter(word for word in words.ravel() if word and word != IRREGULAR)
    frequent = [word for word, _ in counts.most_common(len(COLOURS))]
    rare = np.isin(words, [*frequent, IRREGULAR, ""], invert=True)
    words[rare] = OTHER
    kinds = {word: Kind(colour, "o") for word, colour in zip(frequent, COLOURS, strict=False)}
    kinds |= {OTHER: Kind(GREY, "o"), IRREGULAR: Kind(RED, "D")}
    return kinds, words.astype(str)


def draw_attractor(
    panel: Axes, x: np.ndarray, values: np.ndarray, words: np.ndarray, kinds: dict[str, Kind]
) -> None:
    """One attractor along the parameter, in the colours of what it is."""
    panel.plot(x, values, "-", color="#c8c8c8", linewidth=0.8, zorder=1.5)
    for word in dict.fromkeys(words[words != ""]):
        here = np.where(words == word, values, np.nan)
        panel.plot(x, here, "-", color=kinds[word].colour, linewidth=1.4)
        marked = here if len(x) <= MARKED else np.where(alone(here), here, np.nan)
        style: Any = {"color": kinds[word].colour, "markersize": 3.5, "markeredgewidth": 0.0}
        panel.plot(x, marked, kinds[word].marker, **style)


def alone(values: np.ndarray) -> np.ndarray:
    """Which values have no neighbour to draw a line to."""
    there = np.concatenate([[False], np.isfinite(values), [False]])
    found: np.ndarray = there[1:-1] & ~there[:-2] & ~there[2:]
    return found


def in_ratios(axes: Axes) -> None:
    """A logarithmic parameter with plain numbers."""
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
