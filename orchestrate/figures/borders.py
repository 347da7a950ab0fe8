"""Where windows begin and end over two parameters: a curve for each bifurcation."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from .labels import title_from_attributes
from .scales import parameter_scale
from .style import BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, panels, styled

COLOURS = {
    "fold": ORANGE,
    "period doubling": RED,
    "Neimark-Sacker": BLUE,
    "grazing of an impact": GREEN,
    "grazing of a flight": BLACK,
    "earlier release": PURPLE,
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
    (x_unit, x_label), (y_unit, y_label) = (
        parameter_scale(curves[0], name) for name in (first, second)
    )
    shown: set[str] = set()
    for curve in curves:
        kind = str(curve.attrs["kind"])
        label = kind if kind not in shown else None
        x, y = curve[first] / x_unit, curve[second] / y_unit
        plane.plot(x, y, color=COLOURS[kind], linewidth=1.2, label=label)
        shown.add(kind)
    title = title or title_from_attributes(curves[0])
    plane.set(xlabel=x_label, ylabel=y_label, title=title)
    figure.legend(loc="outside lower right", ncols=len(shown))
    return figure
