"""Marks for few values and for many, large enough to be seen; lines of spectra as stems."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis

MAX_DISTINCT = 600  # values along an axis that marks are told apart at
CELLS = (1500, 750)  # of a panel, for samples that lie on each other
MAX_STEMS = 80  # of a spectrum, in full width
SHADES = ((1, 0.35), (3, 0.6), (8, 1.0))  # from so many samples in a cell on: opacity


class Marks(NamedTuple):
    """Style in which values are marked.

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
    """Return the line and marker style for ``count`` values side by side."""
    style = {"linestyle": "none", "color": marks.colour}
    if count > MAX_DISTINCT and marks.size <= 1.0:
        return {**style, "marker": ","}
    if count > MAX_DISTINCT:
        return {**style, "marker": "s", "markersize": marks.size, "markeredgewidth": 0.0}
    size = float(np.clip(400.0 / count, 1.6, 5.0)) * marks.size
    if marks.filled:
        return {**style, "marker": "o", "markersize": size, "markeredgewidth": 0.0}
    return {**style, "marker": "o", "markersize": size, "markerfacecolor": "none"}


def one_per_cell(axes: Axes, x: np.ndarray, samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return one sample of each cell of a panel that has any, and the number of samples in it.

    Parameters
    ----------
    axes : Axes
        With its scales and limits.
    x : ndarray, shape (n,)
    samples : ndarray, shape (n, m)

    Returns
    -------
    chosen : ndarray of int
        Indices of the samples as a flat list.
    count : ndarray of int
    """
    columns, rows = CELLS
    column = cell_index(axes.xaxis, x, columns)
    row = cell_index(axes.yaxis, samples, rows)
    cell = (column[:, None] * rows + row).ravel()
    last = np.full(columns * rows, -1)
    last[cell] = np.arange(len(cell))
    chosen = last[last >= 0]
    return chosen, np.bincount(cell, minlength=columns * rows)[last >= 0]


def cell_index(axis: Axis, values: np.ndarray, count: int) -> np.ndarray:
    """Return which of ``count`` equal parts of an axis each value falls into."""
    change = axis.get_transform().transform
    first, last = change(axis.get_view_interval())
    position = (change(values.ravel()) - first) * (count / (last - first))
    return position.clip(0.0, count - 1.0).astype(np.intp).reshape(values.shape)


def draw_samples(
    axes: Axes, x: np.ndarray, samples: np.ndarray, marks: Marks, label: str = ""
) -> None:
    """Draw samples over their parameter, darker where there are more; scales are set before.

    Parameters
    ----------
    axes : Axes
    x : ndarray, shape (n,)
    samples : ndarray, shape (n, m)
    marks : Marks
    label : str
    """
    gaps, each = samples.ravel(), samples.shape[1]
    style = {**mark(len(x), marks), "rasterized": True}
    if len(x) <= MAX_DISTINCT:
        axes.plot(np.repeat(x, each), gaps, **style, alpha=0.8, label=label)
        return
    chosen, count = one_per_cell(axes, x, samples)
    ends = [*(minimum for minimum, _ in SHADES[1:]), np.inf]
    for (minimum, opacity), end in zip(SHADES, ends, strict=True):
        of_shade = chosen[(count >= minimum) & (count < end)]
        axes.plot(x[of_shade // each], gaps[of_shade], **style, alpha=opacity)
    size: Any = {"marker": "s", "markersize": 5.0, "linestyle": "none", "color": marks.colour}
    axes.plot([], [], **size, label=label)


def draw_steps(
    axes: Axes, x: np.ndarray, values: np.ndarray, colour: str, width: float = 1.0, **more: Any
) -> None:
    """Draw a quantity that is constant in pieces, with its values marked where they are few."""
    order = np.argsort(x, kind="stable")
    axes.plot(x[order], values[order], color=colour, linewidth=width, drawstyle="steps-mid", **more)
    if len(x) <= MAX_DISTINCT:
        more = {**more, "label": None}
        axes.plot(x, values, **mark(len(x), Marks(colour, 0.7)), **more)


def draw_stems(
    axes: Axes,
    x: np.ndarray,
    amplitudes: np.ndarray,
    floor: float,
    width: float = 1.5,
    **style: Any,
) -> None:
    """Draw the lines of a spectrum as stems on a logarithmic axis that begins at a floor.

    Parameters
    ----------
    axes : Axes
    x, amplitudes : ndarray, shape (n,)
    floor : float
        Lines below it are left out.
    width : float
        Of a stem, in points; many stems are thinner, so that they are told apart.
    **style
        Of :meth:`matplotlib.axes.Axes.vlines`.
    """
    axes.set_yscale("log")
    shown = amplitudes > floor
    thin = min(1.0, (MAX_STEMS / (1 + int(shown.sum()))) ** 0.5)
    axes.vlines(x[shown], floor, amplitudes[shown], linewidth=width * thin, **style)
