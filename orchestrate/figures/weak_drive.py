"""Draw runs of the weak drive (Figure 2, Sommerfeld effect): ramps and their jumps.

The ramp has speed, amplitude, impacts, and where the motor's power goes; the jumps are speed and
amplitude over time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..units import as_shown, omega_of
from .powers import POWER_REVOLUTIONS, draw_powers, mean_powers
from .scales import label_with_unit
from .style import (
    BLACK,
    BLUE,
    ORANGE,
    RED,
    legend_below,
    legend_under,
    make_panels,
    set_title,
    styled,
    write_in_panel,
    write_plain_numbers,
)

COLOURS = {"bonded": BLUE, "delaminated": RED}
COLOUR_OF_RETURN = ORANGE  # impacts on the way back
IMPACT_REVOLUTIONS = 10  # revolutions that impacts are averaged over
TIME_AROUND_JUMP = 500.0  # time shown before and after a jump, in 1/omega
THEORY = "averaged theory, bonded"
MARKS = {  # of bifurcations
    **{"fold": "o", "Neimark-Sacker": "s", "period doubling": "^"},
    **{"grazing of a flight": "x", "grazing of an impact": "+"},
}
HISTORIES = {"speed": "mean speed", "amplitude": "amplitude of $x_1$"}


@styled
def draw(
    runs: Mapping[str, xr.Dataset],
    theory: xr.Dataset | None = None,
    branches: xr.Dataset | None = None,
    title: str = "",
) -> Figure:
    """Draw voltage ramps: speed, amplitude, impacts and power; return the figure."""
    shown = {name: drop_spin_up(as_shown(data)) for name, data in runs.items()}
    figure, axes = make_panels(2, 2, (11, 9.4))
    for name, data in shown.items():
        for part, style, direction in split_directions(data):
            label = f"{name}, {direction}"
            line: Any = {"color": COLOURS[name], "linewidth": 1.2, "label": label}
            axes[0].plot(data.voltage[part], data.speed[part], style, **line)
            axes[1].plot(data.speed[part], data.amplitude[part], style, **line)
            if name == "delaminated":
                draw_impacts(axes[2], data.isel(revolution=part), direction)
        mark_jumps(axes[0], data, name)
    if theory is not None:
        draw_theory(axes, as_shown(theory))
    if branches is not None:
        draw_branches(axes, as_shown(branches).sel(structure=list(runs)))
    set_title(figure, title)
    name = list(runs)[-1]
    draw_outward_powers(axes[3], shown[name], name)
    axes[0].set_title("\n".join(filter(None, (format_jumps(*item) for item in runs.items()))))
    label_axes(axes, shown[name])
    legend_below(figure, axes[:2], title="upper panels")
    for panel in axes[2:]:
        legend_under(panel)
    limit_axes(axes, list(shown.values()))
    return figure


@styled
def draw_jumps(runs: Mapping[str, xr.Dataset], title: str = "") -> Figure:
    """Draw speed and amplitude over time around jumps, one row per direction."""
    shown = {name: as_shown(data) for name, data in runs.items()}
    jumps = jump_directions(shown)
    figure, axes = make_panels(
        max(len(jumps), 1), len(HISTORIES), (10, 0.8 + 3.6 * max(len(jumps), 1))
    )
    for row, jump in enumerate(jumps):
        for panel, what in zip(axes[len(HISTORIES) * row :], HISTORIES, strict=False):
            draw_histories(panel, shown, jump, what)
    if not jumps:
        for panel in axes:
            write_in_panel(panel, "no jump")
    set_title(figure, title)
    return figure


def jump_directions(runs: Mapping[str, xr.Dataset]) -> list[str]:
    """Return the directions, "up" and "down", in which any of the runs jumps."""
    directions = ("up", "down")
    return [
        direction
        for direction in directions
        if any(has_jump(data, direction) for data in runs.values())
    ]


def draw_theory(axes: Sequence[Axes], theory: xr.Dataset) -> None:
    """Draw the averaged theory: dash-dotted where stable, dotted where unstable."""
    stable = theory.stable.values
    for part, style, what in ((stable, "-.", "stable"), (~stable, ":", "unstable")):
        line: Any = {"color": BLACK, "linewidth": 1.0, "label": f"{THEORY}, {what}"}
        voltage, amplitude = (theory[of].where(part) for of in ("voltage", "amplitude"))
        axes[0].plot(voltage, theory.speed, style, **line)
        axes[1].plot(theory.speed, amplitude, style, **line)


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


def has_jump(data: xr.Dataset, direction: str) -> bool:
    """Return whether a run jumps in a direction."""
    return bool(np.isfinite(float(data.jumps.sel(jump=direction))))


def jump_texts(data: xr.Dataset) -> list[str]:
    """Return a text for each jump of a run, and for each undecided direction."""
    jumps = [
        f"{direction} at {float(data.jumps.sel(jump=direction)):.4f} V"
        for direction in map(str, data.jump.values)
        if has_jump(data, direction)
    ]
    undecided = [f"{direction} undecided" for direction in undecided_directions(data)]
    return jumps + undecided


def format_jumps(name: str, data: xr.Dataset) -> str:
    """Format a run's jumps in one line after its name."""
    return f"{name}: jump {', '.join(jump_texts(data))}" if jump_texts(data) else f"{name}: no jump"


