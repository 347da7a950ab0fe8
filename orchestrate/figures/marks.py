"""Marks for few values and for many: large enough to be seen, and no more of them than pixels."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

FEW = 600  # values along an axis that marks are told apart at
CELLS = (1500, 750)  # of a panel, for samples that lie on each other
SHADES = ((1, 0.35), (3, 0.6), (8, 1.0))  # from so many samples in a cell on: opacity


class Marks(NamedTuple):
    """How values are marked.

    Attributes
    ----------
    colour : str
    size : float
        Over the usual size.
    filled : bool
    """

    colour: str
    size: float = 1.0
    filled: bool = True


def mark(count: int, marks: Marks) -> dict[str, Any]:
    """Settings of a line of marks for so many values side by side."""
    style = {"linestyle": "none", "color": marks.colour}
    if count > FEW and marks.size <= 1.0:
        return {**style, "marker": ","}
    if count > FEW:
        return {**style, "marker": "s", "markersize": marks.size, "markeredgewidth": 0.0}
    size = float(np.clip(400.0 / count, 1.6, 5.0)) * marks.size
    if marks.filled:
        return {**style, "marker": "o", "markersize": size, "markeredgewidth": 0.0}
    return {**style, "marker": "o", "markersize": size, "markerfacecolor": "none"}


def cells(axes: Axes, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """One point of each cell of a panel that points fall into, and how many fall there.

    Parameters
    ----------
    axes : Axes
        With its scales and limits.
    x, y : ndarray, shape (n,)

    Returns
    -------
    chosen : ndarray of int
        Indices of points.
    count : ndarray of int
    """
    columns, rows = CELLS
    place = axes.transLimits.transform(axes.transScale.transform(np.column_stack([x, y])))
    column, row = (place * CELLS).astype(np.int64).clip(0, (columns - 1, rows - 1)).T
    cell = column * rows + row
    last = np.full(columns * rows, -1)
    last[cell] = np.arange(len(cell))
    chosen = last[last >= 0]
    return chosen, np.bincount(cell, minlength=columns * rows)[last >= 0]


def draw_samples(
    axes: Axes, x: np.ndarray, samples: np.ndarray, marks: Marks, label: str = ""
) -> None:
    """Samples over their parameter, darker where there are more; the panel has its scales.

    Parameters
    ----------
    axes : Axes
    x : ndarray, shape (n,)
    samples : ndarray, shape (n, m)
    marks : Marks
    label : str
    """
    values, gaps = np.repeat(x, samples.shape[1]), samples.ravel()
    style = {**mark(len(x), marks), "rasterized": True}
    if len(x) <= FEW:
        axes.plot(values, gaps, **style, alpha=0.8, label=label)
        return
    chosen, count = cells(axes, values, gaps)
    ends = [*(least for least, _ in SHADES[1:]), np.inf]
    for (least, opacity), end in zip(SHADES, ends, strict=True):
        some = chosen[(count >= least) & (count < end)]
        axes.plot(values[some], gaps[some], **style, alpha=opacity)
    size: Any = {"marker": "s", "markersize": 5.0, "linestyle": "none", "color": marks.colour}
    axes.plot([], [], **size, label=label)


def draw_steps(
    axes: Axes, x: np.ndarray, values: np.ndarray, colour: str, width: float = 1.0, **more: Any
) -> None:
    """A quantity that is constant in pieces, with its values marked where they are few."""
    order = np.argsort(x, kind="stable")
    axes.plot(x[order], values[order], color=colour, linewidth=width, drawstyle="steps-mid", **more)
    if len(x) <= FEW:
        more = {**more, "label": None}
        axes.plot(x, values, **mark(len(x), Marks(colour, 0.7)), **more)
