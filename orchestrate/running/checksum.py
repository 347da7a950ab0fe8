"""A result's checksum: over all that it says, names, units and numbers, however it is stored.

It travels in an attribute of the file, so that any tool reads the file as before. A result whose
checksum does not fit has been damaged, or changed by somebody after it was written.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

ATTRIBUTE = "content_sha256"


def checksum(data: xr.Dataset) -> str:
    """The checksum of a dataset, its own attribute aside.

    A dataset that was written to NetCDF and read again has the checksum that it had before.

    Parameters
    ----------
    data : xarray.Dataset

    Returns
    -------
    str
        SHA-256, in hexadecimal digits.

    Examples
    --------
    >>> import xarray as xr
    >>> data = xr.Dataset({"x": ("time", [1.0, 2.0])})
    >>> checksum(data) == checksum(data.copy())
    True
    >>> checksum(data) == checksum(data + 1e-15)
    False
    """
    digest = hashlib.sha256(in_text(attributes(data.attrs)))
    for name in sorted(data.variables, key=str):
        array = data.variables[name]
        about = [str(name), list(map(str, array.dims)), list(array.shape), attributes(array.attrs)]
        digest.update(in_text(about))
        digest.update(in_bytes(np.asarray(array.values)))
    return digest.hexdigest()


def attributes(found: Mapping[Any, Any]) -> dict[str, list[Any]]:
    """Attributes as they come back from a file, where a list of one is as good as its element."""
    pairs = ((str(name), value) for name, value in found.items() if name != ATTRIBUTE)
    return {name: np.atleast_1d(np.asarray(value)).tolist() for name, value in pairs}


def in_text(thing: Any) -> bytes:
    """Plain data as text, the same for equal data."""
    return json.dumps(thing, sort_keys=True).encode()


def in_bytes(values: np.ndarray) -> bytes:
    """Numbers, all that are none alike, or words."""
    if values.dtype.kind in "USO":
        return in_text(list(map(str, np.ravel(values))))
    if values.dtype.kind == "f":
        values = np.where(np.isnan(values), np.nan, values)
    return np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<")).tobytes()
