"""Title a branch or a border: the structure, and what of the box's motion all points share."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import xarray as xr

from .labels import EXCITATION, format_excitation, title_from_attributes
from .scales import has_frequency_unit


def branch_title(data: xr.Dataset, over: Iterable[str]) -> str:
    r"""Return a title with the structure, and with the frequency and amplitude that are held.

    Examples
    --------
    >>> beam = dict(m1=1.0, m2=1.0, k1=4.0, k2=4.0, d1=0.02, d2=0.02, e=0.7)
    >>> along = {"frequency": ("point", [2.1, 2.2]), "amplitude": ("point", [1e-3, 1e-3])}
    >>> branch_title(xr.Dataset(coords=along, attrs=beam), ["frequency"]).rpartition(", ")[2]
    '$a$ = 1 mm'
    """
    varied = set(over)
    structure = title_from_attributes(data, {*varied, *EXCITATION})
    shaken = format_excitation(data, held_values(data))
    shown = [text for name, text in shaken.items() if name not in varied]
    return ", ".join(filter(None, [structure, *shown]))


def held_values(data: xr.Dataset) -> dict[str, float]:
    """Return frequency and amplitude, or else peak acceleration, where all points share them.

    Of a structure in the paper's units its usual excitation, a eta^2 = 1, is not named.
    """
    name = "frequency" if has_frequency_unit(data) else "eta"
    points = {key: data[key] for key in (name, "amplitude") if key in data.coords}
    held = {key: float(values[0]) for key, values in points.items() if is_constant(values)}
    if "amplitude" not in held and {"frequency", "amplitude"} <= set(points):
        level = points["amplitude"] * points["frequency"] ** 2
        held |= {"level": float(level[0])} if is_constant(level) else {}
    return held


def is_constant(values: xr.DataArray) -> bool:
    """Return whether values along a curve are all the same."""
    return values.ndim == 1 and bool(np.allclose(values, values[0], rtol=1e-9, atol=0.0))
