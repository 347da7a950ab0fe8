"""Base class of long computations: items in chunks, and all parameters that decide the numbers.

A job is a frozen dataclass whose fields decide every number of its result. Its items are computed
in chunks, by whoever is free; a sequential job's chunks each start from the end of the one before.
"""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ..errors import InputError
from ..lazy import xr

Fmus = Mapping[str, Path]  # FMU files by model
Table = dict[str, np.ndarray]  # arrays by name, their rows along the first axis
MAX_LISTED = 4  # a longer list of numbers is summarized by its ends, count and digest


@dataclass(frozen=True)
class Chunk:
    """Consecutive items of a job computed at once; ``after`` is the chunk it continues."""

    index: int
    start: int  # its first item
    stop: int  # and the first behind it
    after: int | None  # the chunk whose result it starts from


FAMILY = ("wall", "stroke")  # parameters of a structure that not all questions know


@dataclass(frozen=True)
class Job(ABC):
    """Base of a computation with a stored result; subclasses define its items and the work."""

    name: str  # of the result; it decides no number
    asked: ClassVar[str] = ""  # name of the public function: the kind of the result
    models: ClassVar[tuple[str, ...]] = ("TwoMassImpactOscillator",)
    chunk_size: ClassVar[int] = 1
    sequential: ClassVar[bool] = False
    last_item_uses_all: ClassVar[bool] = False  # and is a chunk of its own
    last_weight: ClassVar[int] = 1  # of a last item that uses all others, in the progress bar
    warmup_items: ClassVar[int] = 0  # after which a sequential job has forgotten its beginning
    family: ClassVar[tuple[str, ...]] = ()  # those of `FAMILY` with which its rules hold
    in_threads: ClassVar[bool] = False  # whether its work is in the FMU, past Python
    bulk: ClassVar[tuple[str, ...]] = ()  # columns that a store on disk gives as `StoredRows`
    # columns of a chunk's table that have a row an item, None for all; the others have as many rows
    # as there happen to be (revolutions, impacts), or one: the state at the chunk's end
    item_columns: ClassVar[tuple[str, ...] | None] = None
    item: ClassVar[str] = "item"  # what the progress bar counts

    def require_supported_structure(self) -> None:
        question = self.asked or type(self).__name__
        for field in fields(self):
            refuse_unsupported_structure(question, getattr(self, field.name), self.family)

    def count(self) -> int:
        return len(self.items())

    def progress_total(self) -> int:
        """Return what the progress bar counts to: all items, the last by its weight."""
        return self.count() + self.last_weight - 1

    def count_independent_series(self) -> int:
        """Return how many equally long, independent series a sequential job's items form."""
        return 1

    def items(self) -> Sequence[Any]:
        """Return all items in order, plain data for the workers; by default there is one."""
        return [0]

    @abstractmethod
    def work(self, fmus: Fmus, items: Sequence[Any], previous: Table | None) -> Table:
        """Compute a chunk's items by the FMUs, in a worker; return arrays, see `item_columns`."""

    def has_row_per_item(self, table: Table, count: int) -> bool:
        names = set(table if self.item_columns is None else self.item_columns).intersection(table)
        lengths = {len(table[name]) for name in names if table[name].ndim}
        return bool(table) and lengths <= {count}

    def progress_note(self, first: int) -> str:
        """Return a text shown next to the progress bar while a chunk runs; usually empty."""
        return ""

    def boundary_state(self, table: Table) -> bytes:
        """Return a chunk's end state as bytes, to compare with the next one's guessed start."""
        raise NotImplementedError

    @abstractmethod
    def dataset(self, table: Table) -> xr.Dataset:
        """Return the final xarray dataset from the arrays of all chunks, concatenated."""

    def parameters(self) -> dict[str, Any]:
        """Return the job's fields as JSON data for its identity; long lists summarized."""
        own = (field.name for field in fields(self) if field.name != "name")
        return {name: to_json_data(getattr(self, name)) for name in own}

    def format_call(self) -> str:
        """Return question and parameters in one line; of a long list, its ends and count."""
        parts = [f"{name}={format_brief(value)}" for name, value in self.parameters().items()]
        return f"{self.asked or type(self).__name__}({', '.join(parts)})"

    def chunks(self) -> list[Chunk]:
        count, series = self.count() - self.last_item_uses_all, self.count_independent_series()
        chunks: list[Chunk] = []
        for number in range(series):
            begin, end = number * count // series, (number + 1) * count // series
            for first in range(begin, end, self.chunk_size):
                after = len(chunks) - 1 if self.sequential and first > begin else None
                chunks.append(Chunk(len(chunks), first, min(first + self.chunk_size, end), after))
        if self.last_item_uses_all:
            chunks.append(Chunk(len(chunks), count, count + 1, len(chunks) - 1))
        return chunks


def refuse_unsupported_structure(
    question: str, structure: Any, supported: tuple[str, ...] = ()
) -> None:
    given = {name: getattr(structure, name, None) for name in FAMILY if name not in supported}
    are_numbers = all(isinstance(value, (bool, float)) for value in given.values())
    refuse_unsupported(question, given if given and are_numbers and not structure.bonded else {})


def refuse_unsupported(question: str, parameters: Mapping[str, Any]) -> None:
    """Raise ``InputError`` for the first parameter that is not 0, false or None."""
    for name, value in parameters.items():
        if value:
            text = f"{question} does not know it yet; expected a question without it"
            raise InputError(f"{name} = {value!r}: {text}")


def last_entries(table: Table) -> Table:
    """Return the last row of each array of a chunk: the state the next chunk starts from."""
    return {name: values[-1:].copy() for name, values in table.items()}


def to_json_data(value: Any) -> Any:
    """Convert a value to JSON data recursively; long number lists become ends, count and digest."""
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: to_json_data(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): to_json_data(part) for key, part in value.items()}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (tuple, list, np.ndarray)):
        return to_json_list_or_summary(value)
    return value


def to_json_list_or_summary(values: Any) -> Any:
    parts = list(values)
    are_numbers = all(isinstance(part, (int, float, np.number)) for part in parts)
    if len(parts) <= MAX_LISTED or not are_numbers:
        return list(map(to_json_data, parts))
    numbers = np.asarray(parts, dtype=float)
    summary = {"first": float(numbers[0]), "last": float(numbers[-1]), "count": len(numbers)}
    steps = np.diff(numbers)
    step = float(numbers[-1] - numbers[0]) / (len(numbers) - 1)
    if np.abs(steps - step).max() <= 1e-9 * max(abs(numbers[0]), abs(numbers[-1])):
        summary["step"] = float(f"{step:.12g}")
    return {**summary, "sha256": hashlib.sha256(numbers.tobytes()).hexdigest()[:16]}


def format_brief(value: Any) -> str:
    """Format a parameter's JSON value as text of one line; a summarized list as its range."""
    if isinstance(value, dict) and "sha256" in value:
        step = f" by {value['step']:g}" if "step" in value else ""
        return f"{value['first']:g} ... {value['last']:g}{step} ({value['count']} values)"
    if isinstance(value, dict):
        return f"({', '.join(f'{name}={format_brief(part)}' for name, part in value.items())})"
    return f"{value!r}"
