"""The largest Lyapunov exponent along a sweep, from long runs: what decides between quasi-periodic and chaotic.

It is computed from the impacts that the FMU reports, with exact flow and saltation matrices (:mod:`orchestrate.flow`), not from two neighbours:
a neighbour must be near enough for its distance to be linear and far enough to be above rounding, which near grazing impacts and in chattering
is no distance at all, and it costs a second run and a restart a period.
"""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import xarray

from ..jobs import Job
from ..lyapunov import WORDS, largest_exponent, verdict
from ..sweep import Case
from ..trace import EventInstance, begin, period

STRIDE = 5  # of the sweep's frequencies
LOWEST = 0.43  # below it all is periodic with permanent contact
WANDER = np.log(10.0)  # a deviation that neither grows nor shrinks still wanders by such a factor


@dataclass(frozen=True)
class ExponentJob(Job):
    """Exponents of a sweep's responses.

    Attributes
    ----------
    sweep : str
    case : Case
    periods : int
        Followed at each frequency.
    etas : int
        Number of the sweep's frequencies.
    """

    sweep: str = ""
    case: Case = field(default_factory=Case)
    periods: int = 2500
    etas: int = 0
    NEEDS: ClassVar[tuple] = ("sweep",)
    CHUNK: ClassVar[int] = 20

    def count(self):
        """Number of frequencies."""
        return self.etas

    def items(self, inputs):
        """Frequencies and where the sweep left them."""
        data = inputs[self.sweep]
        rows = zip(data.eta.values, data.end_state.values, strict=True)
        return [(float(eta), tuple(map(float, state))) for eta, state in rows if eta >= LOWEST][::STRIDE]

    def work(self, fmu, items, carry):
        """Some frequencies."""
        rows = []
        with EventInstance(fmu) as instance:
            for eta, start in items:
                end = self.periods * period(eta)
                begin(instance, self.case, eta, start)
                impacts = instance.impacts(0.0, end)
                rows.append([eta, *largest_exponent(impacts, end, eta, self.case), len(impacts.time) / self.periods])
        return {"rows": np.array(rows)}

    def dataset(self, table, inputs):
        """Exponent, error and verdict over eta."""
        eta, exponent, error, impacts = table["rows"].T
        floor = WANDER / (self.periods * period(eta))
        text = ", ".join(f"{number}: {word}" for number, word in WORDS.items())
        variables = {
            "exponent": ("eta", exponent, {"units": "1", "long_name": "largest Lyapunov exponent, per unit of tau"}),
            "error": ("eta", error, {"units": "1", "long_name": "standard error of the exponent"}),
            "verdict": ("eta", verdict(exponent, error, floor).astype("i1"), {"long_name": text}),
            "impacts": ("eta", impacts, {"units": "1", "long_name": "impacts per excitation period"}),
        }
        title = f"Largest Lyapunov exponent, e = {self.case.e:g}, D = {self.case.D:g}"
        return xarray.Dataset(variables, {"eta": ("eta", eta)}, {"title": title, "periods": self.periods})


def exponent_job(sweep, resolution):
    """The job for a sweep's responses."""
    etas = len([eta for eta in sweep.plan.etas if eta >= LOWEST][::STRIDE])
    case = sweep.plan.case
    return ExponentJob(f"exponent_{case.label()}", sweep.fmu_guid, sweep.name, case, resolution.long_run, etas)
