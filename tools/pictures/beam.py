"""Draw the beam, its two halves, and sensor signals, for README and manual."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from orchestrate.show.colours import BLACK, BLUE, GREY, RED
from orchestrate.show.style import styled

from .oscillator import draw_masses_in_box, hide_frame

LENGTH, THICKNESS = 6.0, 0.5  # of the beam that is drawn
SLIT = (2.2, 5.2)  # where its halves part
VERDICTS: dict[str, Any] = {"no opening seen": BLUE, "delaminated": RED}


def half_outline(opening: float, side: int) -> np.ndarray:
    """Return the outline of the upper (side 1) or lower half (-1) of a beam, bent apart."""
    x = np.linspace(0.0, LENGTH, 200)
    inside = np.clip((x - SLIT[0]) / (SLIT[1] - SLIT[0]), 0.0, 1.0)
    bend = side * opening * np.sin(np.pi * inside) ** 2
    outer, inner = bend + side * THICKNESS, bend
    return np.column_stack([np.concatenate([x, x[::-1]]), np.concatenate([inner, outer[::-1]])])


def draw_beam(axes: Axes, opening: float, colour: str) -> None:
    for side in (1, -1) if opening else ():
        outline = half_outline(opening, side)
        axes.add_patch(Polygon(outline, facecolor="0.85", edgecolor="k", lw=1.0))
    if not opening:
        corner, size = (0.0, -THICKNESS), (LENGTH, 2.0 * THICKNESS)
        axes.add_patch(Rectangle(corner, *size, facecolor="0.85", edgecolor="k", lw=1.0))
    axes.add_patch(Rectangle((-0.9, -1.3), 0.9, 2.6, facecolor="0.6", edgecolor="k", lw=1.0))
    axes.add_patch(Rectangle((3.4, opening + THICKNESS), 0.6, 0.42, facecolor=colour, lw=0))
    axes.text(3.7, opening + THICKNESS + 0.6, "sensor", ha="center", fontsize=8, color=colour)
    axes.annotate("", (-1.35, 0.9), (-1.35, -0.9), arrowprops={"arrowstyle": "<->", "lw": 1.6})
    axes.text(-1.5, 0.0, "shaken", ha="right", va="center", fontsize=8, rotation=90)
    hide_frame(axes, (-2.1, LENGTH + 0.2), (-1.5, 2.0))


@styled
def draw_two_masses() -> Figure:
    figure = Figure(figsize=(9.0, 2.7), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
    draw_beam(left, 0.55, RED)
    left.set_title("a beam, delaminated along its middle", fontsize=9)
    draw_masses_in_box(right, 1.0, 10)
    right.text(5.0, 2.25, "gap", ha="center", fontsize=9, color=RED)
    right.annotate("", (5.5, 2.0), (4.5, 2.0), arrowprops={"arrowstyle": "<->", "color": RED})
    right.annotate("", (6.4, -0.5), (3.6, -0.5), arrowprops={"arrowstyle": "<->", "lw": 1.6})
    right.text(6.7, -0.7, "shaken", fontsize=8)
    hide_frame(right, (-0.3, 10.3), (-1.1, 4.3))
    right.set_title("its halves as two masses: they part and strike", fontsize=9)
    return figure


@styled
def draw_verdicts(
    records: Mapping[str, xr.Dataset], begin: float = 12.0, span: float = 0.15
) -> Figure:
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    planes = figure.subplots(len(records), 3, width_ratios=(1.2, 2.4, 0.9), squeeze=False)
    for (beam, trace, word), (verdict, data) in zip(planes, records.items(), strict=True):
        colour = VERDICTS[verdict]
        draw_beam(beam, 0.55 if verdict == "delaminated" else 0.0, colour)
        part = data.sel(time=slice(begin, begin + span))
        milliseconds = 1e3 * (part.time - begin)
        trace.plot(milliseconds, part.box_acceleration, color=GREY, lw=1.2, label="base")
        trace.plot(milliseconds, part.acceleration1, color=colour, lw=1.5, label="sensor")
        trace.set(ylabel="acceleration in m/s²", xlim=(0.0, 1e3 * span))
        word.axis("off")
        middle: Any = {"ha": "center", "va": "center", "transform": word.transAxes}
        word.text(0.5, 0.62, "verdict:", fontsize=9, color=BLACK, **middle)
        word.text(0.5, 0.42, "\n".join(verdict.rsplit(" ", 1)), fontsize=14, color=colour, **middle)
    planes[-1][1].set_xlabel("time in ms")
    planes[0][1].set_title("what the sensor reads while the base is shaken (grey)")
    return figure
