"""Where windows begin and end over two parameters: a curve for each bifurcation."""

from __future__ import annotations

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..flags import flag_words
from .labels import symbol, title_from_attributes
from .style import BLACK, BLUE, GREEN, ORANGE, RED, panels, styled

MARKERS = ("*", "D", "o", "s", "^", "P", "v", "X", "<", ">", "h")  # by number of the point's kind
COLOURS = {
    "fold": ORANGE,
    "period doubling": RED,
    "Neimark-Sacker": BLUE,
    "grazing of an impact": GREEN,
    "grazing of a flight": BLACK,
}


@styled
def draw(*curves: xr.Dataset, title: str = "") -> Figure:
    """Draw bifurcations over two parameters.

    Parameters
    ----------
    *curves : xarray.Dataset
        Of :func:`orchestrate.border`, all over the same two parameters.
    title : str
    """
    figure, (plane,) = panels(1, 1, (9.6, 4.4))
    first, second = (str(name) for name in curves[0].attrs["over"])
    shown: set[str] = set()
    for curve in curves:
        kind = str(curve.attrs["kind"])
        label = kind if kind not in shown else None
        plane.plot(curve[first], curve[second], color=COLOURS[kind], linewidth=1.2, label=label)
        shown.add(kind)
    for curve in curves:
        draw_points(plane, curve, first, second, shown)
    title = title or title_from_attributes(curves[0])
    plane.set(xlabel=symbol(first), ylabel=symbol(second), title=title)
    figure.legend(loc="outside lower right", ncols=min(4, len(shown)))
    return figure


def draw_points(plane: Axes, curve: xr.Dataset, first: str, second: str, shown: set[str]) -> None:
    """Draw a marker at each point of codimension two; each kind once in the legend."""
    if not curve.sizes.get("codimension_two"):
        return
    words = flag_words(curve.codimension_two_kind.attrs)
    x, y = (curve[f"codimension_two_{name}"].values for name in (first, second))
    for number, kind in enumerate(curve.codimension_two_kind.values):
        word = words[int(kind)]
        label = word if word not in shown else None
        plane.plot(
            x[number], y[number], MARKERS[int(kind) % len(MARKERS)], color=BLACK, label=label
        )
        shown.add(word)
