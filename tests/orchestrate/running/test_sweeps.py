"""Sweeps of Figures 6, 10 and 11 on one worker and on many, killed and resumed: the same bytes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest

from orchestrate.access import OSCILLATOR, find
from orchestrate.response.sweep import SweepJob
from orchestrate.running.journal import journal_path
from orchestrate.running.options import RunOptions
from orchestrate.running.progress import Progress
from orchestrate.running.store import Memory, open_store
from orchestrate.structures import Structure

from ...sparing import ordinary
from .workers import play

pytestmark = pytest.mark.usefixtures("exported")

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = Path(__file__).parent / "long_sweep.py"
FIGURES = {"6": (0.7, 0.005), "10": (0.7, 0.05), "11": (0.3, 0.005)}  # e and D
CHAOS = (1.0, 1.3)  # of Figure 6: irregular from 1.09 on
shorter_chunks = patch.object(SweepJob, "chunk_size", 10)


def job(figure: str, direction: str, low: float = 0.1, high: float = 8.0, step: float = 0.02):
    """A figure's sweep at fewer frequencies, over fewer periods."""
    e, D = FIGURES[figure]
    etas = np.round(np.arange(low, high + 0.5 * step, step), 3)
    structure = Structure.nondimensional(e=e, D=D)
    asked = {"structure": structure, "eta": etas, "direction": direction, "start": None}
    rest = {"transient": 40, "samples": 40, "tolerance": 1e-2, "peak_periods": 8}
    return SweepJob(**asked, **rest, name="sweep")


def progress_of(sweep: SweepJob, store=None) -> Progress:
    """Where a sweep begins."""
    return Progress(sweep, store or Memory(), {}, {OSCILLATOR: find(OSCILLATOR)})


def answer(sweep: SweepJob, workers: int, seed: int = 1):
    """The result, and how many values were guessed in vain."""
    progress = progress_of(sweep)
    play(progress, workers, seed)
    return progress.result.drop_attrs(), progress.wasted


@shorter_chunks
@pytest.mark.parametrize("figure", ordinary(FIGURES))
@pytest.mark.parametrize("direction", ["up", "down"])
def test_any_number_of_workers_gives_the_same_sweep(figure, direction):
    sweep = job(figure, direction)
    alone, wasted = answer(sweep, 1)
    assert wasted == 0
    for workers in (2, 3, 7):
        many, _ = answer(sweep, workers)
        assert alone.identical(many)


@shorter_chunks
def test_where_responses_repeat_after_one_period_most_guesses_stand():
    sweep = replace(job("6", "up", 1.4, 2.0, 0.005), transient=500, samples=200)
    alone, _ = answer(sweep, 1)
    many, wasted = answer(sweep, 7)
    assert alone.identical(many)
    assert wasted < alone.sizes["eta"] / 4


@shorter_chunks
@pytest.mark.parametrize("low", [4.0, 5.8])
def test_where_they_repeat_after_more_what_stands_is_right(low):
    """A guess arrives in any of the phases: where in another one, it is thrown away."""
    sweep = replace(job("6", "up", low, low + 0.6, 0.005), transient=500, samples=200)
    alone, _ = answer(sweep, 1)
    many, _ = answer(sweep, 7)
    assert alone.identical(many)


@shorter_chunks
@pytest.mark.parametrize("direction", ["up", "both"])
def test_chaos_is_cut_in_the_middle(direction):
    sweep = job("6", direction, *CHAOS, 0.002)
    alone, _ = answer(sweep, 1)
    in_vain = 0
    for workers in (2, 3, 7):
        many, wasted = answer(sweep, workers)
        assert alone.identical(many)
        in_vain += wasted
    assert in_vain > 0  # where nothing is forgotten, it is seen


@shorter_chunks
@pytest.mark.parametrize("workers", [1, 3])
def test_killed_and_resumed_by_another_number_of_workers(tmp_path, monkeypatch, workers):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    sweep = job("6", "both", *CHAOS, 0.004)
    whole, broken = tmp_path / "whole.nc", tmp_path / "broken.nc"
    for path, stops in ((whole, [-1]), (broken, [3, 4, 5, -1])):
        for seed, stop in enumerate(stops):
            store = open_store("sweep", {}, RunOptions(store=path))
            play(progress_of(sweep, store), workers + seed if path == broken else 1, seed, stop)
            store.close()
    assert whole.read_bytes() == broken.read_bytes()


# -- in full, on processes ------------------------------------------------------------------------


def run(store: Path, jobs: int, figure: str, direction: str, seconds: float | None = None) -> None:
    """A figure's whole sweep by a script; killed after some seconds."""
    arguments = (store, jobs, *FIGURES[figure], direction)
    process = subprocess.Popen(
        [sys.executable, str(SCRIPT), *map(str, arguments)],
        cwd=store.parent,
        env={**os.environ, "PYTHONPATH": str(ROOT), "SOURCE_DATE_EPOCH": "0"},
        start_new_session=True,
    )
    if seconds is not None:
        time.sleep(seconds)
        os.killpg(process.pid, signal.SIGKILL)
    assert process.wait(timeout=300) == 0 or seconds is not None


@pytest.mark.slow
@pytest.mark.parametrize("figure", FIGURES)
@pytest.mark.parametrize("direction", ["up", "down"])
def test_whole_figures_are_equal_files(tmp_path, figure, direction):
    files = {jobs: tmp_path / f"{jobs}.nc" for jobs in (1, 2, 3, 7)}
    for jobs, path in files.items():
        run(path, jobs, figure, direction)
    killed = tmp_path / "killed.nc"
    for jobs in (2, 7):
        run(killed, jobs, figure, direction, seconds=3.0)
    assert journal_path(killed).exists() or killed.exists()
    run(killed, 3, figure, direction)
    alone = files[1].read_bytes()
    for path in (*files.values(), killed):
        assert path.read_bytes() == alone, path.name
