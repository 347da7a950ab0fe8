"""Draw the ElectrodynamicShaker's documentation: the scheme and its reference run."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from orchestrate.show.style import make_panels, styled

from .oscillator import draw_damper, draw_spring, hide_frame, make_sketch

TEXTS = (
    *((1.5, 3.35, "$k$"), (1.5, 0.3, "$c$"), (4.0, 1.9, "$M$"), (6.1, 4.1, "$Bl$")),
    *((9.0, 3.9, "$R, L$"), (10.75, 1.9, "$u$"), (4.0, 4.75, "$F,\\;y$"), (7.9, 3.6, "$i$")),
)


@styled
def draw_shaker(width: float = 4.2) -> Figure:
    figure, axes = make_sketch(width)
    axes.plot([0, 0], [0, 4], "k", lw=2.5)
    draw_spring(axes, 0.0, 2.9, 3.0)
    draw_damper(axes, 0.0, 1.1, 3.0)
    axes.add_patch(Rectangle((3.0, 0.2), 2.0, 3.6, facecolor="0.92", edgecolor="k", lw=1.6))
    for low in (0.2, 3.1):  # the magnet's poles, with the coil between them
        axes.add_patch(Rectangle((5.4, low), 1.6, 0.7, facecolor="0.7", edgecolor="k", lw=1.6))
    axes.plot([5.0, 6.8], [1.6, 1.6], "k", lw=1.4)
    axes.plot([5.0, 6.8], [2.4, 2.4], "k", lw=1.4)
    for x in np.arange(5.6, 6.9, 0.3):
        axes.plot([x, x + 0.1], [1.6, 2.4], color="#b5651d", lw=1.8)
    axes.plot([6.8, 7.6, 7.6, 10.2, 10.2], [2.4, 2.4, 3.2, 3.2, 2.5], "k", lw=1.2)
    axes.plot([6.8, 7.6, 7.6, 10.2, 10.2], [1.6, 1.6, 0.8, 0.8, 1.3], "k", lw=1.2)
    axes.add_patch(Rectangle((8.4, 3.0), 1.2, 0.4, facecolor="w", edgecolor="k", lw=1.4, zorder=3))
    axes.add_patch(Rectangle((9.85, 1.3), 0.7, 1.2, fill=False, lw=1.4))
    for x, y, text in TEXTS:
        axes.text(x, y, text, ha="center", va="center", fontsize=12)
    axes.annotate("", (5.0, 4.4), (3.0, 4.4), arrowprops={"arrowstyle": "->"})
    hide_frame(axes, (-0.3, 11.4), (-0.1, 5.2))
    return figure


@styled
def draw_limited_run(values: dict[str, np.ndarray]) -> Figure:
    """Draw voltage, current and position over time, shaded where a limit acts."""
    figure, panels = make_panels(3, 1, (9, 6), sharex=True)
    electric = ("voltage", "$u$ in V", 1.0), ("current", "$i$ in A", 1.0)
    rows, times = (*electric, ("box_position", "$y$ in mm", 1e3)), values["time"]
    for axes, (name, label, scale) in zip(panels, rows, strict=True):
        axes.plot(times, scale * values[name], "k", lw=0.9)
        low, high = axes.get_ylim()
        axes.fill_between(times, low, high, where=values["limited"] > 0.0, color="0.88", lw=0)
        axes.set_ylim(low, high)
        axes.set_ylabel(label)
    panels[-1].set_xlabel("$t$ in s")
    return figure
