"""Draw samples, steps and spectral lines so that few and many values are visible."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis

MAX_DISTINCT = 600  # values along an axis that marks are told apart at
CELLS = (1500, 750)  # of a panel, for samples that lie on each other
MAX_STEMS = 80  # of a spectrum, in full width
SHADES = ((1, 0.35), (3, 0.6), (8, 1.0))  # from so many samples in a cell on: opacity


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


def one_per_cell(axes: Axes, x: np.ndarray, samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return one sample's index per occupied cell of a panel, and the samples in each cell."""
    columns, rows = CELLS
    column = cell_index(axes.xaxis, x, columns)
    row = cell_index(axes.yaxis, samples, rows)
    cell = (column[:, None] * rows + row).ravel()
    last = np.full(columns * rows, -1)
    last[cell] = np.arange(len(cell))
    chosen = last[last >= 0]
    return chosen, np.bincount(cell, minlength=columns * rows)[last >= 0]


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
    """Draw a piecewise constant quantity as steps, with marks where values are few."""
    order = np.argsort(x, kind="stable")
    axes.plot(x[order], values[order], color=colour, linewidth=width, drawstyle="steps-mid", **more)
    if len(x) <= MAX_DISTINCT:
        more = {**more, "label": None}
        axes.plot(x, values, **marker_keywords(len(x), MarkStyle(colour, 0.7)), **more)


def draw_stems(
    axes: Axes,
    x: np.ndarray,
    amplitudes: np.ndarray,
    floor: float,
    width: float = 1.5,
    **style: Any,
) -> None:
    """Draw a spectrum's lines as stems on a logarithmic axis that begins at a floor."""
    axes.set_yscale("log")
    shown = amplitudes > floor
    thin = min(1.0, (MAX_STEMS / (1 + int(shown.sum()))) ** 0.5)
    axes.vlines(x[shown], floor, amplitudes[shown], linewidth=width * thin, **style)
