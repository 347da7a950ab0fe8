"""Convert values to the display units of axes, and label the axes with them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from ..errors import InputError
from ..units import (
    FACTORS,
    OVER_OMEGA,
    display_units_of,
    omega_of,
    shows_lengths_as_ratios,
    unit_of_xi,
)
from .labels import (
    frequency_scale,
    gap_name,
    has_frequency_unit,
    length_unit,
    symbol_with_unit,
    typeset_unit,
)
from .style import XI_REL

ETA = symbol_with_unit("eta")
FREQUENCIES = {"Hz": r"frequency $\Omega/2\pi$ in Hz", "rpm": "frequency of the box in rpm"}
FREQUENCIES |= {"rad/s": r"$\Omega$ in rad/s", "eta": ETA}
MAX_LISTED = 6  # numbers that a list of values has before it says how many more there are


class AxisValues(NamedTuple):
    """Values and label of a horizontal axis, in display units."""

    values: np.ndarray
    label: str

    def format(self, *values: float) -> str:
        words, _, unit = self.label.rpartition(" in ")
        letter = f"{unit} = " if not words and unit.startswith("$") else ""
        left = len(values) - MAX_LISTED
        numbers = ", ".join(f"{value:.5g}" for value in values[:MAX_LISTED])
        text = f"{letter}{numbers} {unit if words else ''}".rstrip()
        return f"{text} and {left} more" if left > 0 else text


def varied_dimensions(data: xr.DataArray, count: int) -> list[str]:
    """Return the dimensions, besides direction and structure; raise unless there are `count`."""
    names = [str(name) for name in data.dims if name not in ("direction", "structure")]
    if len(names) != count:
        raise InputError(
            f"plot: varies over {' and '.join(names) or 'nothing'}; expected {count} of them: the "
            "whole result, or a selection by a list such as isel(eta=[0])"
        )
    return names


def varied_dimension(data: xr.DataArray) -> str:
    return varied_dimensions(data, 1)[0]


def length_scale(data: xr.Dataset, largest: float, unit: str = "m") -> tuple[float, str]:
    """Return the divisor from m, or m/s, to the display unit, and that unit; none of a ratio."""
    return (1.0, "") if shows_lengths_as_ratios(data) else length_unit(data, largest, unit)


def displayed_lengths(
    data: xr.Dataset, values: xr.DataArray, words: str, unit: str = "m"
) -> tuple[xr.DataArray, str]:
    """Return lengths, or speeds in ``m/s``, in display units, and the axis label."""
    factor, word = length_scale(data, float(abs(values).max()) if values.size else 1.0, unit)
    return values / factor, append_unit(words, word)


def append_unit(words: str, unit: str, separator: str = " ") -> str:
    return f"{words}{separator}in {unit}" if unit else words


def acceleration_scale(data: xr.Dataset, default: str = "m/s2") -> tuple[float, str]:
    """Return the divisor from m/s2 to the display unit, and that unit; none of a ratio."""
    word = display_units_of(data).acceleration
    if shows_lengths_as_ratios(data) and not word:
        return 1.0, ""
    word = word or default
    return FACTORS["acceleration"][word], typeset_unit(word)


def label_with_unit(words: str, array: xr.DataArray) -> str:
    if array.attrs.get("units") == OVER_OMEGA:
        return rf"{words} over $\omega$"
    return f"{words} in {typeset_array_unit(array)}" if "units" in array.attrs else words


def typeset_array_unit(array: xr.DataArray) -> str:
    """Return an array's unit as Matplotlib text: ``m/s$^2$``, ``g$^2$/Hz``."""
    return typeset_unit(str(array.attrs["units"]))


def axis_values(data: xr.Dataset, parameter: str) -> AxisValues:
    if parameter in ("eta", "frequency"):
        factor, word = frequency_scale(data)
        if word == "eta" and "eta" in data.coords:
            return AxisValues(data.eta.values, ETA)
        if has_frequency_unit(data) and "frequency" in data.coords:
            return AxisValues(data.frequency.values / factor, FREQUENCIES[word])
    if parameter == "level":
        factor, word = acceleration_scale(data, "g")
        return AxisValues(
            data.level.values / factor, append_unit("peak acceleration of the box", word)
        )
    factor, label = parameter_scale_and_label(data, parameter)
    return AxisValues(data[parameter].values / factor, label)


def parameter_scale_and_label(data: xr.Dataset, parameter: str) -> tuple[float, str]:
    """Return the divisor of a parameter's values to display units, and its axis label."""
    factor, word = frequency_scale(data)
    if parameter == "frequency" and (has_frequency_unit(data) or word == "eta"):
        return factor, FREQUENCIES[word]
    if parameter == "eta" and display_units_of(data).frequency not in ("", "eta"):
        return factor / omega_of(data), FREQUENCIES[word]
    if parameter in ("amplitude", "clearance") and display_units_of(data).length:
        factor, unit = length_scale(data, 1.0)
        return factor, f"{symbol_with_unit(parameter).removesuffix(' m')} {unit}"
    return 1.0, symbol_with_unit(parameter)


def gap_scale_and_label(data: xr.Dataset, values: xr.DataArray) -> tuple[float, str]:
    """Return an axis' divisor of gaps in m, 0 if they are shown over a eta^2, and its label."""
    length = unit_of_xi(data) if has_frequency_unit(data) or display_units_of(data).length else None
    if length is None:
        return 0.0, XI_REL
    factor, unit = length_scale(data, float((values * length).max()))
    return factor, append_unit(gap_name(data), unit)


def displayed_gaps(data: xr.Dataset, values: xr.DataArray) -> tuple[xr.DataArray, str]:
    """Convert gaps over a eta^2 to display units; return them and the axis label."""
    (factor, label), length = gap_scale_and_label(data, values), unit_of_xi(data)
    return (values * length / factor if factor and length is not None else values), label
