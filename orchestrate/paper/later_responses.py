"""Jobs that test the paper's transient of 500 periods by running responses on.

Each frequency's response goes on from the state that the sweep has left it in, and is sampled and
counted as in the sweep. So what differs is a transient that the sweep has not seen the end of.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..access import OSCILLATOR, Instance
from ..dynamics.following import FollowedResponse, StartStatesQuestion
from ..response.labels import column_variables
from ..response.respond import respond
from ..running.job import Inputs, Table

if TYPE_CHECKING:
    import xarray as xr

NUMBERS = {
    "multiplicity": "least n such that the state repeats after n periods; 0: none",
    "impacts_per_period": "impacts per excitation period, mean over the samples",
    "xi_rel_max": "largest gap over a eta^2",
}


@dataclass(frozen=True, kw_only=True)
class LaterJob(StartStatesQuestion):
    """Job: features of a sweep's responses after further periods."""

    # periods dropped after the sweep's, and stroboscopic samples kept after them
    transient: int = 4300
    samples: int = 201
    tolerance: float = 1e-2  # within which a state repeats, as in the sweep
    chunk_size: ClassVar[int] = 20

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[FollowedResponse], previous: Table | None
    ) -> Table:
        """Run some responses on; return their multiplicity, impacts and largest gap."""
        rows = []
        with Instance(fmus[OSCILLATOR]) as instance:
            for item in items:
                response = respond(
                    instance, *item.point, item.start, self.transient, self.samples, self.tolerance
                )
                gap = response.x_rel_max / item.point.length
                rows.append([response.multiplicity, response.impacts_per_period, gap])
        return {"rows": np.array(rows)}

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the later responses' features over the parameter."""
        import xarray as xr

        variables = column_variables(self.series.name, NUMBERS, table["rows"].T)
        title = f"{self.transient} periods after the sweep: {self.structure.label()}"
        return xr.Dataset(variables, self.series.coordinates(), {"title": title})


def classify_changes(
    swept: xr.Dataset, later: xr.Dataset, tolerance: float
) -> dict[str, np.ndarray]:
    """Return Boolean arrays of a sweep's responses that changed later, by kind of change."""
    first = swept.sel(eta=later.eta.values, method="nearest")
    before, after = first.multiplicity.values, later.multiplicity.values.astype(int)
    counts = first.impacts_per_period.values, later.impacts_per_period.values
    slack = 1.5 / swept.sizes["sample"]  # of a count over a span that is no multiple of the period
    both = (before > 0) & (after > 0)
    kind = both & ((before != after) | (np.abs(counts[0] - counts[1]) > 2.0 * slack))
    gaps = first.xi_rel_max.values, later.xi_rel_max.values
    moved = both & ~kind & (np.abs(gaps[1] / gaps[0] - 1.0) > tolerance)
    return {
        "irregular, later periodic": (before == 0) & (after > 0),
        "periodic, later irregular": (before > 0) & (after == 0),
        "periodic, later with another period or other impacts": kind,
        "of another size later": moved,
    }
