"""The one look of all pictures, in force while one is drawn and no longer."""

from __future__ import annotations

import functools
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any, ParamSpec

import matplotlib.style
from matplotlib.axes import Axes
from matplotlib.figure import Figure

LOOK: dict[str, Any] = {
    "axes.grid": True,
    "grid.alpha": 0.25,
    "axes.titlelocation": "left",
    "axes.titlesize": 9,
    "axes.labelsize": 10,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "savefig.dpi": 130,
    "svg.fonttype": "none",
    "svg.hashsalt": "vibroimpact",  # the same picture is the same bytes
}
BLACK, BLUE, RED, GREY = "black", "tab:blue", "tab:red", "0.55"
XI_REL, XI_REL_RATE = r"$\xi_{\mathrm{Rel}}$", r"$\xi'_{\mathrm{Rel}}$"

Arguments = ParamSpec("Arguments")


def look() -> AbstractContextManager[None]:
    """Our settings on top of matplotlib's own, whatever the user's are, inside a ``with``."""
    return matplotlib.style.context(LOOK, after_reset=True)


def in_our_look(draw: Callable[Arguments, Figure]) -> Callable[Arguments, Figure]:
    """A drawing function that draws in our look."""

    @functools.wraps(draw)
    def drawn(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Figure:
        with look():
            return draw(*args, **kwargs)

    return drawn


def panels(
    rows: int, columns: int, size: tuple[float, float], **more: Any
) -> tuple[Figure, list[Axes]]:
    """A figure with its axes as a flat list, row by row.

    Parameters
    ----------
    rows, columns : int
    size : tuple of float
        Width and height in inches.
    **more
        Of :meth:`matplotlib.figure.Figure.subplots`.
    """
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **more)
    return figure, list(axes.ravel())
