"""Draw the weak drive (Figure 2, Sommerfeld effect): ramps, jumps, branches, starts from rest.

A ramp has speed, amplitude, impacts, and where the motor's power goes; the jumps are speed and
amplitude over time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..units import in_display_units, omega_of
from . import passage
from .colours import BIFURCATION_MARKS, BLACK, DIRECTION_STYLES, GREEN, GREY, ORANGE, STRUCTURES
from .kinds import OTHER, draws
from .labels import format_voltage, typeset_unit
from .passage import HISTORIES, POWER_REVOLUTIONS, has_jump, jump_texts, undecided_directions
from .scales import label_with_unit
from .style import (
    add_figure_legend,
    add_legend_below,
    draw_line,
    make_panels,
    set_plain_log_scale,
    styled,
    write_in_empty_panel,
)

IMPACT_REVOLUTIONS = 10  # revolutions that impacts are averaged over
THEORY = "averaged theory, bonded"
FOLD: Any = {"color": GREY, "linewidth": 1.0, "linestyle": ":", "label": "fold, averaged theory"}
DOUBT: Any = {"color": ORANGE, "alpha": 0.3, "linewidth": 0.0, "label": "undecided between"}


@draws("couple", partner=OTHER)
@styled
def draw_ramps(
    runs: Mapping[str, xr.Dataset],
    theory: xr.Dataset | None = None,
    branches: xr.Dataset | None = None,
    title: str = "",
) -> Figure:
    shown = {name: drop_spin_up(in_display_units(data)) for name, data in runs.items()}
    figure, axes = make_panels(2, 2, (11, 9.4), title)
    for name, data in shown.items():
        for part, style, direction in split_there_and_back(data):
            line: Any = {"color": STRUCTURES[name], "linewidth": 1.2}
            draw_speed_curves(axes, data, part, style, **line, label=f"{name}, {direction}")
            if name == "delaminated":
                draw_impacts(axes[2], data.isel(revolution=part), direction)
        mark_jumps(axes[0], data, name)
    if theory is not None:
        theory, line = in_display_units(theory), {"color": BLACK, "linewidth": 1.0}
        stable = theory.stable
        draw_speed_curves(axes, theory, stable, "-.", **line, label=f"{THEORY}, stable")
        draw_speed_curves(axes, theory, ~stable, ":", **line, label=f"{THEORY}, unstable")
    if branches is not None:
        draw_branches(axes, in_display_units(branches).sel(structure=list(runs)))
    name = list(runs)[-1]
    draw_outward_powers(axes[3], shown[name], name)
    jumps = {name: ", ".join(jump_texts(data)) for name, data in runs.items()}
    texts = (f"{name}: {'jump' if text else 'no jump'} {text}" for name, text in jumps.items())
    axes[0].set_title("\n".join(map(str.rstrip, texts)))
    label_speed_axes(axes, shown[name])
    axes[2].set(xlabel=axes[1].get_xlabel(), ylabel="impacts in a revolution")
    axes[3].set(xlabel=axes[1].get_xlabel(), ylabel="power in W")
    add_figure_legend(figure, axes[:2], title="upper panels")
    for panel in axes[2:]:
        add_legend_below(panel)
    ends = {}  # of the runs: the theory's curves extend beyond them
    for quantity in ("voltage", "speed", "amplitude"):
        values = np.concatenate([data[quantity].values for data in shown.values()])
        ends[quantity] = (values.min(), values.max()) if values.size else (0.0, 1.0)
    for panel, (low, high) in zip(axes[:2], ends.values(), strict=False):
        panel.set_xlim(low, high + 1e-3 * max(high - low, 1e-9))
    axes[0].set_ylim(*axes[1].get_xlim())
    axes[1].set_ylim(0.0, 1.05 * ends["amplitude"][1])
    return figure


@styled
def draw_jump_histories(runs: Mapping[str, xr.Dataset], title: str = "") -> Figure:
    shown = {name: in_display_units(data) for name, data in runs.items()}
    jumps = [way for way in ("up", "down") if any(has_jump(data, way) for data in shown.values())]
    rows = max(len(jumps), 1)
    figure, axes = make_panels(rows, 2, (10, 0.8 + 3.6 * rows), title)
    for number, panel in enumerate(axes):
        if not jumps:
            write_in_empty_panel(panel, "no jump")
            continue
        jump, what = jumps[number // 2], list(HISTORIES)[number % 2]
        for name, data in shown.items():
            if has_jump(data, jump):
                at = data.sel(jump=jump)
                time = data.time.values - float(at.jump_time)
                near = np.abs(time) < 500.0 / omega_of(data)
                label = f"{name}, {float(at.jumps):.4f} V"
                values = data[what].values[near]
                panel.plot(time[near], values, color=STRUCTURES[name], label=label)
                panel.set_ylabel(label_with_unit(HISTORIES[what], data[what]))
        panel.set_xlabel(f"time from the jump {jump} in s")
        add_legend_below(panel)
    return figure


@draws("drive_branch")
@styled
def draw_drive_branches(branches: xr.Dataset, title: str = "") -> Figure:
    figure, axes = make_panels(1, 2, (12, 5), title)
    branches = in_display_units(branches)
    draw_branches(axes, branches)
    for name in branches.structure.values:
        of_one = branches.bifurcation_structure == name
        for kind in np.unique(branches.bifurcation_kind.values[of_one]):
            at = branches.isel(bifurcation=of_one & (branches.bifurcation_kind == kind))
            mark: Any = {"color": STRUCTURES[name], "label": f"{name}, {kind}", "markersize": 5}
            marker = BIFURCATION_MARKS[str(kind)]
            axes[0].plot(at.bifurcation_voltage, at.bifurcation_speed, marker, **mark)
            axes[1].plot(at.bifurcation_speed, at.bifurcation_amplitude, marker, **mark)
    label_speed_axes(axes, branches)
    add_figure_legend(figure, axes[:1])
    return figure


def draw_speed_curves(
    axes: Sequence[Axes], data: xr.Dataset, part: xr.DataArray, style: str, **line: Any
) -> None:
    voltage, amplitude = (data[name].where(part) for name in ("voltage", "amplitude"))
    axes[0].plot(voltage, data.speed, style, **line)
    axes[1].plot(data.speed, amplitude, style, **line)


def draw_branches(axes: Sequence[Axes], branches: xr.Dataset) -> None:
    """Draw stationary motions thick and pale under the ramps, dotted where unstable."""
    for name in branches.structure.values:
        line: Any = {"color": STRUCTURES[name], "linewidth": 3.0, "alpha": 0.45, "zorder": 1}
        for i, leg in enumerate(branches.leg.values):
            branch = branches.sel(structure=name, leg=leg)
            stable, known = branch.stable, branch.voltage.notnull()
            for part, style, what in ((stable, "-", "stable"), (known & ~stable, ":", "unstable")):
                label = None if i else f"{name}, branch, {what}"
                draw_speed_curves(axes, branch, part, style, **line, label=label)


def drop_spin_up(data: xr.Dataset) -> xr.Dataset:
    """Return a run without its beginning: no spin-up, no time at the first voltage."""
    change = np.abs(np.diff(data.voltage.values))
    holds = change <= 1e-3 * change.max(initial=0.0)
    if not holds.any() or holds.all():
        return data
    first = int(np.argmax(holds))
    moves = np.flatnonzero(~holds[first:])
    end = first + int(moves[0]) if moves.size else 0
    early = end < len(change) // 2  # steps of the voltage hold too, all the time
    return data.isel(revolution=slice(end, None)) if early else data


def split_there_and_back(data: xr.Dataset) -> list[tuple[xr.DataArray, str, str]]:
    """Return which revolutions are there, and which are back, each with style and name."""
    change = abs(data.voltage - data.voltage[0]).values
    turn = int(np.argmax(change)) or len(change) - 1  # or a constant voltage
    there = data.voltage.copy(data=np.arange(len(change)) <= turn)
    legs = zip((there, ~there), DIRECTION_STYLES.values(), ("there", "back"), strict=True)
    return [leg for leg in legs if leg[0].any()]


def running_mean(values: np.ndarray, count: int) -> np.ndarray:
    return np.convolve(values, np.full(count, 1.0 / count), "valid")


def draw_impacts(axes: Axes, data: xr.Dataset, direction: str) -> None:
    speed, count = data.speed.values, data.impacts.values
    there = direction == "there"
    colour, style = (STRUCTURES["delaminated"], "-") if there else (ORANGE, "--")
    axes.plot(speed, count, ".", markersize=2.0, color=colour, alpha=0.3)
    if len(count) > IMPACT_REVOLUTIONS:
        label = f"delaminated, {direction}, mean of {IMPACT_REVOLUTIONS}"
        x, y = (running_mean(values, IMPACT_REVOLUTIONS) for values in (speed, count))
        draw_line(axes, x, y, style, colour, 1.2, label)
    if count.size and count.max() > 10.0:
        set_plain_log_scale(axes)


def mark_jumps(axes: Axes, data: xr.Dataset, name: str) -> None:
    for value in data.jumps.values[np.isfinite(data.jumps.values)]:
        axes.axvline(value, color=STRUCTURES[name], linewidth=0.6, alpha=0.6)
    for direction in undecided_directions(data):
        at = data.sel(jump=direction)
        ends = float(at.jump_low), float(at.jump_high)
        if np.isfinite(ends).all():
            label = f"{name}, jump {direction} undecided"
            axes.axvspan(*ends, color=STRUCTURES[name], linewidth=0.0, alpha=0.15, label=label)


def draw_outward_powers(axes: Axes, data: xr.Dataset, name: str) -> None:
    part, count = data.isel(revolution=split_there_and_back(data)[0][0]), POWER_REVOLUTIONS
    if part.sizes["revolution"] < 3 * count:
        return
    powers = passage.mean_powers(part).items()
    twice = {account: running_mean(values, count) for account, values in powers}
    speed = running_mean(running_mean(part.speed.values[1:], count), count)
    passage.draw_powers(axes, speed, twice)
    means = f"means of {POWER_REVOLUTIONS} revolutions, taken twice"
    axes.set_title(f"power on the way there, {name}\n{means}")


def label_speed_axes(axes: Sequence[Axes], data: xr.Dataset) -> None:
    speed, amplitude = (label_with_unit(HISTORIES[name], data[name]) for name in HISTORIES)
    axes[0].set(xlabel="voltage in V", ylabel=speed)
    axes[1].set(xlabel=speed, ylabel=amplitude)


# -- starts from rest -----------------------------------------------------------------------------


@draws("capture", partner=OTHER)
@styled
def draw_capture(maps: Mapping[str, xr.Dataset], title: str = "") -> Figure:
    size = (5.5 * len(maps), 4.5)
    figure, axes = make_panels(1, len(maps), size, title, sharex=True, sharey=True)
    for panel, (name, data) in zip(axes, maps.items(), strict=True):
        over = {str(dim) for dim in data.passes.dims} - {"voltage"}
        panel.set_title(name)
        panel.set_xlabel("voltage switched on, in V")
        if over:
            draw_capture_map(panel, data, over.pop())
        else:
            draw_passage_times(panel, data)
        panel.label_outer()
        add_legend_below(panel)
    return figure


def split_by_outcome(data: xr.Dataset) -> dict[str, tuple[np.ndarray, dict[str, Any]]]:
    """Return the starts that pass, are captured or are undecided, with their marks."""
    passed = data.passes.values > 0
    undecided = data.decision.isin(["undecided", "settled at the resonance"]).values
    kinds: dict[str, tuple[np.ndarray, dict[str, Any]]] = {
        "captured": (~passed & ~undecided, {"marker": "x", "color": GREY}),
        "passes": (passed, {"marker": "o", "color": GREEN}),
        "undecided": (undecided, {"marker": "D", "color": ORANGE}),
    }
    return {name: kind for name, kind in kinds.items() if kind[0].any()}


def is_threshold_uncertain(data: xr.Dataset) -> bool:
    """Return whether undecided starts leave the threshold less exact than the tolerance."""
    return bool((data.border_high - data.border_low > data.border.attrs["tolerance"]).any())


def draw_capture_map(axes: Axes, data: xr.Dataset, over: str) -> None:
    data = data.transpose(over, "voltage")
    volts, values = np.meshgrid(data.voltage.values, data[over].values)
    for name, (chosen, mark) in split_by_outcome(data).items():
        axes.scatter(volts[chosen], values[chosen], s=22, linewidths=0.8, label=name, **mark)
    draw_line(axes, data.border, data[over], "-", BLACK, 1.2, "border")
    if is_threshold_uncertain(data):
        axes.fill_betweenx(data[over], data.border_low, data.border_high, **DOUBT)
    inside = (data.fold >= data.voltage.min()) & (data.fold <= data.voltage.max())
    if inside.sum() > 1:
        axes.plot(data.fold.where(inside), data[over], **FOLD)
    unit = str(data[over].attrs["units"])
    axes.set_ylabel(over.replace("_", " ") + ("" if unit == "1" else f" in {typeset_unit(unit)}"))


def draw_passage_times(axes: Axes, data: xr.Dataset) -> None:
    volts = data.voltage.values
    low: Any = {"transform": axes.get_xaxis_transform(), "clip_on": False}
    for name, (chosen, mark) in split_by_outcome(data).items():
        passes = name == "passes"
        time = data.passage_time.values[chosen] if passes else np.full(chosen.sum(), 0.02)
        place = {} if passes else {**low, "linestyle": "none"}
        axes.plot(volts[chosen], time, label=name, **mark, **place)
    border, ends = float(data.border), (float(data.border_low), float(data.border_high))
    if np.isfinite(border):
        text = f"border, {format_voltage(border, 0.5 * (ends[1] - ends[0]))}"
        axes.axvline(border, color=BLACK, linewidth=1.0, label=text)
    if is_threshold_uncertain(data):
        axes.axvspan(*ends, **DOUBT)
    if volts[0] <= float(data.fold) <= volts[-1]:
        axes.axvline(float(data.fold), **FOLD)
    axes.set_ylabel("time of the passage in s")
    axes.set_ylim(0.0, 1.2 * float(data.passage_time.max().fillna(1.0)))
