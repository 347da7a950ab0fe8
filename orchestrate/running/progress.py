"""How far a job is: which chunks are there, and what may be computed next.

A sequential job's chunk starts from the end of the one before. Where the job forgets its beginning
(a response that converges), a chunk may be guessed: computed before the one before is known, from
the end of a few items ahead of it. When that one is known, the guess stands if it began on the very
same bits, and is thrown away if not. So the result is the sequential one, whoever computed it.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .identity import Fmu, Identity
from .job import Chunk, Job, Table, last_entries
from .provenance import with_provenance
from .store import Store

if TYPE_CHECKING:
    import xarray as xr

log = logging.getLogger(__name__)
GAP = 3  # chunks that nobody has begun, from which it is worth beginning in their middle


@dataclass(frozen=True)
class Task:
    """What a worker needs for a chunk.

    Attributes
    ----------
    chunk : Chunk
    items : sequence
    carry : dict of ndarray, optional
        What it starts from: the last entries of the chunk before.
    lead : sequence
        Items to compute first, from any state, where it is guessed what it starts from.
    guess : bool
        Whether what it starts from is not known to be true.
    """

    chunk: Chunk
    items: Sequence[Any]
    carry: Table | None
    lead: Sequence[Any]
    guess: bool


@dataclass(frozen=True)
class Guess:
    """A chunk that was computed from a guessed state.

    Attributes
    ----------
    start : bytes
        That state.
    table : dict of ndarray
    """

    start: bytes
    table: Table


class Progress:
    """One job on its way.

    Parameters
    ----------
    job : Job
    store : Store
    identity : dict
    fmus : mapping of str to Fmu
    """

    def __init__(self, job: Job, store: Store, identity: Identity, fmus: Mapping[str, Fmu]) -> None:
        self.job, self.store, self.identity, self.fmus = job, store, identity, fmus
        self.chunks = job.chunks()
        self.result = store.result()
        self.there = set(range(len(self.chunks))) if self.complete else self.sound()
        self.under_way: set[int] = set()
        self.guesses: dict[int, Guess] = {}
        self._ends: dict[int, Table] = {}  # last entries of chunks that are certain
        self.wasted = 0  # items that were guessed in vain
        self.inputs: Mapping[str, xr.Dataset] = {}
        self.items: Sequence[Any] | None = None

    def sound(self) -> set[int]:
        """Chunks that are there and are this job's; others are dropped."""
        found = set()
        for index in sorted(self.store.indices()):
            problem = self.problem(index)
            if problem:
                self.store.drop(index, problem)
            else:
                found.add(index)
        return found

    def problem(self, index: int) -> str:
        """Why a stored chunk cannot be one of this job's; an empty string where it can."""
        if not 0 <= index < len(self.chunks):
            return f"none of the {len(self.chunks)} of this job"
        try:
            table = self.store.get(index)
        except Exception:
            return "not readable"
        lengths = {len(values) for values in table.values() if values.ndim}
        if lengths != {self.size(index)}:
            return f"not of {self.size(index)} items"
        return ""

    @property
    def complete(self) -> bool:
        """Whether the result is there."""
        return self.result is not None

    def done(self) -> int:
        """Items computed, guessed ones included."""
        return sum(self.size(index) for index in {*self.there, *self.guesses})

    def size(self, index: int) -> int:
        """Items of a chunk."""
        return self.chunks[index].last - self.chunks[index].first

    def start(self, inputs: Mapping[str, xr.Dataset]) -> None:
        """Make the items, once the needed results are there."""
        self.inputs = inputs
        self.items = self.job.items(inputs)
        self.finish_if_done()

    # -- what may be computed next ----------------------------------------------------------------

    def next_task(self) -> Task | None:
        """What a worker should compute now: what is certain, then what goes on, then a guess."""
        for find in (self.certain, self.continued, self.begun_in_a_gap):
            task = next(find(), None)
            if task is not None:
                return task
        return None

    def untouched(self, index: int) -> bool:
        """Whether nobody has computed a chunk or is at it."""
        return not (index in self.there or index in self.under_way or index in self.guesses)

    def certain(self) -> Iterator[Task]:
        """Chunks whose beginning is known."""
        for chunk in self.chunks:
            if self.is_certain(chunk):
                yield Task(chunk, self.items_of(chunk), self.carry(chunk), (), False)

    def carry(self, chunk: Chunk) -> Table | None:
        """What a chunk starts from: the end of the one before, or all of them."""
        if chunk.after is None:
            return None
        if (self.job.closing or self.job.gathers) and chunk.index == len(self.chunks) - 1:
            return self.store.table(chunk.index)
        return self.end_of(chunk.after)

    def end_of(self, index: int) -> Table:
        """The last entries of a chunk that is certain."""
        if index not in self._ends:
            self._ends[index] = last_entries(self.store.get(index))
        return self._ends[index]

    def is_certain(self, chunk: Chunk) -> bool:
        """Whether nobody is at a chunk whose beginning is known."""
        if not self.untouched(chunk.index) or chunk.after is None:
            return self.untouched(chunk.index)
        if self.job.gathers:
            return len(self.there) == chunk.index
        return chunk.after in self.there

    def continued(self) -> Iterator[Task]:
        """Chunks that go on from a guessed one, in place of guesses that began elsewhere: a run of
        chunks is rather right as a whole.
        """
        for index in sorted(self.guesses):
            following = index + 1
            if following < len(self.chunks) and self.chunks[following].after == index:
                carry = last_entries(self.guesses[index].table)
                if self.untouched(following) or self.begun_elsewhere(following, carry):
                    chunk = self.chunks[following]
                    yield Task(chunk, self.items_of(chunk), carry, (), True)

    def begun_elsewhere(self, index: int, before: Table) -> bool:
        """Whether a chunk was guessed from another state than the chunk before ends in."""
        guess = None if index in self.under_way else self.guesses.get(index)
        return guess is not None and guess.start != self.job.seam(before)

    def begun_in_a_gap(self) -> Iterator[Task]:
        """A chunk in the middle of the longest run of chunks that nobody has begun."""
        first, last = max(self.gaps(), key=lambda gap: gap[1] - gap[0], default=(0, 0))
        if self.job.lead and last - first >= GAP:
            chunk = self.chunks[(first + last) // 2]
            begin = self.chunks[first].first
            lead = self.range(max(chunk.first - self.job.lead, begin), chunk.first)
            yield Task(chunk, self.items_of(chunk), None, lead, True)

    def gaps(self) -> Iterator[tuple[int, int]]:
        """Runs of chunks that nobody has begun, as first and one past the last."""
        first = 0
        for chunk in self.chunks:
            if not self.untouched(chunk.index):
                yield first, chunk.index
                first = chunk.index + 1
            elif chunk.after is None:
                yield first, chunk.index
                first = chunk.index
        yield first, len(self.chunks)

    def items_of(self, chunk: Chunk) -> Sequence[Any]:
        """A chunk's items."""
        return self.range(chunk.first, chunk.last)

    def range(self, first: int, last: int) -> Sequence[Any]:
        """Some items."""
        assert self.items is not None, "not started"
        return self.items[first:last]

    def open_tasks(self) -> int:
        """How many workers could be busy now, about."""
        if self.complete:
            return 0
        longest = max((last - first for first, last in self.gaps()), default=0)
        certain = sum(map(self.is_certain, self.chunks))
        return certain + (longest // GAP if self.job.lead else 0)

    # -- what was computed ------------------------------------------------------------------------

    def enter(self, task: Task, start: bytes, table: Table) -> None:
        """Keep a chunk; the last one makes the result."""
        index = task.chunk.index
        self.under_way.discard(index)
        if task.guess:
            self.wasted += self.size(index) if index in self.guesses else 0
            self.guesses[index] = Guess(start, table)
        else:
            self.keep(index, table)
        self.settle()
        self.finish_if_done()

    def keep(self, index: int, table: Table) -> None:
        """Keep a chunk that is certain."""
        self.store.put(index, table)
        self.there.add(index)
        if self.job.sequential:
            self._ends[index] = last_entries(table)

    def settle(self) -> None:
        """Take over guesses that began where the chunk before ends, throw away the others."""
        for index in sorted(self.guesses):
            after = self.chunks[index].after
            if after is None or after in self.there:
                guess = self.guesses.pop(index)
                if after is None or self.job.seam(self.end_of(after)) == guess.start:
                    self.keep(index, guess.table)
                else:
                    self.wasted += self.size(index)

    def finish_if_done(self) -> None:
        """Make the result where all chunks are there."""
        if self.complete or len(self.there) < len(self.chunks):
            return
        if self.wasted:
            log.debug("%s: %d items were guessed in vain", self.job.name, self.wasted)
        dataset = self.job.dataset(self.table(), self.inputs)
        dataset = with_provenance(dataset, self.job, self.identity, self.fmus, self.store.begun)
        self.result = self.store.finish(dataset)
        self.inputs, self.items = {}, None

    def table(self) -> Table:
        """All chunks put together; the last one of a job that gathers has arrays of its own."""
        last = len(self.chunks) - 1
        if self.job.gathers:
            return {**self.store.table(last), **self.store.get(last)}
        return self.store.table(len(self.chunks))
