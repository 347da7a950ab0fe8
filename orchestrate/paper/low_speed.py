"""Job: counts of slow impacts that would stick by speed alone (17); alike halves.

The printed inequality (17) knows the parting velocity alone. Where the contact force (18) would
have to pull, the masses part again: an impact as slow as that is counted here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..access import OSCILLATOR, REST, EventInstance, begin
from ..dynamics.closed_form import ClosedForm
from ..dynamics.following import follow_impacts
from ..response.labels import column_variables, variable
from ..response.questions import Point
from ..running.job import Inputs, Job, Table
from ..structures import Excitation
from .cases import CASES

if TYPE_CHECKING:
    import xarray as xr

ELASTIC = CASES["elastic"]
COUNTS = {
    "impacts": "impacts",
    "sticking": "impacts after which permanent contact begins",
    "slow": "impacts that part slower than gamma times the largest closing speed",
    "pulled": "of these, those where the contact force (18) would pull",
}


def make_points() -> tuple[Point, ...]:
    """Return Figure 6's structure at several frequencies, then structures of alike halves."""
    etas = np.round(np.arange(0.45, 8.0, 0.15), 3).tolist()
    alike = [ELASTIC.replace(mu=mu, kappa=kappa) for mu, kappa in ((1, 1), (2, 2), (2, 2.2))]
    points_along = [Point(ELASTIC, Excitation.nondimensional(eta, ELASTIC)) for eta in etas]
    return (*points_along, *(Point(one, Excitation.nondimensional(1.3, one)) for one in alike))


@dataclass(frozen=True, kw_only=True)
class LowSpeedJob(Job):
    """Job: counts of impacts, sticking and slow impacts of motions from rest."""

    points: tuple[Point, ...] = make_points()
    periods: int = 2000
    gamma: float = 1e-4  # of (17), in units of the largest velocity of the gap (section 3)
    chunk_size: ClassVar[int] = 10

    def items(self, inputs: Inputs) -> Sequence[Point]:
        """Return the structures with their excitations."""
        return self.points

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[Point], previous: Table | None
    ) -> Table:
        """Simulate some motions; return how many impacts of each kind they have."""
        with EventInstance(fmus[OSCILLATOR]) as instance:
            return {"rows": np.array([self.count_events(instance, point) for point in items])}

    def count_events(self, instance: EventInstance, point: Point) -> list[int]:
        """Simulate one motion and count its events, in the order of ``COUNTS``."""
        begin(instance, *point, REST)
        impacts = follow_impacts(instance, point, REST, self.periods)
        form = ClosedForm.from_structure(*point)
        state, mu = impacts.state, form.mu
        force = form.force(state[:, 0], (state[:, 2] + mu * state[:, 3]) / (1.0 + mu))
        fastest = impacts.closing.max(initial=0.0)
        slow = form.e * impacts.closing < self.gamma * fastest
        pulled = slow & (force >= 0.0)
        return [len(state), int(impacts.sticks.sum()), int(slow.sum()), int(pulled.sum())]

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the counts as a dataset over the motions."""
        import xarray as xr

        variables = column_variables("motion", COUNTS, table["rows"].T)
        etas = [point.excitation.eta(point.structure) for point in self.points]
        numbers = {"eta": etas} | {
            name: [point.structure.get(name) for point in self.points] for name in ("mu", "kappa")
        }
        for name, values in numbers.items():
            variables[name] = variable("motion", np.array(values), "1", name)
        return xr.Dataset(variables, attrs={"title": f"Impacts in {self.periods} periods"})
