"""Runner: submits chunks of jobs to workers, stores what returns, shows the progress bar.

Any worker may take any chunk that is ready, the earliest job's first. Small questions are answered
in this process; where much is left after the first chunks, threads or processes are started. An
FMU of somebody else always runs in a process, where it may crash, exit or hang.
Who computes never changes a bit: a chunk's result depends on its items and on what it starts from.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..files import make_writable_folder
from ..lazy import xr
from .bar import DELAY, progress_bar, update_bar
from .chunk_schedule import ChunkSchedule, Task
from .executors import InlineExecutor, Workers, compute_chunk, process_workers, thread_workers
from .identity import identity_of
from .job import Job, Table
from .options import RunOptions
from .store import open_store

if TYPE_CHECKING:
    from ..fmu.description import Description

log = logging.getLogger(__name__)
FmuFinder = Callable[[str], "Description"]  # from a model's name to its FMU
MIN_PARALLEL_SECONDS = 2.0  # estimated work left from which starting processes pays
POLL_SECONDS = 0.5  # between two looks at the clock while chunks are computed


def compute_dataset(
    job: Job, running: Mapping[str, object], find_fmu: FmuFinder, foreign: str = ""
) -> xr.Dataset:
    """Compute one job, or read its stored result; ``foreign``: digest of somebody else's FMU."""
    return Runner([job], RunOptions.from_keywords(running), find_fmu, foreign).run()[job.name]


def compute_into_folder(
    jobs: Sequence[Job], folder: Path, options: RunOptions, find_fmu: FmuFinder
) -> dict[str, Path]:
    make_writable_folder(folder)
    Runner(jobs, replace(options, store=folder), find_fmu).run()
    return {job.name: folder / f"{job.name}.nc" for job in jobs}