def format_passage(data: xr.Dataset) -> str:
    """Format whether, and from what time on, a run is beyond the resonance."""
    passed = float(data.passage_time)
    if np.isfinite(passed):
        return f"beyond the resonance from {passed:.4g} s on"
    return "the resonance is not passed"


def undecided_directions(data: xr.Dataset) -> list[str]:
    """Return the labels of the jumps that are undecided."""
    decided = zip(data.jump.values, data.decided.values, strict=True)
    return [str(direction) for direction, decision in decided if decision == "undecided"]


def split_directions(data: xr.Dataset) -> list[tuple[np.ndarray, str, str]]:
    """Return a run's revolutions there and back as index arrays, each with style and name."""
    voltage = data.voltage.values
    turn = int(np.argmax(np.abs(voltage - voltage[0])))
    outward, back = np.arange(0, turn + 1), np.arange(turn + 1, len(voltage))
    if turn == 0:  # a constant voltage
        outward, back = np.arange(len(voltage)), np.arange(0)
    legs = [(outward, "-", "there"), (back, "--", "back")]
    return [leg for leg in legs if leg[0].size]


@styled
def draw_stationary(branches: xr.Dataset, title: str = "") -> Figure:
    """Draw branches of stationary motions without runs; return the figure."""
    figure, axes = make_panels(1, 2, (12, 5))
    branches = as_shown(branches)
    draw_branches(axes, branches)
    for name in branches.structure.values:
        of_one = branches.bifurcation_structure == name
        for kind in np.unique(branches.bifurcation_kind.values[of_one]):
            at = branches.isel(bifurcation=of_one & (branches.bifurcation_kind == kind))
            mark: Any = {"color": COLOURS[name], "label": f"{name}, {kind}", "markersize": 5}
            marker = MARKS.get(str(kind), "o")
            axes[0].plot(at.bifurcation_voltage, at.bifurcation_speed, marker, **mark)
            axes[1].plot(at.bifurcation_speed, at.bifurcation_amplitude, marker, **mark)
    speed, amplitude = (history_label(branches, name) for name in HISTORIES)
    axes[0].set(xlabel="voltage in V", ylabel=speed)
    axes[1].set(xlabel=speed, ylabel=amplitude)
    legend_below(figure, axes[:1])
    set_title(figure, title)
    return figure


def draw_branches(axes: Sequence[Axes], branches: xr.Dataset) -> None:
    """Draw stationary motions thick and pale under the ramps, dotted where unstable."""
    for name in branches.structure.values:
        for i, leg in enumerate(branches.leg.values):
            branch = branches.sel(structure=name, leg=leg)
            stable, known = branch.stable.values, np.isfinite(branch.voltage.values)
            for part, style, what in ((stable, "-", "stable"), (known & ~stable, ":", "unstable")):
                line: Any = {"color": COLOURS[name], "linewidth": 3.0, "alpha": 0.45, "zorder": 1}
                line["label"] = None if i else f"{name}, branch, {what}"
                voltage, speed, amplitude = (
                    np.where(part, branch[of].values, np.nan)
                    for of in ("voltage", "speed", "amplitude")
                )
                axes[0].plot(voltage, speed, style, **line)
                axes[1].plot(speed, amplitude, style, **line)


def running_mean(values: np.ndarray, count: int = IMPACT_REVOLUTIONS) -> np.ndarray:
    """Return the running mean of an array over ``count`` values."""
    return np.convolve(values, np.full(count, 1.0 / count), "valid")


