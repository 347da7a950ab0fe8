"""Draw phase curves of both masses: three states (Figure 5), several responses (Figure 12)."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..flags import flag_words
from .curve_data import relative_motion, select_panel
from .style import (
    BLACK,
    BLUE,
    GREY,
    RED,
    XI_REL,
    XI_REL_RATE,
    legend_below,
    make_panels,
    styled,
)

KIND_COLOURS = (BLUE, RED, GREY)  # separate motion, sequence of impacts, permanent contact
CONTACT = 2


@styled
def draw_states(data: xr.Dataset) -> Figure:
    """Draw one response's phase planes, coloured by state (Figure 5); return the figure."""
    figure, (left, right) = make_panels(1, 2, (8.5, 4.2))
    state, kind = data.state.values, data.kind.values
    _, gap, rate = relative_motion(data, 0)
    names = flag_words(data.kind.attrs)
    draw_by_state(left, (state[:, 0], state[:, 2]), kind, "-", names)
    draw_by_state(left, (state[:, 1], state[:, 3]), kind, "--", names)
    draw_by_state(right, (gap, rate), kind, "-", names, dotted=True)
    title = r"(a) both masses: solid $\xi_1$, dashed $\xi_2$"
    left.set(title=title, xlabel=r"$\xi_i$", ylabel=r"$\xi'_i$")
    right.set(title="(b) relative motion", xlabel=XI_REL, ylabel=XI_REL_RATE)
    legend_below(figure, [right])
    return figure


def draw_by_state(
    axes: Axes,
    curve: tuple[np.ndarray, np.ndarray],
    kind: np.ndarray,
    style: str,
    names: dict[int, str],
    dotted: bool = False,
) -> None:
    """Draw a curve in the colours of its states; contact as a thick line, or a dot."""
    for index, colour in enumerate(KIND_COLOURS):
        of_kind = np.where(kind == index, 1.0, np.nan)
        contact = index == CONTACT
        width = 2.5 if contact and not dotted else 1.0
        marker = "o" if contact and dotted else ""
        label = names[index] if style == "-" else None
        line: Any = {"color": colour, "linewidth": width, "label": label, "marker": marker}
        axes.plot(curve[0] * of_kind, curve[1] * of_kind, style, **line)


@styled
def draw_masses(data: xr.Dataset) -> Figure:
    """Draw both masses' phase planes, one panel per response on one scale (Figure 12)."""
    count = data.sizes["panel"]
    figure, axes = make_panels(1, count, (3.3 * count, 3.7))
    reach = 1.08 * float(np.abs(data.state).max())
    for index, plane in enumerate(axes):
        state = select_panel(data, index).state.values
        plane.plot(state[:, 0], state[:, 2], "-", color=BLACK, linewidth=1.0, label=r"$m_1$")
        plane.plot(state[:, 1], state[:, 3], ":", color=RED, linewidth=1.4, label=r"$m_2$")
        e, D, eta = (float(data[name][index]) for name in ("e", "D", "eta"))
        plane.set_title(rf"({'abcdefgh'[index]}) $e = {e:g}$, $D = {D:g}$, $\eta = {eta:.3f}$")
        plane.set_xlabel(r"$\xi_i$")
        plane.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    axes[0].set_ylabel(r"$\xi'_i$")
    legend_below(figure, axes[:1])
    return figure
