"""Universal files, datasets 58 and 58b: functions over the time, by pyuff."""

from __future__ import annotations

import logging
import math
import re
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from ..errors import InputError
from .columns import Column, Columns, Floats
from .record_labview import missing_package_error

Dataset = dict[str, Any]  # as pyuff gives it
log = logging.getLogger(__name__)
TIME_RESPONSE, TIME, ACCELERATION = 1, 17, 12  # of dataset 58
FUNCTIONS = {  # of dataset 58, by their number
    **{1: "time response", 2: "auto spectrum", 3: "cross spectrum", 4: "frequency response"},
    **{5: "transmissibility", 6: "coherence", 7: "auto correlation", 8: "cross correlation"},
    **{9: "power spectral density", 10: "energy spectral density", 12: "spectrum"},
}
NO_LABELS = ("", "none")
NOTE = "sample_rate = {!r}, start = {!r}"  # a heading has six digits of both
NOTED = re.compile(r"sample_rate = (\S+), start = (\S+)")


def import_pyuff() -> ModuleType:
    """Import the package pyuff; raise with the remedy if it is not installed."""
    try:
        import pyuff
    except ImportError:
        raise missing_package_error("pyuff", "universal files") from None
    return pyuff


def read_uff(path: Path) -> Columns:
    """Read accelerations over time; other datasets are skipped, with a line in the log."""
    if not path.read_bytes().rstrip().endswith(b"    -1"):
        raise InputError(f"{path}: no '    -1' at its end; expected a universal file that is whole")
    pyuff = import_pyuff()
    file = pyuff.UFF(str(path))
    kinds = [int(kind) for kind in file.get_set_types()]
    functions = [(i, file.read_sets(i)) for i, kind in enumerate(kinds) if kind == 58]
    return columns_over_time(path, kinds, functions)


def columns_over_time(
    path: Path, kinds: list[int], functions: list[tuple[int, Dataset]]
) -> Columns:
    """Return the datasets over time as columns; log those that are skipped."""
    used = [(i, one) for i, one in functions if is_real_and_over_time(one)]
    for i in sorted({*range(len(kinds))} - {i for i, _ in used}):
        log.info(
            "%s: dataset %d, number %d, is no real function of time; skipped", path, kinds[i], i
        )
    if not used:
        types = {i: int(one.get("func_type", 0)) for i, one in functions}
        named = [
            f"{kind} ({FUNCTIONS.get(types[i], f'function {types[i]}')})"
            if i in types
            else f"{kind}"
            for i, kind in enumerate(kinds)
        ]
        there = ", ".join(dict.fromkeys(named)) or "none"
        raise InputError(f"{path}: datasets {there}; expected a dataset 58 of time response")
    number, first = used[0]
    for i, one in used:
        check_point_count(path, i, one)
        if not np.array_equal(one["x"], first["x"]):
            text = f"other times than number {number}; expected the same"
            raise InputError(f"{path}: dataset 58, number {i}: {text}")
    label = str(first.get("abscissa_axis_units_lab", "")).strip()
    time = Column("time", "s" if label.lower() in NO_LABELS else label, time_values(first))
    return Columns(str(path), [time, *(column_from_dataset(i, one) for i, one in used)])


def is_real_and_over_time(dataset: Dataset) -> bool:
    kind = int(dataset.get("abscissa_spec_data_type", TIME))
    time_response = int(dataset.get("func_type", 0)) == TIME_RESPONSE
    over_time = kind == TIME or (kind == 0 and time_response)
    return over_time and not np.iscomplexobj(dataset["data"])


def time_values(dataset: Dataset) -> Floats:
    """Return the times of a dataset, by the roundest sampling rate that its step allows."""
    if int(dataset["abscissa_spacing"]) != 1:
        return np.asarray(dataset["x"], float)
    noted = NOTED.search(str(dataset.get("id5", "")))
    start, step = float(dataset["abscissa_min"]), float(dataset["abscissa_inc"])
    rate = roundest_rate_for_step(step)
    if noted is not None and math.isclose(float(noted[1]), rate, rel_tol=1e-4):
        rate, start = float(noted[1]), float(noted[2])
    return start + np.arange(len(dataset["data"])) / rate


def roundest_rate_for_step(step: float) -> float:
    """Return the roundest sampling rate whose step is equal to this one to six digits."""
    if not 0.0 < step < math.inf:
        raise InputError(f"abscissa increment {step!r}; expected a number > 0")
    half = 0.5001 * 10.0 ** (math.floor(math.log10(step)) - 5)
    low, high = 1.0 / (step + half), 1.0 / (step - half)
    for digits in range(1, 10):
        rate = float(f"{1.0 / step:.{digits}g}")
        if low <= rate <= high:
            return rate
    return 1.0 / step


def check_point_count(path: Path, number: int, dataset: Dataset) -> None:
    """Check that a dataset has as many values as its heading announces."""
    announced = int(dataset["num_pts"])
    if len(dataset["data"]) != announced:
        text = f"{len(dataset['data'])} values; expected {announced}, as its heading says"
        raise InputError(f"{path}: dataset 58, number {number}: {text}")


def column_from_dataset(number: int, dataset: Dataset) -> Column:
    """Convert a dataset to a column, named by its first line or by its node and direction."""
    name = str(dataset.get("id1", "")).strip()
    if name.lower() in NO_LABELS:
        name = f"{dataset.get('rsp_node', number)}:{dataset.get('rsp_dir', 0)}"
    unit = str(dataset.get("ordinate_axis_units_lab", "")).strip()
    return Column(
        name, "" if unit.lower() in NO_LABELS else unit, np.asarray(dataset["data"], float)
    )


def write_uff(path: Path, columns: list[Column], sample_rate: float, binary: bool) -> None:
    """Write columns after the first, which is the time, as datasets 58 or 58b."""
    pyuff = import_pyuff()
    time, *channels = columns
    datasets = [
        pyuff.prepare_58(
            **{"binary": int(binary), "func_type": TIME_RESPONSE, "id1": column.name},
            **{"id5": NOTE.format(sample_rate, float(time.values[0]))},
            **{"rsp_node": node, "rsp_dir": 3, "ref_node": 0, "ref_dir": 0},
            **{"x": time.values, "data": column.values, "abscissa_spacing": 1},
            **{"abscissa_min": float(time.values[0]), "abscissa_inc": 1.0 / sample_rate},
            **{"abscissa_spec_data_type": TIME, "abscissa_axis_units_lab": time.unit},
            **{"ordinate_spec_data_type": ACCELERATION, "ordinate_axis_units_lab": column.unit},
            **{"orddenom_spec_data_type": 0},
        )
        for node, column in enumerate(channels)
    ]
    pyuff.UFF(str(path)).write_sets(datasets, mode="add")  # overwriting 58b it loses the heading
