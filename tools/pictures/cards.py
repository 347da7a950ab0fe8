"""Draw small pictures with large letters for the cards on the manual's first page."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from orchestrate.show.colours import BLACK, BLUE, RED
from orchestrate.show.style import add_figure_legend, make_panels, styled

SIZE = (3.8, 2.9)
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
