"""Draw the oscillator's documentation: the two masses (Figure 4) and an example run."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from orchestrate.show.style import make_panels, styled


def make_sketch(width: float) -> tuple[Figure, Axes]:
    """Make a figure for a drawing, half as high as wide; return it and its axes."""
    figure = Figure(figsize=(width, width * 0.5))
    return figure, figure.add_subplot()


def hide_frame(axes: Axes, xlim: tuple[float, float], ylim: tuple[float, float]) -> None:
    axes.set(xlim=xlim, ylim=ylim)
    axes.set_aspect("equal")
    axes.axis("off")


def draw_spring(axes: Axes, x: float, y: float, length: float) -> None:
    n = 9
    zigzag = [x + length * (0.15 + 0.7 * (i + 0.5) / n) for i in range(n)]
    xs = [x, x + 0.15 * length, *zigzag, x + 0.85 * length, x + length]
    ys = [y, y, *(y + (0.16 if i % 2 else -0.16) for i in range(n)), y, y]
    axes.plot(xs, ys, "k", lw=1.4)


def draw_damper(axes: Axes, x: float, y: float, length: float) -> None:
    middle = x + 0.5 * length
    left, right = middle - 0.18, middle + 0.18
    axes.plot([x, left], [y, y], "k", lw=1.4)
    axes.plot([right, left, left, right], [y + 0.16, y + 0.16, y - 0.16, y - 0.16], "k", lw=1.4)
    axes.plot([middle + 0.05, middle + 0.05], [y - 0.11, y + 0.11], "k", lw=1.4)
    axes.plot([middle + 0.05, x + length], [y, y], "k", lw=1.4)


def draw_masses_in_box(axes: Axes, gap: float, font_size: float) -> None:
    axes.add_patch(Rectangle((0, 0), 10, 4, fill=False, lw=2.0))
    left, right = 3.4 - 0.5 * gap, 5.0 + 0.5 * gap
    for side, x, begin in (("1", left, 0.0), ("2", right, right + 1.6)):
        axes.add_patch(Rectangle((x, 1.1), 1.6, 1.8, facecolor="0.85", edgecolor="k", lw=1.4))
        axes.text(x + 0.8, 2.0, f"$m_{side}$", ha="center", va="center", fontsize=font_size + 1)
        draw_spring(axes, begin, 2.5, left)
        draw_damper(axes, begin, 1.5, left)
        axes.text(begin + 0.5 * left, 2.95, f"$k_{side}$", ha="center", fontsize=font_size)
        axes.text(begin + 0.5 * left, 0.72, f"$d_{side}$", ha="center", fontsize=font_size)


@styled
def draw_scheme(width: float = 4.8) -> Figure:
    figure, axes = make_sketch(width)
    draw_masses_in_box(axes, 0.0, 12)
    for x, name in ((3.5, "$x_1$"), (5.1, "$x_2$")):
        axes.annotate("", (x + 1.4, 3.35), (x, 3.35), arrowprops={"arrowstyle": "->"})
        axes.text(x + 0.7, 3.45, name, ha="center", fontsize=11)
    axes.annotate("", (6.2, -0.55), (3.8, -0.55), arrowprops={"arrowstyle": "<->", "lw": 1.6})
    axes.text(5.0, -1.15, r"$a\,\sin\,\Omega t$", ha="center", fontsize=12)
    hide_frame(axes, (-0.2, 10.2), (-1.3, 4.2))
    return figure


@styled
def draw_example(values: Mapping[str, np.ndarray]) -> Figure:
    figure, (top, bottom) = make_panels(2, 1, (9, 5), sharex=True)
    times = values["time"]
    top.plot(times, values["x1"], label=r"$\xi_1$")
    top.plot(times, values["x2"], label=r"$\xi_2$", ls="--")
    bottom.plot(times, values["x_rel"], "k", label=r"$\xi_{Rel}$")
    for axes in (top, bottom):
        low, high = axes.get_ylim()
        touching = values["in_contact"] > 0
        axes.fill_between(times, low, high, where=touching, color="0.88", lw=0)
        axes.set_ylim(low, high)
        axes.legend(loc="upper right")
    bottom.set_xlabel(r"$\tau$")
    return figure
