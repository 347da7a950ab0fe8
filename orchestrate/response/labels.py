"""Build dataset variables and coordinates with their units, long names and flag meanings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..lazy import xr
from ..model.ranges import EXCITATION, LEVEL, RATIO_QUANTITIES, STRUCTURE

Dims = str | tuple[str, ...]
Variable = tuple[Dims, Any, dict[str, Any]]
COORDINATES = ("xi_1", "xi_2", "xi_1'", "xi_2'")  # of a non-dimensional state
STATE = ("x1", "x2", "v1", "v2")  # of a state in m and m/s


def make_dataset(
    variables: Mapping[str, Variable],
    coordinates: Mapping[str, Variable],
    title: str,
    **attributes: Any,
) -> xr.Dataset:
    return xr.Dataset(variables, coordinates, {"title": title, **attributes})


def variable(dims: Dims, values: Any, units: str, long_name: str, **attributes: Any) -> Variable:
    return dims, values, {"units": units, "long_name": long_name, **attributes}


def states_over_time(data: xr.Dataset) -> NDArray[np.float64]:
    """Return the states of a motion in time, m and m/s, shape (n, 4)."""
    return np.stack([data[name].values for name in STATE], axis=1)


def column_variables(
    dims: Dims, long_names: Mapping[str, str], columns: Iterable[Any]
) -> dict[str, Variable]:
    """Return dimensionless variables by the names and long names of their columns."""
    pairs = zip(long_names.items(), columns, strict=True)
    return {name: variable(dims, column, "1", text) for (name, text), column in pairs}


def flags(dims: Dims, values: Any, long_name: str, meanings: Mapping[int, str]) -> Variable:
    """Return a variable of integer flags with the CF attributes that give each flag's meaning."""
    words = " ".join(word.replace(" ", "_") for word in meanings.values())
    numbers = np.array(list(meanings), dtype=np.int8)
    values = np.asarray(values, dtype=np.int8)
    return variable(dims, values, "1", long_name, flag_values=numbers, flag_meanings=words)


def yes_or_no(dims: Dims, values: Any, long_name: str) -> Variable:
    return flags(dims, values, long_name, {0: "no", 1: "yes"})


def parameter_variable(name: str, dims: Dims, values: Any) -> Variable:
    """Return a variable of a parameter, with the unit and description that it has elsewhere."""
    quantity = {**STRUCTURE, **RATIO_QUANTITIES, **EXCITATION, "level": LEVEL}[name]
    return variable(dims, np.asarray(values, dtype=float), quantity.unit, quantity.description)


def nondimensional_state_coordinate() -> dict[str, Variable]:
    text = "co-ordinate of the state: x/(a eta^2), and its derivative by tau"
    return {"coordinate": variable("coordinate", np.array(COORDINATES), "1", text)}


def si_state_coordinate() -> dict[str, Variable]:
    text = "co-ordinate of the state: x1, x2 in m, v1, v2 in m/s"
    return {"coordinate": variable("coordinate", np.array(STATE), "1", text)}
