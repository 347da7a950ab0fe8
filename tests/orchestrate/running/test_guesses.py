"""A sequential job on many workers: guessed chunks that stand, and others that do not."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrate.running import runner
from orchestrate.running.executors import compute
from orchestrate.running.journal import Journal, journal_path
from orchestrate.running.options import RunOptions
from orchestrate.running.progress import Progress
from orchestrate.running.runner import answer
from orchestrate.running.store import Memory

from .sums import Forgetful, Squares
from .workers import play

RANGES = [(0, 0), (100, 140), (55, 200), (0, 240), (119, 121)]


def sequential(job):
    """The values, one chunk after the other."""
    return job.work({}, job.items(), None)["value"]


@pytest.fixture
def models(find):
    """The FMUs of a job."""
    return {model: find(model) for model in Squares.models}


@pytest.mark.parametrize("stubborn", RANGES)
@pytest.mark.parametrize("workers", [1, 2, 3, 7, 40])
def test_guesses_never_change_a_bit(models, stubborn, workers):
    job = Forgetful("job", stubborn=stubborn)
    for seed in range(5):
        progress = Progress(job, Memory(), {}, models)
        play(progress, workers, seed)
        assert np.array_equal(progress.result.value, sequential(job))
        assert workers > 1 or progress.wasted == 0


def test_where_the_beginning_is_forgotten_nothing_is_wasted(models):
    progress = Progress(Forgetful("job"), Memory(), {}, models)
    play(progress, 7, 1)
    assert progress.wasted == 0


def test_what_does_not_forget_is_guessed_in_vain_and_no_more(models):
    progress = Progress(Forgetful("job", stubborn=(100, 140)), Memory(), {}, models)
    play(progress, 2, 1)
    assert 0 < progress.wasted <= 60  # the range itself and the chunks it touches


@pytest.mark.parametrize("stubborn", RANGES[:3])
def test_processes_give_equal_files(find, tmp_path, monkeypatch, stubborn):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    job = Forgetful("job", stubborn=stubborn, pause=1e-4)
    one, many = tmp_path / "one.nc", tmp_path / "many.nc"
    answer(job, {"jobs": 1, "store": one}, find)
    monkeypatch.setattr(runner, "MIN_PARALLEL_SECONDS", 0.0)
    answer(job, {"jobs": 3, "store": many}, find)
    assert one.read_bytes() == many.read_bytes()


def test_what_is_on_disk_is_certain(find, tmp_path, models):
    path = tmp_path / "job.nc"
    options = RunOptions(store=path)
    store = runner.open_store("job", {}, options)
    progress = Progress(Forgetful("job"), store, {}, models)
    progress.start()
    certain, guess = progress.next_task(), None
    progress.under_way.add(certain.chunk.index)
    guess = progress.next_task()
    assert (certain.guess, guess.guess) == (False, True)
    progress.under_way.add(guess.chunk.index)
    progress.add_result(
        guess, *compute(progress.job, {}, guess.items, guess.previous, guess.warmup_items)
    )
    store.close()
    journal = Journal(journal_path(path), {}, "")
    assert journal.indices() == set()
    journal.close()
