"""Amplitude spectra under harmonic excitation, bonded against delaminated."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from .style import BLACK, BLUE, RED, in_our_look, panels

FLOOR = 1e-4  # of the largest amplitude: the lower end of the axis
LINES = {  # by kind, in the order of drawing: colour, width, label
    "delaminated": (BLACK, 0.9, "delaminated"),
    "sampled": (RED, 0.6, "delaminated, sampled acceleration"),
    "bonded": (BLUE, 1.6, "bonded"),
}


@in_our_look
def draw(data: xr.Dataset, mass: int = 1) -> Figure:
    """One panel a frequency.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.spectra`.
    mass : int
        1 or 2.
    """
    along = data.acceleration.dims[0]
    count = data.sizes[along]
    figure, axes = panels(count, 1, (11, 3.0 * count), sharex=True)
    for index, plane in enumerate(axes):
        part = data.acceleration.sel(mass=mass).isel({along: index})
        top = float(part.max())
        for kind, (colour, width, label) in LINES.items():
            amplitude = part.sel(kind=kind)
            plane.semilogy(data.order, amplitude, color=colour, linewidth=width, label=label)
        title = rf"$\eta = {float(part.eta):.3f}$"
        plane.set(title=title, ylabel="amplitude in m/s$^2$", ylim=(FLOOR * top, 2.0 * top))
    axes[0].legend()
    axes[-1].set_xlabel(r"multiples of $\eta$")
    axes[-1].set_xlim(0, float(data.order.max()))
    return figure
