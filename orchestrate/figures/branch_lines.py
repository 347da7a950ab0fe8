"""Draw branches as lines, solid where orbits are stable and dashed where not."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ..flags import flag_words
from .style import BLUE, RED

MARKERS = {  # by the bifurcation's kind
    "fold": "<",
    "period doubling": "s",
    "period halving": "d",
    "Neimark-Sacker": "o",
    "grazing of an impact": "v",
    "grazing of a flight": "^",
    "loss of permanent contact": "X",
    "begin of permanent contact": "P",
    "earlier release": "D",
}


def draw_branch(
    plane: Axes,
    x: np.ndarray,
    rows: np.ndarray,
    stable: np.ndarray,
    colours: tuple[str, str] = (BLUE, RED),
) -> None:
    """Draw a branch's values as lines: solid where stable, dashed where unstable."""
    # a step of which one end is unstable is drawn as unstable
    both = stable & np.append(stable[1:], True) & np.append(True, stable[:-1])
    for row in rows:
        for label, shown, style, colour, width in (
            ("stable", stable, "-", colours[0], 1.2),
            ("unstable", ~both, "--", colours[1], 0.9),
        ):
            (line,) = plane.plot(x, np.where(shown, row, np.nan), style, color=colour)
            line.set(linewidth=width, label=label if shown.any() else None)


def draw_bifurcations(plane: Axes, branch: xr.Dataset, x: np.ndarray, rows: np.ndarray) -> None:
    """Draw a marker of the bifurcation's kind at each bifurcation of a branch."""
    names = flag_words(branch.bifurcation_kind.attrs)
    for at, row, kind in zip(x, rows, branch.bifurcation_kind.values, strict=True):
        word = names[int(kind)].replace("Neimark Sacker", "Neimark-Sacker")
        plane.plot(
            np.full(len(row), at),
            row,
            MARKERS[word],
            color="black",
            markerfacecolor="white",
            markersize=5,
            linestyle="none",
            label=word,
            zorder=3,
        )
