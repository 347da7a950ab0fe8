"""Figure 2, the Sommerfeld effect: speed, amplitude, impacts, and where the motor's power goes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .style import in_our_look, panels

COLOURS = {"bonded": "C0", "delaminated": "C3"}
BACK = "C1"  # impacts on the way back
SINKS = {
    "dampers": "dampers of the masses",
    "box_damper": "damper of the box",
    "impact_loss": "impacts",
}
WINDOW = 10  # revolutions that powers and impacts are averaged over
AROUND = 500.0  # time shown before and after a jump, in 1/omega
THEORY = "averaged theory, bonded"
MARKS = {"fold": "o", "Neimark-Sacker": "s", "period doubling": "^"}  # of bifurcations
HISTORIES = {"speed": "mean speed in rad/s", "amplitude": "amplitude of $x_1$ in m"}


@in_our_look
def draw(
    runs: Mapping[str, xr.Dataset],
    theory: xr.Dataset | None = None,
    branches: xr.Dataset | None = None,
    title: str = "",
) -> Figure:
    """Draw runs of one drive.

    Parameters
    ----------
    runs : mapping of xarray.Dataset
        ``"bonded"`` and ``"delaminated"``, or one of them; of :func:`orchestrate.couple`.
    theory : xarray.Dataset, optional
        ``voltage``, ``speed`` and ``amplitude`` of the averaged theory, over ``speed``.
    branches : xarray.Dataset, optional
        Of :func:`orchestrate.drive_branch`: unstable motions are dashed.
    title : str
        What is shown: set, rate, volts.
    """
    figure, axes = panels(4, 2, (13, 17))
    for name, data in runs.items():
        for part, style, way in ways(data):
            label = f"{name}, {way}"
            line: Any = {"color": COLOURS[name], "linewidth": 1.2, "label": label}
            axes[0].plot(data.voltage[part], data.speed[part], style, **line)
            axes[1].plot(data.speed[part], data.amplitude[part], style, **line)
            if name == "delaminated":
                draw_impacts(axes[2], data.isel(revolution=part), way)
        mark_jumps(axes[0], data, name)
    for panel, jump in zip(axes[4:6], ("up", "down"), strict=True):
        draw_histories(panel, runs, jump, "speed")
    for panel, jump in zip(axes[6:], ("up", "down"), strict=True):
        draw_histories(panel, runs, jump, "amplitude")
    if theory is not None:
        dotted: Any = {"linewidth": 1.0, "label": THEORY}
        axes[0].plot(theory.voltage, theory.speed, "k:", **dotted)
        axes[1].plot(theory.speed, theory.amplitude, "k:", **dotted)
    if branches is not None:
        draw_branches(axes, branches.sel(structure=list(runs)))
    if title:
        figure.suptitle(title)
    name = list(runs)[-1]
    draw_powers(axes[3], runs[name], name)
    label_axes(axes)
    limit_axes(axes, list(runs.values()))
    return figure


def ways(data: xr.Dataset) -> list[tuple[np.ndarray, str, str]]:
    """Revolutions on the way there and on the way back, with a line style and a name for each."""
    voltage = data.voltage.values
    turn = int(np.argmax(np.abs(voltage - voltage[0])))
    there, back = np.arange(0, turn + 1), np.arange(turn + 1, len(voltage))
    if turn == 0:  # a constant voltage
        there, back = np.arange(len(voltage)), np.arange(0)
    found = [(there, "-", "there"), (back, "--", "back")]
    return [way for way in found if way[0].size]


@in_our_look
def draw_stationary(branches: xr.Dataset, title: str = "") -> Figure:
    """Draw stationary motions alone.

    Parameters
    ----------
    branches : xarray.Dataset
        Of :func:`orchestrate.drive_branch`.
    title : str
    """
    figure, axes = panels(1, 2, (12, 5))
    draw_branches(axes, branches)
    for name in branches.structure.values:
        of_one = branches.bifurcation_structure == name
        for kind in np.unique(branches.bifurcation_kind.values[of_one]):
            at = branches.isel(bifurcation=of_one & (branches.bifurcation_kind == kind))
            mark: Any = {"color": COLOURS[name], "label": f"{name}, {kind}", "markersize": 5}
            marker = MARKS.get(str(kind), "o")
            axes[0].plot(at.bifurcation_voltage, at.bifurcation_speed, marker, **mark)
            axes[1].plot(at.bifurcation_speed, at.bifurcation_amplitude, marker, **mark)
    speed = "mean speed in rad/s"
    axes[0].set(xlabel="voltage in V", ylabel=speed)
    axes[1].set(xlabel=speed, ylabel="amplitude of $x_1$ in m")
    axes[0].legend(loc="best", fontsize=7)
    if title:
        figure.suptitle(title)
    return figure


def draw_branches(axes: Sequence[Axes], branches: xr.Dataset) -> None:
    """Stationary motions, thin and pale under the ramps: dashed where they are unstable."""
    for name in branches.structure.values:
        for i, leg in enumerate(branches.leg.values):
            branch = branches.sel(structure=name, leg=leg)
            stable, known = branch.stable.values, np.isfinite(branch.voltage.values)
            for part, style, what in ((stable, "-", "stable"), (known & ~stable, ":", "unstable")):
                line: Any = {"color": COLOURS[name], "linewidth": 3.0, "alpha": 0.35, "zorder": 1}
                line["label"] = None if i else f"{name}, branch, {what}"
                voltage, speed, amplitude = (
                    np.where(part, branch[of].values, np.nan)
                    for of in ("voltage", "speed", "amplitude")
                )
                axes[0].plot(voltage, speed, style, **line)
                axes[1].plot(speed, amplitude, style, **line)


def mean_of(values: np.ndarray) -> np.ndarray:
    """The running mean."""
    return np.convolve(values, np.full(WINDOW, 1.0 / WINDOW), "valid")


def draw_impacts(axes: Axes, data: xr.Dataset, way: str) -> None:
    """Impacts of each revolution, and their running mean."""
    speed, count = data.speed.values, data.impacts.values
    colour, style = (COLOURS["delaminated"], "-") if way == "there" else (BACK, "--")
    axes.plot(speed, count, ".", markersize=2.0, color=colour, alpha=0.3)
    if len(count) > WINDOW:
        label = f"delaminated, {way}, mean of {WINDOW}"
        line: Any = {"color": colour, "linewidth": 1.2, "label": label}
        axes.plot(mean_of(speed), mean_of(count), style, **line)
    if count.size and count.max() > 10.0:
        axes.set_yscale("log")


def mark_jumps(axes: Axes, data: xr.Dataset, name: str) -> None:
    """The voltages at which the speed jumps, with their values."""
    colour = COLOURS[name]
    for jump, place in (("up", 0.06), ("down", 0.94)):
        value = float(data.jumps.sel(jump=jump))
        if np.isfinite(value):
            axes.axvline(value, color=colour, linewidth=0.6, alpha=0.6)
            where: Any = {"transform": axes.get_xaxis_transform(), "rotation": 90, "fontsize": 8}
            side: Any = {"verticalalignment": "bottom" if jump == "up" else "top"}
            side["horizontalalignment"] = "left" if name == "bonded" else "right"
            axes.text(value, place, f" {value:.4f}", color=colour, **where, **side)


def draw_histories(axes: Axes, runs: Mapping[str, xr.Dataset], jump: str, what: str) -> None:
    """Speed or amplitude over time around a jump; words where there is none."""
    found = False
    for name, data in runs.items():
        voltage, speed = (float(data[of].sel(jump=jump)) for of in ("jumps", "jump_speed"))
        if not np.isfinite(voltage):
            continue
        found = True
        away = np.abs(data.voltage.values - voltage) + np.abs(data.speed.values - speed)
        row = int(np.argmin(away))
        span = AROUND * float(data.Omega[row] / data.speed[row])
        time = data.time.values - float(data.time[row])
        near = np.abs(time) < span
        axes.plot(time[near], data[what].values[near], color=COLOURS[name], label=name)
    if not found:
        place: Any = {"transform": axes.transAxes, "ha": "center", "va": "center"}
        axes.text(0.5, 0.5, f"no jump {jump}", **place)
    axes.set(xlabel=f"time from the jump {jump} in s", ylabel=HISTORIES[what])


def draw_powers(axes: Axes, data: xr.Dataset, name: str) -> None:
    """Mean power of the motor and where it goes, against the speed, one way."""
    there = ways(data)[0][0][::WINDOW]
    if len(there) < 3:
        return
    span = np.diff(data.time.values[there])
    ends = data.speed.values[there]
    speed = 0.5 * (ends[1:] + ends[:-1])

    def power(account: str) -> np.ndarray:
        return np.diff(data[account].values[there]) / span

    axes.plot(speed, power("motor"), "k", linewidth=1.5, label="motor")
    for account, label in SINKS.items():
        axes.plot(speed, power(account), linewidth=1.0, label=label)
    axes.plot(speed, power("stored"), color="0.7", linewidth=0.8, label="stored")
    axes.set_title(f"power, {name}, there")


def label_axes(axes: Sequence[Axes]) -> None:
    """Names of what is drawn."""
    speed = "mean speed in rad/s"
    axes[0].set(xlabel="voltage in V", ylabel=speed)
    axes[1].set(xlabel=speed, ylabel="amplitude of $x_1$ in m")
    axes[2].set(xlabel=speed, ylabel="impacts in a revolution")
    axes[3].set(xlabel=speed, ylabel="power in W")
    for panel in axes:
        if panel.get_legend_handles_labels()[0]:
            panel.legend(loc="best", fontsize=7)


def limit_axes(axes: Sequence[Axes], runs: Sequence[xr.Dataset]) -> None:
    """Ranges of the computed runs, their first revolutions left out: the theory goes on."""

    def ends(name: str) -> tuple[float, float]:
        values = np.concatenate([data[name].values[5:] for data in runs])
        return (values.min(), values.max()) if values.size else (0.0, 1.0)

    for panel, name in zip(axes[:2], ("voltage", "speed"), strict=True):
        low, high = ends(name)
        panel.set_xlim(low, high + 1e-3 * max(high - low, 1e-9))
    axes[0].set_ylim(*axes[1].get_xlim())
    axes[1].set_ylim(0.0, 1.05 * ends("amplitude")[1])
