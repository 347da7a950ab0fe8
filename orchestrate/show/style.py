"""Matplotlib style, panels, titles and legends that all pictures share.

``STYLE`` is the one place of what pictures have in common, as settings of Matplotlib: change an
entry of it and all pictures follow, those of commands and reports too.

>>> from orchestrate.show.style import STYLE
>>> STYLE["savefig.dpi"] = 300  # for print
>>> STYLE["savefig.dpi"] = 150

Colours are those of Okabe and Ito, which people tell apart however they see them. Wherever two
things are compared, they differ in line style or width too, so that a picture printed in grey is
read as well. What is unstable is dashed or dotted, and the legend says so. Letters are
Matplotlib's own: nothing needs LaTeX.
"""

from __future__ import annotations

import functools
import textwrap
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from typing import Any, ParamSpec

import matplotlib.style
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from .colours import GREY, PALETTE

STYLE: dict[str, Any] = {
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.alpha": 0.25,
    "axes.prop_cycle": cycler(color=PALETTE),
    "axes.titlelocation": "left",
    "axes.titlesize": 9,
    "axes.labelsize": 10,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "legend.title_fontsize": 8,
    "figure.titlesize": 10,
    "savefig.dpi": 150,
    "svg.fonttype": "none",
    "svg.hashsalt": "vibroimpact",  # the same picture is the same bytes
}
XI_REL, XI_REL_RATE = r"$\xi_{\mathrm{Rel}}$", r"$\xi'_{\mathrm{Rel}}$"
NO_BREAK_SPACE = "\xa0"  # a space that no line breaks at

Arguments = ParamSpec("Arguments")


def style_context() -> AbstractContextManager[None]:
    """Return a context manager that applies our Matplotlib settings in place of the user's."""
    return matplotlib.style.context(STYLE, after_reset=True)


def styled(draw: Callable[Arguments, Figure]) -> Callable[Arguments, Figure]:
    """Decorate a drawing function so that our Matplotlib settings hold while it draws."""

    @functools.wraps(draw)
    def draw_in_style(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Figure:
        with style_context():
            return draw(*args, **kwargs)

    return draw_in_style


def make_panels(
    rows: int, columns: int, size: tuple[float, float], title: str = "", **more: Any
) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **more)
    set_title(figure, title)
    return figure, list(axes.ravel())


def set_title(figure: Figure, title: str) -> None:
    if title:
        letters = int(14 * figure.get_figwidth())
        parts = title.replace(" ", NO_BREAK_SPACE).replace(f",{NO_BREAK_SPACE}", ", ")
        lines = textwrap.fill(parts, letters, break_long_words=False)
        figure.suptitle(lines.replace(NO_BREAK_SPACE, " "), x=0.01, ha="left")


def draw_line(
    axes: Axes, x: Any, y: Any, line: str, colour: str, width: float, label: str | None = None
) -> None:
    axes.plot(x, y, line, color=colour, linewidth=width, label=label)


def add_figure_legend(figure: Figure, axes: Iterable[Axes], columns: int = 4, **more: Any) -> None:
    words: dict[str, Any] = {}
    for plane in axes:
        handles, labels = plane.get_legend_handles_labels()
        words = {**dict(zip(labels, handles, strict=True)), **words}
    if words:
        position: Any = {"loc": "outside lower right", "ncols": min(columns, len(words))}
        figure.legend(list(words.values()), list(words), **position, **more)


def add_legend_below(axes: Axes) -> None:
    if axes.get_legend_handles_labels()[0]:
        below: Any = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.16), "frameon": False}
        axes.legend(ncols=3, **below)


def add_legend_above(axes: Axes, columns: int = 1) -> None:
    corner: Any = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.2}
    axes.legend(ncols=columns, **corner)


def write_in_empty_panel(axes: Axes, words: str) -> None:
    axes.set_yticks([])
    middle: Any = {"transform": axes.transAxes, "ha": "center", "va": "center"}
    axes.text(0.5, 0.5, words, color=GREY, fontsize=11, **middle)


def set_plain_log_scale(axes: Axes) -> None:
    """Make the y axis logarithmic with plain numbers such as 0.02, few enough to read."""
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 300.0 * low else (1.0,)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
