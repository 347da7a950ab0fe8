"""Unpacked FMUs: once a process, gone at its end, and after a kill with the next process."""

from __future__ import annotations

import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from fmu_src.version import VERSION
from orchestrate.errors import InputError, StoreError
from orchestrate.fmu import FORMS, OSCILLATOR, Instance, describe, find_or_export
from orchestrate.fmu.unpacked import unpack_once
from orchestrate.temporary import PREFIX, process_temporary_folder
from tests.campaigns import archives

from ...sparing import ordinary
from ..test_files import OTHER_CONTAINER, in_other_containers
from .altered import altered_fmu

PROGRAM = Path(__file__).with_name("processes.py")


@pytest.fixture(params=ordinary(FORMS, ["fmi3"]))
def used_fmu(request, oscillator_in):
    """The usual form, and the others in the slow tests: what cleans up knows no form."""
    return oscillator_in(request.param)


@pytest.fixture
def process(tmp_path, used_fmu):
    """Start a process whose temporary folder is the test's."""
    started = []

    def start(ending, container=()):
        command = [*container, sys.executable, str(PROGRAM), str(used_fmu), ending]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        environment = {**os.environ, "TMPDIR": str(tmp_path)}
        started.append(subprocess.Popen(command, env=environment, text=True, **pipes))
        return started[-1]

    yield start
    for one in started:
        one.kill()
        one.communicate()


def ours(folder):
    return sorted(path.name for path in folder.glob(f"{PREFIX}*"))


def test_nothing_is_left_of_a_process_and_its_fork(process, tmp_path):
    one = process("fork")
    out, err = one.communicate()
    assert one.returncode == 0, err
    assert ours(tmp_path) == [] and len(set(out.split())) == 2


def test_what_a_killed_process_left_is_removed_by_the_next_and_nothing_else(process, tmp_path):
    waiting = process("wait")
    folder = Path(waiting.stdout.readline().strip())
    process("kill").communicate()
    left = set(ours(tmp_path)) - {folder.name}
    assert len(left) == 1 and list((tmp_path / left.pop()).iterdir())
    foreign = [tmp_path / f"{PREFIX}mine", tmp_path / "vibroimpact"]
    for path in foreign:
        path.mkdir()
    (tmp_path / f"{PREFIX}link").symlink_to(tmp_path / "vibroimpact")
    process("well", OTHER_CONTAINER if in_other_containers() else []).communicate()
    assert {folder, *foreign} <= set(tmp_path.iterdir())
    assert len(ours(tmp_path)) == 3 and (tmp_path / "vibroimpact").is_dir()
    assert waiting.communicate("\n")[1] == "" and waiting.returncode == 0
    assert not folder.exists()


def test_a_process_unpacks_an_fmu_once(used_fmu, tmp_path):
    with Instance(used_fmu), Instance(used_fmu, name="second"):
        first = unpack_once(describe(used_fmu))
    stamp = (first / "modelDescription.xml").stat().st_mtime_ns
    copy = tmp_path / "copy.fmu"
    copy.write_bytes(used_fmu.read_bytes())
    with Instance(copy):
        assert unpack_once(describe(copy)) == first  # the bytes decide, not the name
    assert (first / "modelDescription.xml").stat().st_mtime_ns == stamp


def test_what_cannot_be_unpacked_leaves_nothing(used_fmu, tmp_path, monkeypatch):
    import fmpy

    def full(_, target):
        Path(target).mkdir()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(fmpy, "extract", full)
    fmu = altered_fmu(used_fmu, tmp_path / "mine.fmu", version=(VERSION, "0.1.3"))
    before = set(process_temporary_folder().iterdir())
    with pytest.raises(StoreError, match=r"cannot be unpacked \(No space left on device\)"):
        Instance(fmu)
    assert set(process_temporary_folder().iterdir()) == before


def test_an_fmu_that_changes_after_it_was_described_is_refused(oscillator_in, tmp_path):
    good = oscillator_in("fmi3")
    fmu = altered_fmu(good, tmp_path / "mine.fmu", version=(VERSION, "0.1.4"))
    description = describe(fmu)
    fmu.write_bytes(good.read_bytes())
    with pytest.raises(InputError, match="it has changed since it was read; expected"):
        unpack_once(description)


REFUSED = ("path traversal", "link", "bomb", "crowd of files", "a name twice", "no FMU")


@pytest.fixture(scope="module")
def good(exported):
    return find_or_export(OSCILLATOR).path


@pytest.mark.parametrize("kind", REFUSED[:-1])
def test_an_enemys_archive_is_refused_in_a_line(good, tmp_path, monkeypatch, kind):
    monkeypatch.setattr("orchestrate.fmu.description.MAX_BYTES", 1 << 24)
    monkeypatch.setattr(archives, "BOMB", 1 << 25)
    monkeypatch.setattr(archives, "CROWD", 10_001)  # more than MAX_FILES
    for seed in range(1 if kind in ("bomb", "crowd of files") else 2):
        archives.write(kind, good, tmp_path / "bad.fmu", random.Random(seed))
        with pytest.raises(InputError, match="not readable as an FMU"):
            describe(tmp_path / "bad.fmu")
    assert [path.name for path in tmp_path.iterdir()] == ["bad.fmu"]
