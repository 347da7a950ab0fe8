"""MATLAB's files up to version 7.2, by SciPy, which reads them in a process of its own.

SciPy's reader is compiled and trusts the sizes that a file states: a byte that has changed may end
the process that reads it.
"""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .columns import Column, Columns
from .pieces import Floats

RATES = ("sample_rate", "samplerate", "fs", "samplefrequency")  # what a MAT file calls it
STEPS = ("increment", "delta_x", "dt", "xdelta")  # and the step of its times
FREQUENCIES = ("frequency", "freq", "f", "freqs", "frequencies")  # in place of times
READER = """
import io, json, sys
sys.path[:] = json.loads(sys.argv[2])
import numpy as np
from scipy.io import loadmat
try:
    found = loadmat(sys.argv[1])
except NotImplementedError:
    answer = b"a MAT file of version 7.3; expected an earlier one: save with '-v7'"
except BaseException as error:  # what damaged files raise is not said
    text = (str(error).splitlines() or [type(error).__name__])[0][:120]
    answer = f"{text}; expected a MAT file that is whole".encode()
else:
    kept = {}
    def keep(name, one, depth=0):
        one = np.asarray(one)
        if one.dtype.names and one.size <= 64 and depth < 9:
            for i, part in enumerate(one.ravel()):
                number = f"[{i}]" if one.size > 1 else ""
                for field in one.dtype.names:
                    keep(f"{name}{number}.{field}", part[field], depth + 1)
        elif one.dtype.kind == "O" and one.size <= 64 and depth < 9:
            for i, part in enumerate(one.ravel()):
                keep(f"{name}[{i}]" if one.size > 1 else name, part, depth + 1)
        elif one.dtype.kind in "iufcU":
            kept["of " + name] = one
    for name, one in found.items():
        if not name.startswith("__"):
            keep(name, one)
    stream = io.BytesIO()
    np.savez(stream, **kept)
    answer = stream.getvalue()
sys.stdout.buffer.write(answer)
"""  # what it answers begins with PK where it is an archive of arrays
CRASHED = "its reader broke down; expected a MAT file that is whole"


def load_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Load the arrays of numbers and texts of a MAT file by name, in a process of its own."""
    command = [sys.executable, "-c", READER, str(path.absolute()), json.dumps(sys.path)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True)
    if done.returncode or not done.stdout:
        raise InputError(f"{path}: {CRASHED}")
    if not done.stdout.startswith(b"PK"):
        raise InputError(f"{path}: {done.stdout.decode(errors='replace')}")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as arrays:
        return {name.removeprefix("of "): arrays[name] for name in arrays.files}


def read_mat(path: Path) -> Columns:
    """Read vectors of a MAT file, and columns of matrices as ``name[0]``, ``name[1]`` ..."""
    arrays = load_arrays(path)
    texts = {
        name.lower(): str(one.ravel()[0]).strip()
        for name, one in arrays.items()
        if one.dtype.kind == "U" and one.size
    }
    numbers = {name: one for name, one in arrays.items() if one.dtype.kind in "iuf"}
    spectra = spectra_text(arrays, texts)
    rate, columns = None, []
    for name, one in numbers.items():
        last = name.lower().rpartition(".")[2]
        if one.size == 1 and (last in RATES or last in STEPS):
            value = float(one.ravel()[0])
            rate = value if last in RATES else 1.0 / value if value > 0.0 else rate
        elif one.ndim == 2 and min(one.shape) == 1 and one.size > 1:
            columns.append((name, one.ravel()))
        elif one.ndim == 2 and one.shape[0] > one.shape[1]:
            columns += [(f"{name}[{i}]", column) for i, column in enumerate(one.T)]
    times = [len(values) for name, values in columns if is_time(name)]
    longest = max(times or [len(values) for _, values in columns], default=0)
    made = [
        mat_column(name, np.asarray(values, float), texts)
        for name, values in columns
        if len(values) == longest
    ]
    if not made:
        raise InputError(f"{path}: {spectra or 'no vectors of numbers'}; expected some over time")
    return Columns(str(path), made, rate, attributes={"spectra": spectra} if spectra else {})


def is_time(name: str) -> bool:
    """Return whether an array of a MAT file, or its last field, is called as times are."""
    return name.lower().rpartition(".")[2] in ("time", "t")


def mat_column(name: str, values: Floats, texts: dict[str, str]) -> Column:
    """Return a vector as a column, with the name, unit and sensitivity that stand nearest to it."""

    def nearest(*words: str) -> str:
        parents = name.lower().split(".")
        for depth in range(len(parents) - 1, -1, -1):
            above = ".".join([*parents[:depth], ""]) if depth else ""
            for key, text in texts.items():
                inside = key.removeprefix(above).split(".")
                is_own = key.startswith(above) and inside[-1] in words and len(inside) <= 3
                if text and is_own and (depth or len(inside) == 1):
                    return text
        return ""

    short = name.rpartition(".")[2]
    label = "" if is_time(name) or "." not in name else nearest("name", "channelname")
    unit = "" if is_time(name) else nearest("units", "unit", "unitlabel", "label")
    return Column(label or short, unit, values, sensitivity=nearest("sensitivity"))


def spectra_text(arrays: dict[str, NDArray[Any]], texts: dict[str, str]) -> str:
    """Return which arrays are spectra: complex numbers, or a function over the frequency."""
    complexes = [name for name, one in arrays.items() if one.dtype.kind == "c" and one.size > 1]
    over = [name for name in arrays if name.lower().rpartition(".")[2] in FREQUENCIES]
    psd = [text for text in texts.values() if re.search(r"/\s*hz", text, re.I)]
    if not (complexes or over or psd):
        return ""
    kind = f"a spectral density in {psd[0]}" if psd else "a frequency response or a spectrum"
    what = (complexes or over or [""])[0]
    return f"{kind} ({what})" if what else kind


def write_mat(path: Path, columns: list[Column], sample_rate: float) -> None:
    """Write columns as vectors of a MAT file, with ``sample_rate`` and ``units``."""
    from scipy.io import savemat

    vectors: dict[str, Any] = {column.name: column.values for column in columns}
    with path.open("wb") as file:
        savemat(file, {**vectors, "sample_rate": sample_rate, "units": columns[-1].unit})
