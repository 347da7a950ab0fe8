"""Draw amplitude spectra as lines: under harmonic excitation, and on a motor at resonance."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..units import display_units_of, with_units
from .colours import BLACK, BLUE, ORANGE, STRUCTURES
from .kinds import draws
from .labels import format_frequency, frequency_scale, has_frequency_unit, title_from_attributes
from .scales import acceleration_scale, append_unit
from .style import add_figure_legend, make_panels, styled

LEAST_SHOWN = 1e-4  # of the largest line of a harmonic response
FLOOR = 1e-6  # of a motor's spectra: the lower end of the axis over the largest amplitude
SIDES: tuple[dict[str, tuple[str, float, str]], ...] = (  # a thin line lies on a wide one
    {"bonded": (BLUE, 2.6, "bonded")},
    {
        "delaminated": (BLACK, 2.6, "delaminated"),
        "sampled": (ORANGE, 1.0, "delaminated, sampled: without the impulses of the impacts"),
    },
)


def draw_stems(
    axes: Axes, x: np.ndarray, amplitudes: np.ndarray, floor: float, width: float, **style: Any
) -> None:
    """Draw a spectrum's lines as stems on a logarithmic axis that begins at a floor."""
    axes.set_yscale("log")
    shown = amplitudes > floor
    thin = min(1.0, (80 / (1 + int(shown.sum()))) ** 0.5)
    axes.vlines(x[shown], floor, amplitudes[shown], linewidth=width * thin, **style)


def acceleration_spectrum(
    displacement: np.ndarray, interval: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies, Hz, and acceleration amplitudes from displacements (Hann window)."""
    from scipy.signal import periodogram

    frequency, power = periodogram(displacement, 1.0 / interval, "hann", scaling="spectrum")
    return frequency, (2.0 * np.pi * frequency) ** 2 * np.sqrt(2.0 * power)


@draws("spectra")
@styled
def draw_spectra(data: xr.Dataset, title: str = "") -> Figure:
    (felt, unit), (turn, hertz) = acceleration_scale(data), frequency_scale(data)
    shown = data.acceleration.sel(mass=1) / felt
    along, with_unit = str(shown.dims[0]), has_frequency_unit(data)
    count, size = shown.sizes[along], (9.6, 0.9 + 2.1 * shown.sizes[along])
    title = title or title_from_attributes(data)
    figure, axes = make_panels(count, 2, size, title, sharex=not with_unit, sharey="row")
    for index in range(count):
        part = shown.isel({along: index})
        top = float(part.max()) or 1.0
        floor = LEAST_SHOWN * top
        at = float(part.frequency) / turn
        words = f"{at:.4g} {hertz}" if with_unit else rf"$\eta$ = {float(part.eta):.4g}"
        lines = data.order.values * (at if with_unit else 1.0)
        for plane, kinds in zip(axes[2 * index : 2 * index + 2], SIDES, strict=True):
            for kind, (colour, width, label) in kinds.items():
                if kind in data.kind.values:
                    values = part.sel(kind=kind).values
                    draw_stems(plane, lines, values, floor, width, color=colour, label=label)
            plane.set_title(f"{next(iter(kinds))}, {words}")
            plane.set_xlim(0.0, 1.02 * float(lines.max()))
        axes[2 * index].set_ylim(floor, 2.0 * top)
        axes[2 * index].set_ylabel(append_unit("acceleration\nof mass 1", unit))
    over = f"in {hertz}" if with_unit else r"over $\Omega$"
    for plane in axes if with_unit else axes[-2:]:
        plane.set_xlabel(f"frequency of the line {over}")
    left_out = f"what is below {LEAST_SHOWN:g} of the largest line is left out"
    add_figure_legend(figure, axes[:2], sum(map(len, SIDES)), title=left_out)
    return figure


@draws("drive_spectra")
@styled
def draw_drive_spectra(data: xr.Dataset, title: str = "") -> Figure:
    count = data.sizes["kind"]
    figure, axes = make_panels(count, 1, (10, 3.5 * count), title, sharex=True, sharey=True)
    turning = data if display_units_of(data).frequency else with_units(data, "rad/s")
    felt, unit = acceleration_scale(data)
    shown = data.acceleration.sel(mass=1) / felt
    top = float(shown.max())
    for panel, kind in zip(axes, map(str, data.kind.values), strict=True):
        values, colour = shown.sel(kind=kind).values, STRUCTURES[kind]
        draw_stems(panel, data.order.values, values, FLOOR * top, 1.5, color=colour)
        speed = format_frequency(turning, float(data.speed.sel(kind=kind)))
        panel.set(title=f"{kind}, {speed}", ylabel=append_unit("acceleration", unit))
        panel.set_ylim(FLOOR * top, 2.0 * top)
    axes[-1].set_xlabel(r"frequency over the motor's speed $\Omega$")
    return figure
