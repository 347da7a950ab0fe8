"""An FMU is described as it is now, and what is none is refused in one line."""

import shutil

import pytest

from orchestrate.errors import InputError
from orchestrate.fmu import MOTOR_SHAKER, OSCILLATOR, describe, find

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


def test_an_fmu_that_changes_is_described_anew(tmp_path, any_fmu):
    path = tmp_path / "mine.fmu"
    shutil.copy(any_fmu, path)
    assert describe(path).name == OSCILLATOR
    shutil.copy(find(MOTOR_SHAKER, any_fmu.parent.name).path, path)
    assert describe(path).name == MOTOR_SHAKER