class Runner:
    """Compute several jobs with common workers."""

    def __init__(
        self, jobs: Sequence[Job], options: RunOptions, find_fmu: FmuFinder, foreign: str = ""
    ) -> None:
        for job in jobs:
            job.require_supported_structure()
        self.jobs, self.options = jobs, options
        self.in_threads = all(job.in_threads for job in jobs)
        self.fmus = {model: find_fmu(model) for job in jobs for model in job.models}
        others = (str(fmu.path.resolve()) for fmu in self.fmus.values() if options.fmu is not None)
        self.foreign = ",".join(filter(None, [foreign, *others]))  # FMUs of somebody else
        self.schedules: dict[str, ChunkSchedule] = {}
        self.futures: dict[Future[tuple[bytes, Table]], tuple[ChunkSchedule, Task]] = {}
        self.start_time = time.perf_counter()
        self.computed_items = 0  # items computed by this call

    def run(self) -> dict[str, xr.Dataset]:
        try:
            self.open_stores()
            if not self.all_complete():
                self.compute_all()
            results = ((name, schedule.result) for name, schedule in self.schedules.items())
            return {name: result for name, result in results if result is not None}
        except KeyboardInterrupt as ended:
            kept = "what was stored is kept: the same call resumes" if self.options.store else ""
            ended.add_note(kept or "nothing was stored; with store= the same call would resume")
            raise
        finally:
            for future in self.futures:  # of a call that is interrupted or fails
                future.cancel()
            for schedule in self.schedules.values():
                schedule.store.close()

    def open_stores(self) -> None:
        for job in self.jobs:
            fmus = {model: self.fmus[model] for model in job.models}
            identity = identity_of(job, fmus)
            store = open_store(job.name, identity, self.options)
            try:
                self.schedules[job.name] = ChunkSchedule(job, store, identity, fmus)
            except BaseException:
                store.close()
                raise

    def all_complete(self) -> bool:
        return all(schedule.is_complete for schedule in self.schedules.values())

    def compute_all(self) -> None:
        unit = self.jobs[0].item if len(self.jobs) == 1 else "item"
        counts = {"total": self.progress_total(), "initial": self.items_done()}
        with progress_bar(self.bar_label(), self.options.progress, **counts, unit=unit) as bar:
            if not (self.options.cluster or self.foreign):
                inline = nullcontext(Workers(InlineExecutor(), lambda: 1))
                with thread_workers(1) if self.in_threads else inline as workers:
                    self.compute_while(workers, bar, self.is_little_left)
            if not self.all_complete():
                with self.choose_workers() as workers:
                    self.submit_tasks(workers)  # workers start while this process imports
                    threading.Thread(target=import_xarray, daemon=True).start()
                    self.compute_while(workers, bar, lambda: True)

    def choose_workers(self) -> AbstractContextManager[Workers]:
        count = self.options.worker_count
        if self.options.cluster:
            # brings asyncio, which worker processes do without
            from .cluster import cluster_workers

            return cluster_workers(self.options.cluster, count)
        if self.foreign:
            return process_workers(min(count, max(1, self.count_startable_tasks())), self.foreign)
        return thread_workers(count) if self.in_threads else process_workers(count)

    def progress_total(self) -> int:
        return sum(schedule.job.progress_total() for schedule in self.schedules.values())

    def items_done(self) -> int:
        return sum(schedule.items_done() for schedule in self.schedules.values())

    def is_little_left(self) -> bool:
        if self.options.worker_count == 1 or not self.computed_items:
            return True
        left = self.progress_total() - self.items_done()
        seconds = (time.perf_counter() - self.start_time) / self.computed_items * left
        return seconds < MIN_PARALLEL_SECONDS or self.count_startable_tasks() < 2

    def count_startable_tasks(self) -> int:
        unfinished = (one for one in self.schedules.values() if not one.is_complete)
        return sum(schedule.estimate_startable_tasks() for schedule in unfinished)

    def bar_label(self) -> str:
        return self.jobs[0].name if len(self.jobs) == 1 else f"{len(self.jobs)} results"

    def compute_while(self, workers: Workers, bar: Any, may_submit: Callable[[], bool]) -> None:
        while not self.all_complete() and (may_submit() or self.futures):
            if may_submit():
                self.submit_tasks(workers)
            if not self.futures:
                stuck = "nothing is under way, nothing is ready"
                assert self.all_complete() or not may_submit(), stuck
                continue
            if time.perf_counter() - self.start_time > DELAY:
                begun = ((one.job, task.chunk.start) for one, task in self.futures.values())
                notes = (job.progress_note(first) for job, first in begun)
                update_bar(bar, next(filter(None, notes), self.bar_label()))
            finished, _ = wait(self.futures, timeout=POLL_SECONDS, return_when=FIRST_COMPLETED)
            for future in finished:
                schedule, task = self.futures.pop(future)
                schedule.add_result(task, *future.result())
                self.computed_items += len(task.items)
            bar.update(self.items_done() - bar.n)

    @cached_property
    def sent_fmus(self) -> dict[str, Path | bytes]:
        """FMUs by model as workers get them: paths, or bytes where they share no disk with us."""
        files = {model: fmu.path.resolve() for model, fmu in self.fmus.items()}
        return {m: path.read_bytes() if self.options.cluster else path for m, path in files.items()}

    def submit_tasks(self, workers: Workers) -> None:
        for schedule in self.schedules.values():
            while len(self.futures) < workers.max_in_flight() and not schedule.is_complete:
                # nothing that is sure waits behind a guess
                task = schedule.next_task(len(self.futures) + 1 < workers.max_in_flight())
                if task is None:
                    break
                schedule.under_way.add(task.chunk.index)
                fmus = {model: self.sent_fmus[model] for model in schedule.job.models}
                call = (
                    *(schedule.job, fmus),
                    *(task.items, task.previous, task.warmup_items),
                    schedule.identity["code"] if self.options.cluster else None,  # its sources
                )
                future = workers.executor.submit(compute_chunk, *call)
                self.futures[future] = schedule, task


def import_xarray() -> None:
    """Import xarray and what datasets need early, as it takes most of a second."""
    with suppress(Exception):  # a process that ends lets nobody import; it comes again where used
        xr.Dataset({"number": ("place", np.zeros(1))})


def compute_datasets(
    jobs: Iterable[Job], running: Mapping[str, object], find_fmu: FmuFinder
) -> list[xr.Dataset]:
    listed = list(jobs)
    results = Runner(listed, RunOptions.from_keywords(running), find_fmu).run()
    return [results[job.name] for job in listed]
