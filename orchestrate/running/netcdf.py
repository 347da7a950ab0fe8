"""NetCDF files that may come from anybody: what they contain is read in a process of its own."""

from __future__ import annotations

from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..lazy import xr
from ..reader_process import max_reader_memory, read_in_process
from .array_blocks import block_indices

MAX_LOADED = 2**28  # bytes of numbers that are read whole; more are read when they are used
TEXT = 64  # bytes of a text, roughly


def read_dataset(path: Path) -> xr.Dataset:
    """Return the dataset of a file, a large one lazily, after all of it was read elsewhere once."""
    limits: Any = {"keep_process": False, "array_bytes": MAX_LOADED}
    expected = "expected a NetCDF file that is whole"
    content = read_in_process(read_netcdf_content, path, MAX_LOADED, expected=expected, **limits)
    if content["is_large"]:
        return xr.open_dataset(path, engine="netcdf4", cache=False)
    variables = {name: (tuple(dims), *rest) for name, (dims, *rest) in content["variables"].items()}
    return xr.decode_cf(xr.Dataset(variables, attrs=content["attributes"])).load()


def check_unpacked_size(path: Path, size: int) -> None:
    most = max_reader_memory(path.stat().st_size)
    if size > most:
        raise InputError(f"{path}: unpacks to {size} bytes; expected at most {most}")


def unpacked_size(file: Any) -> int:
    return sum(
        prod(one.shape) * (one.dtype.itemsize if isinstance(one.dtype, np.dtype) else TEXT)
        for one in file.variables.values()
    )


def read_netcdf_content(path: Path, max_loaded: int) -> dict[str, Any]:
    import netCDF4

    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        file.set_auto_chartostring(False)
        size = unpacked_size(file)
        check_unpacked_size(path, size)
        is_large, variables = size > max_loaded, {}
        for name, variable in file.variables.items():
            for block in block_indices(variable.shape) if is_large else ():
                variable[block or ...]
            values = None if is_large else np.asarray(variable[...])
            variables[name] = variable.dimensions, values, attributes_of(variable)
        return {"is_large": is_large, "attributes": attributes_of(file), "variables": variables}


def attributes_of(holder: Any) -> dict[str, Any]:
    return {name: holder.getncattr(name) for name in holder.ncattrs()}
