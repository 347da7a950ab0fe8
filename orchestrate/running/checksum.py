"""Checksum of a dataset over its names, units and numbers, independent of the file format.

It travels in an attribute of the file, so that any tool reads the file as before. A result whose
checksum does not fit has been damaged, or changed by somebody after it was written.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..lazy import xr
from .array_blocks import block_indices

ATTRIBUTE = "content_sha256"


def checksum(data: xr.Dataset) -> str:
    """Return a dataset's SHA-256 over names, attributes and values, but its own attribute."""
    digest = hashlib.sha256(encode_json(normalized_attributes(data.attrs)))
    for name in sorted(data.variables, key=str):
        array = data.variables[name]
        dims, attributes = list(map(str, array.dims)), normalized_attributes(array.attrs)
        header = [str(name), dims, list(array.shape), attributes]
        digest.update(encode_json(header))
        for block in block_indices(array.shape):
            digest.update(encode_array(np.asarray(array[block].values)))
    return digest.hexdigest()


def normalized_attributes(attributes: Mapping[Any, Any]) -> dict[str, list[Any]]:
    """Return attributes as lists of plain values, as they come back from a NetCDF file."""
    pairs = ((str(name), value) for name, value in attributes.items() if name != ATTRIBUTE)
    return {name: np.atleast_1d(np.asarray(value)).tolist() for name, value in pairs}


def encode_json(data: Any) -> bytes:
    """Return plain data as JSON bytes with sorted keys, so that equal data give equal bytes."""
    return json.dumps(data, sort_keys=True).encode()


def encode_array(values: np.ndarray) -> bytes:
    """Return an array's bytes for a checksum: little-endian, all NaN alike; texts as JSON."""
    if values.dtype.kind in "USO":
        return encode_json(list(map(str, np.ravel(values))))
    if values.dtype.kind == "f":
        values = np.where(np.isnan(values), np.nan, values)
    return np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<")).tobytes()
