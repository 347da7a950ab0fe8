"""Runner: submits chunks of jobs to workers, stores what returns, shows the progress bar.

Any worker may take any chunk that is ready, the earliest job's first. Small questions are answered
in this process; where much is left after the first chunks, processes are started. Who computes
never changes a bit: a chunk's result depends on its items and on what it starts from alone.
"""

from __future__ import annotations

import logging
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..files import open_folder
from .executors import InlineExecutor, Processes, Threads, Workers, compute, running_workers
from .identity import Fmu, identity_of
from .job import Job, Table
from .options import RunOptions
from .progress import Progress, Task
from .store import open_store

if TYPE_CHECKING:
    import xarray as xr

log = logging.getLogger(__name__)
FmuFinder = Callable[[str], Fmu]  # from a model's name to its FMU
MIN_PARALLEL_SECONDS = 2.0  # estimated work left from which starting processes pays
POLL_SECONDS = 0.5  # between two looks at the clock while chunks are computed
BAR_DELAY = 1.0  # s until the progress bar shows: shorter work needs none


def answer(job: Job, running: Mapping[str, object], find: FmuFinder) -> xr.Dataset:
    """Compute one job in parallel chunks, or read its stored result; return the dataset."""
    return Runner([job], RunOptions.from_keywords(running), find).run()[job.name]


def answer_all(
    jobs: Sequence[Job], folder: Path, options: RunOptions, find: FmuFinder
) -> dict[str, Path]:
    """Compute many jobs into NetCDF files in a folder; return their paths by job name."""
    open_folder(folder)
    Runner(jobs, replace(options, store=folder), find).run()
    return {job.name: folder / f"{job.name}.nc" for job in jobs}


