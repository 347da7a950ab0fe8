"""Draw branches of periodic orbits along a parameter."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from .branch_lines import draw_bifurcations, draw_branch
from .held_excitation import branch_title
from .orbit_diagram import set_gap_scale
from .scales import gap_scale, parameter_scale
from .style import XI_REL, legend_below, make_panels, set_title, styled


@styled
def draw(*branches: xr.Dataset, title: str = "") -> Figure:
    """Draw branches of periodic orbits over their parameter; return the figure."""
    figure, (plane,) = make_panels(1, 1, (9.6, 5.8))
    name = str(branches[0].attrs["over"])
    factor, gap = gap_scale(branches[0], branches[0].xi_rel)
    scales = [lengths_of(branch, factor) for branch in branches]
    gaps = [
        branch.xi_rel.transpose("sample", "point").values * scale
        for branch, scale in zip(branches, scales, strict=True)
    ]
    set_gap_scale(plane, np.concatenate([rows.ravel() for rows in gaps]))
    unit, label = parameter_scale(branches[0], name)
    low = min(float(branch[name].min()) for branch in branches) / unit
    high = max(float(branch[name].max()) for branch in branches) / unit
    edge = 0.01 * (high - low)  # room for markers at the ends
    words = f"{gap}, at $t = nT$" if factor else rf"{XI_REL}$(nT)$"
    plane.set(xlabel=label, ylabel=words, xlim=(low - edge, high + edge))
    set_title(figure, title or branch_title(branches[0], [name]))
    for branch, rows, scale in zip(branches, gaps, scales, strict=True):
        draw_branch(plane, branch[name].values / unit, rows, branch.stable.values == 1)
        if branch.sizes.get("bifurcation"):
            at = branch.bifurcation_value.values / unit
            there = np.interp(branch.bifurcation_place.values, np.arange(len(scale)), scale)
            marks = branch.bifurcation_xi_rel.transpose("bifurcation", ...).values
            draw_bifurcations(plane, branch, at, marks * there[:, np.newaxis])
    legend_below(figure, [plane], columns=8)
    return figure


def lengths_of(branch: xr.Dataset, factor: float) -> np.ndarray:
    """Return what gaps over a eta^2 are multiplied by at each point; 1 for an axis of ratios."""
    if not factor:
        return np.ones(branch.sizes["point"])
    return np.asarray(branch.amplitude.values * branch.eta.values**2 / factor)
