"""Store: the computed chunks of a job and its final dataset, in memory or as NetCDF on disk."""

from __future__ import annotations

import json
import logging
import os
import re
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, StaleError, StoreError, first_line, printable_line
from ..files import check_path_encoding, make_writable_folder, write_atomically
from ..lazy import xr
from .array_blocks import BLOCK, block_indices, file_block_shape
from .checksum import ATTRIBUTE, checksum
from .identity import Identity, describe_difference
from .job import Table
from .journal import ANEW, Journal, delete_journal_files, journal_path, lock_result
from .netcdf import MAX_LOADED, check_unpacked_size, read_dataset
from .options import RunOptions

log = logging.getLogger(__name__)
MIN_COMPRESSED = 10_000  # values from which a variable is worth compressing
LAST_SECOND = 253_402_300_799  # of the year 9999
JOINED = 100  # chunks joined at a time: many small arrays leave holes in memory
# not higher: the last digits of numbers do not shrink, however long it tries
COMPRESSION = {"zlib": True, "complevel": 1}

STARTED: set[Path] = set()  # journals with chunks that this process has seen or written
FINISHED: set[Path] = set()  # results that it has; both say how much an interruption loses


def timestamp() -> str:
    """Return the present time, UTC, as ISO 8601 text; SOURCE_DATE_EPOCH overrides it."""
    fixed = os.environ.get("SOURCE_DATE_EPOCH")
    if fixed and not (re.fullmatch("[0-9]{1,12}", fixed) and int(fixed) <= LAST_SECOND):
        expected = f"expected a whole number of seconds since 1970, up to {LAST_SECOND}"
        raise InputError(f"SOURCE_DATE_EPOCH = {fixed!r} in the environment: {expected}")
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(int(fixed) if fixed else time.time()))


class Store:
    """Storage of one job's computed chunks and its final dataset, in memory."""

    def __init__(self) -> None:
        self.begun = timestamp()
        self._chunks: dict[int, Table] = {}
        self._result: xr.Dataset | None = None

    def result(self) -> xr.Dataset | None:
        """Return the job's finished dataset, or None before it is finished."""
        return self._result

    def keep_intact_chunks(self) -> set[int]:
        """Delete stored chunks that are damaged; return the numbers of the others."""
        return set(self._chunks)

    def get(self, index: int) -> Table:
        return self._chunks[index]

    def put(self, index: int, table: Table) -> None:
        self._chunks[index] = table

    def drop(self, index: int, reason: str = "") -> None:
        """Delete a chunk, with a warning where it cannot be used for a reason."""
        del self._chunks[index]

    def finish(self, dataset: xr.Dataset) -> xr.Dataset:
        """Keep the final dataset and delete the chunks; return the dataset as it reads back."""
        self._chunks.clear()
        self._result = dataset
        return dataset

    def close(self) -> None:
        """Release all files and locks of the store."""

    def joined_table(self, count: int, bulk: Sequence[str] = ()) -> Table:
        """Return the arrays of the first ``count`` chunks joined; ``bulk`` is for those on disk."""
        parts = [self.get(index) for index in range(count)]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


class StoredRows:
    """A column of all chunks on disk, of which chosen rows are read."""

    def __init__(self, store: DiskStore, name: str, lengths: Sequence[int], width: int) -> None:
        self.store, self.name, self.ends = store, name, np.cumsum(lengths)
        self.shape = int(self.ends[-1]), width

    def read_rows(self, chosen: NDArray[np.intp]) -> NDArray[np.float64]:
        result = np.empty((len(chosen), self.shape[1]))
        chunk = np.searchsorted(self.ends, chosen, side="right")
        for index in np.unique(chunk).tolist():
            here = chunk == index
            part = self.store.get(index)[self.name]
            result[here] = part[chosen[here] - (self.ends[index] - len(part))]
        return result


