"""Arrays larger than memory, block by block: read lazily, written and summed in their order."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

BLOCK = 2**19  # values in memory at once
FILE_BLOCK = 2**17  # values compressed together in a file, whole rows

Index = tuple[int | slice, ...]


def file_block_rows(shape: tuple[int, ...]) -> int:
    return max(1, FILE_BLOCK // max(1, int(np.prod(shape[1:], dtype=float))))


def file_block_shape(shape: tuple[int, ...]) -> tuple[int, ...]:
    if len(shape) == 1:
        return (min(FILE_BLOCK, shape[0]),)
    return (*([1] * (len(shape) - 2)), min(file_block_rows(shape[-2:]), shape[-2]), shape[-1])


def block_indices(shape: tuple[int, ...]) -> Iterator[Index]:
    """Yield indices of blocks that make up an array in C order; one for all if it is small."""
    size = int(np.prod(shape, dtype=float))
    if size <= BLOCK:
        yield ()
        return
    if size // shape[0] > BLOCK:
        for i in range(shape[0]):
            for rest in block_indices(shape[1:]):
                yield (i, *rest)
        return
    step = BLOCK // FILE_BLOCK * file_block_rows(shape)
    for first in range(0, shape[0], step):
        yield (slice(first, min(first + step, shape[0])),)


def lazy_array_of_rows(
    leading_shape: tuple[int, ...],
    width: int,
    read_rows: Callable[[NDArray[np.intp]], NDArray[np.float64]],
) -> Any:
    """Return an xarray variable's data (*leading_shape, width) of ``read_rows``."""
    import_module("xarray")  # whole before its parts: another thread may be importing it
    from xarray.backends import BackendArray
    from xarray.core import indexing

    class Rows(BackendArray):
        shape = (*leading_shape, width)
        dtype = np.dtype(float)

        def __getitem__(self, key: Any) -> Any:
            support = indexing.IndexingSupport.BASIC
            return indexing.explicit_indexing_adapter(key, self.shape, support, self.read)

        def read(self, key: Index) -> NDArray[np.float64]:
            numbers = np.arange(int(np.prod(leading_shape))).reshape(leading_shape)[key[:-1]]
            values = read_rows(numbers.ravel()).reshape(*numbers.shape, width)
            return np.asarray(values[(..., key[-1])])

    return indexing.LazilyIndexedArray(Rows())
