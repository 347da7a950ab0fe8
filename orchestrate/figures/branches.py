"""An orbit diagram (Figure 6) with its branches: solid where stable, dashed where not."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..errors import InputError
from ..flags import flag_words
from .labels import EXCITATION, title_from_attributes
from .marks import Marks, draw_samples
from .orbit_diagram import set_gap_scale
from .scales import parameter_scale
from .style import BLUE, GREY, RED, XI_REL, legend_below, panels, styled

MARKERS = {  # by the bifurcation's kind
    "fold": "<",
    "period doubling": "s",
    "Neimark-Sacker": "o",
    "grazing of an impact": "v",
    "grazing of a flight": "^",
    "loss of permanent contact": "X",
    "begin of permanent contact": "P",
    "earlier release": "D",
}


@styled
def draw(*branches: xr.Dataset, responses: xr.Dataset | None = None, title: str = "") -> Figure:
    """Draw branches of orbits over an orbit diagram.

    Parameters
    ----------
    *branches : xarray.Dataset
        Of :func:`orchestrate.branch`, all along the same parameter.
    responses : xarray.Dataset, optional
        Of :func:`orchestrate.sweep` along it, in one direction or both.
    title : str

    Raises
    ------
    InputError
        Where they are along another parameter.
    """
    figure, (plane,) = panels(1, 1, (9.6, 5.8))
    name = str(branches[0].attrs["over"])
    if responses is not None and name not in responses.xi_rel.dims:
        along = ", ".join(map(str, responses.xi_rel.dims))
        raise InputError(f"responses along {along}: expected a result of sweep along {name}")
    gaps = np.concatenate([branch.xi_rel.values.ravel() for branch in branches])
    set_gap_scale(
        plane, gaps if responses is None else np.append(gaps, responses.xi_rel.values.ravel())
    )
    unit, label = parameter_scale(branches[0], name)
    low = min(float(branch[name].min()) for branch in branches) / unit
    high = max(float(branch[name].max()) for branch in branches) / unit
    edge = 0.01 * (high - low)  # room for markers at the ends
    plane.set(xlabel=label, ylabel=rf"{XI_REL}$(nT)$", xlim=(low - edge, high + edge))
    plane.set_title(title or title_from_attributes(branches[0], EXCITATION))
    if responses is not None:
        gaps_of = responses.xi_rel.stack(of_all=[d for d in responses.xi_rel.dims if d != name])
        draw_samples(plane, responses[name].values / unit, gaps_of.values, Marks(GREY))
    shown: set[str] = set()
    for branch in branches:
        draw_branch(plane, branch, name, unit)
        draw_bifurcations(plane, branch, shown, unit)
    legend_below(figure, [plane], columns=8)
    return figure


def draw_branch(plane: Axes, branch: xr.Dataset, name: str, unit: float) -> None:
    """Draw one line for each phase 0 of the orbit."""
    along, stable = branch[name].values / unit, branch.stable.values == 1
    # a step of which one end is unstable is drawn as unstable
    both = stable & np.append(stable[1:], True) & np.append(True, stable[:-1])
    for gaps in branch.xi_rel.transpose("sample", "point").values:
        plane.plot(along, np.where(stable, gaps, np.nan), "-", color=BLUE, linewidth=1.2)
        plane.plot(along, np.where(both, np.nan, gaps), "--", color=RED, linewidth=0.9)


def draw_bifurcations(
    plane: Axes, branch: xr.Dataset, already_shown: set[str], unit: float
) -> None:
    """Draw a marker for each kind; each kind once in the legend."""
    if not branch.sizes.get("bifurcation"):
        return
    names = flag_words(branch.bifurcation_kind.attrs)
    for i, kind in enumerate(branch.bifurcation_kind.values):
        word = names[int(kind)].replace("Neimark Sacker", "Neimark-Sacker")
        gaps = branch.bifurcation_xi_rel.values[i]
        plane.plot(
            np.full(len(gaps), branch.bifurcation_value.values[i] / unit),
            gaps,
            MARKERS[word],
            color="black",
            markerfacecolor="white",
            markersize=5,
            linestyle="none",
            label=word if word not in already_shown else None,
            zorder=3,
        )
        already_shown.add(word)
