"""Draw acceleration spectra on a motor at resonance (Figure 3), bonded above delaminated."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from ..units import units_of, with_units
from .labels import format_frequency
from .marks import draw_stems
from .scales import acceleration_scale
from .style import make_panels, set_title, styled
from .weak_drive import COLOURS

FLOOR = 1e-6  # of the largest amplitude: the lower end of the axis


@styled
def draw(data: xr.Dataset, mass: int = 1, title: str = "") -> Figure:
    """Draw one mass' acceleration spectra of both structures, one below the other."""
    count = data.sizes["kind"]
    figure, axes = make_panels(count, 1, (10, 3.5 * count), sharex=True, sharey=True)
    turning = data if units_of(data).frequency else with_units(data, "rad/s")
    felt, unit = acceleration_scale(data)
    shown = data.acceleration.sel(mass=mass) / felt
    top = float(shown.max())
    for panel, kind in zip(axes, map(str, data.kind.values), strict=True):
        amplitude = shown.sel(kind=kind).values
        draw_stems(panel, data.order.values, amplitude, FLOOR * top, color=COLOURS[kind])
        speed = format_frequency(turning, float(data.speed.sel(kind=kind)))
        panel.set(title=f"{kind}, {speed}", ylabel=f"acceleration in {unit}")
        panel.set_ylim(FLOOR * top, 2.0 * top)
    axes[-1].set_xlabel(r"frequency over the motor's speed $\Omega$")
    set_title(figure, title)
    return figure
