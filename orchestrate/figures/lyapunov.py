"""Draw largest Lyapunov exponents over a parameter, coloured by verdict."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..flags import flag_words
from .labels import title_from_attributes
from .scales import axis_values, varied_dimension
from .style import BLACK, BLUE, RED, legend_below, make_panels, styled

VERDICTS = {1: (RED, "o"), 0: (BLUE, "s"), -1: (BLACK, ".")}  # chaotic, neutral, periodic


@styled
def draw(
    *cases: xr.Dataset, title: str = "", titles: tuple[str, ...] = (), lowest: float = -0.1
) -> Figure:
    """Draw exponents with standard errors, one panel per dataset; return the figure."""
    size = (9.6, 0.6 + 2.2 * len(cases))
    figure, axes = make_panels(len(cases), 1, size, sharex=True, sharey=True)
    highest = max(float(data.exponent.max()) for data in cases)
    minimum = min(float(data.exponent.min()) for data in cases)
    lowest = min(max(1.2 * minimum, lowest), -0.01)
    axes[0].set_ylim(lowest, max(0.05, 1.2 * highest))
    names = titles or (*([title] if title else map(title_from_attributes, cases)),)
    for plane, data, words in zip(axes, cases, names, strict=True):
        draw_case(plane, data, lowest)
        plane.axhline(0.0, color="0.5", linewidth=0.8)
        plane.set(ylabel=r"$\lambda$ per unit of $\tau$", title=words)
    axes[-1].set_xlabel(axis_values(cases[-1], varied_dimension(cases[-1].exponent)).label)
    legend_below(figure, axes, 6, title="bars: one standard error")
    return figure


def draw_case(axes: Axes, data: xr.Dataset, lowest: float) -> None:
    """Draw one dataset's exponents by verdict, each verdict in the legend."""
    names, parameter = flag_words(data.verdict.attrs), varied_dimension(data.exponent)
    x = axis_values(data, parameter).values
    size = float(np.clip(1000.0 / len(x), 2.0, 4.0))
    for verdict, (colour, shape) in VERDICTS.items():
        of_verdict = data.verdict.values == verdict
        exponent, error = data.exponent.values[of_verdict], data.standard_error.values[of_verdict]
        style: Any = {"fmt": shape, "color": colour, "markersize": size, "linewidth": 0.7}
        axes.errorbar(x[of_verdict], exponent, yerr=error, label=names[verdict], **style)
    below = data.exponent.values < lowest
    if below.any():
        edge = axes.get_xaxis_transform()
        style = {"color": BLACK, "markersize": 4, "label": f"periodic, below {lowest:.2g}"}
        axes.plot(x[below], np.full(below.sum(), 0.02), "v", transform=edge, **style)
