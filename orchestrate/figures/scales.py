"""Units of axes: hertz and metres for a structure in SI, else the paper's ratios."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import xarray as xr

from ..constants import GRAVITY
from .labels import is_number, prefix, symbol
from .style import XI_REL

HERTZ = r"frequency $\Omega/2\pi$ in Hz"
LEVEL = "peak acceleration of the box in g"


class Along(NamedTuple):
    """Values and label of a horizontal axis.

    Attributes
    ----------
    values : ndarray
    label : str
    """

    values: np.ndarray
    label: str


def parameter_of(data: xr.DataArray) -> str:
    """Return the dimension that a quantity runs along, beside the direction and the structure."""
    (name,) = (str(name) for name in data.dims if name not in ("direction", "structure"))
    return name


def in_si(data: xr.Dataset) -> bool:
    """Return whether a structure is given in SI: omega is not 1 rad/s, or frequencies were asked
    for.
    """
    known = all(is_number(data.attrs.get(name)) for name in ("k1", "m1"))
    has_own_frequency = known and not math.isclose(data.attrs["k1"], data.attrs["m1"], rel_tol=1e-9)
    return bool(has_own_frequency or "frequency" in data.dims)


def along(data: xr.Dataset, parameter: str) -> Along:
    """Return the parameter's values: frequencies of a structure in SI in hertz."""
    if parameter in ("eta", "frequency") and "frequency" in data.coords and in_si(data):
        return Along(data.frequency.values / (2.0 * np.pi), HERTZ)
    if parameter == "level":
        return Along(data.level.values / GRAVITY, LEVEL)
    return Along(data[parameter].values, symbol(parameter))


def gap_unit(data: xr.Dataset, values: xr.DataArray) -> tuple[float, str]:
    """Return the unit in m of an axis of gaps, with its label; 0 where it has them over a eta^2.

    It is in m for a structure in SI.
    """
    if not (in_si(data) and {"amplitude", "eta"} <= set(data.coords)):
        return 0.0, XI_REL
    factor, name = prefix(float((values * data.amplitude * data.eta**2).max()))
    return factor, f"gap $x_2 - x_1$ in {name}m"


def gaps(data: xr.Dataset, values: xr.DataArray) -> tuple[xr.DataArray, str]:
    """Return gaps over a eta^2 as an axis shows them, with its label, see :func:`gap_unit`."""
    factor, label = gap_unit(data, values)
    return (values * data.amplitude * data.eta**2 / factor if factor else values), label
