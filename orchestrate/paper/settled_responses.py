"""Job: sweep responses run on until they repeat, for at most 100,000 periods.

After the paper's 500 periods a transient may look like an attractor: chaos that dies out, a
deviation from an unstable orbit that has not grown yet.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..access import OSCILLATOR, Instance
from ..dynamics.clusters import AttractorSettings, response_features, run_until_settled
from ..dynamics.following import FollowedResponse, StartStatesQuestion
from ..response.labels import column_variables, nondimensional_state_coordinate, variable, yes_or_no
from ..response.respond import count_impacts
from ..running.job import Inputs, Table

if TYPE_CHECKING:
    import xarray as xr

FIELDS = {
    "multiplicity": "excitation periods after which the settled response repeats; 0: irregular",
    "impacts_per_period": "impacts per excitation period",
    "xi_rel_max": "largest gap over a eta^2",
    "periods": "periods after the sweep's until a repeated state decided",
}


@dataclass(frozen=True, kw_only=True)
class SettledJob(StartStatesQuestion):
    """Job: what a sweep's responses settle to."""

    settings: AttractorSettings = AttractorSettings(transient=0, settle=0.0)
    chunk_size: ClassVar[int] = 20

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[FollowedResponse], previous: Table | None
    ) -> Table:
        """Run some of a sweep's responses until they repeat; return features and end states."""
        rows, ends, contacts = [], [], []
        with Instance(fmus[OSCILLATOR]) as instance:
            for item in items:
                response, periods = run_until_settled(
                    instance, item.point, item.start, self.settings
                )
                n, impacts, gap = response_features(response, item.point.length)[:3]
                if n:  # over the response's own period
                    impacts = count_impacts(instance, item.point, response.end, int(n)) / n
                rows.append([n, impacts, gap, periods])
                ends.append(response.end / item.point.scale)
                contacts.append(response.permanent_contact)
        return {"rows": np.array(rows), "end": np.array(ends), "contact": np.array(contacts)}

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the settled responses over the parameter: features, contact, end state."""
        import xarray as xr

        along = self.series.name
        variables = column_variables(along, FIELDS, table["rows"].T)
        contact = "whether permanent contact occurs"
        variables["permanent_contact"] = yes_or_no(along, table["contact"], contact)
        text = "state at phase 0 at the end"
        variables["end_state"] = variable((along, "coordinate"), table["end"], "1", text)
        coordinates = {**self.series.coordinates(), **nondimensional_state_coordinate()}
        title = f"Settled responses along {along}: {self.structure.label()}"
        return xr.Dataset(variables, coordinates, {"title": title})
