"""MATLAB's files up to version 7.2, by SciPy, which reads them in a process of its own.

SciPy's reader is compiled and trusts the sizes that a file states: a byte that has changed may end
the process that reads it.
"""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .columns import Column, Columns

RATES = ("sample_rate", "samplerate", "fs")  # what a MAT file calls it
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
    whole = {name: np.asarray(one) for name, one in found.items() if not name.startswith("__")}
    kept = {"of " + name: one for name, one in whole.items() if one.dtype.kind in "iufU"}
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
    units = {name.lower(): one for name, one in arrays.items()}.get("units", np.array([""]))
    unit = str(units.ravel()[0]) if units.dtype.kind == "U" and units.size else ""
    rate, columns = None, []
    for name, one in arrays.items():
        if one.dtype.kind not in "iuf":
            continue
        if one.size == 1 and name.lower() in RATES:
            rate = float(one.ravel()[0])
        elif one.ndim == 2 and min(one.shape) == 1 and one.size > 1:
            columns.append((name, one.ravel()))
        elif one.ndim == 2 and one.shape[0] > one.shape[1]:
            columns += [(f"{name}[{i}]", column) for i, column in enumerate(one.T)]
    made = [
        Column(name, "" if name in ("time", "t") else unit, np.asarray(values, float))
        for name, values in columns
    ]
    if not made:
        raise InputError(f"{path}: no vectors of numbers; expected some")
    return Columns(str(path), made, rate)


def write_mat(path: Path, columns: list[Column], sample_rate: float) -> None:
    """Write columns as vectors of a MAT file, with ``sample_rate`` and ``units``."""
    from scipy.io import savemat

    vectors: dict[str, Any] = {column.name: column.values for column in columns}
    with path.open("wb") as file:
        savemat(file, {**vectors, "sample_rate": sample_rate, "units": columns[-1].unit})
