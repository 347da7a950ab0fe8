"""Draw analyses of vibration records (FRF, PSD, orders, shock spectra), several in one picture."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain, groupby
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..units import in_display_units
from .colours import BESIDES_RED, BLACK, BLUE, DIRECTION_STYLES, GREY, RED, STRUCTURES
from .kinds import draws
from .labels import convert_accelerations_in, expand_title
from .scales import label_with_unit, typeset_array_unit
from .style import draw_line, make_panels, set_plain_log_scale, set_title, styled

Results = dict[str, xr.Dataset]  # by label
Reader = Callable[[xr.Dataset], xr.DataArray]
CHANNEL_TITLES = {"box_acceleration": "box", "acceleration1": "mass 1", "acceleration2": "mass 2"}
COLOURS = (BLUE, RED, *BESIDES_RED[1:4])
PHASE = {"ylim": (-280.0, 100.0), "yticks": (-270, -180, -90, 0, 90)}  # an axis in degrees


@styled
def draw(
    data: xr.Dataset,
    label: str = "",
    others: Mapping[str, xr.Dataset] | None = None,
    title: str = "",
) -> Figure:
    results = {label: data, **(others or {})}
    kind = data.attrs["analysis"]
    for name, result in results.items():
        if (wrong := result.attrs["analysis"]) != kind:
            raise ValueError(f"others[{name!r}]: result of {wrong}; expected one of {kind}")
    figure = DRAW[kind]({name: in_display_units(result) for name, result in results.items()})
    words = convert_accelerations_in(expand_title(str(data.attrs["title"])), data)
    set_title(figure, title or words)
    return figure


# -- parts of pictures ----------------------------------------------------------------------------


def first_result(results: Results) -> xr.Dataset:
    return next(iter(results.values()))


def frequency_label(results: Results, words: str = "frequency") -> str:
    return label_with_unit(words, first_result(results).frequency)


def channel_names(results: Results) -> list[str]:
    known = {str(name) for data in results.values() for name in data.channel.values}
    return [name for name in CHANNEL_TITLES if name in known]


def iterate_channel(results: Results, channel: str) -> Iterator[tuple[str, xr.Dataset, str]]:
    colours = colours_by_label(results)
    for label, data in results.items():
        if channel in data.channel.values:
            yield label, data.sel(channel=channel), colours[label]


def colours_by_label(results: Results) -> dict[str, str]:
    colours = {label: STRUCTURES[label] for label in results if label in STRUCTURES}
    free = [colour for colour in COLOURS if colour not in colours.values()]
    for number, label in enumerate(label for label in results if label not in colours):
        measured = label.startswith("measured") and BLACK not in colours.values()
        colours[label] = BLACK if measured else free[number % len(free)]
    return colours


def add_legend(figure: Figure, axes: Axes, results: Results) -> None:
    if any(results):
        colours = colours_by_label(results)
        handles = [axes.plot([], [], color=colours[label])[0] for label in results]
        figure.legend(handles, list(results), loc="outside lower right", ncols=len(results))


def fit_log_axis_to(axes: Axes, values: list[np.ndarray], max_decades: int = 6) -> None:
    every = np.concatenate([np.ravel(array) for array in values])
    every = every[np.isfinite(every) & (every > 0.0)]
    axes.set_yscale("log")
    if len(every):
        top = float(every.max())
        low = max(0.7 * float(every.min()), 10.0**-max_decades * top)
        axes.set_ylim(min(low, 0.5 * top), 1.5 * top)
        if top < 300.0 * low:
            set_plain_log_scale(axes)


def phase_in_degrees(phase: xr.DataArray) -> xr.DataArray:
    """Convert a phase from rad to degrees in -270 to 90; NaN where the drawn line would jump."""
    degrees = ((180.0 / np.pi) * phase.values + 270.0) % 360.0 - 270.0
    degrees[np.flatnonzero(np.abs(np.diff(degrees)) > 180.0)] = np.nan
    return phase.copy(data=degrees)


def note_curves_below_axis(axes: Axes, curves: Mapping[str, list[np.ndarray]]) -> None:
    """Write above a panel the labels of curves whose medians lie below its axis."""
    low = axes.get_ylim()[0]
    hidden = [name for name, arrays in curves.items() if np.nanmedian(np.hstack(arrays)) < low]
    if any(hidden):
        axes.set_title(f"below this axis: {', '.join(hidden)}", loc="right", fontsize=8)


def split_sweep_by_direction(data: xr.Dataset) -> Iterator[tuple[xr.Dataset, str]]:
    """Yield the upward and downward parts of a swept-sine result, each with its line style."""
    if "sweep_rate" not in data:
        yield data, "-"
        return
    rising = (data.sweep_rate.values >= 0.0).tolist()
    for up, numbers in groupby(range(len(rising)), key=rising.__getitem__):
        yield data.isel(time=list(numbers)), DIRECTION_STYLES["up" if up else "down"]


# -- pictures -------------------------------------------------------------------------------------


class PanelRow(NamedTuple):
    """A row of curves over the frequency, a panel for each mass."""

    label: str
    height: float
    values: Reader
    axis: Mapping[str, Any] | None = None  # limits and ticks; by default logarithmic
    max_decades: int = 3  # of a logarithmic axis


def draw_frequency_rows(results: Results, rows: Sequence[PanelRow], x_words: str) -> Figure:
    """Draw rows of curves over the frequency, dashed for downward sweeps; return the figure."""
    every = channel_names(results)
    names = [name for name in every if name != "box_acceleration"] or every
    heights = [row.height for row in rows]
    size = (5.4 * len(names), 0.6 + 2.0 * sum(heights))
    shared: Any = {"sharex": True, "sharey": "row", "height_ratios": heights}
    figure, axes = make_panels(len(rows), len(names), size, **shared)
    shown: list[dict[str, list[np.ndarray]]] = [{} for _ in rows]
    for number, channel in enumerate(names):
        column = axes[number :: len(names)]
        for label, data, colour in iterate_channel(results, channel):
            for part, style in split_sweep_by_direction(data):
                for plane, row, values in zip(column, rows, shown, strict=True):
                    curve = row.values(part)
                    draw_line(plane, curve.frequency, curve, style, colour, 1.0)
                    values.setdefault(label, []).append(curve.values)
        column[0].set_title(CHANNEL_TITLES[channel])
        column[-1].set_xlabel(frequency_label(results, x_words))
    for plane, row, values in zip(axes[:: len(names)], rows, shown, strict=True):
        plane.set_ylabel(row.label)
        if row.axis is None:
            fit_log_axis_to(plane, [*chain.from_iterable(values.values())], row.max_decades)
            note_curves_below_axis(plane, values)
        else:
            plane.set(**row.axis)
    add_legend(figure, axes[0], results)
    return figure


def draw_frf(results: Results) -> Figure:
    """Draw frequency response functions: magnitude (H1), phase and coherence; return the figure."""

    def excited(name: str) -> Reader:
        return lambda data: data.sel(estimator="H1").where(data.excited > 0)[name]

    word = "force in 1/kg" if first_result(results).magnitude.units == "1/kg" else "box"
    phase = excited("phase")
    rows = (
        PanelRow(f"|H1|, mass over {word}", 1.5, excited("magnitude"), max_decades=6),
        PanelRow("phase in degrees", 0.9, lambda data: phase_in_degrees(phase(data)), PHASE),
        PanelRow("coherence", 0.9, excited("coherence"), {"ylim": (-0.03, 1.03)}),
    )
    return draw_frequency_rows(results, rows, "frequency")


def draw_psd(results: Results) -> Figure:
    names = channel_names(results)
    figure, axes = make_panels(len(names), 1, (9.0, 0.8 + 2.0 * len(names)), sharex=True)
    for channel, plane in zip(names, axes, strict=True):
        shown = []
        for label, data, colour in iterate_channel(results, channel):
            rms = f"{float(data.rms):.4g} {typeset_array_unit(data.rms)} rms"
            words = f"{label + ': ' if label else ''}{rms}"
            draw_line(plane, data.frequency, data.psd, "-", colour, 1.0, words)
            shown.append(data.psd.values[1:])
        fit_log_axis_to(plane, shown)
        plane.set_title(CHANNEL_TITLES[channel])
        plane.set_ylabel(f"spectral density\nin {typeset_array_unit(first_result(results).psd)}")
        plane.legend(loc="upper right")
    axes[-1].set_xlabel(frequency_label(results))
    return figure


def draw_orders(results: Results) -> Figure:
    first, words = first_result(results), "order {:g}\nin {}"
    unit = typeset_array_unit(first.amplitude)
    orders = map(float, first.order.values)
    rows = [PanelRow(words.format(n, unit), 1.0, order_reader(n, "amplitude")) for n in orders]
    phase = order_reader(1.0, "phase")
    label = "phase of order 1\nin degrees"
    rows.append(PanelRow(label, 0.8, lambda data: phase_in_degrees(phase(data)), PHASE))
    return draw_frequency_rows(results, rows, "frequency of the excitation")


def draw_harmonics(results: Results) -> Figure:
    words, orders = "order {:g}\nover order 1 in %", first_result(results).order.values[:2]
    rows = [PanelRow("distortion\n(THD) in %", 1.3, lambda data: 100.0 * data.distortion)]
    rows += [
        PanelRow(words.format(n), 1.0, order_reader(n, "ratio", 100.0)) for n in map(float, orders)
    ]
    return draw_frequency_rows(results, rows, "frequency of the excitation")


def order_reader(order: float, variable: str, factor: float = 1.0) -> Reader:
    """Return a function that takes one order's values, times a factor; NaN where it has none."""
    return lambda data: factor * data.reindex(order=[order]).isel(order=0)[variable]


