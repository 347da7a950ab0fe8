"""Measured resonance curves in files: columns of text, as analysers and spreadsheets write them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

import numpy as np

from ..errors import InputError
from ..lazy import xr
from ..model.arguments import checked_path
from .columns import (
    BY_NAME,
    BY_USER,
    Column,
    ColumnAssignment,
    Columns,
    column_indices_by_name,
    column_label,
    format_column_names,
    requested_column_indices,
    warn_of_lines_left_out,
)
from .conversion import normalize_unit, si_factor
from .headings import ANGLES, CURVE_NAMES, FREQUENCIES, RATIO_UNITS
from .pieces import Floats
from .record_files import file_kind, read_columns_in_process
from .resonance_curve import CurveColumns, acceleration_factor, make_curve
from .signals import LEVEL, checked_quantity


def read_curve(
    path: str | os.PathLike[str],
    *,
    columns: Mapping[str, str | int] | Sequence[str | int] | None = None,
    unit: str | None = None,
    level: float | None = None,
    relative: bool = False,
    direction: str | None = None,
) -> xr.Dataset:
    r"""Read a measured resonance curve from a file.

    Parameters
    ----------
    path : path-like
        A text file (``.csv``, ``.txt``, ``.tsv``, ``.asc``, ``.dat``) with a row for each
        frequency.
    columns : mapping or sequence, optional
        Which column ``frequency``, ``level``, ``amplitude1``, ``phase1``, ``amplitude1_order2``,
        ``amplitude1_order3``, ``floor1`` and those of face 2 are in, by name or by number from
        0; a sequence has these names in this order. By default columns with these names or others
        that are usual.
    unit : str, optional
        Of the amplitudes, as for :func:`orchestrate.resonance_curve`; by default what stands in
        the file, which must be there.
    level : float, optional
        Peak acceleration of the base at all frequencies, m/s2, where no column has it.
    relative, direction
        As for :func:`orchestrate.resonance_curve`.

    Returns
    -------
    xarray.Dataset
        As :func:`orchestrate.resonance_curve` makes it. The attribute ``columns`` says which column
        was taken for what.

    Raises
    ------
    InputError
        Where the file is damaged or its numbers are no resonance curve; in one line with column and
        row.

    Warns
    -----
    UserWarning
        Where rows without a number are dropped.

    Notes
    -----
    Frequencies without a unit are in Hz. Phases without a unit are in degrees if one of them is
    beyond 7, else in rad.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "curve.csv"
    >>> rows = [f"{hertz};{abs(1 / (1 - (hertz / 50) ** 2 + 0.02j))}" for hertz in range(40, 60)]
    >>> _ = path.write_text("frequency [Hz];face 1 [g]\n" + "\n".join(rows))
    >>> curve = read_curve(path, level=4.0)
    >>> curve.amplitude.sel(order=1.0, frequency=50.0).values.round(2).tolist()
    [490.33]
    >>> curve.attrs["columns"]
    'frequency "frequency", amplitude1 "face 1"'
    """
    path = checked_path("path", path)
    if file_kind(path) != "csv":
        raise InputError(f"{path}: expected columns of text (.csv, .txt, .tsv, .asc, .dat)")
    table = read_columns_in_process(path, True)  # fields may be empty
    warn_of_lines_left_out(table)
    indices = curve_column_indices(table, columns)
    known = BY_NAME if columns is None else BY_USER
    assignment = ColumnAssignment(indices, dict.fromkeys(indices, known))
    assignment.warn_of_guesses(table, "columns=")
    made = curve_columns(table, indices, unit, level)
    words = {"title": f"Resonance curve {path.name}", "source": path.name}
    words["columns"] = assignment.format(table)
    try:
        return make_curve(made, relative, direction, words)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def curve_column_indices(
    table: Columns, columns: Mapping[str, str | int] | Sequence[str | int] | None
) -> dict[str, int]:
    """Return the column index of each quantity of a curve, as requested or by usual names."""
    if columns is None:
        indices = column_indices_by_name(table, CURVE_NAMES)
    else:
        indices = requested_column_indices(table, columns, tuple(CURVE_NAMES), tuple(CURVE_NAMES))
    lacking = [] if "frequency" in indices else ["frequency"]
    lacking += [] if {"amplitude1", "amplitude2"} & set(indices) else ["amplitude1"]
    if lacking:
        text = "expected columns=, which of them is which"
        names = format_column_names(table)
        raise InputError(f"{table.path}: no {lacking[0]} among the columns {names}; {text}")
    return indices


def curve_columns(
    table: Columns, indices: Mapping[str, int], unit: str | None, level: float | None
) -> CurveColumns:
    by_name = {name: table.columns[index] for name, index in indices.items()}
    faces = [f"amplitude{n}" for n in "12" if f"amplitude{n}" in by_name]
    frequency = column_in_si(table, by_name["frequency"], "Hz", FREQUENCIES)
    phases = {name: by_name.get(name.replace("amplitude", "phase")) for name in faces}
    floors = {name: by_name.get(name.replace("amplitude", "floor")) for name in faces}
    return CurveColumns(
        frequency=frequency,
        level=base_level(table, by_name.get("level"), unit, level, frequency),
        amplitudes={name: stack_face_orders(name, by_name) for name in faces},
        phases={name: phase_in_rad(table, one) for name, one in phases.items() if one},
        floors={name: one.values for name, one in floors.items() if one},
        units={name: unit or by_name[name].unit for name in faces},
        first_row=table.first_row,
    )


def stack_face_orders(name: str, by_name: Mapping[str, Column]) -> Floats:
    """Return orders 1, 2, 3 of a face in the file's unit, NaN where there is no column."""
    first = by_name[name]
    columns = [by_name.get(f"{name}{order}") for order in ("", "_order2", "_order3")]
    for one in columns[1:]:
        if one is not None and normalize_unit(one.unit) != normalize_unit(first.unit):
            text = f"in {one.unit or 'no unit'}; expected {first.unit or 'none'}, as order 1"
            raise InputError(f'column "{one.name}": {text}')
    missing = np.full(len(first.values), np.nan)
    return np.stack([missing if one is None else one.values for one in columns])


