"""An FMU is described as it is now, and what is none is refused in one line."""

import os
import time

import pytest

from orchestrate.errors import InputError
from orchestrate.fmu import OSCILLATOR, describe
from orchestrate.fmu.description import QUIET, digest_of
from orchestrate.fmu.unit_names import parse_unit

from .altered import altered_fmu


def changed(words):
    return lambda fmu, path: altered_fmu(fmu, path, **words)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda fmu, path: None, "no such file.*orchestrate build"),
        (lambda fmu, path: path.mkdir(), "no such file"),
        (lambda fmu, path: path.write_bytes(bytes(range(256)) * 20), "not readable"),
        (lambda fmu, path: path.write_bytes(fmu.read_bytes()[:-2000]), "not readable"),
        (lambda fmu, path: path.touch(), "not readable"),
        (changed({"causality": ("parameter", "whim")}), "not readable"),
        (changed({"modelName": (OSCILLATOR, "Ball")}), f"model Ball.*expected {OSCILLATOR}"),
    ],
)
def test_what_is_no_fmu_of_the_model(tmp_path, any_fmu, make, words):
    path = tmp_path / "made.fmu"
    make(any_fmu, path)
    with pytest.raises(InputError, match=words) as error:
        describe(path, OSCILLATOR)
    line = str(error.value)
    assert line.startswith(f"FMU {path}: ") and "expected" in line and "\n" not in line


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


METRE, ACCELERATION, FORCE = {"m": 1}, {"m": 1, "s": -2}, {"kg": 1, "m": 1, "s": -2}
KNOWN = {
    **dict.fromkeys(("m/s2", "m/s^2", "m/s²", "m.s-2", "m*s^(-2)", "m/s/s"), (ACCELERATION, 1.0)),
    **{"mm/s2": (ACCELERATION, 1e-3), "mm": (METRE, 1e-3), "\u00b5m": (METRE, 1e-6)},
    **{"N": (FORCE, 1.0), "kN": (FORCE, 1e3), "kg.m/s2": (FORCE, 1.0), "g mm/s2": (FORCE, 1e-6)},
    **{"N/s": ({**FORCE, "s": -3}, 1.0), "m/min": ({"m": 1, "s": -1}, 1 / 60), "m/m": ({}, 1.0)},
}


@pytest.mark.parametrize("name", KNOWN)
def test_a_unit_is_what_its_name_says(name):
    exponents, factor = KNOWN[name]
    unit = parse_unit(name)
    assert unit is not None and unit.exponents == exponents
    assert unit.factor == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize("name", ["", "g", "fathom", "1", "m/", "m//s", "%", "m2x"])
def test_what_is_not_sure_is_not_guessed(name):
    assert parse_unit(name) is None
