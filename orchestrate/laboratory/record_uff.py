"""Universal files, datasets 58 and 58b: functions over the time, by pyuff."""

from __future__ import annotations

import logging
import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from .columns import Column, Columns, Floats
from .record_labview import needed_package
from .time_base import fewest_digits

Dataset = dict[str, Any]  # as pyuff gives it
log = logging.getLogger(__name__)
TIME_RESPONSE, TIME, ACCELERATION = 1, 17, 12  # of dataset 58
FUNCTIONS = {  # of dataset 58, by their number
    **{1: "time response", 2: "auto spectrum", 3: "cross spectrum", 4: "frequency response"},
    **{5: "transmissibility", 6: "coherence", 7: "auto correlation", 8: "cross correlation"},
    **{9: "power spectral density", 10: "energy spectral density", 12: "spectrum"},
}
NOTE = "sample_rate = {!r}, start = {!r}"  # a heading has six digits of both
NOTED = re.compile(r"sample_rate = (\S+), start = (\S+)")


def read_uff(path: Path) -> Columns:
    """Read accelerations over time; other datasets are skipped, with a line in the log."""
    if not path.read_bytes().rstrip().endswith(b"    -1"):
        raise InputError(f"{path}: no '    -1' at its end; expected a universal file that is whole")
    with needed_package("pyuff", "universal files"):
        import pyuff
    file = pyuff.UFF(str(path))
    kinds, used = [], {}
    for number, kind in enumerate(map(str, map(int, file.get_set_types()))):
        dataset = file.read_sets(number) if kind == "58" else {}
        function = int(dataset.get("func_type", 0))
        if dataset and is_real_and_over_time(dataset, function):
            used[number] = dataset
            continue
        text = "%s: dataset %s, number %d, is no real function of time; skipped"
        log.info(text, path, kind, number)
        name = f" ({FUNCTIONS.get(function, f'function {function}')})" if dataset else ""
        kinds.append(f"{kind}{name}")
    if not used:
        there = ", ".join(dict.fromkeys(kinds)) or "none"
        raise InputError(f"{path}: datasets {there}; expected a dataset 58 of time response")
    number, first = next(iter(used.items()))
    for i, one in used.items():
        if len(one["data"]) != (announced := int(one["num_pts"])):
            text = f"{len(one['data'])} values; expected {announced}, as its heading says"
        elif not np.array_equal(one["x"], first["x"]):
            text = f"other times than number {number}; expected the same"
        else:
            continue
        raise InputError(f"{path}: dataset 58, number {i}: {text}")
    time = Column("time", label_of(first, "abscissa_axis_units_lab") or "s", time_values(first))
    columns = [
        Column(
            label_of(one, "id1") or f"{one.get('rsp_node', i)}:{one.get('rsp_dir', 0)}",
            label_of(one, "ordinate_axis_units_lab"),
            np.asarray(one["data"], float),
        )
        for i, one in used.items()
    ]
    return Columns(str(path), [time, *columns])


def is_real_and_over_time(dataset: Dataset, function: int) -> bool:
    kind = int(dataset.get("abscissa_spec_data_type", TIME))
    over_time = kind == TIME or (kind == 0 and function == TIME_RESPONSE)
    return over_time and not np.iscomplexobj(dataset["data"])


def label_of(dataset: Dataset, field: str) -> str:
    """Return a line of a dataset's heading; empty where the file says that there is none."""
    text = str(dataset.get(field, "")).strip()
    return "" if text.lower() == "none" else text


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
    return fewest_digits(1.0 / step, lambda rate: low <= rate <= high) or 1.0 / step


def write_uff(path: Path, columns: list[Column], sample_rate: float, binary: bool) -> None:
    """Write columns after the first, which is the time, as datasets 58 or 58b."""
    with needed_package("pyuff", "universal files"):
        import pyuff
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
