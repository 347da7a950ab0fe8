"""Damaged journals and results: told with what to do, or computed anew; never other numbers."""

from __future__ import annotations

import random
from contextlib import suppress
from pathlib import Path

import netCDF4
import pytest
import xarray as xr

from orchestrate.errors import InputError, StoreError
from orchestrate.running.checksum import ATTRIBUTE, checksum
from orchestrate.running.journal import Journal, journal_path
from orchestrate.running.runner import compute_dataset
from tests.faults import FILE_DAMAGE, ROW_DAMAGE, a_shorter_row, rows, too_many_rows
from tests.sparing import ordinary

from .sums import Squares, interrupted

SQUARES = [float(i * i) for i in range(30)]
JOB = Squares("squares", size=30)


@pytest.fixture
def path(tmp_path) -> Path:
    return tmp_path / "squares.nc"


@pytest.fixture
def journal(find, path) -> Path:
    """Journal of the job, which was interrupted after seven of ten chunks."""
    with interrupted(Squares, 22) as ended:
        compute_dataset(JOB, {"store": path, "jobs": 1}, find)
    assert ended.value.__notes__ == ["what was stored is kept: the same call resumes"]
    return journal_path(path)


def numbers(find, path, **running) -> list[float]:
    return list(compute_dataset(JOB, {"store": path, **running}, find).square.values)


def right_or_told(path: Path, damaged: Path, find) -> bool:
    """Whether the job is refused, in a line with its remedy; else the answer is right."""
    try:
        assert numbers(find, path) == SQUARES
    except (StoreError, InputError) as error:
        text = str(error)
        assert "\n" not in text and str(damaged) in text and "remove it" in text, text
        return True
    return False


@pytest.mark.parametrize("damage", [*FILE_DAMAGE, *ROW_DAMAGE])
@pytest.mark.parametrize("seed", ordinary(range(40)))
def test_a_damaged_journal(journal, path, find, damage, seed):
    {**FILE_DAMAGE, **ROW_DAMAGE}[damage](journal, random.Random(seed))
    if right_or_told(path, journal, find):
        assert numbers(find, path, force=True) == SQUARES


def query(journal: Path, text: str, *values: object) -> None:
    opened = Journal(journal, {}, "")
    opened._query(text, *values)
    opened.close()


@pytest.mark.parametrize(
    ("damage", "text"),
    [(a_shorter_row, "not of 3 items"), (too_many_rows, "none of the 10 of this job")],
)
def test_sealed_rows_of_another_job_are_computed_anew(journal, path, find, caplog, damage, text):
    """Even where whoever changed them knew how rows are sealed."""
    damage(journal, random.Random(1))
    opened = Journal(journal, {}, "")
    seals = [(opened._row_checksum(index, data), index) for index, data in rows(journal)]
    opened.close()
    for seal in seals:
        query(journal, "UPDATE chunks SET sha256 = ? WHERE i = ?", *seal)
    assert numbers(find, path) == SQUARES
    assert text in caplog.text


def test_a_row_damaged_while_the_job_runs_makes_no_shorter_result(journal, path, find, monkeypatch):
    """What was sound when the job went on may be damaged when it is put together."""
    work = Squares.work

    def damage(self, fmus, items, previous):
        query(journal, "UPDATE chunks SET data = x'00' WHERE i = 2")
        return work(self, fmus, items, previous)

    with monkeypatch.context() as patch, pytest.raises(StoreError, match="chunk 2 is damaged"):
        patch.setattr(Squares, "work", damage)
        compute_dataset(JOB, {"store": path, "jobs": 1}, find)
    assert not path.exists()
    assert numbers(find, path) == SQUARES


@pytest.mark.parametrize("stop", range(4))
def test_killed_while_it_is_finished_it_leaves_nothing_behind(
    journal, path, find, tmp_path, monkeypatch, stop
):
    """Before any of the files goes that a finished result needs no more."""
    unlink, gone = Path.unlink, []

    def killed(file, missing_ok=False):
        if path.exists() and file.name.startswith(journal.name):
            gone.append(file)
            if len(gone) > stop:
                raise KeyboardInterrupt
        unlink(file, missing_ok=missing_ok)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", killed)
        with suppress(KeyboardInterrupt):
            compute_dataset(JOB, {"store": path, "jobs": 1}, find)
    assert journal.exists() == (stop == 0)
    assert numbers(find, path) == SQUARES
    assert {file.name for file in tmp_path.iterdir()} == {path.name, "model.fmu"}


@pytest.mark.parametrize("damage", FILE_DAMAGE)
@pytest.mark.parametrize("seed", ordinary(range(4)))
def test_a_damaged_result(find, path, damage, seed):
    compute_dataset(JOB, {"store": path}, find)
    FILE_DAMAGE[damage](path, random.Random(seed))
    if right_or_told(path, path, find):
        path.unlink()  # the remedy
        assert numbers(find, path) == SQUARES


def test_other_tools_read_a_result_and_numbers_changed_by_hand_are_told(find, path):
    compute_dataset(JOB, {"store": path}, find)
    with xr.open_dataset(path) as data:
        assert data.attrs[ATTRIBUTE] == checksum(data)
    with netCDF4.Dataset(path, "a") as file:
        assert file["square"][:].tolist() == SQUARES
        file["square"][4] = 17.0
    with pytest.raises(StoreError, match="do not fit its checksum"):
        compute_dataset(JOB, {"store": path}, find)
    with netCDF4.Dataset(path, "a") as file:
        file.delncattr(ATTRIBUTE)  # as the message says; and as results of earlier versions are
    assert numbers(find, path)[4] == 17.0