def draw_spectrograms(results: Results) -> Figure:
    names, count = channel_names(results), len(results)
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
            limits: Any = {"vmin": -80.0, "vmax": 0.0, "rasterized": True}
            mesh = plane.pcolormesh(data.time, data.frequency, levels.T, **limits)
            plane.grid(visible=False)
            plane.set_title(", ".join(filter(None, [CHANNEL_TITLES[channel], label])))
            if column == 0:
                plane.set_ylabel(frequency_label(results))
            if row == len(names) - 1:
                plane.set_xlabel("time in s")
    unit = typeset_array_unit(first_result(results).amplitude)
    figure.colorbar(mesh, ax=axes, label=f"amplitude in dB re {top:.3g} {unit}", aspect=40)
    return figure


def draw_shock_spectra(results: Results) -> Figure:
    names = channel_names(results)
    size = (1.0 + 3.6 * len(names), 4.4)
    figure, axes = make_panels(1, len(names), size, sharex=True, sharey=True)
    shown = []
    for channel, plane in zip(names, axes, strict=True):
        for _, data, colour in iterate_channel(results, channel):
            plane.loglog(data.frequency, data.maximax, color=colour, linewidth=1.4)
            plane.loglog(data.frequency, data.residual, ":", color=colour, linewidth=0.7)
            shown.append(data.maximax.values)
        plane.set_title(f"{CHANNEL_TITLES[channel]} (dotted: after the record)")
        plane.set_xlabel(frequency_label(results, "natural frequency"))
    first = first_result(results)
    unit, damping = typeset_array_unit(first.maximax), f"{100.0 * float(first.damping):g} %"
    axes[0].set_ylabel(f"largest acceleration in {unit}, damping ratio {damping}")
    fit_log_axis_to(axes[0], shown, 4)
    add_legend(figure, axes[0], results)
    return figure


def draw_probability_densities(results: Results) -> Figure:
    names = channel_names(results)
    figure, axes = make_panels(1, len(names), (1.0 + 3.8 * len(names), 4.2), sharey=True)
    gauss = np.linspace(-4.5, 4.5, 181)
    for channel, plane in zip(names, axes, strict=True):
        bell = np.exp(-0.5 * gauss**2) / np.sqrt(2.0 * np.pi)
        plane.set_yscale("log")
        draw_line(plane, gauss, bell, "--", GREY, 1.0, "Gaussian")
        for label, data, colour in iterate_channel(results, channel):
            sigma = float(data.standard_deviation) or 1.0
            numbers = f"skewness {float(data.skewness):.2f}, kurtosis {float(data.kurtosis):.2f}"
            words = f"{label + ': ' if label else ''}{numbers}"
            density = (sigma * data.density).where(data.density > 0.0)
            over = (data.acceleration - data["mean"]) / sigma
            draw_line(plane, over, density, "-", colour, 1.1, words)
        plane.set_ylim(1e-5, 20.0)
        plane.set_title(CHANNEL_TITLES[channel])
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
    "probability_density": draw_probability_densities,
}
draws(*DRAW)(draw)