def draw_impacts(axes: Axes, data: xr.Dataset, direction: str) -> None:
    """Draw the impacts per revolution over the speed in one direction, and their running mean."""
    speed, count = data.speed.values, data.impacts.values
    colour, style = (
        (COLOURS["delaminated"], "-") if direction == "there" else (COLOUR_OF_RETURN, "--")
    )
    axes.plot(speed, count, ".", markersize=2.0, color=colour, alpha=0.3)
    if len(count) > IMPACT_REVOLUTIONS:
        label = f"delaminated, {direction}, mean of {IMPACT_REVOLUTIONS}"
        line: Any = {"color": colour, "linewidth": 1.2, "label": label}
        axes.plot(running_mean(speed), running_mean(count), style, **line)
    if count.size and count.max() > 10.0:
        axes.set_yscale("log")
        write_plain_numbers(axes)


def mark_jumps(axes: Axes, data: xr.Dataset, name: str) -> None:
    """Mark the voltages of jumps by lines, undecided ones by a band."""
    for value in data.jumps.values:
        if np.isfinite(value):
            axes.axvline(value, color=COLOURS[name], linewidth=0.6, alpha=0.6)
    for direction in undecided_directions(data):
        at = data.sel(jump=direction)
        ends = float(at.jump_low), float(at.jump_high)
        if np.isfinite(ends).all():
            label = f"{name}, jump {direction} undecided"
            axes.axvspan(*ends, color=COLOURS[name], linewidth=0.0, alpha=0.15, label=label)


def draw_histories(axes: Axes, runs: Mapping[str, xr.Dataset], jump: str, what: str) -> None:
    """Draw speed or amplitude over time around one direction's jump, for all runs."""
    for name, data in runs.items():
        at = data.sel(jump=jump)
        if not has_jump(data, jump):
            continue
        span = TIME_AROUND_JUMP / omega_of(data)
        time = data.time.values - float(at.jump_time)
        near = np.abs(time) < span
        label = f"{name}, {float(at.jumps):.4f} V"
        axes.plot(time[near], data[what].values[near], color=COLOURS[name], label=label)
        axes.set_ylabel(history_label(data, what))
    axes.set_xlabel(f"time from the jump {jump} in s")
    legend_under(axes)


def draw_outward_powers(axes: Axes, data: xr.Dataset, name: str) -> None:
    """Draw the motor's mean power and where it goes over speed, until the voltage returns."""
    outward = split_directions(data)[0][0]
    if len(outward) < 3 * POWER_REVOLUTIONS:
        return
    part = data.isel(revolution=outward)
    ends = part.speed.values[1:]
    speed = running_mean(running_mean(ends, POWER_REVOLUTIONS), POWER_REVOLUTIONS)
    twice = {
        account: running_mean(values, POWER_REVOLUTIONS)
        for account, values in mean_powers(part).items()
    }
    draw_powers(axes, speed, twice)
    means = f"means of {POWER_REVOLUTIONS} revolutions, taken twice"
    axes.set_title(f"power on the way there, {name}\n{means}")


def history_label(data: xr.Dataset, name: str) -> str:
    """Return the axis label of speed or amplitude with its display unit."""
    return label_with_unit(HISTORIES[name], data[name])


def label_axes(axes: Sequence[Axes], data: xr.Dataset) -> None:
    """Label the four panels' axes."""
    speed, amplitude = (history_label(data, name) for name in HISTORIES)
    axes[0].set(xlabel="voltage in V", ylabel=speed)
    axes[1].set(xlabel=speed, ylabel=amplitude)
    axes[2].set(xlabel=speed, ylabel="impacts in a revolution")
    axes[3].set(xlabel=speed, ylabel="power in W")


def limit_axes(axes: Sequence[Axes], runs: Sequence[xr.Dataset]) -> None:
    """Limit the axes to the runs: the theory's curves extend beyond them."""

    def ends(name: str) -> tuple[float, float]:
        """Return the smallest and largest value of a variable in all runs."""
        values = np.concatenate([data[name].values for data in runs])
        return (values.min(), values.max()) if values.size else (0.0, 1.0)

    for panel, name in zip(axes[:2], ("voltage", "speed"), strict=True):
        low, high = ends(name)
        panel.set_xlim(low, high + 1e-3 * max(high - low, 1e-9))
    axes[0].set_ylim(*axes[1].get_xlim())
    axes[1].set_ylim(0.0, 1.05 * ends("amplitude")[1])
