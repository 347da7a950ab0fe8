"""Names of parameters and of kinds of responses, as pictures and legends write them."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

SYMBOLS = {
    "eta": r"$\eta$",
    "e": "$e$",
    "D": "$D$",
    "D1": "$D_1$",
    "D2": "$D_2$",
    "mu": r"$\mu$",
    "kappa": r"$\kappa$",
    "gamma": r"$\gamma$",
    "omega": r"$\omega$ in rad/s",
    "frequency": r"$\Omega$ in rad/s",
    "amplitude": "$a$ in m",
    "m1": "$m_1$ in kg",
    "m2": "$m_2$ in kg",
    "k1": "$k_1$ in N/m",
    "k2": "$k_2$ in N/m",
    "d1": "$d_1$ in N s/m",
    "d2": "$d_2$ in N s/m",
}


def symbol(name: str) -> str:
    """A parameter's name for an axis; what has no symbol keeps its name."""
    return SYMBOLS.get(name, name.replace("_", " "))


def parameters_text(values: Mapping[str, float]) -> str:
    """Parameters with their values, for a title."""
    parts = []
    for name, value in values.items():
        letter, _, unit = symbol(name).partition(" in ")
        parts.append(f"{letter} = {value:g} {unit}".rstrip())
    return ", ".join(parts)


def kind_of(multiplicity: int) -> str:
    """A response's kind in the paper's words: ``T``, ``2T`` or not periodic."""
    if multiplicity == 0:
        return "not periodic"
    return "$T$" if multiplicity == 1 else f"${multiplicity}T$"


def meanings(variable: xr.DataArray) -> dict[int, str]:
    """What the values of a variable stand for, from CF's ``flag_values`` and ``flag_meanings``."""
    words = variable.attrs["flag_meanings"].split()
    return {
        int(value): word.replace("_", " ")
        for value, word in zip(variable.attrs["flag_values"], words, strict=True)
    }