class DiskStore(Store):
    """Storage of one job on disk: an SQLite journal of chunks, then a NetCDF file of the result."""

    def __init__(self, path: Path, identity: Identity, options: RunOptions) -> None:
        super().__init__()
        self.path, self.identity, self.options = path, identity, options
        check_path_encoding(path)
        make_writable_folder(path.parent)
        if path.is_dir():
            expected = "expected a place for a file: remove it, or choose another"
            raise InputError(f"{path}: a folder; {expected}")
        self._lock = lock_result(path)
        self._journal: Journal | None = None
        try:
            anew = journal_path(path, recomputing=True)
            if not path.exists():
                self._open_journal(journal_path(path))
            elif options.force or self._is_resumable(anew):
                if options.force:
                    read_identity(path)  # of another's file there is nothing to replace
                self._open_journal(anew)
            else:
                identity = read_identity(path)
                self._result = load_result(path)  # first, or damage is taken for another question
                self.check_identity(identity, path)
                FINISHED.add(path)
                delete_journal_files(journal_path(path))  # of a process killed before it did so
        except BaseException:
            self.close()
            raise

    def _open_journal(self, path: Path) -> None:
        """Open the journal at a path, with ``force`` an empty one; note if it has chunks."""
        if self.options.force and not path.is_dir():
            delete_journal_files(path)
        journal = Journal(path, self.identity, timestamp())
        try:
            self.check_identity(journal.identity, path)
        except InputError:
            journal.close()
            raise
        self._journal, self.begun = journal, journal.begun
        if not journal.is_empty():
            STARTED.add(path)

    def _is_resumable(self, path: Path) -> bool:
        """Return whether a run with ``force`` has left a journal of the present code and FMUs."""
        if self.options.keep_stale or not path.exists():
            return False
        try:
            with closing(Journal(path, self.identity, timestamp())) as journal:
                differs = describe_difference(journal.identity, self.identity)
                return not (journal.is_empty() or differs)
        except StoreError:
            return False

    def check_identity(self, stored: Identity, path: Path) -> None:
        reason = describe_difference(stored, self.identity)
        if not reason:
            return
        if stored.get("question") != self.identity.get("question"):
            text = f"{path}: contains the result of a different calculation ({reason})"
            raise InputError(f"{text}; choose another place, or force to replace it")
        if not self.options.keep_stale:
            advice = "force to recompute it, or keep stale results as they are"
            raise StaleError(f"{path}: stale ({reason}); {advice}")
        log.warning("%s: stale (%s), taken as it is", path, reason)

    @property
    def journal(self) -> Journal:
        assert self._journal is not None, "finished"
        return self._journal

    def keep_intact_chunks(self) -> set[int]:
        return self.journal.keep_intact_chunks()

    def get(self, index: int) -> Table:
        return self.journal.get(index)

    def put(self, index: int, table: Table) -> None:
        self.journal.put(index, table)
        STARTED.add(self.journal.path)

    def joined_table(self, count: int, bulk: Sequence[str] = ()) -> Table:
        """Return ``count`` chunks' arrays joined, those of ``bulk`` as :class:`StoredRows`."""
        columns: dict[str, list[np.ndarray]] = {}
        shapes: dict[str, list[tuple[int, ...]]] = {name: [] for name in bulk}
        for first in range(0, count, JOINED):
            parts = [self.get(index) for index in range(first, min(first + JOINED, count))]
            for name in parts[0]:
                arrays = [part[name] for part in parts]
                if name in shapes:
                    shapes[name] += [array.shape for array in arrays]
                else:
                    columns.setdefault(name, []).append(np.concatenate(arrays))
        table: dict[str, Any] = {name: np.concatenate(columns.pop(name)) for name in [*columns]}
        for name, each in shapes.items():
            table[name] = StoredRows(self, name, [rows for rows, _ in each], each[0][1])
        return table

    def drop(self, index: int, reason: str = "") -> None:
        self.journal.drop(index, reason)

    def finish(self, dataset: xr.Dataset) -> xr.Dataset:
        """Write the NetCDF file over an older one, delete the journal; return the dataset."""
        write_netcdf(dataset, self.path)
        FINISHED.add(self.path)
        STARTED.discard(self.journal.path)
        self.journal.delete()
        for recomputing in (False, True):  # of runs that were killed as they finished
            delete_journal_files(journal_path(self.path, recomputing))
        self._journal = None
        del dataset  # there may be no room for both it and what is read
        self._result = load_result(self.path)
        return self._result

    def close(self) -> None:
        """Close the journal, delete it if empty, and release the lock on the result."""
        if self._journal is not None:
            with suppress(StoreError):
                if self._journal.is_empty():
                    self._journal.delete()
            self._journal.close()
        self._lock.release()


