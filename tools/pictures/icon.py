"""Draw the icons of the FMUs."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

EDGE: dict[str, Any] = {"edgecolor": "#1b3a57", "linewidth": 2.5}


LINE: dict[str, Any] = {"color": "#1b3a57", "linewidth": 3.0, "solid_joinstyle": "round"}
ORANGE, BLUE = "#d98b3a", "#5b8db8"


def draw_oscillator_icon() -> Figure:
    figure, axes = make_icon_with_springs((0.5, 9.5))
    for left, color in ((2.6, ORANGE), (5.0, BLUE)):
        axes.add_patch(Rectangle((left, 2.6), 2.4, 4.8, facecolor=color, **EDGE))
    return figure


def draw_motor_icon() -> Figure:
    figure, axes = make_icon_with_springs((0.5,))
    axes.add_patch(Rectangle((2.6, 2.6), 6.4, 4.8, facecolor=ORANGE, **EDGE))
    axes.add_patch(Circle((5.8, 5.0), 1.7, facecolor="white", **EDGE))
    axes.add_patch(Circle((6.6, 5.8), 0.6, facecolor="#1b3a57", **EDGE))
    return figure


def draw_coil_icon() -> Figure:
    figure, axes = make_icon_with_springs((0.5,))
    axes.add_patch(Rectangle((2.6, 2.6), 2.4, 4.8, facecolor=ORANGE, **EDGE))
    for low in (1.4, 7.0):
        axes.add_patch(Rectangle((6.0, low), 3.2, 1.6, facecolor=BLUE, **EDGE))
    for x in (5.6, 6.7, 7.8):
        axes.plot((x, x + 0.7), (3.8, 6.2), **LINE)
    return figure


def make_icon_with_springs(walls: tuple[float, ...]) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(1.0, 1.0))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, 10.0), ylim=(0.0, 10.0))
    axes.axis("off")
    zigzag = np.array([0.0, 1.0, -1.0, 1.0, -1.0, 0.0])
    along = np.array([0.0, 0.3, 0.8, 1.3, 1.8, 2.1])
    for wall in walls:
        axes.plot((wall, wall), (2.0, 8.0), **LINE)
        axes.plot(wall + np.copysign(along, 5.0 - wall), 5.0 + zigzag, **LINE)
    return figure, axes
