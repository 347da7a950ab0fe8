"""The passage through the resonance: speed, motion, where the power goes, spectra over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ..constants import TURN
from .style import GREY, in_our_look, panels
from .weak_drive import COLOURS, SINKS

MOST = 4  # revolutions after which a motion is seen to repeat
CALM = 0.9  # of the revolutions: the others belong to the jump
FLOOR = 1e-4  # of the largest line: the lower end of the colours


@in_our_look
def draw(
    runs: Mapping[str, xr.Dataset], spectra: Mapping[str, xr.Dataset], title: str = ""
) -> Figure:
    """Draw passages, one a column.

    Parameters
    ----------
    runs : mapping of xarray.Dataset
        Of :func:`orchestrate.passage`, by what they are, such as ``"bonded"``.
    spectra : mapping of xarray.Dataset
        Of :func:`orchestrate.waterfall`, by the same names.
    title : str
        What is shown: set, rate, volts.
    """
    count = len(runs)
    figure, axes = panels(5, count, (6.5 * count + 1.0, 14), sharex="col", sharey="row")
    top = max(float(found.acceleration.max()) for found in spectra.values())
    for column, (name, data) in enumerate(runs.items()):
        begin, words = beginning(data)
        own = axes[column::count]
        period = repeats_after(data)
        means = over_revolutions(data, period)
        time = data.time.values - begin
        draw_speed(own[0], time, data, means)
        own[1].plot(time, data.voltage, color="k", linewidth=1.0)
        own[2].plot(time, data.x1, color=COLOURS.get(name, "C0"), linewidth=0.3)
        draw_powers(own[3], time, means)
        mesh = draw_waterfall(own[4], spectra[name], begin, top)
        for panel in own[:4]:
            panel.axvline(0.0, color=GREY, linewidth=0.8, zorder=0)
        own[0].set_title(f"{name}: {told(data)}")
        turns = "a revolution" if period == 1 else f"{period} revolutions"
        own[3].set_title(f"means of {turns}, twice")
        own[4].set_xlabel(f"time {words} in s")
        own[4].set_xlim(time[0], time[-1])
    labels = ("speed in rad/s", "voltage in V", "$x_1$ in m", "power in W", "multiple of the speed")
    for panel, label in zip(axes[::count], labels, strict=True):
        panel.set_ylabel(label)
    for row in (0, 3):
        axes[row * count].legend(loc="best", fontsize=7)
    bar = "amplitude of the acceleration in m/s$^2$"
    figure.colorbar(mesh, ax=axes[4 * count :], label=bar, pad=0.01)
    if title:
        figure.suptitle(title)
    return figure


def beginning(data: xr.Dataset) -> tuple[float, str]:
    """The time that counts as 0, and its name."""
    jumps = data.jump_time.values
    known = np.flatnonzero(np.isfinite(jumps))
    if known.size:
        return float(jumps[known[0]]), f"from the jump {data.jump.values[known[0]]}"
    passed = float(data.passage_time)
    return (passed, "from the passage") if np.isfinite(passed) else (0.0, "from the start")


def told(data: xr.Dataset) -> str:
    """The jumps in words, or whether the resonance is passed."""
    found = [
        f"jump {way} at {float(data.jumps.sel(jump=way)):.4f} V"
        for way in data.jump.values
        if np.isfinite(float(data.jumps.sel(jump=way)))
    ]
    pairs = zip(data.jump.values, data.decided.values, strict=True)
    found += [f"jump {way} undecided" for way, how in pairs if how == "undecided"]
    if found:
        return ", ".join(found)
    passed = float(data.passage_time)
    if np.isfinite(passed):
        return f"beyond the resonance from {passed:.4g} s on"
    return "the resonance is not passed"


def repeats_after(data: xr.Dataset) -> int:
    """Revolutions after which what is lost in impacts in each repeats best; 1 without impacts."""
    angle = np.maximum.accumulate(np.abs(data.angle.values))
    turns = ((angle - angle[0]) // TURN).astype(int)
    first = np.unique(turns, return_index=True)[1]
    lost = np.diff(data.impact_loss.values[first])
    if len(lost) < 4 * MOST or not lost.any():
        return 1
    changes = [np.sort(np.abs(lost[lag:] - lost[:-lag])) for lag in range(1, MOST + 1)]
    sizes = np.array([change[: int(CALM * len(change))].mean() for change in changes])
    return 1 + int(np.flatnonzero(sizes <= 2.0 * sizes.min())[0])


def over_revolutions(data: xr.Dataset, count: int = 1) -> dict[str, np.ndarray]:
    """Mean speed of the revolution around each sample, and mean powers of ``count`` revolutions,
    twice: of one that an impact enters a little late they would jump. NaN at the ends.
    """
    angle, powers = np.abs(data.angle.values), means_over(data, count)
    twice = {name: mean_again(angle, values, count) for name, values in powers.items()}
    return {**twice, "speed": means_over(data, 1)["speed"]}


def mean_again(angle: np.ndarray, means: np.ndarray, count: int) -> np.ndarray:
    """Means of ``count`` revolutions around each sample of what is NaN at the ends."""
    from scipy.integrate import cumulative_trapezoid

    far, half = np.maximum.accumulate(angle), 0.5 * count * TURN
    known = np.flatnonzero(np.isfinite(means))
    if not known.size:
        return means
    inner = slice(known[0], known[-1] + 1)
    total = cumulative_trapezoid(means[inner], far[inner], initial=0.0)
    before, after = (np.interp(angle + side, far[inner], total) for side in (-half, half))
    whole = (angle - half >= far[known[0]]) & (angle + half <= far[known[-1]])
    return np.where(whole, (after - before) / (2.0 * half), np.nan)


def means_over(data: xr.Dataset, count: int) -> dict[str, np.ndarray]:
    """Mean speed and powers of ``count`` revolutions around each sample; NaN at the ends."""
    angle, time, half = np.abs(data.angle.values), data.time.values, 0.5 * count * TURN
    far = np.maximum.accumulate(angle)
    before, after = (np.interp(angle + side, far, time) for side in (-half, half))
    span = after - before
    whole = (angle - half > far[0]) & (angle + half < far[-1])
    turned = np.interp(after, time, angle) - np.interp(before, time, angle)
    found = {"speed": turned / span}
    for account in ("motor", *SINKS, "stored"):
        values = data[account].values
        found[account] = (np.interp(after, time, values) - np.interp(before, time, values)) / span
    return {name: np.where(whole, values, np.nan) for name, values in found.items()}


def draw_speed(
    axes: Axes, time: np.ndarray, data: xr.Dataset, revolution: Mapping[str, np.ndarray]
) -> None:
    """The speed at each instant, and its mean over a revolution."""
    instant: Any = {"color": "C0", "linewidth": 0.4, "alpha": 0.6, "label": "at the instant"}
    axes.plot(time, np.abs(data.speed), **instant)
    mean: Any = {"color": "k", "linewidth": 1.2, "label": "mean of a revolution"}
    axes.plot(time, revolution["speed"], **mean)


def draw_powers(axes: Axes, time: np.ndarray, means: Mapping[str, np.ndarray]) -> None:
    """Where the motor's power goes, means of the motion's period."""
    axes.plot(time, means["motor"], "k", linewidth=1.6, label="motor")
    for account, label in SINKS.items():
        axes.plot(time, means[account], linewidth=1.0, label=label)
    axes.plot(time, means["stored"], color=GREY, linewidth=1.0, label="stored")


def draw_waterfall(axes: Axes, spectra: xr.Dataset, begin: float, top: float) -> Any:
    """Lines over time as colours; the slow swinging of the box below half the speed left out."""
    shown = spectra.sel(order=slice(0.25, None))
    values = shown.acceleration.values.T.clip(FLOOR * top)
    norm = LogNorm(FLOOR * top, top)
    return axes.pcolormesh(
        shown.time.values - begin, shown.order.values, values, norm=norm, shading="nearest"
    )
