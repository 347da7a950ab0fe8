"""Largest Lyapunov exponents over the frequency ratio, coloured by verdict."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from .labels import meanings
from .style import BLACK, BLUE, RED, in_our_look, panels

COLOURS = {1: RED, 0: BLUE, -1: BLACK}  # by verdict: chaotic, neutral, periodic
SIGMAS = 3.0  # standard errors a bar is long, up and down
LOWEST = -0.1


@in_our_look
def draw(*cases: xr.Dataset, titles: tuple[str, ...] = ()) -> Figure:
    """One panel a case.

    Parameters
    ----------
    *cases : xarray.Dataset
        Of :func:`orchestrate.lyapunov`.
    titles : tuple of str
        One a case, or none.
    """
    figure, axes = panels(len(cases), 1, (12, 3.0 * len(cases)), sharex=True, sharey=True)
    for plane, data, title in zip(axes, cases, titles or ("",) * len(cases), strict=True):
        names = meanings(data.verdict)
        for verdict, colour in COLOURS.items():
            part = data.isel(eta=data.verdict.values == verdict)
            bars = {"yerr": SIGMAS * part.standard_error, "markersize": 3, "linewidth": 0.5}
            plane.errorbar(
                part.eta, part.exponent, fmt=".", color=colour, label=names[verdict], **bars
            )
        plane.axhline(0.0, color="0.5", linewidth=0.8)
        plane.set(ylabel=r"$\lambda$", title=title)
    highest = max(float(data.exponent.max()) for data in cases)
    axes[0].set_ylim(LOWEST, max(0.05, 1.2 * highest))
    axes[0].legend()
    axes[-1].set_xlabel(r"$\eta$")
    return figure
