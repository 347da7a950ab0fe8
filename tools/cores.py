"""Predict how a sweep of Figure 6 scales with cores: ``python -m tools.cores``.

The plan of chunks is played with so many workers. Each chunk is computed once for each state it is
begun from, for real and timed, in this process: which guesses stand and what each costs is
measured, only the clock is simulated.
"""

from __future__ import annotations

import argparse
import heapq
import time
from dataclasses import dataclass, field
from unittest.mock import patch

import numpy as np

from orchestrate.access import OSCILLATOR, find
from orchestrate.response.sweep import SweepJob
from orchestrate.running.executors import compute
from orchestrate.running.job import Table
from orchestrate.running.progress import Progress, Task
from orchestrate.running.store import Memory
from orchestrate.structures import Structure

WORKERS = (1, 2, 4, 8, 16, 32, 64, 128, 256, 1000)
Done = tuple[bytes, Table]


def figure_6_job(step: float) -> SweepJob:
    """Return the job of the paper's sweep with a step of the frequency ratio."""
    etas = np.round(np.arange(0.1, 8.0 + 0.5 * step, step), 3)
    rest = {"direction": "up", "transient": 500, "samples": 200, "tolerance": 1e-2}
    call = {"structure": Structure.nondimensional(), "eta": etas, "start": None, **rest}
    return SweepJob.from_call({**call, "peak_periods": 8}, name="figure 6")


@dataclass
class TimedChunks:
    """Cache of chunks computed once each, with the processor seconds they took."""

    known: dict[tuple[int, bytes], tuple[Done, float]] = field(default_factory=dict)

    def compute(self, job: SweepJob, task: Task) -> tuple[Done, float]:
        """Return a chunk's result and its seconds; compute it only the first time."""
        begun = (
            job.boundary_state(task.previous)
            if task.previous is not None
            else repr(task.warmup_items).encode()
        )
        key = task.chunk.start, begun
        if key not in self.known:
            fmus = {OSCILLATOR: find(OSCILLATOR).path}
            clock = time.process_time()
            done = compute(job, fmus, task.items, task.previous, task.warmup_items)
            self.known[key] = done, time.process_time() - clock
        return self.known[key]


def simulate_schedule(
    job: SweepJob, workers: int, clockwork: TimedChunks, each: float
) -> tuple[float, int]:
    """Return the seconds a job would take on some workers, and the wasted guessed values."""
    progress = Progress(job, Memory(), {}, {OSCILLATOR: find(OSCILLATOR)})
    progress.start()
    busy: list[tuple[float, int, Task, Done]] = []
    now = 0.0
    while not progress.complete:
        while len(busy) < workers and (task := progress.next_task()) is not None:
            progress.under_way.add(task.chunk.index)
            done, seconds = clockwork.compute(job, task)
            heapq.heappush(busy, (now + seconds + each, task.chunk.index, task, done))
        now, _, task, done = heapq.heappop(busy)
        progress.add_result(task, *done)
    return now, progress.wasted


def main() -> None:
    """Print a table of a sweep's seconds and efficiency with more and more workers."""
    parser = argparse.ArgumentParser(prog="python -m tools.cores", description=__doc__)
    parser.add_argument("--step", type=float, default=0.001, help="of the frequency ratio")
    parser.add_argument("--chunk", type=int, default=SweepJob.chunk_size, help="values a chunk")
    parser.add_argument("--each", type=float, default=2e-3, help="seconds beside, a chunk")
    arguments = parser.parse_args()
    job, clockwork = figure_6_job(arguments.step), TimedChunks()
    find(OSCILLATOR)
    with patch.object(SweepJob, "chunk_size", arguments.chunk):
        print(f"{job.count()} values in {len(job.chunks())} chunks")
        print("workers   seconds   efficiency   guessed in vain")
        simulate_schedule(job, 1, clockwork, arguments.each)
        clockwork.known.clear()  # the first time all is loaded
        alone = 0.0
        for workers in WORKERS:
            seconds, wasted = simulate_schedule(job, workers, clockwork, arguments.each)
            alone = alone or seconds
            part = alone / (workers * seconds)
            print(f"{workers:7d}{seconds:10.2f}{part:13.3f}{wasted:18d}", flush=True)


if __name__ == "__main__":
    main()
