"""Draw a laboratory time history: envelopes of accelerations and gap, and impacts."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .labels import in_shown_units, title_from_attributes
from .scales import acceleration_scale, length_scale
from .style import BLACK, BLUE, RED, set_title, styled, write_in_panel

COLUMNS = 400  # of an envelope
SHORT = 5000  # points that are drawn as a line
MASSES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("a1_abs", {"color": BLUE, "label": "mass 1"}),
    ("a2_abs", {"color": RED, "label": "mass 2"}),
)


@styled
def draw(data: xr.Dataset, title: str = "", bonded: xr.Dataset | None = None) -> Figure:
    """Draw a laboratory record: accelerations, gap and impulses over time; return the figure."""
    figure = Figure(figsize=(10.4, 7.2), layout="constrained")
    rows = figure.subplots(4, 1, sharex=True, height_ratios=(1.0, 1.6, 1.2, 1.2))
    set_title(figure, title or shaken_title(data))
    box, masses, gap, impacts = rows
    scale, unit = acceleration_scale(data)
    draw_signal(box, data, "box_acceleration", scale, color=BLACK)
    box.set_ylabel(f"acceleration\nof box in {unit}")
    for name, style in MASSES:
        draw_signal(masses, data, name, scale, alpha=0.55, **style)
    if bonded is not None:
        draw_bonded_envelope(masses, bonded, scale)
    masses.set_ylabel(f"acceleration\nof masses in {unit}")
    masses.legend(ncols=3, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    factor, letter = length_scale(data, float(data.x_rel.max()))
    draw_signal(gap, data, "x_rel", factor, color=BLACK)
    gap.set_ylabel(f"gap in {letter}m")
    draw_impacts(impacts, data)
    impacts.set(xlabel="time in s", xlim=(0.0, float(data.time[-1])))
    return figure


def shaken_title(data: xr.Dataset) -> str:
    """Return a title with the excitation, its level in the unit asked for, and the structure."""
    words = data.attrs.get("excitation_description") or data.attrs["excitation"]
    return f"{in_shown_units(data, str(words))}; {title_from_attributes(data)}"


def draw_impacts(axes: Axes, data: xr.Dataset) -> None:
    """Draw each impact's impulse at its time."""
    count = data.sizes["impact"]
    axes.set_ylabel("impulse in N s")
    if not count:
        write_in_panel(axes, "no impacts")
        return
    size = 5 if count < COLUMNS else 2
    axes.plot(data.impact_time, data.impulse, ".", color=RED, markersize=size)
    axes.set_ylim(bottom=0.0)


def draw_bonded_envelope(axes: Axes, bonded: xr.Dataset, felt: float) -> None:
    """Draw the lower and upper envelope of the bonded structure's acceleration."""
    time, low, high = local_extremes(bonded.time.values, bonded.a1_abs.values / felt)
    axes.plot(time, high, color=BLACK, linewidth=0.9, label="both, bonded")
    axes.plot(time, low, color=BLACK, linewidth=0.9)


def local_extremes(
    time: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Split a signal into equal parts; return each part's time, smallest and largest value."""
    edges = np.linspace(0, len(time), min(COLUMNS, len(time)) + 1).astype(int)[:-1]
    return time[edges], np.minimum.reduceat(values, edges), np.maximum.reduceat(values, edges)


def draw_signal(axes: Axes, data: xr.Dataset, name: str, factor: float, **style: Any) -> None:
    """Draw a signal as a line, or as the band between its extremes if it is long."""
    time, values = data.time.values, data[name].values / factor
    if len(time) <= SHORT:
        axes.plot(time, values, linewidth=1.0, **{**style, "alpha": 1.0})
        return
    axes.fill_between(*local_extremes(time, values), linewidth=0.4, **style)
