"""A sequential job on many workers: guessed chunks that stand, and others that do not."""

import random
from unittest.mock import patch

import numpy as np
import pytest

from orchestrate.fmu import OSCILLATOR, find_or_export
from orchestrate.model import Structure
from orchestrate.response.sweep import SweepJob
from orchestrate.running.chunk_schedule import ChunkSchedule
from orchestrate.running.executors import compute_chunk
from orchestrate.running.options import RunOptions
from orchestrate.running.store import Store, open_store
from tests.sparing import ordinary

from .sums import Forgetful, Model

RANGES = [(0, 0), (100, 140), (55, 200), (0, 240), (119, 121)]
MODELS = {OSCILLATOR: Model(None)}


def play(schedule: ChunkSchedule, workers: int, seed: int, stop: int = -1) -> None:
    """Compute a job, or so many chunks of it, as if by workers that end in a random order."""
    draw, busy = random.Random(seed), []
    fmus = {model: fmu.path for model, fmu in schedule.fmus.items()}
    while not schedule.is_complete and stop != 0:
        while len(busy) < workers and (task := schedule.next_task()) is not None:
            schedule.under_way.add(task.chunk.index)
            busy.append(task)
        task = busy.pop(draw.randrange(len(busy)))
        chunk = compute_chunk(schedule.job, fmus, task.items, task.previous, task.warmup_items)
        schedule.add_result(task, *chunk)
        stop -= 1


@pytest.mark.parametrize("stubborn", RANGES)
@pytest.mark.parametrize("workers", ordinary([1, 2, 3, 7, 40], kept=[1, 2, 7]))
def test_guesses_never_change_a_bit(stubborn, workers):
    """In vain are those where the beginning is not forgotten, of 240, and the chunks next to it."""
    job = Forgetful("job", stubborn=stubborn)
    alone = job.work({}, job.items(), None)["value"]
    for seed in range(3):
        schedule = ChunkSchedule(job, Store(), {}, MODELS)
        play(schedule, workers, seed)
        assert np.array_equal(schedule.result.value, alone)
        assert schedule.wasted == 0 or (workers > 1 and stubborn != (0, 0))
        assert stubborn != (100, 140) or workers != 2 or schedule.wasted > 0
        assert schedule.wasted < (60 if stubborn == (100, 140) else 300)  # it does not go on so


def test_a_guess_is_stored_for_a_run_that_is_interrupted(tmp_path, monkeypatch):
    monkeypatch.setattr("orchestrate.running.chunk_schedule.REACH", 2)
    path = tmp_path / "job.nc"
    store = open_store("job", {}, RunOptions(store=path))
    schedule = ChunkSchedule(Forgetful("job"), store, {}, MODELS)
    certain = schedule.next_task()
    schedule.under_way.add(certain.chunk.index)
    guess = schedule.next_task()
    assert (certain.guess, guess.guess, guess.chunk.index) == (False, True, 3)  # 1 and the reach
    schedule.under_way.add(guess.chunk.index)
    made = compute_chunk(schedule.job, {}, guess.items, guess.previous, guess.warmup_items)
    schedule.add_result(guess, *made)
    store.close()
    store = open_store("job", {}, RunOptions(store=path))
    again = ChunkSchedule(Forgetful("job"), store, {}, MODELS)
    assert (set(again.guesses), again.items_done()) == ({3}, 10)
    play(again, 2, seed=0)
    assert np.array_equal(again.result.value, again.job.work({}, again.job.items(), None)["value"])


def job(direction: str):
    etas = np.round(np.arange(0.1, 8.025, 0.05), 3)
    asked = {"structure": Structure.nondimensional(), "eta": etas, "start": None}
    rest = {"transient": 40, "samples": 40, "tolerance": 1e-2, "peak_periods": 8}
    return SweepJob(**asked, **rest, name="sweep", direction=direction)


def played(sweep: SweepJob, workers: int):
    """The result, and how many values were guessed in vain."""
    fmus = {OSCILLATOR: find_or_export(OSCILLATOR)}
    with patch.object(SweepJob, "chunk_size", 10):
        schedule = ChunkSchedule(sweep, Store(), {}, fmus)
        play(schedule, workers, 1)
    return schedule.result.drop_attrs(), schedule.wasted


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize("direction", ordinary(["both", "down"]))
def test_any_number_of_workers_gives_the_same_sweep(direction):
    sweep = job(direction)
    alone, wasted = played(sweep, 1)
    assert wasted == 0
    for workers in (2, 7):
        assert played(sweep, workers)[0].identical(alone)
