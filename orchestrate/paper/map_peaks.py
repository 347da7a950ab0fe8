"""Job: impact statistics of the response with a map's largest impulse, in a longer run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..dynamics.impact_statistics import ImpactStatisticsJob
from ..dynamics.lyapunov import WANDER, WORDS, classify_exponents
from ..dynamics.variational import period_in_tau
from ..response.labels import flags, variable
from ..running.job import Inputs, Table
from ..structures import Structure
from .derived_job import DerivedJob

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, kw_only=True)
class MapPeakJob(DerivedJob):
    """Job: longer run at the point of a map with the largest impulse.

    The largest impulse of an irregular response depends on how long it is followed; and of many
    points with few periods each, that with the largest one is chosen for its chance too.
    """

    map: str  # its name
    parameter: str  # of the structure, along the map's first side
    structure: Structure  # with the map's other parameters
    # dropped from rest, and followed after them
    transient: int = 3000
    periods: int = 10_000

    def needs(self) -> tuple[str, ...]:
        """Return the name of the map's job, in a tuple."""
        return (self.map,)

    def count(self) -> int:
        """Return 1: one response."""
        return 1

    def derived_job(self, inputs: Inputs) -> ImpactStatisticsJob:
        """Return the impact-statistics job at the point of the map's largest impulse."""
        impulses = inputs[self.map].impulse_max
        best = impulses.where(impulses == impulses.max(), drop=True)
        changed = self.structure.replace(**{self.parameter: float(best[self.parameter][0])})
        return ImpactStatisticsJob(
            name=self.name,
            structure=changed,
            eta=(float(best.eta[0]),),
            transient=self.transient,
            periods=self.periods,
        )

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the response's statistics, its largest impulse (15), and its verdict."""
        structure = self.derived_job(inputs).structure
        answer = super().dataset(table, inputs)
        factor = (1.0 + structure.e) * structure.mu / (1.0 + structure.mu)
        floor = np.log(WANDER) / (self.periods * period_in_tau(float(answer.eta[0])))
        kind = classify_exponents(answer.exponent, answer.standard_error, floor)
        text = "largest impulse over m1 omega a eta^2"
        answer["impulse_max"] = variable("eta", factor * answer.closing_max.values, "1", text)
        answer["verdict"] = flags("eta", kind, "what the exponent says of the response", WORDS)
        return answer
