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
from contextlib import AbstractContextManager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..files import make_writable_folder
from ..lazy import xr
from .bar import DELAY, progress_bar, refresh
from .chunk_schedule import ChunkSchedule, Task
from .executors import Workers, compute, in_this_process, processes, threads
from .identity import Fmu, identity_of
from .job import Job, Table
from .options import RunOptions
from .store import open_store

log = logging.getLogger(__name__)
FmuFinder = Callable[[str], Fmu]  # from a model's name to its FMU
MIN_PARALLEL_SECONDS = 2.0  # estimated work left from which starting processes pays
POLL_SECONDS = 0.5  # between two looks at the clock while chunks are computed


def answer(
    job: Job, running: Mapping[str, object], find: FmuFinder, foreign: str = ""
) -> xr.Dataset:
    """Compute one job, or read its stored result; ``foreign``: digest of somebody else's FMU."""
    return Runner([job], RunOptions.from_keywords(running), find, foreign).run()[job.name]


def answer_all(
    jobs: Sequence[Job], folder: Path, options: RunOptions, find: FmuFinder
) -> dict[str, Path]:
    make_writable_folder(folder)
    Runner(jobs, replace(options, store=folder), find).run()
    return {job.name: folder / f"{job.name}.nc" for job in jobs}


class Runner:
    """Compute several jobs with common workers."""

    def __init__(
        self, jobs: Sequence[Job], options: RunOptions, find: FmuFinder, foreign: str = ""
    ) -> None:
        for job in jobs:
            job.check_family()
        self.jobs, self.options = jobs, options
        self.in_threads = all(job.in_threads for job in jobs)
        self.fmus: dict[str, Fmu] = {model: find(model) for job in jobs for model in job.models}
        others = (str(fmu.path.resolve()) for fmu in self.fmus.values() if options.fmu is not None)
        self.foreign = ",".join(filter(None, [foreign, *others]))  # FMUs of somebody else
        self.schedules: dict[str, ChunkSchedule] = {}
        self.futures: dict[Future[tuple[bytes, Table]], tuple[ChunkSchedule, Task]] = {}
        self.start_time = time.perf_counter()
        self.computed_items = 0  # items computed by this call

    def run(self) -> dict[str, xr.Dataset]:
        try:
            self.open()
            if not self.finished():
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

    def open(self) -> None:
        for job in self.jobs:
            fmus = {model: self.fmus[model] for model in job.models}
            identity = identity_of(job, fmus)
            store = open_store(job.name, identity, self.options)
            try:
                self.schedules[job.name] = ChunkSchedule(job, store, identity, fmus)
            except BaseException:
                store.close()
                raise

    def finished(self) -> bool:
        return all(schedule.complete for schedule in self.schedules.values())

    def compute_all(self) -> None:
        with self.bar() as bar:
            if not (self.options.cluster or self.foreign):
                with threads(1) if self.in_threads else in_this_process() as workers:
                    self.work(workers, self.fmus_to_send(workers), bar, self.little_left)
            if not self.finished():
                with self.workers() as workers:
                    fmus = self.fmus_to_send(workers)
                    self.hand_out(workers, fmus, bar)  # workers start while this process imports
                    threading.Thread(target=import_xarray, daemon=True).start()
                    self.work(workers, fmus, bar, lambda: True)

    def workers(self) -> AbstractContextManager[Workers]:
        count = self.options.workers
        if self.options.cluster:
            from .cluster import cluster  # brings asyncio, which worker processes do without

            return cluster(self.options.cluster, count)
        if self.foreign:
            return processes(min(count, max(1, self.busy_workers())), self.foreign)
        return threads(count) if self.in_threads else processes(count)

    def done(self) -> int:
        return sum(schedule.done() for schedule in self.schedules.values())

    def little_left(self) -> bool:
        if self.options.workers == 1 or not self.computed_items:
            return True
        left = sum(schedule.job.total() for schedule in self.schedules.values()) - self.done()
        seconds = (time.perf_counter() - self.start_time) / self.computed_items * left
        return seconds < MIN_PARALLEL_SECONDS or self.busy_workers() < 2

    def busy_workers(self) -> int:
        return sum(
            schedule.open_tasks() for schedule in self.schedules.values() if self.ready(schedule)
        )

    def bar(self) -> Any:
        total = sum(schedule.job.total() for schedule in self.schedules.values())
        unit = self.jobs[0].item if len(self.jobs) == 1 else "item"
        shown = self.options.progress
        return progress_bar(self.title(), shown, total=total, initial=self.done(), unit=unit)

    def title(self) -> str:
        return self.jobs[0].name if len(self.jobs) == 1 else f"{len(self.jobs)} results"

    def work(
        self,
        workers: Workers,
        fmus: Mapping[str, Path | bytes],
        bar: Any,
        go_on: Callable[[], bool],
    ) -> None:
        while not self.finished() and (go_on() or self.futures):
            if go_on():
                self.hand_out(workers, fmus, bar)
            if not self.futures:
                assert self.finished() or not go_on(), "nothing is under way, nothing is ready"
                continue
            if time.perf_counter() - self.start_time > DELAY:
                notes = (
                    schedule.job.progress_note(t.chunk.start)
                    for schedule, t in self.futures.values()
                )
                refresh(bar, next(filter(None, notes), self.title()))
            finished, _ = wait(self.futures, timeout=POLL_SECONDS, return_when=FIRST_COMPLETED)
            for future in finished:
                schedule, task = self.futures.pop(future)
                schedule.add_result(task, *future.result())
                self.computed_items += len(task.items)
            bar.update(self.done() - bar.n)

    def fmus_to_send(self, workers: Workers) -> dict[str, Path | bytes]:
        """Return FMUs by model as workers get them: paths, or bytes for remote workers."""
        return {
            model: fmu.path.read_bytes() if workers.remote else fmu.path.resolve()
            for model, fmu in self.fmus.items()
        }

    def hand_out(self, workers: Workers, fmus: Mapping[str, Path | bytes], bar: Any) -> None:
        for schedule in self.schedules.values():
            while len(self.futures) < workers.max_in_flight() and self.ready(schedule):
                # nothing that is sure waits behind a guess
                task = schedule.next_task(len(self.futures) + 1 < workers.max_in_flight())
                if task is None:
                    break
                chosen = {model: fmus[model] for model in schedule.job.models}
                schedule.under_way.add(task.chunk.index)
                code = schedule.identity["code"] if workers.remote else None
                future = workers.executor.submit(
                    compute,
                    schedule.job,
                    chosen,
                    task.items,
                    task.previous,
                    task.warmup_items,
                    code,
                )
                self.futures[future] = schedule, task

    def ready(self, schedule: ChunkSchedule) -> bool:
        """Return whether a job has chunks to compute; make its items at first."""
        if schedule.complete:
            return False
        if schedule.items is None:
            schedule.make_items()
        return not schedule.complete


def import_xarray() -> None:
    """Import xarray and what datasets need early, as it takes most of a second."""
    with suppress(Exception):  # a process that ends lets nobody import; it comes again where used
        xr.Dataset({"number": ("place", np.zeros(1))})


def compute_datasets(
    jobs: Iterable[Job], running: Mapping[str, object], find: FmuFinder
) -> list[xr.Dataset]:
    listed = list(jobs)
    results = Runner(listed, RunOptions.from_keywords(running), find).run()
    return [results[job.name] for job in listed]
