"""Draw a controlled sweep on an electrodynamic shaker, bonded and delaminated, for the manual."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import orchestrate
from orchestrate.constants import GRAVITY
from orchestrate.show.colours import BLACK, RED
from orchestrate.show.style import make_panels, styled

LEVEL = 0.5 * GRAVITY
HALVES: dict[str, Any] = {
    "m1": 0.10,
    "m2": 0.08,
    "f1": 42.0,
    "f2": 55.0,
    "zeta1": 0.007,
    "zeta2": 0.007,
    "e": 0.6,
}


def simulate_controlled_sweeps() -> dict[str, tuple[xr.Dataset, xr.Dataset]]:
    beam = orchestrate.Structure.from_halves(**HALVES)
    shaker = orchestrate.Shaker.from_file("shaker_100N").replace(table_mass=0.4)
    sweep = orchestrate.SweptSine(first=35.0, last=60.0, duration=60.0, acceleration=LEVEL)
    found = {}
    for name, structure in {"delaminated": beam, "bonded": beam.as_bonded()}.items():
        run = orchestrate.shake(structure, sweep, shaker=shaker, progress=False)
        run = run.assign(a1_abs=run.a1_abs.copy(data=run.current.values))  # its orders, as of one
        found[name] = run, orchestrate.track_orders(run, phase=sweep, orders=(1, 2, 3))
    return found


@styled
def draw_controlled_sweep() -> Figure:
    """Draw the table's level, the current and the table's second and third order over frequency."""
    figure, panels = make_panels(3, 1, (7.6, 6.4), "", sharex=True)
    for name, (_, orders) in simulate_controlled_sweeps().items():
        colour, frequency = RED if name == "delaminated" else BLACK, orders.frequency
        table = orders.amplitude.sel(channel="box_acceleration") / LEVEL
        current = orders.amplitude.sel(channel="acceleration1", order=1)
        style: Any = {"color": colour, "label": name}
        panels[0].plot(frequency, table.sel(order=1), **style)
        panels[1].plot(frequency, current, **style)
        panels[2].semilogy(frequency, np.maximum(table.sel(order=2), 1e-6), **style)
        panels[2].semilogy(frequency, np.maximum(table.sel(order=3), 1e-6), "--", color=colour)
    panels[0].set(ylabel="table's fundamental\nover the level", ylim=(0.5, 1.5))
    panels[1].set(ylabel="current in A", ylim=(0.0, None))
    panels[2].set(ylabel="table's orders 2, 3 (dashed)\nover the level", xlabel="frequency in Hz")
    panels[2].set(ylim=(1e-5, 1.0), xlim=(36.0, 60.0))
    panels[0].legend()
    return figure
