"""Draw the motor's power and where it goes, for all pictures of the weak drive."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from .style import GREY

SINKS = {
    "dampers": "dampers of the masses",
    "box_damper": "damper of the box",
    "impact_loss": "impacts",
}
ACCOUNTS = ("motor", *SINKS, "stored")
POWER_REVOLUTIONS = 2  # that powers are averaged over: a motion may repeat after two


def mean_powers(revolutions: xr.Dataset) -> dict[str, np.ndarray]:
    """Return mean powers, W, by account, each over ``POWER_REVOLUTIONS`` revolutions."""
    time = revolutions.time.values
    span = time[POWER_REVOLUTIONS:] - time[:-POWER_REVOLUTIONS]
    energies = {account: revolutions[account].values for account in ACCOUNTS}
    return {
        account: (values[POWER_REVOLUTIONS:] - values[:-POWER_REVOLUTIONS]) / span
        for account, values in energies.items()
    }


def draw_powers(axes: Axes, along: np.ndarray, powers: Mapping[str, np.ndarray]) -> None:
    """Draw the motor's power and its losses by account, over time or speed."""
    axes.plot(along, powers["motor"], "k", linewidth=1.6, label="motor")
    for account, label in SINKS.items():
        axes.plot(along, powers[account], linewidth=1.0, label=label)
    axes.plot(along, powers["stored"], color=GREY, linewidth=1.0, label="stored")
