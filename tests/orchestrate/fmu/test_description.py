"""An FMU is described as it is now, and what is none is refused in one line."""

import os
import time

import pytest

from orchestrate.errors import InputError
from orchestrate.fmu import OSCILLATOR, describe
from orchestrate.fmu.description import QUIET, digest_of

from .altered import altered_fmu


def random_bytes(folder, _):
    path = folder / "random.fmu"
    path.write_bytes(bytes(range(256)) * 20)
    return path


def cut_off(folder, fmu):
    path = folder / "cut.fmu"
    path.write_bytes(fmu.read_bytes()[:-2000])
    return path


def empty_file(folder, _):
    path = folder / "empty.fmu"
    path.touch()
    return path


def foreign(folder, fmu):
    return altered_fmu(fmu, folder / "foreign.fmu", modelName=(OSCILLATOR, "BouncingBall"))


def invalid(folder, fmu):
    return altered_fmu(fmu, folder / "invalid.fmu", causality=("parameter", "whim"))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda folder, _: folder / "missing.fmu", ["no such file", "orchestrate build"]),
        (lambda folder, _: folder, ["no such file"]),
        (random_bytes, ["not readable as an FMU"]),
        (cut_off, ["not readable as an FMU"]),
        (empty_file, ["not readable as an FMU"]),
        (invalid, ["not readable as an FMU"]),
        (foreign, ["model BouncingBall", f"expected {OSCILLATOR}"]),
    ],
    ids=["missing", "folder", "random", "cut off", "empty", "invalid", "foreign"],
)
def test_what_is_no_fmu_of_the_model(tmp_path, any_fmu, make, words):
    fmu = make(tmp_path, any_fmu)
    with pytest.raises(InputError) as error:
        describe(fmu, OSCILLATOR)
    line = str(error.value)
    assert line.startswith(f"FMU {fmu}: ") and "expected" in line and "\n" not in line
    assert all(word in line for word in words), line


def test_a_file_is_read_again_only_if_it_may_have_changed(tmp_path, monkeypatch):
    """Another content of the same size and time is noticed, just after a change or long after."""
    path, now, clock = tmp_path / "a.fmu", time.time(), [0.0]
    monkeypatch.setattr(time, "time", lambda: now + clock[0])
    digests, old = [], now - 100.0
    for content, later in ((b"one", 0.0), (b"two", 0.0), (b"six", 1e3 * QUIET), (b"ten", 0.0)):
        clock[0] += later
        time.sleep(0.02 * bool(clock[0]))  # the clock of files is coarse
        path.write_bytes(content)
        os.utime(path, (old, old))
        digests.append(digest_of(path))
    assert len(set(digests)) == 4
    clock[0] += 1e3
    assert digest_of(path) == digests[-1]
    monkeypatch.setattr(type(path), "read_bytes", lambda _: pytest.fail("read again"))
    assert digest_of(path) == digests[-1]
