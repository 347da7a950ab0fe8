"""Draw bifurcation curves over two parameters."""

from __future__ import annotations

from collections.abc import Iterable

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..flags import flag_words
from .held_excitation import branch_title
from .scales import parameter_scale
from .style import BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, make_panels, set_title, styled

MARKERS = ("*", "D", "o", "s", "^", "P", "v", "X", "<", ">", "h")  # by number of the point's kind
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
    """Draw bifurcation curves over two parameters, with codimension-two points; return the
    figure.
    """
    figure, (plane,) = make_panels(1, 1, (9.6, 4.4))
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
    for curve in curves:
        draw_points(plane, curve, ((first, x_unit), (second, y_unit)), shown)
    plane.set(xlabel=x_label, ylabel=y_label)
    set_title(figure, title or branch_title(curves[0], (first, second)))
    figure.legend(loc="outside lower right", ncols=min(4, len(shown)))
    return figure


def draw_points(
    plane: Axes, curve: xr.Dataset, axes: Iterable[tuple[str, float]], shown: set[str]
) -> None:
    """Draw a marker at each codimension-two point; each kind once in the legend."""
    if not curve.sizes.get("codimension_two"):
        return
    words = flag_words(curve.codimension_two_kind.attrs)
    x, y = (curve[f"codimension_two_{name}"].values / unit for name, unit in axes)
    for number, kind in enumerate(curve.codimension_two_kind.values):
        word = words[int(kind)]
        label = word if word not in shown else None
        plane.plot(
            x[number], y[number], MARKERS[int(kind) % len(MARKERS)], color=BLACK, label=label
        )
        shown.add(word)
