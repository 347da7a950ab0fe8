"""A job computed as so many workers would, whose chunks end in a random order, in this process."""

from __future__ import annotations

import random

from orchestrate.running.executors import compute
from orchestrate.running.progress import Progress


def play(progress: Progress, workers: int, seed: int, stop: int = -1) -> None:
    """Compute a job, or so many chunks of it."""
    draw, busy = random.Random(seed), []
    fmus = {model: fmu.path for model, fmu in progress.fmus.items()}
    progress.start()
    while not progress.complete and stop != 0:
        while len(busy) < workers and (task := progress.next_task()) is not None:
            progress.under_way.add(task.chunk.index)
            busy.append(task)
        task = busy.pop(draw.randrange(len(busy)))
        answered = compute(progress.job, fmus, task.items, task.previous, task.warmup_items)
        progress.add_result(task, *answered)
        stop -= 1
