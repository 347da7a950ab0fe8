"""A job of this test suite: squares of whole numbers, and their running sum."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
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

    def items(self) -> range:
        return range(self.size)

    def work(self, fmus: Any, items: Any, previous: Table | None) -> Table:
        time.sleep(self.pause)
        assert self.fail_at not in items, "as it was told to"
        return {"square": np.array([float(item * item) for item in items])}

    def dataset(self, table: Table) -> xr.Dataset:
        return xr.Dataset({"square": ("number", table["square"])}, attrs={"title": "Squares"})


@dataclass(frozen=True)
class Sums(Squares):
    """Running sums of squares in two lanes: each chunk starts from the end of the one before."""

    sequential: ClassVar[bool] = True

    def independent_series(self) -> int:
        return 2

    def work(self, fmus: Any, items: Any, previous: Table | None) -> Table:
        squares = super().work(fmus, items, None)["square"]
        return {"sum": np.cumsum(squares) + (previous["sum"][-1] if previous else 0.0)}

    def dataset(self, table: Table) -> xr.Dataset:
        return xr.Dataset({"sum": ("number", table["sum"])})


@dataclass(frozen=True)
class Gathered(Squares):
    """Squares, and their sum over all that nobody knows before all are there."""

    gathers: ClassVar[bool] = True

    def count(self) -> int:
        return self.size + 1

    def items(self) -> range:
        return range(self.size + 1)

    def work(self, fmus: Any, items: Any, previous: Table | None) -> Table:
        if previous is None:
            return super().work(fmus, items, None)
        return {"whole": previous["square"].sum(keepdims=True)}

    def dataset(self, table: Table) -> xr.Dataset:
        return xr.Dataset({"square": ("number", table["square"]), "whole": table["whole"][0]})


@dataclass(frozen=True)
class Model:
    """An FMU's description as the runner needs it."""

    path: Path
    name: str = "TwoMassImpactOscillator"
    guid: str = "{1}"
    fmi_version: str = "3.0"


@dataclass(frozen=True)
class Forgetful(Job):
    """A sequence that forgets its beginning, but for items in ``stubborn`` that double what was."""

    size: int = 240
    stubborn: tuple[int, int] = (0, 0)
    pause: float = 0.0
    chunk_size: ClassVar[int] = 10
    sequential: ClassVar[bool] = True
    warmup_items: ClassVar[int] = 8

    def count(self) -> int:
        return self.size

    def items(self) -> range:
        return range(self.size)

    def boundary_state(self, table: Table) -> bytes:
        return table["value"][-1].tobytes()

    def work(self, fmus: Any, items: Any, previous: Table | None) -> Table:
        time.sleep(self.pause * len(items))
        value, values = float(previous["value"][-1]) if previous else 0.3, []
        for item in items:
            chaotic = self.stubborn[0] <= item < self.stubborn[1]
            value = 3.9 * value * (1.0 - value) if chaotic else 1.0 / (item + 2.0) + 1e-9 * value
            values.append(value)
        return {"value": np.array(values)}

    def dataset(self, table: Table) -> xr.Dataset:
        return xr.Dataset({"value": ("number", table["value"])})


@dataclass(frozen=True)
class Noise(Squares):
    """Numbers that cannot be compressed: 8 kB an item."""

    size: int = 30

    def work(self, fmus: Any, items: Any, previous: Table | None) -> Table:
        rows = [np.random.default_rng(item).uniform(size=1000) for item in items]
        return {"noise": np.array(rows)}

    def dataset(self, table: Table) -> xr.Dataset:
        return xr.Dataset({"noise": (("number", "part"), table["noise"])})
