"""MATLAB's files up to version 7.2, by SciPy.

Its reader is compiled and trusts the sizes that a file states: a byte that has changed may end the
process that reads it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .columns import Column, Columns
from .pieces import Floats

RATES = ("sample_rate", "samplerate", "fs", "samplefrequency")  # what a MAT file calls it
STEPS = ("increment", "delta_x", "dt", "xdelta")  # and the step of its times
FREQUENCIES = ("frequency", "freq", "f", "freqs", "frequencies")  # in place of times
PARTS, DEPTH = 64, 9  # of structures and cells that are looked into


def load_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Load the arrays of numbers and texts of a MAT file by name, those of structures too."""
    from scipy.io import loadmat

    try:
        content = loadmat(path)
    except NotImplementedError:
        text = "a MAT file of version 7.3; expected an earlier one: save with '-v7'"
        raise InputError(f"{path}: {text}") from None
    return {
        name: array
        for top, value in content.items()
        if not top.startswith("__")
        for name, array in iterate_arrays(top, value)
    }


def iterate_arrays(name: str, value: Any, depth: int = 0) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield names and arrays of numbers and texts of a variable, a structure or a cell."""
    array = np.asarray(value)
    if array.dtype.kind in "iufcU":
        yield name, array
    if array.size > PARTS or depth >= DEPTH:
        return
    for i, part in enumerate(array.ravel() if array.dtype.names or array.dtype == "O" else ()):
        own = f"{name}[{i}]" if array.size > 1 else name
        for field in array.dtype.names or ():
            yield from iterate_arrays(f"{own}.{field}", part[field], depth + 1)
        if array.dtype == "O":
            yield from iterate_arrays(own, part, depth + 1)


def read_mat(path: Path) -> Columns:
    """Read vectors of a MAT file, and columns of matrices as ``name[0]``, ``name[1]`` ..."""
    arrays = load_arrays(path)
    texts = {
        name.lower(): str(one.ravel()[0]).strip()
        for name, one in arrays.items()
        if one.dtype.kind == "U" and one.size
    }
    numbers = {name: one for name, one in arrays.items() if one.dtype.kind in "iuf"}
    spectra = describe_spectra(arrays, texts)
    rate, columns = None, []
    for name, one in numbers.items():
        last = name.lower().rpartition(".")[2]
        if one.size == 1 and (last in RATES or last in STEPS):
            value = float(one.ravel()[0])
            rate = value if last in RATES else 1.0 / value if value > 0.0 else rate
        elif one.ndim == 2 and min(one.shape) == 1 and one.size > 1:
            columns.append((name, one.ravel()))
        elif one.ndim == 2 and one.shape[0] > one.shape[1]:
            columns += [(f"{name}[{i}]", column) for i, column in enumerate(one.T)]
    times = [len(values) for name, values in columns if is_time_name(name)]
    longest = max(times or [len(values) for _, values in columns], default=0)
    made = [
        mat_column(name, np.asarray(values, float), texts)
        for name, values in columns
        if len(values) == longest
    ]
    if not made:
        raise InputError(f"{path}: {spectra or 'no vectors of numbers'}; expected some over time")
    return Columns(str(path), made, rate, attributes={"spectra": spectra} if spectra else {})


def is_time_name(name: str) -> bool:
    """Return whether an array of a MAT file, or its last field, is called time or t."""
    return name.lower().rpartition(".")[2] in ("time", "t")


def mat_column(name: str, values: Floats, texts: dict[str, str]) -> Column:
    """Return a vector as a column, with the name, unit and sensitivity that stand nearest to it."""

    def nearest_text(*field_names: str) -> str:
        parents = name.lower().split(".")
        for depth in range(len(parents) - 1, -1, -1):
            above = ".".join([*parents[:depth], ""]) if depth else ""
            for key, text in texts.items():
                inside = key.removeprefix(above).split(".")
                is_own = key.startswith(above) and inside[-1] in field_names and len(inside) <= 3
                if text and is_own and (depth or len(inside) == 1):
                    return text
        return ""

    short = name.rpartition(".")[2]
    label = "" if is_time_name(name) or "." not in name else nearest_text("name", "channelname")
    unit = "" if is_time_name(name) else nearest_text("units", "unit", "unitlabel", "label")
    return Column(label or short, unit, values, sensitivity=nearest_text("sensitivity"))


def describe_spectra(arrays: dict[str, NDArray[Any]], texts: dict[str, str]) -> str:
    """Say which arrays look like spectra, as complex numbers do; empty if none does."""
    complexes = [name for name, one in arrays.items() if one.dtype.kind == "c" and one.size > 1]
    over = [name for name in arrays if name.lower().rpartition(".")[2] in FREQUENCIES]
    psd = [text for text in texts.values() if re.search(r"/\s*hz", text, re.I)]
    if not (complexes or over or psd):
        return ""
    kind = f"a spectral density in {psd[0]}" if psd else "a frequency response or a spectrum"
    what = (complexes or over or [""])[0]
    return f"{kind} ({what})" if what else kind


def write_mat(path: Path, columns: list[Column], sample_rate: float) -> None:
    """Write columns as vectors of a MAT file, with ``sample_rate`` and ``units``.

    Those in another unit than the first channel are structs of their own.
    """
    from scipy.io import savemat

    unit = columns[1].unit
    vectors: dict[str, Any] = {
        one.name: {one.name: one.values, "units": one.unit}
        if i and one.unit != unit
        else one.values
        for i, one in enumerate(columns)
    }
    with path.open("wb") as file:
        savemat(file, {**vectors, "sample_rate": sample_rate, "units": unit})
