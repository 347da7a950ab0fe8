"""Job: exact stability limits of the paper's responses, by branches through the sweeps'."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from ..access import OSCILLATOR
from ..dynamics.branches import branch
from ..dynamics.orbits import orbit
from ..dynamics.stable_windows import StableWindow, stable_windows
from ..response.labels import column_variables, variable
from ..running.job import Inputs, Job, Table
from ..structures import Structure
from .cases import CASES

if TYPE_CHECKING:
    import xarray as xr


class BranchSpec(NamedTuple):
    """A branch to trace: case, orbit's name, start frequency, period and limits."""

    # mT/k: k impacts in m periods
    case: str
    label: str
    eta: float  # where the up-sweep is on it
    period: int
    limits: tuple[float, float]  # of eta


WINDOWS = (  # of all cases: label, eta, periods, limits
    ("T/1", 1.6, 1, (0.9, 3.0)),
    ("2T/1", 4.2, 2, (3.3, 5.1)),
    ("3T/1", 6.2, 3, (5.4, 7.2)),
    ("4T/1", 8.0, 4, (7.45, 9.3)),
)
OWN = {
    "elastic": (
        ("T, contact", 0.41, 1, (0.405, 0.45)),
        ("T/13", 0.421, 1, (0.41, 0.45)),
        ("T/2", 1.0, 1, (0.42, 1.37)),
        ("2T/3", 1.36, 2, (1.06, 1.5)),
    ),
    "damped": (
        ("T, contact", 0.44, 1, (0.42, 0.5)),
        ("T/2", 1.06, 1, (0.42, 1.37)),
        ("2T/3", 1.2, 2, (1.06, 1.5)),
    ),
    "plastic": (
        ("T, contact", 0.94, 1, (0.92, 1.0)),
        ("T/3", 1.0, 1, (0.9, 1.2)),
        ("T/2", 1.1, 1, (0.9, 1.37)),
    ),
}
BRANCHES = tuple(BranchSpec(case, *row) for case in CASES for row in (*OWN[case], *WINDOWS))


@dataclass(frozen=True, kw_only=True)
class LimitsJob(Job):
    """Job: stable windows along each branch."""

    # names of the up-sweeps, in the order of the cases, whose responses the branches begin with
    sweeps: tuple[str, ...]
    structures: tuple[Structure, ...] = tuple(CASES.values())  # of these sweeps
    branches: tuple[BranchSpec, ...] = BRANCHES
    item: ClassVar[str] = "branch"

    def needs(self) -> tuple[str, ...]:
        """Return the names of the sweep jobs whose results it needs."""
        return self.sweeps

    def count(self) -> int:
        """Return the number of branches."""
        return len(self.branches)

    def items(self, inputs: Inputs) -> Sequence[tuple[int, Structure, tuple[float, ...]]]:
        """Return number, structure and start state of each branch."""
        items = []
        for number, one in enumerate(self.branches):
            index = list(CASES).index(one.case)
            row = inputs[self.sweeps[index]].sel(eta=one.eta, method="nearest")
            state = tuple(map(float, row.end_state.values))
            items.append((number, self.structures[index], state))
        return items

    def work(
        self,
        fmus: Mapping[str, Path],
        items: Sequence[tuple[int, Structure, tuple[float, ...]]],
        previous: Table | None,
    ) -> Table:
        """Trace one branch; return its stable windows with their bifurcations."""
        ((number, structure, state),) = items
        one = self.branches[number]
        keywords: Any = {"progress": False, "fmu": fmus[OSCILLATOR]}
        start = orbit(structure, eta=one.eta, period=one.period, guess=state, **keywords)
        windows = stable_windows(branch(structure, start=start, limits=one.limits, **keywords))
        return {
            "branch": np.full(len(windows), number),
            "ends": np.array([(w.low, w.high) for w in windows]).reshape(-1, 2),
            "kinds": np.array([(w.below, w.above) for w in windows], dtype="U40").reshape(-1, 2),
        }

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return all stable windows one after the other."""
        import xarray as xr

        of = [self.branches[number] for number in table["branch"].tolist()]
        texts = {
            "low": "where it begins",
            "high": "where it ends",
            "below": "what happens where it begins",
            "above": "what happens where it ends",
        }
        variables = column_variables("window", texts, [*table["ends"].T, *table["kinds"].T])
        variables["case"] = variable("window", [one.case for one in of], "1", "structure")
        text = "orbit: mT/k has k impacts in m periods"
        variables["orbit"] = variable("window", [one.label for one in of], "1", text)
        return xr.Dataset(variables, attrs={"title": "Exact limits of stability"})


def stable_windows_of(data: xr.Dataset, case: str, label: str) -> list[StableWindow]:
    """Return the stable windows of one orbit of a case, by rising frequency."""
    which = (data.case.values == case) & (data.orbit.values == label)
    names = StableWindow._fields
    rows = zip(*(data[name].values[which].tolist() for name in names), strict=True)
    return sorted(StableWindow(*row) for row in rows)
