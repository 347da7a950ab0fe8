"""Draw analyses of vibration records (FRF, PSD, orders, shock spectra), several in one picture."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import groupby
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..units import as_shown
from .labels import in_shown_units, plain_title
from .resonance import COLOURS as STRUCTURES
from .scales import label_with_unit, typeset_array_unit
from .style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    RED,
    make_panels,
    set_title,
    styled,
    write_plain_numbers,
)

Results = dict[str, xr.Dataset]  # by label
Reader = Callable[[xr.Dataset], xr.DataArray]
CHANNELS = {"box_acceleration": "box", "acceleration1": "mass 1", "acceleration2": "mass 2"}
COLOURS = (BLUE, RED, BLACK, ORANGE, GREEN, PURPLE)
DECADES = 6  # of an axis, below the largest value
FEW = 300.0  # largest over smallest value of an axis that has plain numbers
DEGREES = 180.0 / np.pi
NOTE_ENDS = {"left": (0.0, 0.4), "right": (0.6, 1.0), "center": (0.3, 0.7)}  # of a panel's width


@styled
def draw(
    data: xr.Dataset,
    label: str = "",
    others: Mapping[str, xr.Dataset] | None = None,
    title: str = "",
) -> Figure:
    """Draw an analysis' result, with those of further records for comparison; return the figure."""
    results = {label: data, **(others or {})}
    kind = data.attrs["analysis"]
    other = [name for name, result in results.items() if result.attrs["analysis"] != kind]
    if other:
        wrong = results[other[0]].attrs["analysis"]
        raise ValueError(f"others[{other[0]!r}]: result of {wrong}; expected one of {kind}")
    figure = DRAW[kind]({name: as_shown(result) for name, result in results.items()})
    set_title(figure, title or in_shown_units(data, plain_title(str(data.attrs["title"]))))
    return figure


# -- parts of pictures ----------------------------------------------------------------------------


def make_channel_grid(
    results: Results, rows: int, heights: tuple[float, ...]
) -> tuple[Figure, Any]:
    """Make a figure with a column for each measured mass; return it and the axes by channel."""
    every = channels_in(results)
    names = [name for name in every if name != "box_acceleration"] or every
    size = (5.4 * len(names), 0.6 + 2.0 * sum(heights))
    figure, axes = make_panels(
        rows, len(names), size, sharex=True, sharey="row", height_ratios=heights[:rows]
    )
    columns = {name: axes[i :: len(names)] for i, name in enumerate(names)}
    for name, column in columns.items():
        column[0].set_title(CHANNELS[name])
    return figure, columns


def first_result(results: Results) -> xr.Dataset:
    """Return the first record's result, whose display units the axes use."""
    return next(iter(results.values()))


def frequency_label(results: Results, words: str = "frequency") -> str:
    """Return a frequency axis' label with the display unit."""
    return label_with_unit(words, first_result(results).frequency)


def channels_in(results: Results) -> list[str]:
    """Return the names of the channels that any of the records has, the base first."""
    known = {str(name) for data in results.values() for name in data.channel.values}
    return [name for name in CHANNELS if name in known]


def iterate_records(results: Results, channel: str) -> Iterator[tuple[str, xr.Dataset, str]]:
    """Yield label, part of the result and colour of each record that has a channel."""
    colours = colours_by_label(results)
    for label, data in results.items():
        if channel in data.channel.values:
            yield label, data.sel(channel=channel), colours[label]


def colours_by_label(results: Results) -> dict[str, str]:
    """Return a dict from record label to line colour.

    Black is one labelled "measured"; a structure has the colour that it has in other pictures.
    """
    colours = {label: STRUCTURES[label] for label in results if label in STRUCTURES}
    free = [colour for colour in COLOURS if colour not in (BLACK, *colours.values())]
    for number, label in enumerate(label for label in results if label not in colours):
        measured = label.startswith("measured") and BLACK not in colours.values()
        colours[label] = BLACK if measured else free[number % len(free)]
    return colours


def add_legend(figure: Figure, axes: Axes, results: Results) -> None:
    """Add a legend with the records' labels below all panels, if they have labels."""
    if any(results):
        colours = colours_by_label(results)
        handles = [axes.plot([], [], color=colours[label])[0] for label in results]
        place: Any = {"loc": "outside lower right", "ncols": len(results)}
        figure.legend(handles, list(results), **place)


