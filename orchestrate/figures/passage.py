"""Draw a passage through the resonance: speed, motion, powers and spectra over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ..constants import TURN
from ..units import as_shown, scale_of
from .powers import ACCOUNTS, draw_powers
from .scales import acceleration_scale, label_with_unit
from .style import BLUE, GREY, make_panels, set_title, styled
from .weak_drive import COLOURS, format_passage, jump_texts

MAX_REPETITION = 4  # revolutions after which a motion is seen to repeat
CALM_SHARE = 0.9  # of the revolutions: the others belong to the jump
FLOOR = 1e-4  # of the largest line: the lower end of the colours


@styled
def draw(
    runs: Mapping[str, xr.Dataset], spectra: Mapping[str, xr.Dataset], title: str = ""
) -> Figure:
    """Draw passages, one column per structure; return the figure."""
    count = len(runs)
    figure, axes = make_panels(5, count, (6.5 * count + 1.0, 14), sharex="col", sharey="row")
    shown = {name: as_shown(data) for name, data in runs.items()}
    felt, unit = acceleration_scale(next(iter(runs.values())))
    top = max(float(spectrum.acceleration.max()) for spectrum in spectra.values()) / felt
    for column, (name, data) in enumerate(shown.items()):
        begin, words = time_origin(data)
        column_axes = axes[column::count]
        period = repeats_after(data)
        means = revolution_means(data, period)
        time = data.time.values - begin
        draw_speed(column_axes[0], time, data, means)
        column_axes[1].plot(time, data.voltage, color="k", linewidth=1.0)
        column_axes[2].plot(time, data.x1, color=COLOURS.get(name, BLUE), linewidth=0.3)
        draw_powers(column_axes[3], time, means)
        mesh = draw_waterfall(column_axes[4], spectra[name], begin, felt, top)
        for panel in column_axes[:4]:
            panel.axvline(0.0, color=GREY, linewidth=0.8, zorder=0)
        column_axes[0].set_title(f"{name}: {format_jumps(data)}")
        turns = "a revolution" if period == 1 else f"{period} revolutions"
        column_axes[3].set_title(f"averaged over {turns}, twice")
        column_axes[4].set_xlabel(f"time {words} in s")
        column_axes[4].set_xlim(time[0], time[-1])
    speed, displacement = label_with_unit("speed", data.speed), label_with_unit("$x_1$", data.x1)
    labels = (speed, "voltage in V", displacement, "power in W", "multiple of the speed")
    for panel, label in zip(axes[::count], labels, strict=True):
        panel.set_ylabel(label)
    for row in (0, 3):
        axes[row * count].legend(loc="best", fontsize=7)
    bar = f"amplitude of the acceleration in {unit}"
    figure.colorbar(mesh, ax=axes[4 * count :], label=bar, pad=0.01)
    set_title(figure, title)
    return figure


def time_origin(data: xr.Dataset) -> tuple[float, str]:
    """Return the time, s, at which a passage's axis has 0, and its name."""
    jumps = data.jump_time.values
    known = np.flatnonzero(np.isfinite(jumps))
    if known.size:
        return float(jumps[known[0]]), f"from the jump {data.jump.values[known[0]]}"
    passed = float(data.passage_time)
    return (passed, "from the passage") if np.isfinite(passed) else (0.0, "from the start")


def format_jumps(data: xr.Dataset) -> str:
    """Format a run's jumps for a title, or whether it passes the resonance."""
    return ", ".join(f"jump {text}" for text in jump_texts(data)) or format_passage(data)


def repeats_after(data: xr.Dataset) -> int:
    """Return the number of revolutions after which impact losses repeat best; 1 without any."""
    angle = np.maximum.accumulate(np.abs(data.angle.values))
    turns = ((angle - angle[0]) // TURN).astype(int)
    first = np.unique(turns, return_index=True)[1]
    lost = np.diff(data.impact_loss.values[first])
    if len(lost) < 4 * MAX_REPETITION or not lost.any():
        return 1
    changes = [np.sort(np.abs(lost[lag:] - lost[:-lag])) for lag in range(1, MAX_REPETITION + 1)]
    sizes = np.array([change[: int(CALM_SHARE * len(change))].mean() for change in changes])
    return 1 + int(np.flatnonzero(sizes <= 2.0 * sizes.min())[0])


def revolution_means(data: xr.Dataset, count: int = 1) -> dict[str, np.ndarray]:
    """Return running means: speed over one revolution, powers over ``count``; NaN at ends.

    Means of powers are averaged twice: single ones would jump when an impact enters a little late.
    """
    angle, powers = np.abs(data.angle.values), means_over(data, count)
    twice = {name: smooth_edges(angle, values, count) for name, values in powers.items()}
    return {**twice, "speed": means_over(data, 1)["speed"]}


def smooth_edges(angle: np.ndarray, means: np.ndarray, count: int) -> np.ndarray:
    """Return means over ``count`` revolutions, averaged once more; NaN at the ends."""
    from scipy.integrate import cumulative_trapezoid

    distance, half = np.maximum.accumulate(angle), 0.5 * count * TURN
    known = np.flatnonzero(np.isfinite(means))
    if not known.size:
        return means
    inner = slice(known[0], known[-1] + 1)
    total = cumulative_trapezoid(means[inner], distance[inner], initial=0.0)
    before, after = (np.interp(angle + side, distance[inner], total) for side in (-half, half))
    complete = (angle - half >= distance[known[0]]) & (angle + half <= distance[known[-1]])
    return np.where(complete, (after - before) / (2.0 * half), np.nan)


def means_over(data: xr.Dataset, count: int) -> dict[str, np.ndarray]:
    """Return moving means of motor speed and powers over ``count`` revolutions, NaN at ends."""
    angle, time, half = np.abs(data.angle.values), data.time.values, 0.5 * count * TURN
    distance = np.maximum.accumulate(angle)
    before, after = (np.interp(angle + side, distance, time) for side in (-half, half))
    span = after - before
    complete = (angle - half > distance[0]) & (angle + half < distance[-1])
    turned = np.interp(after, time, angle) - np.interp(before, time, angle)
    means = {"speed": turned / span}
    for account in ACCOUNTS:
        values = data[account].values
        means[account] = (np.interp(after, time, values) - np.interp(before, time, values)) / span
    return {name: np.where(complete, values, np.nan) for name, values in means.items()}


def draw_speed(
    axes: Axes, time: np.ndarray, data: xr.Dataset, revolution: Mapping[str, np.ndarray]
) -> None:
    """Draw the speed at each instant and its mean over a revolution."""
    instant: Any = {"color": BLUE, "linewidth": 0.4, "alpha": 0.6, "label": "at the instant"}
    axes.plot(time, np.abs(data.speed), **instant)
    mean: Any = {"color": "k", "linewidth": 1.2, "label": "mean of a revolution"}
    axes.plot(time, revolution["speed"] / scale_of(data, "rad/s")[0], **mean)


def draw_waterfall(axes: Axes, spectra: xr.Dataset, begin: float, felt: float, top: float) -> Any:
    """Draw spectra over time as colours, without the slow motion below half the speed."""
    shown = spectra.sel(order=slice(0.25, None))
    values = (shown.acceleration.values.T / felt).clip(FLOOR * top)
    norm = LogNorm(FLOOR * top, top)
    return axes.pcolormesh(
        shown.time.values - begin, shown.order.values, values, norm=norm, shading="nearest"
    )