class Runner:
    """Compute several jobs with common workers."""

    def __init__(self, jobs: Sequence[Job], options: RunOptions, find: FmuFinder) -> None:
        self.jobs, self.options = jobs, options
        self.fmus: dict[str, Fmu] = {model: find(model) for job in jobs for model in job.models}
        self.states: dict[str, Progress] = {}
        self.futures: dict[Future[tuple[bytes, Table]], tuple[Progress, Task]] = {}
        self.start_time = time.perf_counter()
        self.computed_items = 0  # items computed by this call

    def run(self) -> dict[str, xr.Dataset]:
        """Compute all results that are not stored yet; return all datasets by job name."""
        try:
            self.open()
            if not self.finished():
                self.compute_all()
            results = ((name, state.result) for name, state in self.states.items())
            return {name: result for name, result in results if result is not None}
        finally:
            for state in self.states.values():
                state.store.close()

    def open(self) -> None:
        """Open the store of each job and read which results and chunks it already has."""
        for job in self.jobs:
            fmus = {model: self.fmus[model] for model in job.models}
            identity = identity_of(job, fmus)
            store = open_store(job.name, identity, self.options)
            try:
                self.states[job.name] = Progress(job, store, identity, fmus)
            except BaseException:
                store.close()
                raise

    def finished(self) -> bool:
        """Return whether every job has its final dataset."""
        return all(state.complete for state in self.states.values())

    def compute_all(self) -> None:
        """Compute all jobs: in this process while little is left, then with parallel workers."""
        with self.bar() as bar:
            if not self.options.cluster:
                with running_workers(InlineExecutor()) as workers:
                    self.work(workers, self.fmus_to_send(workers), bar, self.little_left)
            if not self.finished():
                with running_workers(self.start_workers()) as workers:
                    fmus = self.fmus_to_send(workers)
                    self.hand_out(workers, fmus, bar)  # workers start while this process imports
                    threading.Thread(target=import_xarray, daemon=True).start()
                    self.work(workers, fmus, bar, lambda: True)

    def start_workers(self) -> Workers:
        """Return new workers: of a Dask cluster if one is given, else threads or processes."""
        if self.options.cluster:
            from .cluster import Cluster  # brings asyncio, which worker processes do without

            return Cluster(self.options.cluster)
        in_threads = all(job.in_threads for job in self.jobs)
        return (Threads if in_threads else Processes)(self.options.processes)

    def done(self) -> int:
        """Return the number of computed items of all jobs together."""
        return sum(state.done() for state in self.states.values())

    def little_left(self) -> bool:
        """Return whether the rest is too short, by time or tasks, to be worth parallel workers."""
        if self.options.processes == 1 or not self.computed_items:
            return True
        left = sum(state.job.count() for state in self.states.values()) - self.done()
        seconds = (time.perf_counter() - self.start_time) / self.computed_items * left
        return seconds < MIN_PARALLEL_SECONDS or self.busy_workers() < 2

    def busy_workers(self) -> int:
        """Return how many workers could compute chunks now, an estimate over all jobs."""
        return sum(state.open_tasks() for state in self.states.values() if self.ready(state))

    def bar(self) -> Any:
        """Return a tqdm progress bar over the items of all jobs."""
        tqdm = progress_bar(self.options.progress)
        total = sum(state.job.count() for state in self.states.values())
        single = self.jobs[0] if len(self.jobs) == 1 else None
        return tqdm(
            total=total,
            initial=self.done(),
            desc=self.title(),
            unit=single.item if single else "item",
            disable=not self.options.progress,
            delay=BAR_DELAY,
            dynamic_ncols=True,
            smoothing=0.1,
            unit_scale=total > 100_000,
        )

    def title(self) -> str:
        """Return the progress bar's title: the job's name, or the number of jobs."""
        return self.jobs[0].name if len(self.jobs) == 1 else f"{len(self.jobs)} results"

    def describe(self, bar: Any, note: str) -> None:
        """Show a note beside the progress bar's title, once the bar is visible."""
        if time.perf_counter() - self.start_time > BAR_DELAY:
            bar.delay = 0.0  # it is shown from now on, or tqdm would not end its line
            bar.set_description(f"{self.title()}, {note}" if note else self.title())

    def work(
        self,
        workers: Workers,
        fmus: Mapping[str, Path | bytes],
        bar: Any,
        go_on: Callable[[], bool],
    ) -> None:
        """Submit chunks and collect results until all jobs are done or ``go_on()`` is false."""
        while not self.finished() and (go_on() or self.futures):
            if go_on():
                self.hand_out(workers, fmus, bar)
            if not self.futures:
                assert self.finished() or not go_on(), "nothing is under way, nothing is ready"
                continue
            finished, _ = wait(self.futures, timeout=POLL_SECONDS, return_when=FIRST_COMPLETED)
            for future in finished:
                state, task = self.futures.pop(future)
                state.add_result(task, *future.result())
                self.computed_items += len(task.items)
            bar.update(self.done() - bar.n)

    def fmus_to_send(self, workers: Workers) -> dict[str, Path | bytes]:
        """Return FMUs by model as workers get them: paths, or bytes for remote workers."""
        return {
            model: fmu.path.read_bytes() if workers.remote else fmu.path.resolve()
            for model, fmu in self.fmus.items()
        }

    def hand_out(self, workers: Workers, fmus: Mapping[str, Path | bytes], bar: Any) -> None:
        """Submit the next tasks of all ready jobs until the workers' queue is full."""
        for state in self.states.values():
            while len(self.futures) < workers.max_in_flight() and self.ready(state):
                task = state.next_task()
                if task is None:
                    break
                chosen = {model: fmus[model] for model in state.job.models}
                state.under_way.add(task.chunk.index)
                self.describe(bar, state.job.progress_note(task.chunk.start))
                code = state.identity["code"] if workers.remote else None
                future = workers.executor.submit(
                    compute, state.job, chosen, task.items, task.previous, task.warmup_items, code
                )
                self.futures[future] = state, task

    def ready(self, state: Progress) -> bool:
        """Return whether a job has chunks to compute; make its items at first."""
        if state.complete:
            return False
        if state.items is None:
            state.start()
        return not state.complete


def import_xarray() -> None:
    """Import xarray and what datasets need early, as it takes most of a second."""
    with suppress(Exception):  # a process that ends lets nobody import; it comes again where used
        import xarray as xr

        xr.Dataset({"number": ("place", np.zeros(1))})


def progress_bar(shown: bool) -> Any:
    """Return tqdm's class for progress bars, of notebooks or terminals as it fits."""
    if not shown:
        from tqdm import tqdm

        return tqdm
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a notebook without widgets: it gets a line of text
        from tqdm.auto import tqdm as automatic

        return automatic


def gather(jobs: Iterable[Job], running: Mapping[str, object], find: FmuFinder) -> list[xr.Dataset]:
    """Compute several jobs in parallel with common workers; return their datasets in order."""
    listed = list(jobs)
    results = Runner(listed, RunOptions.from_keywords(running), find).run()
    return [results[job.name] for job in listed]
