"""Draw runs of the weak drive over time: speed, motion, power and, of passages, spectra."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ..constants import TURN
from ..units import display_scale_of, in_display_units
from .colours import BLACK, BLUE, GREY, STRUCTURES
from .scales import acceleration_scale, label_with_unit
from .style import draw_line, make_panels, styled

HISTORIES = {"speed": "mean speed", "amplitude": "amplitude of $x_1$"}
ROWS = {"speed": HISTORIES["speed"], "voltage": "voltage", **HISTORIES}
ROWS |= {"impacts": "impacts in a revolution"}
SINKS = {"dampers": "dampers of the masses", "box_damper": "damper of the box"}
SINKS |= {"impact_loss": "impacts"}
ACCOUNTS = ("motor", *SINKS, "stored")
POWER_REVOLUTIONS = 2  # that powers are averaged over: a motion may repeat after two
FLOOR = 1e-4  # of the largest line: the lower end of the colours


@styled
def draw_passage_histories(
    runs: Mapping[str, xr.Dataset], resonance: float, title: str = ""
) -> Figure:
    count, rows = len(runs), len(ROWS) + 1
    size = (6.5 * count, 2.6 * rows)
    figure, axes = make_panels(rows, count, size, title, sharex=True, sharey="row")
    shown = {name: in_display_units(data) for name, data in runs.items()}
    for column, (name, data) in enumerate(shown.items()):
        panels, time = axes[column::count], data.time.values
        for panel, what in zip(panels, ROWS, strict=False):
            style = "." if what == "impacts" else "-"
            points: Any = {"color": STRUCTURES.get(name, BLUE), "markersize": 2.5}
            panel.plot(time, data[what], style, linewidth=1.0, **points)
        dashed: Any = {"linewidth": 1.0, "linestyle": "--", "label": "resonance"}
        panels[0].axhline(resonance / display_scale_of(data, "rad/s")[0], color=GREY, **dashed)
        panels[0].set_title(f"{name}: {format_passage(data)}")
        middle = 0.5 * (time[POWER_REVOLUTIONS:] + time[:-POWER_REVOLUTIONS])
        draw_powers(panels[-1], middle, mean_powers(data))
        panels[-1].set_xlabel("time in s")
    for panel, (what, words) in zip(axes[::count], ROWS.items(), strict=False):
        panel.set_ylabel(words if what == "impacts" else label_with_unit(words, data[what]))
    axes[-count].set_ylabel("power in W")
    axes[0].legend(loc="best")
    axes[-count].legend(loc="best", fontsize=7)
    return figure


@styled
def draw_passage_with_spectra(
    runs: Mapping[str, xr.Dataset], spectra: Mapping[str, xr.Dataset], title: str = ""
) -> Figure:
    count = len(runs)
    size = (6.5 * count + 1.0, 14)
    figure, axes = make_panels(5, count, size, title, sharex="col", sharey="row")
    factor, unit = acceleration_scale(next(iter(runs.values())))
    top = max(float(spectrum.acceleration.max()) for spectrum in spectra.values()) / factor
    for column, (name, shown) in enumerate(runs.items()):
        data, panels = in_display_units(shown), axes[column::count]
        origin, words = time_origin(data)
        time = data.time.values - origin
        instant: Any = {"alpha": 0.6, "label": "at the instant"}
        panels[0].plot(time, np.abs(data.speed), color=BLUE, linewidth=0.4, **instant)
        mean_speed = mean_rate(data, np.abs(data.angle.values), 1)
        shown_speed = mean_speed / display_scale_of(data, "rad/s")[0]
        draw_line(panels[0], time, shown_speed, "-", BLACK, 1.2, "mean of a revolution")
        draw_line(panels[1], time, data.voltage, "-", BLACK, 1.0)
        draw_line(panels[2], time, data.x1, "-", STRUCTURES.get(name, BLUE), 0.3)
        twice = {x: mean_rate(data, data[x].values, POWER_REVOLUTIONS, 2) for x in ACCOUNTS}
        draw_powers(panels[3], time, twice)
        # without the slow motion below half the speed
        lines = spectra[name].sel(order=slice(0.25, None))
        values = (lines.acceleration.values.T / factor).clip(FLOOR * top)
        colours: Any = {"norm": LogNorm(FLOOR * top, top), "shading": "nearest"}
        mesh = panels[4].pcolormesh(lines.time - origin, lines.order, values, **colours)
        for panel in panels[:4]:
            panel.axvline(0.0, color=GREY, linewidth=0.8, zorder=0)
        panels[0].set_title(f"{name}: {format_jumps_or_passage(data)}")
        panels[3].set_title(f"means of {POWER_REVOLUTIONS} revolutions, taken twice")
        panels[4].set(xlabel=f"time {words} in s", xlim=(time[0], time[-1]))
    speed, displacement = label_with_unit("speed", data.speed), label_with_unit("$x_1$", data.x1)
    labels = (speed, "voltage in V", displacement, "power in W", "multiple of the speed")
    for panel, label in zip(axes[::count], labels, strict=True):
        panel.set_ylabel(label)
    for row in (0, 3):
        axes[row * count].legend(loc="best", fontsize=7)
    bar = f"amplitude of the acceleration in {unit}"
    figure.colorbar(mesh, ax=axes[4 * count :], label=bar, pad=0.01)
    return figure


# -- jumps in words -------------------------------------------------------------------------------


def has_jump(data: xr.Dataset, direction: str) -> bool:
    return bool(np.isfinite(float(data.jumps.sel(jump=direction))))


def undecided_directions(data: xr.Dataset) -> list[str]:
    decided = zip(data.jump.values, data.decided.values, strict=True)
    return [str(direction) for direction, decision in decided if decision == "undecided"]


def jump_texts(data: xr.Dataset) -> list[str]:
    known = [way for way in map(str, data.jump.values) if has_jump(data, way)]
    jumps = [f"{way} at {float(data.jumps.sel(jump=way)):.4f} V" for way in known]
    return jumps + [f"{way} undecided" for way in undecided_directions(data)]


def format_jumps_or_passage(data: xr.Dataset) -> str:
    return ", ".join(f"jump {text}" for text in jump_texts(data)) or format_passage(data)


def format_passage(data: xr.Dataset) -> str:
    passed = float(data.passage_time)
    if np.isfinite(passed):
        return f"beyond the resonance from {passed:.4g} s on"
    return "the resonance is not passed"


def time_origin(data: xr.Dataset) -> tuple[float, str]:
    """Return the time, s, at which a passage's axis has 0, and words for it: from the jump up."""
    jumps = data.jump_time.values
    known = np.flatnonzero(np.isfinite(jumps))
    if known.size:
        return float(jumps[known[0]]), f"from the jump {data.jump.values[known[0]]}"
    passed = float(data.passage_time)
    return (passed, "from the passage") if np.isfinite(passed) else (0.0, "from the start")


