"""A full disk ends a sweep with one line; what was computed is kept, and the same command goes on when there is space."""

import os
import resource
import subprocess

import numpy as np
import pytest
import xarray

from orchestrate.commands.sweep_command import parse_etas
from orchestrate.fmu import describe
from orchestrate.store import Journal
from orchestrate.sweep import Case, Plan, Response

from .command import NAME
from .conftest import ROWS, RUN

SHORT = ("--eta", "1:1.06:0.001", "--transient", "5", "--samples", "400")


@pytest.fixture
def small_disk(sweeps):
    """Mount a small file system as the results folder; yields a function that gives it another size."""
    sweeps.output.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=400k", "none", str(sweeps.output)]
    if os.name != "posix" or os.geteuid() != 0 or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("file systems cannot be mounted here")

    def resize(size):
        subprocess.run(["mount", "-o", f"remount,size={size}", str(sweeps.output)], check=True)

    yield resize
    sweeps.clean_up()
    subprocess.run(["umount", str(sweeps.output)], check=True)


def complete_journal(sweeps):
    """Write a journal of SHORT as its worker leaves it, with made-up rows; returns the samples."""
    numbers = np.random.default_rng(1)
    plan = Plan(Case(), parse_etas(SHORT[1])[0], 5, 400, 1e-2, describe(sweeps.fmu).guid)
    journal = Journal(sweeps.journal(), plan.identity())
    samples = numbers.uniform(size=(len(plan.etas), 400))
    for index, row in enumerate(samples):
        journal.append(index, Response(row, 1.0, False, float(row.max()), 1, (0.0, 0.0, 0.0, 0.0)).row())
    journal.close()
    return samples


def fill(folder, left):
    """Fill a file system but for ``left`` bytes; returns the file in the way."""
    ballast = folder / "ballast"
    space = os.statvfs(folder)
    ballast.write_bytes(b"x" * (space.f_bavail * space.f_bsize - left))
    return ballast


def test_full_disk_while_the_journal_grows(sweeps, small_disk, uninterrupted):
    sweeps.run(*RUN).complaint(sweeps.journal(), "full", "goes on")
    kept = sweeps.rows()
    assert 5 < kept < ROWS
    assert not sweeps.result().exists()
    small_disk("20m")
    done = sweeps.run(*RUN).success()
    assert done.counts[0] >= kept
    assert sweeps.result().read_bytes() == uninterrupted


def test_full_disk_before_the_first_row(sweeps, small_disk, uninterrupted):
    ballast = fill(sweeps.output, 16384)
    sweeps.run(*RUN).complaint(sweeps.output)
    ballast.unlink()
    small_disk("20m")
    sweeps.run(*RUN).success()
    assert sweeps.result().read_bytes() == uninterrupted


@pytest.fixture
def full_at_the_end(sweeps, small_disk):
    """Run a sweep whose last row fits on the disk and whose result file does not; yields answer, samples and the file in the way."""
    small_disk("2m")
    samples = complete_journal(sweeps)
    ballast = fill(sweeps.output, 120_000)
    answer = sweeps.run(*SHORT)
    yield answer, samples, ballast


def test_full_disk_when_the_result_is_written(sweeps, full_at_the_end):
    answer, samples, ballast = full_at_the_end
    answer.complaint(code=answer.code)
    assert answer.code != 0
    assert not sweeps.result().exists()
    assert not [name for name in sweeps.files() if name.endswith(".tmp")]
    assert sweeps.rows() == len(samples)
    ballast.unlink()
    sweeps.run(*SHORT).success()
    np.testing.assert_array_equal(xarray.load_dataset(sweeps.result()).xi_rel, samples)
    assert sweeps.files() == [f"{NAME}.nc", f"{NAME}.png"]


def test_full_disk_when_the_result_is_written_is_called_so(sweeps, full_at_the_end):
    line = full_at_the_end[0].complaint(sweeps.result(), "goes on")
    assert "Permission denied" not in line


def test_file_size_limit(sweeps, uninterrupted):
    # as a quota: EFBIG instead of ENOSPC, within what the FMU itself needs when it is unpacked
    limit = 600_000
    answer = sweeps.run(*RUN, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
    answer.complaint(sweeps.journal(), "goes on")
    kept = sweeps.rows()
    assert 5 < kept < ROWS
    done = sweeps.run(*RUN).success()
    assert done.counts[0] >= kept
    assert sweeps.result().read_bytes() == uninterrupted
