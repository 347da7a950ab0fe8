"""Draw branches of periodic orbits along a parameter."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from .branch_lines import draw_bifurcations, draw_branch
from .labels import EXCITATION, title_from_attributes
from .orbit_diagram import set_gap_scale
from .scales import parameter_scale
from .style import XI_REL, legend_below, make_panels, styled


@styled
def draw(*branches: xr.Dataset, title: str = "") -> Figure:
    """Draw branches of periodic orbits over their parameter; return the figure.

    Parameters
    ----------
    *branches : xarray.Dataset
        Of :func:`orchestrate.branch`, all along the same parameter.
    title : str
    """
    figure, (plane,) = make_panels(1, 1, (9.6, 5.8))
    name = str(branches[0].attrs["over"])
    set_gap_scale(plane, np.concatenate([branch.xi_rel.values.ravel() for branch in branches]))
    unit, label = parameter_scale(branches[0], name)
    low = min(float(branch[name].min()) for branch in branches) / unit
    high = max(float(branch[name].max()) for branch in branches) / unit
    edge = 0.01 * (high - low)  # room for markers at the ends
    plane.set(xlabel=label, ylabel=rf"{XI_REL}$(nT)$", xlim=(low - edge, high + edge))
    plane.set_title(title or title_from_attributes(branches[0], EXCITATION))
    for branch in branches:
        rows = branch.xi_rel.transpose("sample", "point").values
        draw_branch(plane, branch[name].values / unit, rows, branch.stable.values == 1)
        if branch.sizes.get("bifurcation"):
            at = branch.bifurcation_value.values / unit
            draw_bifurcations(plane, branch, at, branch.bifurcation_xi_rel.values)
    legend_below(figure, [plane], columns=8)
    return figure
