"""Draw amplitude spectra under harmonic excitation, bonded beside delaminated."""

from __future__ import annotations

from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .labels import title_from_attributes
from .marks import draw_stems
from .scales import acceleration_scale, frequency_scale, has_frequency_unit
from .style import BLACK, BLUE, ORANGE, legend_below, make_panels, set_title, styled

SIDES: tuple[dict[str, dict[str, Any]], ...] = (  # left and right; a thin line lies on a wide one
    {"bonded": {"color": BLUE, "width": 2.6, "label": "bonded"}},
    {
        "delaminated": {"color": BLACK, "width": 2.6, "label": "delaminated"},
        "sampled": {
            "color": ORANGE,
            "width": 1.0,
            "label": "delaminated, sampled: without the impulses of the impacts",
        },
    },
)


@styled
def draw(data: xr.Dataset, title: str = "", mass: int = 1, decades: int = 4) -> Figure:
    """Draw spectra, one row per frequency, bonded left and delaminated right."""
    felt, unit = acceleration_scale(data)
    shown = data.acceleration.sel(mass=mass) / felt
    along = str(shown.dims[0])
    count = data.sizes[along]
    figure, axes = make_panels(
        count, 2, (9.6, 0.9 + 2.1 * count), sharex=not has_frequency_unit(data), sharey="row"
    )
    set_title(figure, title or title_from_attributes(data))
    for index in range(count):
        part = shown.isel({along: index})
        top = float(part.max()) or 1.0
        floor = 10.0**-decades * top
        for plane, kinds in zip(axes[2 * index : 2 * index + 2], SIDES, strict=True):
            draw_panel(plane, data, part, kinds, floor)
        axes[2 * index].set_ylim(floor, 2.0 * top)
        axes[2 * index].set_ylabel(f"acceleration\nof mass {mass} in {unit}")
    for plane in axes if has_frequency_unit(data) else axes[-2:]:
        unit = f"in {frequency_scale(data)[1]}" if has_frequency_unit(data) else r"over $\Omega$"
        plane.set_xlabel(f"frequency of the line {unit}")
    columns = sum(map(len, SIDES))
    left_out = f"what is below {10.0**-decades:g} of the largest line is left out"
    legend_below(figure, axes[:2], columns, title=left_out)
    return figure


def draw_panel(
    axes: Axes,
    data: xr.Dataset,
    amplitudes: xr.DataArray,
    kinds: dict[str, dict[str, Any]],
    floor: float,
) -> None:
    """Draw the spectra of one or both structures at one frequency."""
    si, (turn, unit) = has_frequency_unit(data), frequency_scale(data)
    speed = float(amplitudes.frequency)
    lines = data.order.values * (speed / turn if si else 1.0)
    for kind, style in kinds.items():
        if kind in data.kind.values:
            draw_stems(axes, lines, amplitudes.sel(kind=kind).values, floor, **style)
    frequency_text = (
        f"{speed / turn:.4g} {unit}" if si else rf"$\eta$ = {float(amplitudes.eta):.4g}"
    )
    axes.set_title(f"{next(iter(kinds))}, {frequency_text}")
    axes.set_xlim(0.0, 1.02 * float(lines.max()))
