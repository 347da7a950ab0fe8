"""LabVIEW's files: measurement text (.lvm) by lvm_read, binary streams (.tdms) by npTDMS."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ..errors import InputError
from .columns import Column, Columns
from .record_csv import decode_text


@contextmanager
def needed_package(package: str, kind: str) -> Iterator[None]:
    """Raise with the remedy where the package cannot be imported that files of a kind need."""
    try:
        yield
    except ImportError:
        text = f"expected the package {package}: pip install {package}"
        raise InputError(f"{kind} need a package that is not here; {text}") from None


def read_lvm(path: Path) -> Columns:
    """Read the first segment of an .lvm file; others are refused, since their times differ."""
    with needed_package("lvm_read", "LabVIEW's .lvm files"):
        import lvm_read
    text = decode_text(path, path.read_bytes())
    data = lvm_read.read_str(text)  # its read() takes a pickle that lies next to the file
    segment = data[0]
    names = list(map(str, segment["Channel names"]))
    rows = np.atleast_2d(np.asarray(segment["data"], float))
    steps, starts = segment.get("Delta_X", []), segment.get("X0", [])
    if data["Segments"] > 1:
        raise InputError(f"{path}: {data['Segments']} segments; expected one: cut the file")
    has_time = data.get("X_Columns", "One") != "No"
    named = sum(name != "Comment" for name in names[has_time:])
    channels = int(segment.get("Channels", 0))
    if named < channels:
        raise InputError(f"{path}: names of {named} channels; expected {channels}, as stated above")
    if len(names) < rows.shape[1]:
        text = f"{rows.shape[1]} columns below {len(names)} names"
        raise InputError(f"{path}: {text}; expected a .lvm file that is whole")
    units = ["s"] * has_time + list(map(str, segment.get("Y_Unit_Label", [])))
    names[:1] = ["time"] if has_time else names[:1]
    columns = [
        Column(name, unit, values)
        for name, unit, values in zip(names, units + [""] * len(names), rows.T, strict=False)
        if name != "Comment" and np.isfinite(values).any()
    ]
    even = len({*steps}) == 1 and len({*starts}) == 1 and float(steps[0]) > 0.0
    if even:  # the header has all digits of the times
        columns = [one for one in columns if one.name != "time"]
    return Columns(str(path), columns, 1.0 / float(steps[0]) if even else None)


def read_tdms(path: Path) -> Columns:
    """Read the waveforms of a .tdms file that have the same times, with their units."""
    with needed_package("npTDMS", "LabVIEW's .tdms files"):
        import nptdms
    file = nptdms.TdmsFile.read(path)
    channels = [channel for group in file.groups() for channel in group.channels()]
    columns, steps = [], set()
    for channel in channels:
        words = channel.properties
        steps.add(float(words.get("wf_increment", 0.0)))
        if len(channel) and channel.dtype.kind in "iuf":
            unit = str(words.get("unit_string", words.get("NI_UnitDescription", "")))
            sensitivity = str(words.get("sensitivity", words.get("Sensitivity", "")))
            values = np.asarray(channel[:], float)
            columns.append(Column(channel.name, unit, values, sensitivity=sensitivity))
    if len({len(column.values) for column in columns}) > 1:
        text = "channels of different lengths; expected one length: export those of one rate"
        raise InputError(f"{path}: {text}")
    if not columns:
        raise InputError(f"{path}: no channels of numbers; expected some")
    step = steps.pop()
    return Columns(str(path), columns, None if steps or step <= 0.0 else 1.0 / step)
