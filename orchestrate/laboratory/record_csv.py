"""Columns of numbers as text, as analysers and spreadsheets write them.

Separators are semicolon, tab, comma or blanks; decimals have a point, or a comma where that is not
the separator, or in quotes. What stands above the first line of numbers is the heading: its last
line with as many fields has the names, or the units if a line above it has the names. Columns of
texts, as of clock times, are kept as such.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from io import StringIO
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .columns import Column, Columns
from .conversion import SENSITIVITY
from .headings import TEXTS, describe_text, is_unit, split_heading

MOST_HEADING = 200  # lines
SEPARATORS = (";", "\t", ",", " ")
POINT = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf(inity)?)", re.I)
COMMA = re.compile(r"[+-]?(\d+(,\d*)?|,\d+)([eE][+-]?\d+)?|[+-]?(nan|inf(inity)?)", re.I)
NUMBERS = {".": POINT, ",": COMMA}
TEXT = re.compile("|".join((r".*[^\W\d_].*", TEXTS["a clock time"], TEXTS["a date"])))
BYTE_ORDERS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}


@dataclass(frozen=True)
class Dialect:
    """Describe how numbers are written in a text file: separator, decimal sign, first row."""

    separator: str
    decimal: str
    first: int  # line of the first numbers, counted from 0
    texts: frozenset[int] = frozenset()  # columns of texts

    def split(self, line: str) -> list[str]:
        """Split a line into its fields; a separator at its end is dropped."""
        line = line.strip() if self.separator == " " else line.strip("\r\n")
        if self.separator == " ":
            return line.split()
        fields = next(csv.reader([line], delimiter=self.separator), [])
        return fields[:-1] if len(fields) > 1 and not fields[-1].strip() else fields


def read_csv(path: Path, gaps: bool = False) -> Columns:
    """Read all columns of a text file; with ``gaps`` fields may be empty, which makes them NaN."""
    data = path.read_bytes()
    text = decode_text(path, data)
    lines = text.split("\n", MOST_HEADING + 1)[: MOST_HEADING + 1]
    if not text.strip():
        raise InputError(f"{path}: empty; expected columns of numbers")
    dialect = detect_dialect(path, lines)
    text, left_out = cut_footing(text, dialect)
    columns = len(dialect.split(lines[dialect.first]))
    if gaps:
        columns = max(columns, *(len(dialect.split(line)) for line in lines[: dialect.first]), 1)
        text = fill_empty_fields(text, dialect, columns)
    names = column_names_and_units(lines[: dialect.first], dialect, columns)
    values = parse_numbers(path, text, dialect, [name for name, _ in names])
    first = dialect.split(lines[dialect.first])
    sensors = column_sensitivities(lines[: dialect.first], dialect, columns)
    made = [
        Column(*heading, column, first[i].strip() if i in dialect.texts else "", sensors[i])
        for i, (heading, column) in enumerate(zip(names, values.T, strict=True))
    ]
    words = {"left_out": left_out} if left_out else {}
    return Columns(str(path), made, first_row=dialect.first + 1, attributes=words)


def decode_text(path: Path, data: bytes) -> str:
    """Decode a file's text: UTF-8, UTF-16 with its mark, or Windows' letters."""
    if b"\0" in data[:4096] and data[:2] not in BYTE_ORDERS:
        raise InputError(f"{path}: no text; expected columns of numbers")
    try:
        text = data.decode(BYTE_ORDERS.get(data[:2], "utf-8-sig"))
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def detect_dialect(path: Path, lines: list[str]) -> Dialect:
    """Detect how a file's first lines write numbers; raise naming what stands in their place."""
    for has_texts in (False, True):
        for number in range(len(lines)):
            for separator, decimal in product(SEPARATORS, NUMBERS):
                dialect = Dialect(separator, decimal, number)
                texts = text_columns_of_row(dialect, lines[number:], has_texts)
                if texts is not None:
                    # whole numbers in the first line leave both decimal signs possible
                    near = "".join(lines[number : number + 50])
                    comma = separator != "," and "," in near and "." not in near
                    return Dialect(separator, "," if comma else decimal, number, texts)
    named = (
        f"row {number}: {describe_text(field.strip())}"
        for number, line in enumerate(lines, 1)
        for separator in SEPARATORS
        for field in Dialect(separator, ".", 0).split(line)
        if any(re.fullmatch(pattern, field.strip()) for pattern in TEXTS.values())
    )
    text = next(named, f"no line of numbers in the first {min(len(lines), MOST_HEADING)}")
    raise InputError(f"{path}: {text}; expected columns of numbers")


def text_columns_of_row(
    dialect: Dialect, lines: list[str], has_texts: bool
) -> frozenset[int] | None:
    """Return which columns of the first line are texts; None if it is no row of a table."""
    if dialect.separator == dialect.decimal and '"' not in lines[0]:
        return None
    more = [line for line in lines[1:] if line.strip()][: 10 if has_texts else 0]
    rows = [[one.strip() for one in dialect.split(line)] for line in (lines[0], *more)]
    number, row = NUMBERS[dialect.decimal], rows[0]
    texts = [{i for i, one in enumerate(r) if one and not number.fullmatch(one)} for r in rows]
    full, others = sum(map(bool, row)) - len(texts[0]), len(row) - len(texts[0])
    is_row = (len(row) > 1 or dialect.separator == " ") and full >= max(0.5 * others, 1)
    if texts[0]:
        same = {len(r) for r in rows} == {len(row)} and all(one == texts[0] for one in texts)
        is_row = is_row and has_texts and same and all(TEXT.fullmatch(row[i]) for i in texts[0])
    return frozenset(texts[0]) if is_row else None


