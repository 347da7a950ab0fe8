"""Job of chattering sequences (16): intervals between impacts that shrink by e each time.

Both masses lie together, pressed by their springs under a slow excitation near its crest, and one
is kicked off. What follows depends on e alone: each flight is shorter than the one before by the
factor e, in the limit, and gamma (17) says how many are followed before the masses stick.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..access import OSCILLATOR, EventInstance, Impacts, begin
from ..response.labels import column_variables, variable
from ..response.questions import Point
from ..running.job import Inputs, Job, Table
from ..structures import Excitation, Structure
from .cases import CASES

if TYPE_CHECKING:
    import xarray as xr

NUMBERS = {
    "impacts": "impacts until the masses stick",
    "sticks": "whether the sequence ends in permanent contact",
    "ratio": "median ratio of successive times between impacts, of the latest ones",
    "ratio_error": "largest distance of such a ratio from the coefficient of restitution",
    "shortest": "shortest time between impacts, over omega",
    "time": "time from the first impact to the last, over the excitation period",
}


@dataclass(frozen=True, kw_only=True)
class ChatteringJob(Job):
    """Job: impacts after one kick until sticking, for each restitution and gamma."""

    structure: Structure = CASES["elastic"]
    restitutions: tuple[float, ...] = (0.01, 0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.95, 0.99, 1.0)
    gammas: tuple[float, ...] = (1e-3, 1e-5, 1e-7, 1e-9)
    # so slow that the force which presses the masses together hardly changes meanwhile
    eta: float = 0.02
    # parting velocity over omega a eta^2 and 1 - e, so that all sequences take about as long; over
    # omega a eta^2 alone where e is 1, and the sequence has no end
    kick: float = 0.01
    latest: int = 3  # ratios taken, of the latest times that rounding does not reach
    item: ClassVar[str] = "sequence"

    def items(self, inputs: Inputs) -> Sequence[Structure]:
        """Return a structure for each pair of restitution and gamma."""
        return [
            self.structure.replace(e=e, gamma=gamma)
            for e in self.restitutions
            for gamma in self.gammas
        ]

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[Structure], previous: Table | None
    ) -> Table:
        """Simulate one structure's sequence; return its count, interval ratios and times."""
        (structure,) = items
        with EventInstance(fmus[OSCILLATOR]) as instance:
            impacts, point = self.simulate_kick(instance, structure)
        times = impacts.time * structure.omega
        between = np.diff(times)
        clear = between[between > 1e8 * np.finfo(float).eps * times[-1]] if len(times) else between
        ratios = (clear[1:] / clear[:-1])[-self.latest :]
        away = np.abs(ratios - structure.e).max(initial=0.0) if len(ratios) else np.nan
        row = [
            len(times),
            bool(impacts.sticks.any()),
            np.median(ratios) if len(ratios) else np.nan,
            away,
            between.min() if len(between) else np.nan,
            (times[-1] - times[0]) / (structure.omega * point.excitation.period),
        ]
        return {"rows": np.array([row], dtype=float)}

    def simulate_kick(self, instance: EventInstance, structure: Structure) -> tuple[Impacts, Point]:
        """Simulate from a kick until the masses stick, at most a quarter period; return impacts."""
        crest = 0.5 * np.pi
        point = Point(structure, Excitation.nondimensional(self.eta, structure, crest))
        middle = point.length * (1.0 + structure.mu) / (1.0 + structure.kappa)  # (6) without rates
        parting = self.kick * ((1.0 - structure.e) or 1.0) * point.speed
        share = structure.mu / (1.0 + structure.mu)
        start = middle, middle, -share * parting, (1.0 - share) * parting
        begin(instance, *point, start)
        impacts = instance.impacts(0.0, 0.25 * point.excitation.period)
        ends = np.flatnonzero(impacts.sticks)
        last = int(ends[0]) + 1 if len(ends) else len(impacts.time)
        kept = slice(0, last)
        cut = Impacts(
            impacts.time[kept], impacts.state[kept], impacts.closing[kept], impacts.sticks[kept]
        )
        return cut, point

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the sequences' numbers as a dataset over restitution and gamma."""
        import xarray as xr

        dims = "e", "gamma"
        shape = len(self.restitutions), len(self.gammas)
        variables = column_variables(dims, NUMBERS, table["rows"].T.reshape(-1, *shape))
        coordinates = {
            "e": variable("e", np.array(self.restitutions), "1", "coefficient of restitution"),
            "gamma": variable("gamma", np.array(self.gammas), "1", "end of chattering (17)"),
        }
        return xr.Dataset(variables, coordinates, {"title": "Chattering from one kick (16)"})
