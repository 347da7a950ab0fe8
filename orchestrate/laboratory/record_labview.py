"""LabVIEW's files: measurement text (.lvm) by lvm_read, binary streams (.tdms) by npTDMS."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from .columns import Column, Columns
from .record_csv import decode_text


def missing_package_error(package: str, kind: str) -> InputError:
    """Return the error of a package that is not installed, with the remedy."""
    text = f"expected the package {package}: pip install {package}"
    return InputError(f"{kind} need a package that is not here; {text}")


def read_lvm(path: Path) -> Columns:
    """Read the first segment of an .lvm file; others are refused, since their times differ."""
    try:
        import lvm_read
    except ImportError:
        raise missing_package_error("lvm_read", "LabVIEW's .lvm files") from None
    text = decode_text(path, path.read_bytes())
    data = lvm_read.read_str(text)  # its read() takes a pickle that lies next to the file
    segment = data[0]
    names = list(map(str, segment["Channel names"]))
    rows = np.atleast_2d(np.asarray(segment["data"], float))
    units = list(map(str, segment.get("Y_Unit_Label", [])))
    steps, starts = segment.get("Delta_X", []), segment.get("X0", [])
    if data["Segments"] > 1:
        text = f"{data['Segments']} segments; expected one: cut the file"
        raise InputError(f"{path}: {text}")
    has_time = data.get("X_Columns", "One") != "No"
    named = sum(name != "Comment" for name in names[has_time:])
    channels = int(segment.get("Channels", 0))
    if named < channels:
        raise InputError(f"{path}: names of {named} channels; expected {channels}, as stated above")
    units = ["s"] * has_time + units
    filled = np.isfinite(rows).any(axis=0) & (np.array(names[: rows.shape[1]]) != "Comment")
    columns = [
        Column("time" if has_time and i == 0 else names[i], (units + [""] * len(names))[i], one)
        for i, one in enumerate(rows.T)
        if filled[i]
    ]
    even = len({*steps}) == 1 and len({*starts}) == 1 and float(steps[0]) > 0.0
    if even:  # the header has all digits of the times
        columns = [one for one in columns if one.name != "time"]
    return Columns(str(path), columns, 1.0 / float(steps[0]) if even else None)


def read_tdms(path: Path) -> Columns:
    """Read the waveforms of a .tdms file that have the same times, with their units."""
    try:
        import nptdms
    except ImportError:
        raise missing_package_error("npTDMS", "LabVIEW's .tdms files") from None
    file = nptdms.TdmsFile.read(path)
    channels = [(one, dict(one.properties)) for group in file.groups() for one in group.channels()]
    columns = list(tdms_columns(channels))
    steps = {float(properties.get("wf_increment", 0.0)) for _, properties in channels}
    if len({len(column.values) for column in columns}) > 1:
        text = "channels of different lengths; expected one length: export those of one rate"
        raise InputError(f"{path}: {text}")
    if not columns:
        raise InputError(f"{path}: no channels of numbers; expected some")
    if len(steps) == 1 and (step := steps.pop()) > 0.0:
        return Columns(str(path), columns, 1.0 / step)
    return Columns(str(path), columns)


def tdms_columns(channels: list[tuple[Any, dict[str, Any]]]) -> Iterator[Column]:
    for channel, properties in channels:
        if len(channel) and channel.dtype.kind in "iuf":
            unit = str(properties.get("unit_string", properties.get("NI_UnitDescription", "")))
            sensitivity = str(properties.get("sensitivity", properties.get("Sensitivity", "")))
            values = np.asarray(channel[:], float)
            yield Column(channel.name, unit, values, sensitivity=sensitivity)
