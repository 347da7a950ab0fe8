"""Draw small pictures with large letters for the cards on the manual's first page."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from orchestrate.show.colours import BLACK, BLUE, RED
from orchestrate.show.style import add_figure_legend, make_panels, styled

SIZE = (3.8, 2.9)
FMU_INPUTS = ("box_\namplitude", "box_\nfrequency", "box_\nacceleration")
FMU_OUTPUTS = ("x1, x2, v1, v2", "x_rel: gap", "contact_force", "box_force")
STYLES: dict[str, dict[str, Any]] = {
    "bonded": {"color": BLUE, "linestyle": "--"},
    "delaminated": {"color": RED, "linestyle": "-"},
}


@styled
def draw_resonance(curves: xr.Dataset) -> Figure:
    figure, (axes,) = make_panels(1, 1, SIZE)
    for name, style in STYLES.items():
        amplitude = curves.x1_max.sel(structure=name, direction="up")
        axes.plot(curves.hertz, 1e3 * amplitude, linewidth=1.8, label=name, **style)
    axes.set(xlabel="frequency in Hz", ylabel="amplitude in mm")
    add_figure_legend(figure, [axes])
    return figure


@styled
def draw_orbit_diagram(diagram: xr.Dataset) -> Figure:
    figure, (axes,) = make_panels(1, 1, SIZE)
    eta = np.repeat(diagram.eta.values, diagram.sizes["sample"])
    dots: Any = {"color": BLACK, "markersize": 1.2, "alpha": 0.35, "markeredgewidth": 0.0}
    axes.plot(eta, diagram.xi_rel.values.ravel(), ".", **dots)
    axes.set(xlabel="frequency ratio", ylabel="gap, once a period", yscale="log", ylim=(1e-3, 30))
    return figure


@styled
def draw_block() -> Figure:
    figure = Figure(figsize=SIZE, layout="constrained")
    axes = figure.subplots()
    style: Any = {"boxstyle": "round,pad=0.1", "facecolor": "0.93", "edgecolor": "k", "lw": 1.6}
    axes.add_patch(FancyBboxPatch((3.2, 0.4), 4.0, 3.6, **style))
    middle: Any = {"ha": "center", "va": "center"}
    axes.text(5.2, 3.1, "TwoMass-\nImpact-\nOscillator", fontsize=10, weight="bold", **middle)
    axes.text(5.2, 1.1, "exact impacts,\nwhatever\nthe step", fontsize=8, color=RED, **middle)
    arrow: Any = {"arrowstyle": "->", "lw": 1.4, "color": BLUE}
    for i, name in enumerate(FMU_INPUTS):
        y = 3.4 - 1.2 * i
        axes.annotate("", (3.1, y), (2.3, y), arrowprops=arrow)
        axes.text(2.2, y, name, ha="right", va="center", fontsize=8)
    for i, name in enumerate(FMU_OUTPUTS):
        y = 3.7 - 0.8 * i
        axes.annotate("", (8.1, y), (7.3, y), arrowprops=arrow)
        axes.text(8.2, y, name, va="center", fontsize=8)
    axes.annotate("", (8.1, 0.5), (7.3, 0.5), arrowprops={**arrow, "color": RED, "ls": "--"})
    axes.text(8.2, 0.5, "impact (clock)", va="center", fontsize=8, color=RED)
    axes.set(xlim=(-1.1, 11.9), ylim=(0.0, 4.4))
    axes.axis("off")
    return figure