def limit_log_axis(axes: Axes, values: list[np.ndarray], decades: int = DECADES) -> None:
    """Set a logarithmic y axis that ends some decades below the largest value."""
    every = np.concatenate([np.ravel(array) for array in values])
    every = every[np.isfinite(every) & (every > 0.0)]
    axes.set_yscale("log")
    if len(every):
        top = float(every.max())
        low = max(0.7 * float(every.min()), 10.0**-decades * top)
        axes.set_ylim(min(low, 0.5 * top), 1.5 * top)
        if top < FEW * low:
            write_plain_numbers(axes)


def phase_in_degrees(phase: xr.DataArray) -> np.ndarray:
    """Convert a phase from rad to degrees in -270 to 90; NaN where the drawn line would jump."""
    degrees = (DEGREES * phase.values + 270.0) % 360.0 - 270.0
    jumps = np.flatnonzero(np.abs(np.diff(degrees)) > 180.0)
    degrees[jumps] = np.nan
    return np.asarray(degrees)


def note_hidden(axes: Axes, values: Mapping[str, list[np.ndarray]]) -> None:
    """Write into a panel the labels of records whose curves lie below its axis.

    The words stand where the lowest visible curve is highest.
    """
    low = axes.get_ylim()[0]
    hidden = [name for name, arrays in values.items() if np.nanmedian(np.hstack(arrays)) < low]
    if any(hidden):
        free = {align: lowest_curve(axes, *ends) for align, ends in NOTE_ENDS.items()}
        align = max(free, key=lambda each: free[each])
        place: Any = {"transform": axes.transAxes, "ha": align, "va": "bottom"}
        x = {"left": 0.01, "right": 0.99, "center": 0.5}[align]
        axes.text(x, 0.02, f"below this axis: {', '.join(hidden)}", fontsize=8, **place)


def lowest_curve(axes: Axes, begin: float, end: float) -> float:
    """Return the lowest height of a panel's visible curves between two parts of its width."""
    axes.autoscale_view(scaley=False)
    to_axes = axes.transData + axes.transAxes.inverted()
    points = np.concatenate([to_axes.transform(line.get_xydata()) for line in axes.lines])
    x, y = points.T
    inside = (x >= begin) & (x <= end) & (y >= 0.0)
    return float(y[inside].min()) if inside.any() else 1.0


def split_sweep(data: xr.Dataset) -> Iterator[tuple[xr.Dataset, str]]:
    """Yield the upward and downward parts of a swept-sine result, each with its line style."""
    rising = (data.sweep_rate.values >= 0.0).tolist()
    for up, numbers in groupby(range(len(rising)), key=rising.__getitem__):
        yield data.isel(time=list(numbers)), "-" if up else "--"


# -- pictures -------------------------------------------------------------------------------------


def draw_frf(results: Results) -> Figure:
    """Draw frequency response functions: magnitude (H1), phase and coherence; return the figure."""
    figure, columns = make_channel_grid(results, 3, (1.5, 0.9, 0.9))
    shown: list[np.ndarray] = []
    for channel, (magnitude, phase, coherence) in columns.items():
        for _, data, colour in iterate_records(results, channel):
            part = data.sel(estimator="H1").where(data.excited > 0)
            line: dict[str, Any] = {"color": colour, "linewidth": 1.0}
            magnitude.plot(part.frequency, part.magnitude, **line)
            phase.plot(part.frequency, phase_in_degrees(part.phase), **line)
            coherence.plot(part.frequency, part.coherence, **line)
            shown.append(part.magnitude.values)
        phase.set(ylim=(-280.0, 100.0), yticks=(-270, -180, -90, 0, 90))
        coherence.set(ylim=(-0.03, 1.03), xlabel=frequency_label(results))
    first = next(iter(columns.values()))
    for axes, word in zip(first, ("|H1|", "phase in degrees", "coherence"), strict=True):
        axes.set_ylabel(word)
    limit_log_axis(first[0], shown)
    first[0].set_ylabel("|H1|, mass over box")
    add_legend(figure, first[0], results)
    return figure


