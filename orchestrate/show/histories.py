"""Draw time histories: motions, laboratory records and coupled runs, a panel per quantity."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..constants import TURN
from ..units import display_units_of, with_units
from . import labels
from .colours import BLACK, BLUE, GREY, RED
from .kinds import BONDED, draws
from .planes import gap_through_impacts, relative_motion
from .scales import acceleration_scale, append_unit, length_scale
from .spectra import acceleration_spectrum, draw_stems
from .style import (
    XI_REL,
    add_legend_above,
    draw_line,
    make_panels,
    set_title,
    styled,
    write_in_empty_panel,
)

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
COLUMNS = 400  # of an envelope


@draws("simulate", partner=BONDED)
@styled
def draw_motion(data: xr.Dataset, title: str = "", bonded: xr.Dataset | None = None) -> Figure:
    figure = Figure(figsize=(10.4, 6.8), layout="constrained")
    axes = figure.subplot_mosaic(LAYOUT, width_ratios=(2.2, 1))
    set_title(figure, title or labels.title_from_attributes(data))
    largest = {name: float(np.abs(data[name]).max()) for name in ("x1", "x2", "v1", "v2")}
    factor, unit = length_scale(data, max(largest["x1"], largest["x2"]))
    pace, speed_unit = length_scale(data, max(largest["v1"], largest["v2"]), "m/s")
    turns, instants = time_values_and_label(data, data)
    time, gap, gap_rate = gap_through_impacts(data)
    for number, style in MASSES:
        axes["masses"].plot(turns, data[f"x{number}"] / factor, **style)
        axes["phases"].plot(data[f"x{number}"] / factor, data[f"v{number}"] / pace, **style)
    draw_line(axes["gap"], np.interp(time, data.time, turns), gap / factor, "-", BLACK, 1.0)
    draw_line(axes["relative"], gap / factor, gap_rate / pace, "-", BLACK, 0.8)
    at, count = np.interp(data.impact_time.values, data.time.values, turns), data.sizes["impact"]
    label = f"{count} impact{'s' * (count != 1)}" if count else "no impacts"
    axes["gap"].plot(at, np.zeros_like(at), "|", color=RED, markersize=8, label=label)
    if float(data.contact_force.max()):
        draw_line(axes["force"], turns, data.contact_force, "-", BLACK, 1.0)
    else:
        write_in_empty_panel(axes["force"], "no permanent contact")
    top = draw_acceleration_spectra(axes["spectrum"], data, MASSES)
    if bonded is not None:
        axes["masses"].plot(time_values_and_label(data, bonded)[0], bonded.x1 / factor, **GLUED)
        axes["phases"].plot(bonded.x1 / factor, bonded.v1 / pace, **GLUED)
        alike = with_units(bonded, display_units_of(data))  # one axis has one unit
        top = max(top, draw_acceleration_spectra(axes["spectrum"], alike, (("1", GLUED),)))
    axes["spectrum"].set_ylim(SPECTRUM_FLOOR * (top or 1.0), 2.0 * (top or 1.0))
    axes["masses"].set_ylabel(append_unit("displacement", unit))
    axes["gap"].set_ylabel(append_unit(labels.gap_name(data), unit))
    axes["force"].set(ylabel="contact force in N", xlabel=instants, xlim=(turns[0], turns[-1]))
    for name, place, rate in (
        ("phases", "displacement", "velocity"),
        ("relative", "gap", "gap velocity"),
    ):
        axes[name].set(xlabel=append_unit(place, unit), ylabel=append_unit(rate, speed_unit))
    for name, columns in (("masses", 3), ("gap", 1)):
        axes[name].sharex(axes["force"])
        axes[name].tick_params(labelbottom=False)
        add_legend_above(axes[name], columns)
    return figure


def time_values_and_label(data: xr.Dataset, motion: xr.Dataset) -> tuple[np.ndarray, str]:
    """Return a motion's times in the display unit (periods or s), and the axis label."""
    if display_units_of(data).time == "s":
        return motion.time.values, "time in s"
    return motion.periods_done.values, "time in periods, $t/T$"


