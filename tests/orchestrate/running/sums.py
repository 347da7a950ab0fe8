"""Jobs of this test suite: squares of whole numbers, and what starts from others of them."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar
from unittest.mock import patch

import numpy as np
import pytest
import xarray as xr

from orchestrate.running.job import Job, Table


@dataclass(frozen=True)
class Squares(Job):
    """Squares of 0 ... size - 1; each chunk may take a while."""

    size: int = 10
    pause: float = 0.0
    fail_at: int = -1
    chunk_size: ClassVar[int] = 3

    def count(self) -> int:
        return self.size

    def items(self) -> Any:
        return range(self.count())

    def work(self, fmus: Any, items: Any, previous: Table | None) -> Table:
        time.sleep(self.pause)
        assert self.fail_at not in items, "as it was told to"
        return {"square": np.array([float(item * item) for item in items])}

    def dataset(self, table: Table) -> xr.Dataset:
        dims = "number", "part"
        return xr.Dataset({name: (dims[: a.ndim], a) for name, a in table.items()})


@dataclass(frozen=True)
class Sums(Squares):
    """Running sums of squares in two lanes: each chunk starts from the end of the one before."""

    sequential: ClassVar[bool] = True

    def count_independent_series(self) -> int:
        return 2

    def work(self, fmus: Any, items: Any, previous: Table | None) -> Table:
        squares = super().work(fmus, items, None)["square"]
        return {"sum": np.cumsum(squares) + (previous["sum"][-1] if previous else 0.0)}


@dataclass(frozen=True)
class Gathered(Squares):
    """Squares, and their sum over all that nobody knows before all are there."""

    last_item_uses_all: ClassVar[bool] = True

    def count(self) -> int:
        return self.size + 1

    def work(self, fmus: Any, items: Any, previous: Table | None) -> Table:
        if previous is None:
            return super().work(fmus, items, None)
        return {"whole": previous["square"].sum(keepdims=True)}

    def dataset(self, table: Table) -> xr.Dataset:
        whole = table.pop("whole")[0]
        return super().dataset(table).assign(whole=whole)


@dataclass(frozen=True)
class Forgetful(Squares):
    """A sequence that forgets its beginning, but for items in ``stubborn`` that double what was."""

    size: int = 240
    stubborn: tuple[int, int] = (0, 0)
    chunk_size: ClassVar[int] = 10
    sequential: ClassVar[bool] = True
    warmup_items: ClassVar[int] = 8

    def boundary_state(self, table: Table) -> bytes:
        return table["value"][-1].tobytes()

    def work(self, fmus: Any, items: Any, previous: Table | None) -> Table:
        value, values = float(previous["value"][-1]) if previous else 0.3, []
        for item in items:
            chaotic = self.stubborn[0] <= item < self.stubborn[1]
            value = 3.9 * value * (1.0 - value) if chaotic else 1.0 / (item + 2.0) + 1e-9 * value
            values.append(value)
        return {"value": np.array(values)}


@dataclass(frozen=True)
class Noise(Squares):
    """Numbers that cannot be compressed: 8 kB an item."""

    size: int = 30

    def work(self, fmus: Any, items: Any, previous: Table | None) -> Table:
        rows = [np.random.default_rng(item).uniform(size=1000) for item in items]
        return {"noise": np.array(rows)}


@contextmanager
def interrupted(kind: type[Job], item: int) -> Iterator[Any]:
    """A ``with`` block that ends by Ctrl-C when an item of a kind of job is computed."""
    work = kind.work

    def stop(self: Any, fmus: Any, items: Any, previous: Table | None) -> Table:
        if item in items:
            raise KeyboardInterrupt
        return work(self, fmus, items, previous)

    with patch.object(kind, "work", stop), pytest.raises(KeyboardInterrupt) as ended:
        yield ended


@dataclass(frozen=True)
class Model:
    path: Path
    name: str = "TwoMassImpactOscillator"
    guid: str = "{1}"
    fmi_version: str = "3.0"
