"""Scheduling of one job: which chunks are done, running or guessed, and which comes next.

A sequential job's chunk starts from the end of the one before. Where the job forgets its beginning
(a response that converges), a chunk may be guessed: computed before the one before is known, from
the end of a few items ahead of it. When that one is known, the guess stands if it began on the very
same bits, and is thrown away if not. So the result is the sequential one, whoever computed it. The
guess of chunk i is stored under ``~i``, with its start, for a run that is interrupted.
"""

from __future__ import annotations

import functools
import logging
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .identity import Identity
from .job import Chunk, Job, Table, last_entries
from .provenance import with_provenance
from .store import Store

if TYPE_CHECKING:
    from ..fmu.description import Description

log = logging.getLogger(__name__)
MIN_GAP = 3  # chunks in a row not begun: from here on, guessing the middle one pays
VAIN = 0.25  # of the items stored: where more were guessed in vain, guesses only cost time
REACH = 100  # chunks past the first of them at most: until it comes there, all may be in vain
START = "start of a guess"  # column of its table


@dataclass(frozen=True)
class Task:
    """A chunk to be computed: its items, its start or warm-up items, whether it is a guess."""

    chunk: Chunk
    items: Sequence[Any]
    previous: Table | None  # what it starts from: the last entries of the chunk before
    # items to compute first, from any state, where it is guessed what it starts from
    warmup_items: Sequence[Any]
    guess: bool  # whether what it starts from is not known to be true


@dataclass(frozen=True)
class Guess:
    """A chunk computed early from a guessed start state, stored until the true one is known."""

    start: bytes  # that state
    end: Table  # the chunk's last entries


