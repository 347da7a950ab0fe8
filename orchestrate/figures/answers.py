"""The picture of an answer, by the name of the question, where it needs no more than the answer."""

from __future__ import annotations

from collections.abc import Callable

import xarray as xr
from matplotlib.figure import Figure

from . import attractors, basin, lyapunov, maps, orbit_diagram, resonance, spectra

DRAW: dict[str, Callable[[xr.Dataset], Figure]] = {
    "attractors": attractors.draw,
    "basin": basin.draw,
    "lyapunov": lyapunov.draw,
    "map": maps.draw,
    "resonance": resonance.draw,
    "spectra": spectra.draw,
    "sweep": orbit_diagram.draw,
}
