"""Draw a Poincaré section at a phase of the box, at impacts or at releases."""

from __future__ import annotations

from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator

from ..constants import TURN
from .labels import title_from_attributes
from .scales import length_scale
from .style import BLACK, RED, make_panels, set_title, styled

POINTS: dict[str, Any] = {"linestyle": "none", "marker": ".", "markeredgewidth": 0.0}
LEAST_HALF = 0.05  # of an axis, over its middle
SHARES = {0.0: "0", 0.25: "π/2", 0.5: "π", 0.75: "3π/2", 1.0: "2π"}  # of a turn


@styled
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw a motion's Poincaré section; return the figure."""
    figure, (plane,) = make_panels(1, 1, (6.4, 5.0))
    DRAW[str(data.attrs["at"])](plane, data, marker_size(data.sizes["point"]))
    widen_narrow_limits(plane)
    set_title(figure, title or title_from_attributes(data))
    return figure


def widen_narrow_limits(plane: Axes) -> None:
    """Widen axes with nearly constant values, so that a periodic motion shows as a point."""
    for low, high, put in (
        (*plane.get_xlim(), plane.set_xlim),
        (*plane.get_ylim(), plane.set_ylim),
    ):
        middle = 0.5 * (low + high)
        half = max(0.5 * (high - low), LEAST_HALF * abs(middle))
        put(middle - half, middle + half)


def marker_size(count: int) -> float:
    """Return a marker size for ``count`` points: smaller where there are many."""
    return 2.0 if count > 2000 else 4.0 if count > 200 else 7.0


def draw_phase(plane: Axes, data: xr.Dataset, size: float) -> None:
    """Draw gap rate over gap, one point per period."""
    factor, letter = length_scale(data, float(data.x_rel.max()) if data.sizes["point"] else 1.0)
    pace, speed_letter = length_scale(
        data, float(abs(data.v_rel).max()) if data.sizes["point"] else 1.0
    )
    plane.plot(data.x_rel / factor, data.v_rel / pace, color=BLACK, markersize=size, **POINTS)
    plane.set(xlabel=f"gap in {letter}m", ylabel=f"gap velocity in {speed_letter}m/s")


def draw_impacts(plane: Axes, data: xr.Dataset, size: float) -> None:
    """Draw closing velocities over the box's phase; red where permanent contact begins."""
    sticks = data.sticks.values.astype(bool)
    factor, letter = length_scale(
        data, float(data.impact_velocity.max()) if data.sizes["point"] else 1.0
    )
    kinds = (("impacts", ~sticks, BLACK), ("permanent contact follows", sticks, RED))
    for label, which, colour in kinds:
        if which.any():
            speed = data.impact_velocity.values[which] / factor
            phase = data.phase.values[which] / TURN
            plane.plot(phase, speed, color=colour, markersize=size, label=label, **POINTS)
    plane.set_ylabel(f"closing speed in {letter}m/s")
    label_phase(plane)
    if sticks.any():
        plane.legend()


def draw_releases(plane: Axes, data: xr.Dataset, size: float) -> None:
    """Draw both masses' common velocity at releases over the box's phase."""
    factor, letter = length_scale(data, float(abs(data.v1).max()) if data.sizes["point"] else 1.0)
    plane.plot(data.phase / TURN, data.v1 / factor, color=BLACK, markersize=size, **POINTS)
    plane.set_ylabel(f"velocity of both masses in {letter}m/s")
    label_phase(plane)


def label_phase(plane: Axes) -> None:
    """Label an x axis of the box's phase, given in turns, by multiples of pi."""
    plane.set(xlim=(0.0, 1.0), xlabel="phase of the box in rad")
    plane.xaxis.set_major_locator(MultipleLocator(0.25))
    plane.xaxis.set_major_formatter(FuncFormatter(lambda turn, _: SHARES.get(turn, "")))


DRAW = {"phase": draw_phase, "impacts": draw_impacts, "releases": draw_releases}