def draw_acceleration_spectra(
    axes: Axes, data: xr.Dataset, masses: Iterable[tuple[str, dict[str, Any]]]
) -> float:
    """Draw amplitude spectra of accelerations in the box; return the largest amplitude."""
    turns, time = data.periods_done.values, data.time.values
    periods = float(turns[-1] - turns[0])
    if periods < MIN_PERIODS:
        if not axes.texts:
            write_in_empty_panel(axes, f"a spectrum takes {MIN_PERIODS} periods")
            axes.set_xticks([])
        return 0.0
    base, top = periods / (time[-1] - time[0]), 0.0
    (turn, word), (felt, unit_felt) = labels.frequency_scale(data), acceleration_scale(data)
    for number, style in masses:
        moved = data[f"x{number}"].values[1:]
        frequency, amplitude = acceleration_spectrum(moved, time[1] - time[0])
        shown = (frequency > 0.25 * base) & (frequency <= 20.0 * base)
        # a window widens lines: of each, its largest amplitude
        peaks = shown & np.append(True, np.diff(amplitude) > 0.0)
        peaks &= np.append(np.diff(amplitude) <= 0.0, True)
        felt_amplitude = amplitude / felt
        highest = float(felt_amplitude[shown].max(initial=0.0))
        top = max(top, highest)
        lines = frequency * (TURN / turn if labels.has_frequency_unit(data) else 1.0 / base)
        stem = {name: style[name] for name in ("color", "alpha", "zorder") if name in style}
        floor = 1e-3 * SPECTRUM_FLOOR * highest  # unseen
        width = STEM_WIDTHS[style["color"]]
        draw_stems(axes, lines[peaks], felt_amplitude[peaks], floor, width, **stem)
    unit = f"in {word}" if labels.has_frequency_unit(data) else r"over $\Omega/2\pi$"
    axes.set(xlabel=f"frequency {unit}", ylabel=append_unit("acceleration", unit_felt))
    return top


@draws("shake", partner=BONDED)
@styled
def draw_shake(data: xr.Dataset, title: str = "", bonded: xr.Dataset | None = None) -> Figure:
    words = str(data.attrs.get("excitation_description") or data.attrs["excitation"])
    excitation = labels.convert_accelerations_in(words, data)
    title = title or f"{excitation}; {labels.title_from_attributes(data)}"
    heights: Any = {"sharex": True, "height_ratios": (1.0, 1.6, 1.2, 1.2)}
    figure, (box, masses, gap, impacts) = make_panels(4, 1, (10.4, 7.2), title, **heights)
    scale, unit = acceleration_scale(data)
    draw_excitation(box, data)
    draw_gap_and_impacts(data, gap, impacts)
    for i, colour in ((1, BLUE), (2, RED)):
        draw_signal(masses, data, f"a{i}_abs", scale, color=colour, label=f"mass {i}", alpha=0.55)
    if bonded is not None:
        time, low, high = signal_envelope(bonded.time.values, bonded.a1_abs.values / scale)
        draw_line(masses, time, high, "-", BLACK, 0.9, "both, bonded")
        draw_line(masses, time, low, "-", BLACK, 0.9)
    masses.set_ylabel(append_unit("acceleration\nof masses", unit))
    add_legend_above(masses, 3)
    impacts.set(xlabel="time in s", xlim=(0.0, float(data.time[-1])))
    return figure