def draw_psd(results: Results) -> Figure:
    """Draw power spectral densities, a row per channel; return the figure."""
    names = channels_in(results)
    figure, axes = make_panels(len(names), 1, (9.0, 0.8 + 2.0 * len(names)), sharex=True)
    for channel, plane in zip(names, axes, strict=True):
        shown = []
        for label, data, colour in iterate_records(results, channel):
            rms = f"{float(data.rms):.4g} {typeset_array_unit(data.rms)} rms"
            words = f"{label + ': ' if label else ''}{rms}"
            plane.plot(data.frequency, data.psd, color=colour, linewidth=1.0, label=words)
            shown.append(data.psd.values[1:])
        limit_log_axis(plane, shown)
        plane.set_title(CHANNELS[channel])
        plane.set_ylabel(f"spectral density\nin {typeset_array_unit(first_result(results).psd)}")
        plane.legend(loc="upper right")
    axes[-1].set_xlabel(frequency_label(results))
    return figure


def draw_orders(results: Results) -> Figure:
    """Draw tracked orders' amplitudes over frequency, a row each, and the phase of order 1."""
    first = first_result(results)
    orders, unit = (
        [float(order) for order in first.order.values],
        typeset_array_unit(first.amplitude),
    )
    rows = [(f"order {n:g}\nin {unit}", make_order_reader(n, "amplitude", 1.0)) for n in orders]
    figure, columns = draw_frequency_rows(results, rows, (1.0,) * len(orders) + (0.8,))
    for channel, column in columns.items():
        for _, data, colour in iterate_records(results, channel):
            for part, style in split_sweep(data):
                phase = phase_in_degrees(select_order(part, 1.0).phase)
                column[-1].plot(part.frequency, phase, color=colour, linestyle=style, linewidth=1.0)
        column[-1].set(ylim=(-280.0, 100.0), yticks=(-270, -180, -90, 0, 90))
    next(iter(columns.values()))[-1].set_ylabel("phase of order 1\nin degrees")
    return figure


def draw_harmonics(results: Results) -> Figure:
    """Draw total harmonic distortion and the lowest harmonics over frequency; return the figure."""
    orders = [float(order) for order in first_result(results).order.values[:2]]
    rows: list[tuple[str, Reader]] = [("distortion\n(THD) in %", lambda x: 100.0 * x.distortion)]
    words = "order {:g}\nover order 1 in %"
    rows += [(words.format(n), make_order_reader(n, "ratio", 100.0)) for n in orders]
    return draw_frequency_rows(results, rows, (1.3,) + (1.0,) * len(orders))[0]


def make_order_reader(order: float, name: str, factor: float) -> Reader:
    """Return a function that takes one order's values, times a factor, from a result."""
    return lambda data: factor * select_order(data, order)[name]


def draw_frequency_rows(
    results: Results, rows: list[tuple[str, Reader]], heights: tuple[float, ...]
) -> tuple[Figure, Any]:
    """Draw rows of curves over a sweep's frequency, dashed for downward parts."""
    figure, columns = make_channel_grid(results, len(heights), heights)
    shown: list[dict[str, list[np.ndarray]]] = [{} for _ in rows]
    for channel, column in columns.items():
        for label, data, colour in iterate_records(results, channel):
            for part, style in split_sweep(data):
                line: dict[str, Any] = {"color": colour, "linestyle": style, "linewidth": 1.0}
                for axes, (_, values_of), values in zip(column, rows, shown, strict=False):
                    curve = values_of(part)
                    axes.plot(part.frequency, curve, **line)
                    values.setdefault(label, []).append(curve.values)
        column[-1].set_xlabel(frequency_label(results, "frequency of the excitation"))
    first = next(iter(columns.values()))
    for axes, (word, _), values in zip(first, rows, shown, strict=False):
        axes.set_ylabel(word)
        limit_log_axis(axes, [array for arrays in values.values() for array in arrays], 3)
        note_hidden(axes, values)
    add_legend(figure, first[0], results)
    return figure, columns


def select_order(data: xr.Dataset, order: float) -> xr.Dataset:
    """Return the part of a result for one order; NaN if that order was not tracked."""
    return data.reindex(order=[order]).isel(order=0)