class ChunkSchedule:
    """Scheduling state of one job: chunks done, running, or computed ahead from guessed states."""

    def __init__(
        self, job: Job, store: Store, identity: Identity, fmus: Mapping[str, Description]
    ) -> None:
        self.job, self.store, self.identity, self.fmus = job, store, identity, fmus
        self.chunks = job.chunks()
        self.result = store.result()
        self.guesses: dict[int, Guess] = {}
        done = set(range(len(self.chunks))) if self.is_complete else self.load_stored_chunks()
        self.left = {each.index: each for each in self.chunks if each.index not in done}
        self._stored_items = sum(map(self.item_count, done))
        self.under_way: set[int] = set()
        self._ends: dict[int, Table] = {}  # last entries of the last chunks that are certain
        self.wasted = 0  # items that were guessed in vain
        self.finish_if_done()  # of a run that was interrupted as it finished

    def load_stored_chunks(self) -> set[int]:
        """Return the numbers of stored chunks that fit this job; delete others, load guesses."""
        valid = set()
        for index in sorted(self.store.keep_intact_chunks(), reverse=True):
            problem = self.problem_of_stored_chunk(index)
            if problem or ~index in valid:  # of a guess that stands already
                self.store.drop(index, problem)
            elif index < 0:
                start, table = self.read_guess(~index)
                self.guesses[~index] = Guess(start, last_entries(table))
            else:
                valid.add(index)
        return valid

    def read_guess(self, index: int) -> tuple[bytes, Table]:
        table = dict(self.store.get(~index))
        return table.pop(START).tobytes(), table

    def problem_of_stored_chunk(self, index: int) -> str:
        number = max(index, ~index)
        if number >= len(self.chunks):
            return f"none of the {len(self.chunks)} of this job"
        try:
            table = self.store.get(index) if index >= 0 else self.read_guess(number)[1]
        except Exception:
            return "not readable"
        fits = self.job.has_row_per_item(table, self.item_count(number))
        return "" if fits else f"not of {self.item_count(number)} items"

    @property
    def is_complete(self) -> bool:
        return self.result is not None

    def items_done(self) -> int:
        """Return how far the progress bar is: items computed, those of guessed chunks included."""
        last = self.job.last_weight - 1 if self.is_complete else 0
        return self._stored_items + sum(map(self.item_count, self.guesses)) + last

    def item_count(self, index: int) -> int:
        return self.chunks[index].stop - self.chunks[index].start

    @functools.cached_property
    def items(self) -> Sequence[Any]:
        """The job's items, made when the first of them is computed."""
        return self.job.items()

    # -- what may be computed next ----------------------------------------------------------------

    def next_task(self, may_guess: bool = True) -> Task | None:
        finders = [self.tasks_with_known_start]
        if may_guess and self.wasted <= VAIN * self._stored_items:
            finders += [self.tasks_continuing_guesses, self.tasks_in_longest_gap]
        return next((task for find in finders for task in find()), None)

    def is_untouched(self, index: int) -> bool:
        return index in self.left and index not in self.under_way and index not in self.guesses

    def tasks_with_known_start(self) -> Iterator[Task]:
        for chunk in self.left.values():
            if self.can_start_now(chunk):
                yield self.task(chunk, self.previous_table(chunk))

    def previous_table(self, chunk: Chunk) -> Table | None:
        """Return the rows a chunk continues from: none, the last, or all for the last item."""
        if chunk.after is None:
            return None
        if self.job.last_item_uses_all and chunk.index == len(self.chunks) - 1:
            return self.store.joined_table(chunk.index)
        return self.last_entries_of(chunk.after)

    def last_entries_of(self, index: int) -> Table:
        if index not in self._ends:
            self._ends[index] = last_entries(self.store.get(index))
        return self._ends[index]

    def can_start_now(self, chunk: Chunk) -> bool:
        """Return whether a chunk can start now from its true state, and nobody computes it yet."""
        if not self.is_untouched(chunk.index) or chunk.after is None:
            return self.is_untouched(chunk.index)
        if self.job.last_item_uses_all and chunk.index == len(self.chunks) - 1:
            return len(self.left) == 1
        return chunk.after not in self.left

    def tasks_continuing_guesses(self) -> Iterator[Task]:
        """Yield tasks that continue guessed chunks, also instead of guesses with another start."""
        for index in sorted(self.guesses):
            following, previous = index + 1, self.guesses[index].end
            if following < len(self.chunks) and self.chunks[following].after == index:
                guess = None if following in self.under_way else self.guesses.get(following)
                has_other_start = guess and guess.start != self.job.boundary_state(previous)
                if has_other_start or self.is_untouched(following):
                    yield self.task(self.chunks[following], previous, guess=True)

    def tasks_in_longest_gap(self) -> Iterator[Task]:
        """Yield one task amid the longest run of untouched chunks, started by warm-up items."""
        first, last = max(self.untouched_runs(), key=lambda gap: gap[1] - gap[0], default=(0, 0))
        if self.job.warmup_items and last - first >= MIN_GAP:
            chunk = self.chunks[min((first + last) // 2, first + REACH)]
            room = chunk.start - self.chunks[first].start
            yield self.task(chunk, None, True, min(self.job.warmup_items, room))

    def untouched_runs(self) -> Iterator[tuple[int, int]]:
        first = last = 0
        for index in filter(self.is_untouched, self.left):
            if index != last or self.chunks[index].after is None:
                yield first, last
                first = index
            last = index + 1
        yield first, last

    def task(
        self, chunk: Chunk, previous: Table | None, guess: bool = False, warmup: int = 0
    ) -> Task:
        """Return the task of a chunk; ``warmup``: how many items before it are computed first."""
        before = self.items[chunk.start - warmup : chunk.start] if warmup else ()
        return Task(chunk, self.items[chunk.start : chunk.stop], previous, before, guess)

    def estimate_startable_tasks(self) -> int:
        """Return how many workers could compute chunks of this job now, an estimate."""
        longest_gap = max((last - first for first, last in self.untouched_runs()), default=0)
        certain = sum(map(self.can_start_now, self.left.values()))
        return certain + (longest_gap // MIN_GAP if self.job.warmup_items else 0)

    # -- what was computed ------------------------------------------------------------------------

    def add_result(self, task: Task, start: bytes, table: Table) -> None:
        index = task.chunk.index
        fits = self.job.has_row_per_item(table, self.item_count(index))
        assert fits, f"{self.job.name}: item_columns"
        self.under_way.discard(index)
        if task.guess:
            self.wasted += self.item_count(index) if index in self.guesses else 0
            self.guesses[index] = Guess(start, last_entries(table))
            self.store.put(~index, {**table, START: np.frombuffer(start, np.uint8)})
        else:
            self.store_chunk(index, table)
        self.resolve_guesses()
        self.finish_if_done()

    def store_chunk(self, index: int, table: Table) -> None:
        self.store.put(index, table)
        del self.left[index]
        self._stored_items += self.item_count(index)
        if self.job.sequential:
            self._ends.pop(index - 1, None)
            self._ends[index] = last_entries(table)

    def resolve_guesses(self) -> None:
        for index in sorted(self.guesses):
            after = self.chunks[index].after
            if after is None or after not in self.left:
                guess = self.guesses.pop(index)
                end = None if after is None else self.last_entries_of(after)
                if end is None or self.job.boundary_state(end) == guess.start:
                    self.store_chunk(index, self.read_guess(index)[1])
                else:
                    self.wasted += self.item_count(index)
                self.store.drop(~index)

    def finish_if_done(self) -> None:
        if self.is_complete or self.left:
            return
        if self.wasted:
            log.debug("%s: %d items were guessed in vain", self.job.name, self.wasted)
        about = self.job, self.identity, self.fmus, self.store.begun
        # only the store holds the dataset, and lets go of it; nobody the table
        self.result = self.store.finish(
            with_provenance(self.job.dataset(self.joined_table()), *about)
        )
        self.__dict__.pop("items", None)

    def joined_table(self) -> Table:
        last = len(self.chunks) - 1
        if self.job.last_item_uses_all:
            return {**self.store.joined_table(last), **self.store.get(last)}
        return self.store.joined_table(len(self.chunks), self.job.bulk)