def base_level(
    table: Columns, column: Column | None, unit: str | None, level: float | None, frequency: Floats
) -> Floats | float:
    """Return the peak acceleration of the base, m/s2, from its column or from the given number."""
    if (column is None) == (level is None):
        text = "no column of the base's level" if column is None else f'column "{column.name}"'
        given = "" if level is None else f" and level = {level!r}"
        expected = "expected a column, or level= in m/s2, not both"
        raise InputError(f"{table.path}: {text}{given}; {expected}")
    if column is None:
        return float(checked_quantity(LEVEL, "level", level))
    own = column.unit or (unit if unit and normalize_unit(unit) not in RATIO_UNITS else "")
    label = column_label(table, column)
    ratio = normalize_unit(own) in RATIO_UNITS  # of a level there is none
    factor = acceleration_factor(label, "" if ratio else own, frequency, frequency)
    return np.asarray(factor * column.values)


def phase_in_rad(table: Columns, column: Column) -> Floats:
    """Convert a column of phases to rad; without a unit, large numbers are in degrees."""
    # a phase without a unit beyond 2 pi and some
    degrees = np.nanmax(np.abs(column.values), initial=0.0) > 7.0
    return column_in_si(table, column, "deg" if degrees else "rad", ANGLES)


def column_in_si(
    table: Columns, column: Column, default_unit: str, factors: Mapping[str, float]
) -> Floats:
    """Convert a column to SI by its own unit, or by the default where it has none."""
    factor = si_factor(column_label(table, column), column.unit or default_unit, factors)
    return factor * column.values
