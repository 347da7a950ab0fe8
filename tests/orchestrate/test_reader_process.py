"""Files from anybody: whatever happens to the process that reads one, it is a line, and little."""

import runpy
import sys
import time

import numpy as np
import pytest

from orchestrate import InputError, reader_process
from orchestrate.reader_process import IDLE, ReaderProcess, read_in_process

# runpy.run_path, as a reader, does in the process of readers what its file says
MISHAPS = {
    "import os; os.abort()": "its reader broke down",
    "import os; os.closerange(3, 9); raise ValueError": "its reader broke down",
    "import sys; sys.exit(3)": "3",
    "raise ValueError('one\\x1b[2J\\ntwo')": r"one\\x1b\[2J",
    "raise KeyboardInterrupt": "KeyboardInterrupt",
    "def f(): f()\nf()": "maximum recursion depth exceeded",
    "f = 5": "data of the type .*",
}
HANGS = ("import time; time.sleep(60)", "while True: pass")
BOMBS = {
    "x = bytearray(6 << 30)": "more memory than a file of its size needs",
    "import numpy; numpy.ones(1 << 30)": "Unable to allocate 8.00 GiB for an array",
    "x = []\nwhile True: x.append(bytes(1 << 20))": "more memory than a file of its size needs",
}


def check_mishap(path, text, words):
    """Run a text in the process of readers: it ends with a line."""
    path.write_text(text)
    with pytest.raises(InputError, match=rf"a\.py: {words}.*; expected better$") as error:
        read_in_process(runpy.run_path, path, expected="expected better")
    assert str(error.value).isprintable() and len(str(error.value)) < 1000


@pytest.mark.parametrize("text", MISHAPS)
def test_a_reader_that_fails_is_one_line(tmp_path, text):
    check_mishap(tmp_path / "a.py", text, MISHAPS[text])


@pytest.mark.parametrize("text", HANGS)
def test_a_reader_that_hangs_is_ended(tmp_path, monkeypatch, text):
    monkeypatch.setattr(reader_process, "SECONDS", 0.2)
    begun = time.monotonic()
    check_mishap(tmp_path / "a.py", text, "not read within 0.2 s")
    assert time.monotonic() - begun < 30.0


@pytest.mark.skipif(sys.platform != "linux", reason="limits of Linux")
@pytest.mark.parametrize("text", BOMBS)
def test_a_reader_has_little_memory(tmp_path, text):
    check_mishap(tmp_path / "a.py", text, BOMBS[text])


def test_no_module_in_the_folders_of_a_user_is_imported(tmp_path, monkeypatch):
    """A folder of measurements may come from anybody, with Python files in it."""
    for name in ("json", "io", "numpy", "scipy", "types", "csv", "sitecustomize", "unheard_of"):
        (tmp_path / f"{name}.py").write_text("open('ran', 'w').close(); raise SystemError('ran')")
    path = tmp_path / "a.csv"
    path.write_text("import csv, json, io, os, scipy, sys, types, unheard_of\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.syspath_prepend("")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    while IDLE:
        IDLE.popitem()[1].close()
    with pytest.raises(InputError, match="No module named 'unheard_of'"):
        read_in_process(runpy.run_path, path, expected="")
    assert not list(tmp_path.glob("ran"))


@pytest.mark.parametrize("kind", ["f8", ">i2", "c16", "?", "U5", "S3"])
@pytest.mark.parametrize("shape", [(), (0,), (2, 3)])
def test_arrays_come_back_with_their_bits(tmp_path, kind, shape):
    path, drawn = tmp_path / "a.npy", np.random.default_rng(1).integers(0, 2, shape)
    array = np.asarray(drawn).astype(kind)
    np.save(path, array)
    back = read_in_process(np.load, path, expected="")
    assert back.dtype == array.dtype and back.shape == shape and (back == array).all()


def test_an_answer_is_of_plain_arrays_and_within_its_size():
    child = object.__new__(ReaderProcess)
    child.read_exactly = bytearray
    assert child.unpack_value({"array": "<f8", "shape": [10]}, [80]).tolist() == [0.0] * 10
    for kind, shape in (("<f8", [11]), ("O", [2]), ("V8", [2]), ("<f8", [-1]), ("<f8", [9, 9])):
        with pytest.raises(ValueError, match="^$"):
            child.unpack_value({"array": kind, "shape": shape}, [80])