@draws("cosimulate")
@styled
def draw_cosimulation(data: xr.Dataset, title: str = "") -> Figure:
    names = [str(name) for name in data.attrs["recorded"].split(",") if name]
    count = (4 if "x1" in data else 1) + len(names)
    title = title or f"{data.attrs['drive']}; {labels.title_from_attributes(data)}"
    figure, rows = make_panels(count, 1, (10.4, 1.2 + 1.6 * count), title, sharex=True)
    draw_excitation(rows[0], data)
    if "x1" in data:
        draw_gap_and_impacts(data, rows[2], rows[3])
        factor, unit = length_scale(data, float(abs(data.x1).max()))
        for name, colour in (("x1", BLUE), ("x2", RED)):
            draw_signal(rows[1], data, name, factor, color=colour, label=f"mass {name[1]}")
        rows[1].set_ylabel(append_unit("displacement", unit, "\n"))
        add_legend_above(rows[1], 2)
    for axes, name in zip(rows[count - len(names) :], names, strict=True):
        draw_signal(axes, data, name, 1.0, color=BLACK)
        unit = str(data[name].attrs["units"])
        axes.set_ylabel(name if unit == "1" else f"{name}\nin {unit}")
    rows[-1].set(xlabel="time in s", xlim=(0.0, float(data.time[-1])))
    return figure


def draw_excitation(panel: Axes, data: xr.Dataset) -> None:
    if force := next((name for name in ("force1", "force2") if name in data), ""):
        draw_signal(panel, data, force, 1.0, color=BLACK)
        panel.set_ylabel(f"force on\nmass {force[-1]} in N")
    else:
        scale, unit = acceleration_scale(data)
        draw_signal(panel, data, "box_acceleration", scale, color=BLACK)
        panel.set_ylabel(append_unit("acceleration\nof box", unit))


def draw_gap_and_impacts(data: xr.Dataset, gap: Axes, impacts: Axes) -> None:
    factor, unit = length_scale(data, float(data.x_rel.max()))
    draw_signal(gap, data, "x_rel", factor, color=BLACK)
    gap.set_ylabel(append_unit("gap", unit))
    impacts.set_ylabel("impulse in N s")
    if count := data.sizes["impact"]:
        size = 5 if count < COLUMNS else 2
        impacts.plot(data.impact_time, data.impulse, ".", color=RED, markersize=size)
        impacts.set_ylim(bottom=0.0)
    else:
        write_in_empty_panel(impacts, "no impacts")


def draw_signal(axes: Axes, data: xr.Dataset, name: str, divisor: float, **style: Any) -> None:
    """Draw a signal as a line; a long one as the area between its extremes."""
    time, values = data[data[name].dims[0]].values, data[name].values / divisor
    if len(time) <= 5000:
        axes.plot(time, values, linewidth=1.0, **{**style, "alpha": 1.0})
    else:
        axes.fill_between(*signal_envelope(time, values), linewidth=0.4, **style)


def signal_envelope(
    time: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Split a signal into equal parts; return each part's time, smallest and largest value."""
    edges = np.linspace(0, len(time), min(COLUMNS, len(time)) + 1).astype(int)[:-1]
    return time[edges], np.minimum.reduceat(values, edges), np.maximum.reduceat(values, edges)


@styled
def draw_paper_histories(data: xr.Dataset) -> Figure:
    """Draw the gap over periods, a panel per response, and the excitation below (Figure 7)."""
    count, turns = data.sizes["panel"], np.zeros(1)
    figure, axes = make_panels(count + 1, 1, (8.5, 1.6 * (count + 1)), sharex=True)
    for index, plane in enumerate(axes[:count]):
        eta = float(data.eta[index])
        tau, gap, _ = relative_motion(data, index)
        turns = tau * eta / TURN
        draw_line(plane, turns, gap, "-", BLACK, 0.9)
        kind = f"{labels.format_period(index + 1)}-periodic, one impact in a response period"
        plane.set(ylabel=XI_REL, title=rf"$\eta = {eta:.3f}$: {kind}")
        plane.ticklabel_format(axis="y", scilimits=(-2, 3))
    draw_line(axes[-1], turns, np.sin(TURN * turns), "-", BLUE, 0.9)
    axes[-1].set(ylabel=r"$\sin\eta\tau$", xlabel=r"$\tau/T$", xlim=(0, round(turns[-1])))
    return figure
