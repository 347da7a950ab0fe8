"""Table of the drawing functions by the name of the question, for answers that need nothing
else.
"""

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
