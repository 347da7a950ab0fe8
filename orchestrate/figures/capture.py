"""Draw capture maps: voltages from rest that pass the resonance, are captured or undecided."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .labels import format_voltage, typeset_unit
from .style import BLACK, GREEN, GREY, ORANGE, legend_under, make_panels, set_title, styled

PASSED, UNDECIDED = GREEN, ORANGE
FOLD: Any = {"color": GREY, "linewidth": 1.0, "linestyle": ":", "label": "fold, averaged theory"}


@styled
def draw(maps: Mapping[str, xr.Dataset], title: str = "") -> Figure:
    """Draw capture maps, one column per structure; return the figure."""
    figure, axes = make_panels(1, len(maps), (5.5 * len(maps), 4.5), sharex=True, sharey=True)
    for panel, (name, data) in zip(axes, maps.items(), strict=True):
        over = {str(dim) for dim in data.passes.dims} - {"voltage"}
        panel.set_title(name)
        panel.set_xlabel("voltage switched on, in V")
        if over:
            draw_map(panel, data, over.pop())
        else:
            draw_passage_times(panel, data)
        panel.label_outer()
        legend_under(panel, columns=3)
    set_title(figure, title)
    return figure


def split_by_outcome(data: xr.Dataset) -> dict[str, tuple[np.ndarray, dict[str, Any]]]:
    """Return the starts that pass, are captured or are undecided, with their marks."""
    passed = data.passes.values > 0
    undecided = data.decision.isin(["undecided", "settled at the resonance"]).values
    kinds: dict[str, tuple[np.ndarray, dict[str, Any]]] = {
        "captured": (~passed & ~undecided, {"marker": "x", "color": GREY}),
        "passes": (passed, {"marker": "o", "color": PASSED}),
        "undecided": (undecided, {"marker": "D", "color": UNDECIDED}),
    }
    return {name: kind for name, kind in kinds.items() if kind[0].any()}


def is_threshold_uncertain(data: xr.Dataset) -> bool:
    """Return whether undecided starts leave the threshold less exact than the tolerance."""
    return bool((data.border_high - data.border_low > data.border.attrs["tolerance"]).any())


def draw_map(axes: Axes, data: xr.Dataset, over: str) -> None:
    """Draw passed, captured and undecided starts over voltage and parameter, with the threshold."""
    data = data.transpose(over, "voltage")
    volts, values = np.meshgrid(data.voltage.values, data[over].values)
    for name, (chosen, mark) in split_by_outcome(data).items():
        axes.scatter(volts[chosen], values[chosen], s=22, linewidths=0.8, label=name, **mark)
    axes.plot(data.border, data[over], "-", color=BLACK, linewidth=1.2, label="border")
    if is_threshold_uncertain(data):
        interval: Any = {"color": UNDECIDED, "alpha": 0.3, "linewidth": 0.0}
        ends = data.border_low, data.border_high
        axes.fill_betweenx(data[over], *ends, label="undecided between", **interval)
    inside = (data.fold >= data.voltage.min()) & (data.fold <= data.voltage.max())
    if inside.sum() > 1:
        axes.plot(data.fold.where(inside), data[over], **FOLD)
    unit = str(data[over].attrs["units"])
    axes.set_ylabel(over.replace("_", " ") + ("" if unit == "1" else f" in {typeset_unit(unit)}"))


def draw_passage_times(axes: Axes, data: xr.Dataset) -> None:
    """Draw the time at which the resonance is passed over the starting voltage."""
    volts = data.voltage.values
    low: Any = {"transform": axes.get_xaxis_transform(), "clip_on": False, "linestyle": "none"}
    for name, (chosen, mark) in split_by_outcome(data).items():
        if name == "passes":
            axes.plot(volts[chosen], data.passage_time.values[chosen], label=name, **mark)
        else:
            axes.plot(volts[chosen], np.full(chosen.sum(), 0.02), label=name, **mark, **low)
    border = float(data.border)
    if np.isfinite(border):
        error = 0.5 * float(data.border_high - data.border_low)
        text = f"border, {format_voltage(border, error)}"
        axes.axvline(border, color=BLACK, linewidth=1.0, label=text)
    if is_threshold_uncertain(data):
        ends = float(data.border_low), float(data.border_high)
        axes.axvspan(*ends, color=UNDECIDED, alpha=0.3, linewidth=0.0, label="undecided between")
    if volts[0] <= float(data.fold) <= volts[-1]:
        axes.axvline(float(data.fold), **FOLD)
    axes.set_ylabel("time of the passage in s")
    axes.set_ylim(0.0, 1.2 * float(data.passage_time.max().fillna(1.0)))
