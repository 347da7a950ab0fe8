"""Base of jobs that run a public API's job with parameters read from earlier results."""

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
    """Job that computes another job, whose parameters earlier results decide.

    Subclasses say which, and give ``chunk`` and ``item`` the values of the job that is asked.
    """

    @abstractmethod
    def derived_job(self, inputs: Inputs) -> Job:
        """Return the job to compute, made from the results it needs."""

    def items(self, inputs: Inputs) -> list[tuple[Job, Any]]:
        """Return the derived job's items, each with that job."""
        job = self.derived_job(inputs)
        return [(job, item) for item in job.items({})]

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[tuple[Job, Any]], previous: Table | None
    ) -> Table:
        """Compute some items by the derived job."""
        job = items[0][0]
        return job.work(fmus, [item for _, item in items], previous)

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the derived job's dataset."""
        return self.derived_job(inputs).dataset(table, {})