def draw_spectrograms(results: Results) -> Figure:
    """Draw spectrograms in decibels: a row per channel, a column per record; return the figure."""
    names, count = channels_in(results), len(results)
    size = (1.2 + 4.2 * count, 0.8 + 2.2 * len(names))
    figure, axes = make_panels(len(names), count, size, sharex=True, sharey=True)
    top = max(float(data.amplitude.max()) for data in results.values()) or 1.0
    for row, channel in enumerate(names):
        for column, (label, data) in enumerate(results.items()):
            plane = axes[row * count + column]
            if channel not in data.channel.values:
                plane.set_axis_off()
                continue
            amplitude = data.amplitude.sel(channel=channel)
            levels = 20.0 * np.log10(np.maximum(amplitude / top, 1e-12))
            mesh = plane.pcolormesh(
                data.time, data.frequency, levels.T, vmin=-80.0, vmax=0.0, rasterized=True
            )
            plane.grid(visible=False)
            plane.set_title(", ".join(filter(None, [CHANNELS[channel], label])))
            if column == 0:
                plane.set_ylabel(frequency_label(results))
            if row == len(names) - 1:
                plane.set_xlabel("time in s")
    unit = typeset_array_unit(first_result(results).amplitude)
    figure.colorbar(mesh, ax=axes, label=f"amplitude in dB re {top:.3g} {unit}", aspect=40)
    return figure


def draw_shock_spectra(results: Results) -> Figure:
    """Draw maximax shock response spectra, residual ones as thin lines; return the figure."""
    names = channels_in(results)
    size = (1.0 + 3.6 * len(names), 4.4)
    figure, axes = make_panels(1, len(names), size, sharex=True, sharey=True)
    shown = []
    for channel, plane in zip(names, axes, strict=True):
        for _, data, colour in iterate_records(results, channel):
            plane.loglog(data.frequency, data.maximax, color=colour, linewidth=1.4)
            plane.loglog(data.frequency, data.residual, color=colour, linewidth=0.7, linestyle=":")
            shown.append(data.maximax.values)
        plane.set_title(f"{CHANNELS[channel]} (dotted: after the record)")
        plane.set_xlabel(frequency_label(results, "natural frequency"))
    damping, unit = (
        float(first_result(results).damping),
        typeset_array_unit(first_result(results).maximax),
    )
    axes[0].set_ylabel(f"largest acceleration in {unit}, damping ratio {100.0 * damping:g} %")
    limit_log_axis(axes[0], shown, 4)
    add_legend(figure, axes[0], results)
    return figure


def draw_densities(results: Results) -> Figure:
    """Draw probability densities over standard deviations, beside the Gaussian one."""
    names = channels_in(results)
    figure, axes = make_panels(1, len(names), (1.0 + 3.8 * len(names), 4.2), sharey=True)
    gauss = np.linspace(-4.5, 4.5, 181)
    for channel, plane in zip(names, axes, strict=True):
        bell = np.exp(-0.5 * gauss**2) / np.sqrt(2.0 * np.pi)
        plane.semilogy(gauss, bell, color=GREY, linestyle="--", linewidth=1.0, label="Gaussian")
        for label, data, colour in iterate_records(results, channel):
            sigma = float(data.standard_deviation) or 1.0
            numbers = f"skewness {float(data.skewness):.2f}, kurtosis {float(data.kurtosis):.2f}"
            words = f"{label + ': ' if label else ''}{numbers}"
            density = (sigma * data.density).where(data.density > 0.0)
            over = (data.acceleration - data["mean"]) / sigma
            plane.plot(over, density, color=colour, linewidth=1.1, label=words)
        plane.set_ylim(1e-5, 20.0)
        plane.set_title(CHANNELS[channel])
        plane.set_xlabel("acceleration in standard deviations")
        plane.legend(loc="upper right", fontsize=7)
    axes[0].set_ylabel("probability density")
    return figure


DRAW: dict[str, Callable[[Results], Figure]] = {
    "frf": draw_frf,
    "psd": draw_psd,
    "orders": draw_orders,
    "harmonics": draw_harmonics,
    "spectrogram": draw_spectrograms,
    "shock_spectrum": draw_shock_spectra,
    "probability_density": draw_densities,
}