def column_names_and_units(lines: list[str], dialect: Dialect, count: int) -> list[tuple[str, str]]:
    """Return names and units of columns from the lines above the numbers."""
    rows = [dialect.split(line.lstrip("#%").strip(" ")) for line in lines]
    fitting = [[field.strip() for field in row] for row in rows if len(row) == count]
    fitting = [row for row in fitting if not any(map(SENSITIVITY.fullmatch, row))]
    if not fitting:
        return [(f"column {number}", "") for number in range(count)]
    units = [text.strip("[]() ") for text in fitting[-1]]
    filled = [unit for unit in units if unit]
    if len(fitting) > 1 and filled and 2 * sum(map(is_unit, filled)) >= len(filled):
        names = [split_heading(text)[0] for text in fitting[-2]]
        return list(zip(names, units, strict=True))
    return [split_heading(text) for text in fitting[-1]]


def column_sensitivities(lines: list[str], dialect: Dialect, count: int) -> list[str]:
    """Return the sensitivities of columns from a line above the numbers, empty without one."""
    rows = [[field.strip() for field in dialect.split(line)] for line in lines]
    fitting = [row for row in rows if len(row) <= count and any(map(SENSITIVITY.fullmatch, row))]
    row = [*(fitting or [[]])[0], *[""] * count][:count]
    return [field if SENSITIVITY.fullmatch(field) else "" for field in row]


def cut_footing(text: str, dialect: Dialect) -> tuple[str, str]:
    """Cut last lines that begin with a word in place of a number; return text and a note on it."""
    body, number, footing = text.rstrip(), NUMBERS[dialect.decimal], ""
    for _ in range(0 if 0 in dialect.texts else MOST_HEADING):
        above, _, line = body.rpartition("\n")
        field = (dialect.split(line) or [""])[0].strip()
        if number.fullmatch(field) or not TEXT.fullmatch(field):
            break
        body, footing, row = above.rstrip(), line.strip(), above.count("\n") + 2
    if not footing:
        return text, ""
    return body, f"row {row}: {footing[:80]!r} after the numbers is left out"


def fill_empty_fields(text: str, dialect: Dialect, columns: int) -> str:
    """Return a text with nan in place of each empty field of its numbers."""
    if dialect.separator == " ":
        return text
    lines = text.split("\n")
    for number, line in enumerate(lines[dialect.first :], dialect.first):
        fields = dialect.split(line)
        if any(field.strip() for field in fields):
            full = [field.strip() or "nan" for field in fields]
            full = [f'"{field}"' if dialect.separator in field else field for field in full]
            full += ["nan"] * (columns - len(full))
            lines[number] = dialect.separator.join(full)
    return "\n".join(lines)


def parse_numbers(path: Path, text: str, dialect: Dialect, names: list[str]) -> NDArray[np.float64]:
    """Parse the numbers, shape (rows, columns); raise naming line and column of another field."""
    body = text.split("\n", dialect.first)[dialect.first]
    numbers = body.replace(",", ".") if dialect.decimal == "," else body
    if dialect.separator == dialect.decimal:
        numbers = re.sub(r'"([^"]*)"', lambda quoted: quoted[1].replace(",", "."), body)
    columns = [i for i in range(len(names)) if i not in dialect.texts]
    separator = None if dialect.separator == " " else dialect.separator
    if separator is not None and body.partition("\n")[0].rstrip(" ").endswith(separator):
        numbers = re.sub(f"{re.escape(separator)} *$", "", numbers, flags=re.MULTILINE)
    try:
        rows = np.loadtxt(
            StringIO(numbers),
            delimiter=separator,
            comments=None,
            quotechar='"',
            ndmin=2,
            usecols=columns if dialect.texts else None,
        )
    except ValueError:
        rows = np.empty((0, 0))
    if rows.shape[1] != len(columns):
        raise_first_bad_field(path, body, dialect, names)
    values = np.full((len(rows), len(names)), np.nan)
    values[:, columns] = rows
    return values


def raise_first_bad_field(path: Path, body: str, dialect: Dialect, names: list[str]) -> None:
    """Raise an error that names the first field that is not a number."""
    pattern = NUMBERS[dialect.decimal]
    for number, line in enumerate(body.split("\n"), dialect.first + 1):
        fields = [field.strip() for field in dialect.split(line)]
        if fields and len(fields) != len(names):
            text = f"{len(fields)} columns; expected {len(names)}"
            raise InputError(f"{path}, row {number}: {text}")
        for i, (name, field) in enumerate(zip(names, fields, strict=False)):
            if i not in dialect.texts and not pattern.fullmatch(field):
                text = describe_text(field) if field else "nothing"
                text += "; expected a number"
                raise InputError(f'{path}, column "{name}", row {number}: {text}')
    raise InputError(f"{path}: cannot be read; expected columns of numbers")


def write_csv(path: Path, columns: list[Column]) -> None:
    """Write columns as text, with headings ``name [unit]`` and all digits of the numbers."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(f"{column.name} [{column.unit}]" for column in columns) + "\n")
        rows = zip(*(column.values.tolist() for column in columns), strict=True)
        file.writelines(",".join(map(repr, row)) + "\n" for row in rows)
