"""The level at which a pressed structure first opens, or an open one first touches."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ..constants import GRAVITY
from .labels import title_from_attributes
from .scales import HERTZ
from .style import BLACK, panels, set_title, styled

THRESHOLD = "threshold_acceleration"


def finite(threshold: xr.DataArray) -> np.ndarray:
    """Return a threshold as it is drawn: no line where no level opens or joins the halves."""
    return np.where(np.isfinite(threshold.values), threshold.values, np.nan)


@styled
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw the level over the frequency, in g and Hz.

    Parameters
    ----------
    data : xarray.Dataset
        Of :func:`orchestrate.contact_threshold`.
    title : str
        By default the structure.
    """
    figure, (plane,) = panels(1, 1, (6.4, 4.2))
    set_title(figure, title or title_from_attributes(data, ("eta", "frequency")))
    level = finite(data[THRESHOLD]) / GRAVITY
    mark = "o-" if level.size < 2 else "-"
    plane.plot(data.hertz, level, mark, color=BLACK, label=f"it first {data.attrs['event']}")
    if np.nanmax(level, initial=0.0) > 0.0:
        plane.set_yscale("log")
    plane.set(xlabel=HERTZ, ylabel="peak acceleration of the box in g")
    plane.legend()
    return figure
