"""Draw a motion in time: displacements, gap, contact force, phase planes and spectrum."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..constants import TURN
from ..units import units_of, with_units
from .labels import gap_name, title_from_attributes
from .marks import draw_stems
from .scales import acceleration_scale, frequency_scale, has_frequency_unit, length_scale
from .style import BLACK, BLUE, GREY, RED, set_title, styled, write_in_panel

LAYOUT: list[Any] = [["masses", "phases"], ["gap", "relative"], ["force", "spectrum"]]
MASSES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("1", {"color": BLUE, "linewidth": 1.4, "label": "mass 1"}),
    ("2", {"color": RED, "linewidth": 1.0, "linestyle": "--", "label": "mass 2"}),
)
GLUED: dict[str, Any] = {"color": GREY, "linewidth": 3.0, "alpha": 0.6, "zorder": 1}
GLUED["label"] = "both, bonded"
STEM_WIDTHS = {GREY: 5.0, BLUE: 2.6, RED: 1.0}  # a thin line lies on a wide one
SPECTRUM_FLOOR = 1e-5  # of the largest line: the lower end of the axis
MIN_PERIODS = 4  # periods that a spectrum takes


@styled
def draw(data: xr.Dataset, title: str = "", bonded: xr.Dataset | None = None) -> Figure:
    """Draw a simulated motion: histories, phase planes and spectrum; return the figure."""
    figure = Figure(figsize=(10.4, 6.8), layout="constrained")
    axes = figure.subplot_mosaic(LAYOUT, width_ratios=(2.2, 1))
    set_title(figure, title or title_from_attributes(data))
    reach = max(float(np.abs(data[name]).max()) for name in ("x1", "x2"))
    factor, letter = length_scale(data, reach)
    draw_histories(axes, data, factor, letter)
    draw_phase_planes(axes["phases"], axes["relative"], data, factor, letter)
    top = draw_spectrum(axes["spectrum"], data, MASSES)
    if bonded is not None:
        axes["masses"].plot(time_axis(data, bonded)[0], bonded.x1 / factor, **GLUED)
        axes["phases"].plot(
            bonded.x1 / factor, bonded.v1 / length_scale(data, largest_speed(data))[0], **GLUED
        )
        alike = with_units(bonded, units_of(data))  # one axis has one unit
        top = max(top, draw_spectrum(axes["spectrum"], alike, (("1", GLUED),)))
    axes["spectrum"].set_ylim(SPECTRUM_FLOOR * (top or 1.0), 2.0 * (top or 1.0))
    above: Any = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.2}
    axes["masses"].legend(ncols=3, **above)
    axes["gap"].legend(**above)
    return figure


def draw_histories(axes: Mapping[str, Axes], data: xr.Dataset, factor: float, letter: str) -> None:
    """Draw both displacements, the gap with its impacts, and the contact force over time."""
    turns, instants = time_axis(data, data)
    time, gap, _ = relative_motion(data)
    for number, style in MASSES:
        axes["masses"].plot(turns, data[f"x{number}"] / factor, **style)
    axes["masses"].set_ylabel(f"displacement in {letter}m")
    at = np.interp(data.impact_time.values, data.time.values, turns)
    axes["gap"].plot(np.interp(time, data.time, turns), gap / factor, color=BLACK, linewidth=1.0)
    axes["gap"].set_ylabel(f"{gap_name(data)} in {letter}m")
    count = data.sizes["impact"]
    label = f"{count} impact{'s' * (count != 1)}" if count else "no impacts"
    axes["gap"].plot(at, np.zeros_like(at), "|", color=RED, markersize=8, label=label)
    axes["force"].set(ylabel="contact force in N", xlabel=instants)
    if float(data.contact_force.max()):
        axes["force"].plot(turns, data.contact_force, color=BLACK, linewidth=1.0)
    else:
        write_in_panel(axes["force"], "no permanent contact")
    for name in ("masses", "gap"):
        axes[name].sharex(axes["force"])
        axes[name].tick_params(labelbottom=False)
    axes["force"].set_xlim(turns[0], turns[-1])


def time_axis(data: xr.Dataset, motion: xr.Dataset) -> tuple[np.ndarray, str]:
    """Return a motion's times in the display unit (periods or s), and the axis label."""
    if units_of(data).time == "s":
        return motion.time.values, "time in s"
    return motion.periods_done.values, "time in periods, $t/T$"


