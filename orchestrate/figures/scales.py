"""Units of axes: those that an answer is shown in; else hertz and metres for a structure in SI, and
the paper's ratios.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from ..units import FACTORS, OVER_OMEGA, has_own_frequency, omega_of, scale_of, units_of
from .labels import gap_name, prefix, symbol, unit_sign
from .style import XI_REL

ETA = symbol("eta")
FREQUENCIES = {
    "Hz": r"frequency $\Omega/2\pi$ in Hz",
    "rpm": "frequency of the box in rpm",
    "rad/s": r"$\Omega$ in rad/s",
    "eta": ETA,
}


class Along(NamedTuple):
    """Values and label of a horizontal axis.

    Attributes
    ----------
    values : ndarray
    label : str
    """

    values: np.ndarray
    label: str

    def text(self, value: float) -> str:
        """Format a value with the unit of its axis."""
        unit = self.label.rpartition(" in ")[2] if " in " in self.label else ""
        return f"{value:.5g} {unit}".rstrip()


def parameter_of(data: xr.DataArray) -> str:
    """Return the dimension that a quantity runs along, beside the direction and the structure."""
    (name,) = (str(name) for name in data.dims if name not in ("direction", "structure"))
    return name


def in_si(data: xr.Dataset) -> bool:
    """Return whether frequencies are shown with a unit, not as ratios eta."""
    if units_of(data).frequency:
        return units_of(data).frequency != "eta"
    return has_own_frequency(data) or "frequency" in data.dims


def frequency_scale(data: xr.Dataset) -> tuple[float, str]:
    """Return the divisor of frequencies in rad/s and their unit, Hz by default."""
    if units_of(data).frequency:
        return scale_of(data, "rad/s")
    return FACTORS["frequency"]["Hz"], "Hz"


def length_scale(data: xr.Dataset, largest: float) -> tuple[float, str]:
    """Return the divisor of lengths or velocities, and the prefix of their unit."""
    factor, word = scale_of(data, "m")
    if not units_of(data).length:
        return prefix(largest)
    return factor, word.removesuffix("m").replace("u", "µ")


def acceleration_scale(data: xr.Dataset, usual: str = "m/s2") -> tuple[float, str]:
    """Return the divisor of accelerations, and their unit for an axis.

    Parameters
    ----------
    data : xarray.Dataset
    usual : str
        The unit where none is asked for.
    """
    word = units_of(data).acceleration or usual
    return FACTORS["acceleration"][word], unit_sign(word)


def with_unit(words: str, array: xr.DataArray) -> str:
    """Return an axis' label with the unit of what it shows, see :func:`.units.as_shown`."""
    if array.attrs.get("units") == OVER_OMEGA:
        return rf"{words} over $\omega$"
    return f"{words} in {unit_text(array)}" if "units" in array.attrs else words


def unit_text(array: xr.DataArray) -> str:
    """Return the unit of what is shown, as a picture has it: ``m/s$^2$``, ``g$^2$/Hz``."""
    return unit_sign(str(array.attrs["units"]))


def along(data: xr.Dataset, parameter: str) -> Along:
    """Return the parameter's values as they are shown, and the axis' label."""
    if parameter in ("eta", "frequency"):
        factor, word = frequency_scale(data)
        if word == "eta" and "eta" in data.coords:
            return Along(data.eta.values, ETA)
        if in_si(data) and "frequency" in data.coords:
            return Along(data.frequency.values / factor, FREQUENCIES[word])
    if parameter == "level":
        factor, word = acceleration_scale(data, "g")
        return Along(data.level.values / factor, f"peak acceleration of the box in {word}")
    factor, label = parameter_scale(data, parameter)
    return Along(data[parameter].values / factor, label)


def parameter_scale(data: xr.Dataset, parameter: str) -> tuple[float, str]:
    """Return the divisor of a parameter's values, and the label of its axis."""
    factor, word = frequency_scale(data)
    if parameter == "frequency" and (in_si(data) or word == "eta"):
        return factor, FREQUENCIES[word]
    if parameter == "eta" and units_of(data).frequency not in ("", "eta"):
        return factor / omega_of(data), FREQUENCIES[word]
    if parameter in ("amplitude", "clearance") and units_of(data).length:
        factor, letter = length_scale(data, 1.0)
        return factor, f"{symbol(parameter).removesuffix(' m')} {letter}m"
    return 1.0, symbol(parameter)


def gap_unit(data: xr.Dataset, values: xr.DataArray) -> tuple[float, str]:
    """Return what an axis of gaps is in, in m (0: over a eta^2), and its label.

    It is in m for a structure in SI, or where a unit of length is asked for.
    """
    asked = in_si(data) or units_of(data).length
    if not (asked and {"amplitude", "eta"} <= set(data.coords)):
        return 0.0, XI_REL
    largest = float((values * data.amplitude * data.eta**2).max())
    factor, name = length_scale(data, largest)
    return factor, f"{gap_name(data)} in {name}m"


def gaps(data: xr.Dataset, values: xr.DataArray) -> tuple[xr.DataArray, str]:
    """Return gaps over a eta^2 as an axis shows them, with its label, see :func:`gap_unit`."""
    factor, label = gap_unit(data, values)
    return (values * data.amplitude * data.eta**2 / factor if factor else values), label
