"""Draw the MotorShaker's documentation: the mechanical scheme and its reference run."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from orchestrate.show.style import make_panels, styled

from .oscillator import draw_damper, draw_spring, hide_frame, make_sketch

TEXTS = (
    *((1.5, 3.35, "$k_b$"), (1.5, 0.3, "$c_b$"), (3.5, 0.55, "$M_t$")),
    *((5.35, 2.6, r"$\varphi$"), (6.65, 3.15, "$m_u$"), (8.6, 2.35, "$F$"), (5.2, 4.55, "$y$")),
)


@styled
def draw_shaker(width: float = 4.2) -> Figure:
    figure, axes = make_sketch(width)
    axes.plot([0, 0], [0, 4], "k", lw=2.5)
    draw_spring(axes, 0.0, 2.9, 3.0)
    draw_damper(axes, 0.0, 1.1, 3.0)
    axes.add_patch(Rectangle((3.0, 0.2), 4.6, 3.6, fill=False, lw=2.5))
    axes.add_patch(Circle((5.3, 2.0), 1.2, facecolor="0.92", edgecolor="k", lw=1.6))
    axes.plot([5.3, 6.1], [2.0, 2.75], "k", lw=1.6)
    axes.add_patch(Circle((6.1, 2.75), 0.22, color="k"))
    for x, y, text in TEXTS:
        axes.text(x, y, text, ha="center", fontsize=12)
    axes.annotate("", (9.4, 2.0), (7.6, 2.0), arrowprops={"arrowstyle": "->", "lw": 1.6})
    axes.annotate("", (6.2, 4.4), (4.2, 4.4), arrowprops={"arrowstyle": "->"})
    hide_frame(axes, (-0.3, 9.8), (-0.1, 5.2))
    return figure


@styled
def draw_run_up(times: np.ndarray, speed: np.ndarray, position: np.ndarray) -> Figure:
    figure, (top, bottom) = make_panels(2, 1, (9, 5), sharex=True)
    top.plot(times, speed, "k", lw=1.0)
    top.set_ylabel(r"$\dot\varphi$ in rad/s")
    bottom.plot(times, 1e3 * position, "k", lw=0.6)
    bottom.set_ylabel("$y$ in mm")
    bottom.set_xlabel("$t$ in s")
    return figure