def draw_phase_planes(
    masses: Axes, plane: Axes, data: xr.Dataset, factor: float, letter: str
) -> None:
    """Draw the phase planes of both masses and of their relative motion."""
    slow, prefixed = length_scale(data, largest_speed(data))
    for number, style in MASSES:
        masses.plot(data[f"x{number}"] / factor, data[f"v{number}"] / slow, **style)
    masses.set(xlabel=f"displacement in {letter}m", ylabel=f"velocity in {prefixed}m/s")
    _, gap, rate = relative_motion(data)
    plane.plot(gap / factor, rate / slow, color=BLACK, linewidth=0.8)
    plane.set(xlabel=f"gap in {letter}m", ylabel=f"gap velocity in {prefixed}m/s")


def largest_speed(data: xr.Dataset) -> float:
    """Return the largest speed of either mass, m/s."""
    return max(float(np.abs(data[name]).max()) for name in ("v1", "v2"))


def relative_motion(data: xr.Dataset) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time, gap and gap velocity, with points before and after each impact (14)."""
    at, closing = data.impact_time.values, data.impact_velocity.values
    after = np.where(data.sticks.values == 1, 0.0, float(data.attrs.get("e", 0.0)) * closing)
    time = np.concatenate([data.time.values, at, at])
    gap = np.concatenate([data.x_rel.values, 0.0 * at, 0.0 * at])
    rate = np.concatenate([data.v_rel.values, -closing, after])
    order = np.argsort(time, kind="stable")
    return time[order], gap[order], rate[order]


def draw_spectrum(
    axes: Axes, data: xr.Dataset, masses: Iterable[tuple[str, dict[str, Any]]], highest: float = 20
) -> float:
    """Draw amplitude spectra of accelerations in the box; return the largest amplitude."""
    turns, time = data.periods_done.values, data.time.values
    periods = float(turns[-1] - turns[0])
    if periods < MIN_PERIODS:
        if not axes.texts:
            write_in_panel(axes, f"a spectrum takes {MIN_PERIODS} periods")
            axes.set_xticks([])
        return 0.0
    base, top = periods / (time[-1] - time[0]), 0.0
    (turn, word), (felt, unit_felt) = frequency_scale(data), acceleration_scale(data)
    for number, style in masses:
        frequency, amplitude = acceleration_spectrum(
            data[f"x{number}"].values[1:], time[1] - time[0]
        )
        shown = (frequency > 0.25 * base) & (frequency <= highest * base)
        felt_amplitude = amplitude / felt
        top = max(top, float(felt_amplitude[shown].max(initial=0.0)))
        lines = frequency * (TURN / turn if has_frequency_unit(data) else 1.0 / base)
        peaks = shown & is_local_maximum(amplitude)
        stem = {name: style[name] for name in ("color", "alpha", "zorder") if name in style}
        floor = 1e-3 * SPECTRUM_FLOOR * float(felt_amplitude[shown].max(initial=0.0))  # unseen
        width = STEM_WIDTHS[style["color"]]
        draw_stems(axes, lines[peaks], felt_amplitude[peaks], floor, width, **stem)
    unit = f"in {word}" if has_frequency_unit(data) else r"over $\Omega/2\pi$"
    axes.set(xlabel=f"frequency {unit}", ylabel=f"acceleration in {unit_felt}")
    return top


def is_local_maximum(amplitude: np.ndarray) -> np.ndarray:
    """Return a Boolean array: amplitudes larger than both neighbours (a window widens lines)."""
    above = np.full(len(amplitude), True)
    above[1:] &= amplitude[1:] > amplitude[:-1]
    above[:-1] &= amplitude[:-1] >= amplitude[1:]
    return above


def acceleration_spectrum(
    displacement: np.ndarray, interval: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies, Hz, and acceleration amplitudes from displacements (Hann window).

    An impulse is a kink of the displacement, so it is in them.
    """
    from scipy.signal import periodogram

    frequency, power = periodogram(displacement, 1.0 / interval, "hann", scaling="spectrum")
    return frequency, (2.0 * np.pi * frequency) ** 2 * np.sqrt(2.0 * power)
