"""Units and long names of every variable and coordinate of a result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ..structures.ranges import EXCITATION, LEVEL, RATIO_QUANTITIES, STRUCTURE

Dims = str | tuple[str, ...]
Variable = tuple[Dims, Any, dict[str, Any]]
COORDINATES = ("xi_1", "xi_2", "xi_1'", "xi_2'")  # of a non-dimensional state
STATE = ("x1", "x2", "v1", "v2")  # of a state in m and m/s


def variable(dims: Dims, values: Any, units: str, long_name: str, **more: Any) -> Variable:
    """Return a variable or coordinate as :class:`xarray.Dataset` takes it."""
    return dims, values, {"units": units, "long_name": long_name, **more}


def columns(dims: Dims, texts: Mapping[str, str], values: Iterable[Any]) -> dict[str, Variable]:
    """Return columns as dimensionless variables, by their names and long names in ``texts``."""
    parts = zip(texts.items(), values, strict=True)
    return {name: variable(dims, column, "1", text) for (name, text), column in parts}


def flags(dims: Dims, values: Any, long_name: str, meanings: Mapping[int, str]) -> Variable:
    """Return numbers that stand for words, with CF's attributes that give the words."""
    words = " ".join(word.replace(" ", "_") for word in meanings.values())
    numbers = np.array(list(meanings), dtype=np.int8)
    values = np.asarray(values, dtype=np.int8)
    return variable(dims, values, "1", long_name, flag_values=numbers, flag_meanings=words)


def yes_or_no(dims: Dims, values: Any, long_name: str) -> Variable:
    """Return a truth value as 1 or 0."""
    return flags(dims, values, long_name, {0: "no", 1: "yes"})


def parameter(name: str, dims: Dims, values: Any) -> Variable:
    """Return a parameter of a structure or an excitation as a variable, by its name."""
    quantity = {**STRUCTURE, **RATIO_QUANTITIES, **EXCITATION, "level": LEVEL}[name]
    return variable(dims, np.asarray(values, dtype=float), quantity.unit, quantity.description)


def nondimensional_state() -> dict[str, Variable]:
    """Return the coordinate along a state in the paper's units."""
    text = "co-ordinate of the state: x/(a eta^2), and its derivative by tau"
    return {"coordinate": variable("coordinate", np.array(COORDINATES), "1", text)}


def si_state() -> dict[str, Variable]:
    """Return the coordinate along a state in m and m/s."""
    text = "co-ordinate of the state: x1, x2 in m, v1, v2 in m/s"
    return {"coordinate": variable("coordinate", np.array(STATE), "1", text)}