def open_store(name: str, identity: Identity, options: RunOptions) -> Store:
    path = options.result_path(name)
    return Store() if path is None else DiskStore(path, identity, options)


def load_result(path: Path, read: Callable[[Path], xr.Dataset] | None = None) -> xr.Dataset:
    """Return a file's dataset, read in this process; raise ``StoreError`` if damaged (checksum)."""
    check_path_encoding(path)
    try:
        data = (read or open_unverified_result)(path)
        stored_checksum = data.attrs.pop(ATTRIBUTE, None)
        fits = stored_checksum is None or stored_checksum == checksum(data)
    except Exception as error:
        if path.is_file() and not is_netcdf(path):
            raise StoreError(f"{path}: not readable; expected a NetCDF file") from error
        line = printable_line(first_line(error)).removeprefix(f"{path}: ")
        raise StoreError(f"{path}: damaged ({line}); {ANEW}") from error
    if not fits:
        text = f"{path}: its contents do not fit its checksum: damaged, or changed by hand"
        advice = f"{ANEW}, or delete its attribute {ATTRIBUTE} to take it as it is"
        raise StoreError(f"{text}; {advice}")
    return data


def load_foreign_result(path: Path) -> xr.Dataset:
    return load_result(path, read_dataset)


def open_unverified_result(path: Path) -> xr.Dataset:
    with small_chunk_cache():
        # what is read of a large one, for the checksum or by a user, does not stay in memory
        data = xr.open_dataset(path, engine="netcdf4", cache=False)
    check_unpacked_size(path, data.nbytes)
    if data.nbytes > MAX_LOADED:
        return data
    with data:
        return data.load()


@contextmanager
def small_chunk_cache() -> Iterator[None]:
    """Let netCDF keep a block of each variable of a file opened now, in place of 64 MB."""
    import netCDF4

    before = netCDF4.get_chunk_cache()
    netCDF4.set_chunk_cache(8 * BLOCK)
    try:
        yield
    finally:
        netCDF4.set_chunk_cache(*before)


def create_variable(file: Any, name: str, array: xr.DataArray) -> Any:
    for dimension, size in array.sizes.items():
        if dimension not in file.dimensions:
            file.createDimension(str(dimension), size)
    create: Any = file.createVariable
    storage = {**COMPRESSION, "chunksizes": file_block_shape(array.shape), "fill_value": np.nan}
    target = create(name, array.dtype, array.dims, **storage)
    target.set_var_chunk_cache(8 * BLOCK)
    target.setncatts(array.attrs)
    return target


def is_netcdf(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(4).startswith((b"\x89HDF", b"CDF"))


def read_identity(path: Path) -> Identity:
    import netCDF4

    try:
        with netCDF4.Dataset(path) as file:
            identity: Identity = json.loads(file.getncattr("identity"))
        identity["question"]  # or it is another's attribute of the same name
        return identity
    except Exception as error:
        text = f"{path}: not a result of this project, or damaged ({first_line(error)})"
        raise StoreError(f"{text}; choose another place, or {ANEW}") from error


def write_netcdf(dataset: xr.Dataset, path: Path) -> Path:
    from xarray.backends import NetCDF4DataStore

    dataset = dataset.assign_attrs({ATTRIBUTE: checksum(dataset)})
    variables = dataset.data_vars.items()
    large = {name: one for name, one in variables if one.size > MIN_COMPRESSED}
    floats = {name: one for name, one in large.items() if one.dtype == float}
    # in blocks, those whose rows are shorter than one
    bulk = [name for name, one in floats.items() if len(list(block_indices(one.shape))) > 1]
    others = {name: COMPRESSION for name in large if name not in bulk}
    open_file: Any = NetCDF4DataStore.open

    def write(path_to_write: Path) -> None:
        # xarray's to_netcdf imports Dask's scheduler to find a lock that nobody needs here
        with open_file(path_to_write, mode="w", lock=False) as file:
            targets = {name: create_variable(file.ds, str(name), dataset[name]) for name in bulk}
            dataset.drop_vars(bulk).dump_to_store(file, encoding=others)
            for name, target in targets.items():
                for block in block_indices(dataset[name].shape):
                    target[block] = dataset.variables[name][block].values

    return write_atomically(path, write)