# -- powers ---------------------------------------------------------------------------------------


def draw_powers(axes: Axes, along: np.ndarray, powers: Mapping[str, np.ndarray]) -> None:
    """Draw the motor's power and its losses by account, over time or speed."""
    draw_line(axes, along, powers["motor"], "-", BLACK, 1.6, "motor")
    for account, label in SINKS.items():
        axes.plot(along, powers[account], linewidth=1.0, label=label)
    draw_line(axes, along, powers["stored"], "-", GREY, 1.0, "stored")


def mean_powers(revolutions: xr.Dataset) -> dict[str, np.ndarray]:
    names, lag = ("time", *ACCOUNTS), POWER_REVOLUTIONS
    span, *gained = (revolutions[x].values[lag:] - revolutions[x].values[:-lag] for x in names)
    return {account: energy / span for account, energy in zip(ACCOUNTS, gained, strict=True)}


def mean_rate(
    data: xr.Dataset, total: np.ndarray, revolutions: int, repeats: int = 1
) -> np.ndarray:
    """Return the rate of a total, averaged over revolutions, repeatedly; NaN at the ends."""
    from scipy.integrate import cumulative_trapezoid

    angle, time, half = np.abs(data.angle.values), data.time.values, 0.5 * revolutions * TURN
    distance = np.maximum.accumulate(angle)
    before, after = (np.interp(angle + side, distance, time) for side in (-half, half))
    for done in range(1, repeats + 1):
        known = (angle - done * half > distance[0]) & (angle + done * half < distance[-1])
        gained = np.interp(after, time, total) - np.interp(before, time, total)
        rate = np.where(known, gained / (after - before), np.nan)
        total = cumulative_trapezoid(np.nan_to_num(rate), time, initial=0.0)
    return rate
