"""Large computations as jobs of many chunks: any worker may take any chunk, each is on disk when it is done.

A job's chunks go into a journal as they arrive, its NetCDF file appears whole or not at all when the last one has, and both carry the identity
of what was computed. So a run killed at any moment loses the chunks its workers were at, and the same command goes on with the others.
"""

import hashlib
import io
import itertools
import json
import sqlite3
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from .errors import UserError
from .store import Journal, difference, read_identity, write_netcdf


@dataclass(frozen=True)
class Job:
    """One result file: subclasses say what its items are and how they are computed.

    Attributes
    ----------
    name : str
        Of the result file, without its ending.
    fmu_guid : str
        GUID of the FMU that computes it.
    """

    name: str
    fmu_guid: str
    NEEDS: ClassVar[tuple] = ()  # names of the fields that name other jobs
    CHUNK: ClassVar[int] = 1  # items a chunk
    SEQUENTIAL: ClassVar[bool] = False  # each chunk starts from the end of the last

    def needs(self):
        """Names of the jobs whose results this one starts from."""
        return tuple(getattr(self, field) for field in self.NEEDS)

    def identity(self):
        """All that decides the numbers, but for the results it starts from."""
        return {"kind": type(self).__name__, **asdict(self)}

    def count(self):
        """Number of items, known before any work."""
        raise NotImplementedError

    def items(self, inputs):
        """The items in their order: plain data that travels to a worker.

        Parameters
        ----------
        inputs : dict
            Datasets of the needed jobs by name.
        """
        raise NotImplementedError

    def work(self, fmu, items, carry):
        """Compute a chunk, in a worker.

        Parameters
        ----------
        fmu : Path
        items : list
        carry : dict of ndarray, optional
            Result of the chunk before, of a sequential job.

        Returns
        -------
        dict of ndarray
            One entry an item along the first axis of each.
        """
        raise NotImplementedError

    def dataset(self, table, inputs):
        """The result as an xarray.Dataset, from all chunks put together."""
        raise NotImplementedError

    def chunks(self):
        """Number of chunks."""
        return -(-self.count() // self.CHUNK)


class ChunkJournal(Journal):
    """A journal whose rows are chunks: arrays by name."""

    def put(self, index, arrays):
        """Enter a chunk."""
        stream = io.BytesIO()
        np.savez(stream, **arrays)
        try:
            self._db.execute("INSERT OR REPLACE INTO rows VALUES (?, ?)", (index, stream.getvalue()))
        except sqlite3.Error as error:
            raise UserError(f"{self.path}: cannot be written ({error}); what was computed is kept, the same command goes on from there") from None

    def chunk(self, index):
        """One chunk, as a dict of ndarray."""
        data = self._query("SELECT data FROM rows WHERE i = ?", index)[0][0]
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
                return dict(arrays)
        except Exception:
            raise UserError(f"{self.path}: damaged (chunk {index} cannot be read); remove it to begin anew") from None

    def indices(self):
        """Which chunks are there."""
        return {index for (index,) in self._query("SELECT i FROM rows")}

    def table(self):
        """All chunks put together along their first axis."""
        parts = [self.chunk(index) for index in sorted(self.indices())]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


class Progress:
    """How far a job is: what is on disk, what may be computed next.

    Parameters
    ----------
    job : Job
    folder : Path
    identity : dict
        The job's, with those of the results it starts from.
    """

    def __init__(self, job, folder, identity):
        self.job, self.result = job, Path(folder) / f"{job.name}.nc"
        self.identity = Journal.normal(identity)
        self.journal: Any = None
        self._todo: Any = None
        self._items: Any = ()
        self._inputs: dict = {}
        self.complete = self.result.exists()
        if self.complete:
            found = read_identity(self.result)
            if found != self.identity:
                raise UserError(f"{self.result}: holds another run ({difference(found, self.identity)}); remove it or choose another --output")
            self.done = job.chunks()
            return
        self.journal = ChunkJournal(f"{self.result}.journal", self.identity)
        self.done = len(self.journal.indices())

    def start(self, inputs):
        """Make the chunks to be computed, once the needed results are there."""
        self._items, self._inputs = self.job.items(inputs), inputs
        there = self.journal.indices()
        self._todo = [index for index in range(self.job.chunks()) if index not in there]

    @property
    def started(self):
        """Whether the chunks are known."""
        return self._todo is not None

    def take(self, busy):
        """The next chunk to compute: its index, items and carry; None where there is none now.

        Parameters
        ----------
        busy : int
            Chunks of this job under way.
        """
        if not self._todo or (self.job.SEQUENTIAL and busy):
            return None
        index = self._todo.pop(0)
        first = index * self.job.CHUNK
        carry = self.journal.chunk(index - 1) if self.job.SEQUENTIAL and index else None
        return index, list(itertools.islice(self._items, first, first + self.job.CHUNK)), carry

    def enter(self, index, arrays):
        """Keep a chunk; the last one completes the result file."""
        self.journal.put(index, arrays)
        self.done += 1
        return self.finish_if_done()

    def finish_if_done(self):
        """Write the result file where all chunks are there; returns whether it is."""
        if not self.complete and self.done == self.job.chunks():
            write_netcdf(self.job.dataset(self.journal.table(), self._inputs), self.result, self.identity)
            self.journal.remove()
            self.complete, self._inputs = True, {}
        return self.complete

    def close(self):
        """Close the journal."""
        if self.journal is not None and not self.complete:
            self.journal.close()


def identities(jobs):
    """Identity of each job by name, with fingerprints of those it starts from."""
    known: dict = {}
    for job in jobs:
        identity = job.identity()
        if job.needs():
            identity["from"] = {name: fingerprint(known[name]) for name in job.needs()}
        known[job.name] = identity
    return known


def fingerprint(identity):
    """A short name for an identity."""
    return hashlib.sha256(json.dumps(identity, sort_keys=True).encode()).hexdigest()[:16]
