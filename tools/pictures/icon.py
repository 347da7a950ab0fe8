"""Draw the icons of the FMUs."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

EDGE: dict[str, Any] = {"edgecolor": "#1b3a57", "linewidth": 2.5}


def draw_icon(shaker: bool) -> Figure:
    """Draw a model's icon, recognizable at 64 pixels; return the figure.

    Two masses that touch between springs, or one with a disc and its unbalance on a spring.
    """
    figure = Figure(figsize=(1.0, 1.0))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, 10.0), ylim=(0.0, 10.0))
    axes.axis("off")
    line: Any = {"color": "#1b3a57", "linewidth": 3.0, "solid_joinstyle": "round"}
    zigzag = np.array([0.0, 1.0, -1.0, 1.0, -1.0, 0.0])
    along = np.array([0.0, 0.3, 0.8, 1.3, 1.8, 2.1])
    walls = (0.5,) if shaker else (0.5, 9.5)
    for wall in walls:
        axes.plot((wall, wall), (2.0, 8.0), **line)
        axes.plot(wall + np.copysign(along, 5.0 - wall), 5.0 + zigzag, **line)
    boxes = ((2.6, 6.4, "#d98b3a"),) if shaker else ((2.6, 2.4, "#d98b3a"), (5.0, 2.4, "#5b8db8"))
    for left, width, color in boxes:
        axes.add_patch(Rectangle((left, 2.6), width, 4.8, facecolor=color, **EDGE))
    if shaker:
        axes.add_patch(Circle((5.8, 5.0), 1.7, facecolor="white", **EDGE))
        axes.add_patch(Circle((6.6, 5.8), 0.6, facecolor="#1b3a57", **EDGE))
    return figure
