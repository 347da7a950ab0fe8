"""What a long computation is: items in chunks, and all that decides its numbers.

A job is a frozen dataclass whose fields decide every number of its result. Its items are computed
in chunks, by whoever is free; a sequential job's chunks each start from the end of the one before.
"""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

Table = dict[str, np.ndarray]  # arrays by name, one entry an item along the first axis
Inputs = Mapping[str, "xr.Dataset"]  # results that a job starts from, by name
FEW = 4  # numbers of a list that are told one by one


@dataclass(frozen=True)
class Chunk:
    """A part of a job.

    Attributes
    ----------
    index : int
    first, last : int
        Its items: from the first up to, not including, the last.
    after : int, optional
        The chunk whose result it starts from.
    """

    index: int
    first: int
    last: int
    after: int | None


@dataclass(frozen=True)
class Job(ABC):
    """One result; subclasses say what its items are and how they are computed.

    Attributes
    ----------
    name : str
        Of the result; it decides no number.
    """

    name: str
    models: ClassVar[tuple[str, ...]] = ("TwoMassImpactOscillator",)
    chunk: ClassVar[int] = 1
    sequential: ClassVar[bool] = False
    closing: ClassVar[bool] = False  # a sequential job's last chunk starts from all before it
    gathers: ClassVar[bool] = False  # the last item starts from all others, in a chunk of its own
    lead: ClassVar[int] = 0  # items after which a sequential job has forgotten its beginning
    item: ClassVar[str] = "it"  # what the progress bar counts

    def needs(self) -> tuple[str, ...]:
        """Names of the jobs whose results this one starts from."""
        return ()

    @abstractmethod
    def count(self) -> int:
        """Number of items, known before any work."""

    def lanes(self) -> int:
        """Equal runs of items that know nothing of each other, in a sequential job."""
        return 1

    @abstractmethod
    def items(self, inputs: Inputs) -> Sequence[Any]:
        """The items in their order: plain data that travels to a worker."""

    @abstractmethod
    def work(self, fmus: Mapping[str, Path], items: Sequence[Any], carry: Table | None) -> Table:
        """Compute a chunk, in a worker.

        Parameters
        ----------
        fmus : mapping of str to Path
            FMU by model name.
        items : sequence
        carry : dict of ndarray, optional
            The last entries of the chunk before, in a sequential job; of the last chunk of a
            ``closing`` one, or one that ``gathers``, all entries of all before, put together.

        Returns
        -------
        dict of ndarray
        """

    def aside(self, first: int) -> str:
        """What the chunk that begins at an item does, where it is other work than the rest: for
        the progress bar, which stands still meanwhile.
        """
        return ""

    def seam(self, table: Table) -> bytes:
        """What a chunk starts from, of a sequential job with a ``lead``: by the last entries of
        the one before.
        """
        raise NotImplementedError

    @abstractmethod
    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """The result, from all chunks put together along their first axis; the last chunk of a job
        that ``gathers`` adds arrays of other names.
        """

    def parameters(self) -> dict[str, Any]:
        """All that decides the numbers, as plain data; long lists by what they are made of."""
        return {
            field.name: plain(getattr(self, field.name))
            for field in fields(self)
            if field.name != "name"
        }

    def call(self) -> str:
        """The question as a line, for people."""
        parts = [f"{name}={brief(value)}" for name, value in self.parameters().items()]
        return f"{type(self).__name__}({', '.join(parts)})"

    def chunks(self) -> list[Chunk]:
        """The parts, in order."""
        count, lanes = self.count() - self.gathers, self.lanes()
        found: list[Chunk] = []
        for lane in range(lanes):
            begin, end = lane * count // lanes, (lane + 1) * count // lanes
            for first in range(begin, end, self.chunk):
                after = len(found) - 1 if self.sequential and first > begin else None
                found.append(Chunk(len(found), first, min(first + self.chunk, end), after))
        if self.gathers:
            found.append(Chunk(len(found), count, count + 1, len(found) - 1))
        return found


def last_entries(table: Table) -> Table:
    """The last entry of each array of a chunk, all that the next one starts from."""
    return {name: values[-1:].copy() for name, values in table.items()}


def plain(value: Any) -> Any:
    """A value as JSON holds it; a long list by its ends, count and digest."""
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(part) for key, part in value.items()}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (tuple, list, np.ndarray)):
        return listed(value)
    return value


def listed(values: Any) -> Any:
    """A list for JSON: as it is where it is short or holds more than numbers, else its make-up."""
    parts = list(values)
    if len(parts) <= FEW or not all(isinstance(part, (int, float, np.number)) for part in parts):
        return [plain(part) for part in parts]
    numbers = np.asarray(parts, dtype=float)
    found = {"first": float(numbers[0]), "last": float(numbers[-1]), "count": len(numbers)}
    steps = np.diff(numbers)
    step = float(numbers[-1] - numbers[0]) / (len(numbers) - 1)
    if np.abs(steps - step).max() <= 1e-9 * max(abs(numbers[0]), abs(numbers[-1])):
        found["step"] = float(f"{step:.12g}")
    return {**found, "sha256": hashlib.sha256(numbers.tobytes()).hexdigest()[:16]}


def brief(value: Any) -> str:
    """A parameter in a line."""
    if isinstance(value, dict) and "sha256" in value:
        step = f" by {value['step']:g}" if "step" in value else ""
        return f"{value['first']:g} ... {value['last']:g}{step} ({value['count']} values)"
    if isinstance(value, dict):
        return f"({', '.join(f'{name}={brief(part)}' for name, part in value.items())})"
    return f"{value!r}"
