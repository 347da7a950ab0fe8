"""A question of the public API whose parameters are read off results that come before it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..running.job import Inputs, Job, Table

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, kw_only=True)
class DerivedJob(Job):
    """A job that asks another one, once the results that decide its parameters are there.

    Subclasses say which, and give ``chunk`` and ``item`` the values of the job that is asked.
    """

    @abstractmethod
    def question(self, inputs: Inputs) -> Job:
        """Return the job of the public API that is asked."""

    def items(self, inputs: Inputs) -> list[tuple[Job, Any]]:
        """Return its items, each with the job that computes it."""
        job = self.question(inputs)
        return [(job, item) for item in job.items({})]

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[tuple[Job, Any]], previous: Table | None
    ) -> Table:
        """Compute some of its items."""
        job = items[0][0]
        return job.work(fmus, [item for _, item in items], previous)

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return its result."""
        return self.question(inputs).dataset(table, {})
