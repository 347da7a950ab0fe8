"""The sweeps of Figures 6, 10 and 11, and what each response looks like impact by impact."""

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import xarray

from .. import orbit
from ..fmu import Instance
from ..jobs import Job
from ..lyapunov import largest_exponent
from ..sweep import Case, Plan, respond
from ..trace import REST, EventInstance, begin, period


@dataclass(frozen=True)
class SweepJob(Job):
    """One sequential sweep: the same numbers, file and identity as ``orchestrate sweep`` with the same FMU.

    Attributes
    ----------
    plan : Plan
    """

    plan: Plan = None  # type: ignore[assignment]
    CHUNK: ClassVar[int] = 200
    SEQUENTIAL: ClassVar[bool] = True

    def identity(self):
        """The plan's."""
        return self.plan.identity()

    def count(self):
        """Number of frequencies."""
        return len(self.plan.etas)

    def items(self, inputs):
        """The frequencies in the sweep's order."""
        return self.plan.etas

    def work(self, fmu, items, carry):
        """Some frequencies, from the end of the last."""
        start = tuple(carry["rows"][-1, 4:8]) if carry else REST
        rows = []
        with Instance(fmu) as instance:
            for eta in items:
                response = respond(instance, self.plan, eta, start)
                rows.append(response.row())
                start = response.end
        return {"rows": np.array(rows)}

    def dataset(self, table, inputs):
        """As ``orchestrate sweep`` writes it."""
        return orbit.dataset(self.plan, table["rows"], Named(self.fmu_guid))


@dataclass(frozen=True)
class Named:
    """What a result says of its FMU."""

    guid: str
    name: str = "TwoMassImpactOscillator"
    fmi_version: str = "3.0"


def sweep_job(case, direction, resolution, guid):
    """The sweep of a case, ``up`` or ``down``."""
    etas = resolution.etas() if direction == "up" else resolution.etas()[::-1]
    plan = Plan(case, etas, resolution.transient, resolution.samples, 1e-2, guid)
    return SweepJob(f"orbit_{case.label()}_{direction}", guid, plan)


FIELDS = {
    "impacts": "impacts per excitation period",
    "fewest": "fewest impacts in one excitation period",
    "most": "most impacts in one excitation period",
    "contacts": "permanent contacts begun per excitation period",
    "contact_share": "share of the time from the beginnings of permanent contacts to the next impacts",
    "closing_max": "largest closing velocity",
    "closing_min": "least closing velocity",
    "closing_sum": "sum of closing velocities per excitation period",
    "distance_min": "least time between successive impacts, over T",
    "distance_max": "largest time between successive impacts, over T",
    "exponent": "largest Lyapunov exponent, per unit of tau",
    "exponent_error": "its standard error",
}


@dataclass(frozen=True)
class SteadyJob(Job):
    """Each response of a sweep followed further, impact by impact.

    Attributes
    ----------
    sweep : str
        Name of the sweep.
    case : Case
    periods : int
        Excitation periods followed.
    """

    sweep: str = ""
    case: Case = field(default_factory=Case)
    periods: int = 200
    size: int = 0
    NEEDS: ClassVar[tuple] = ("sweep",)
    CHUNK: ClassVar[int] = 50

    def count(self):
        """Number of frequencies."""
        return self.size

    def items(self, inputs):
        """Frequency and state at the end of its sweep's samples."""
        data = inputs[self.sweep]
        return [(float(eta), tuple(map(float, state))) for eta, state in zip(data.eta.values, data.end_state.values, strict=True)]

    def work(self, fmu, items, carry):
        """Some frequencies."""
        with EventInstance(fmu) as instance:
            rows = [list(steady(instance, self.case, eta, start, self.periods).values()) for eta, start in items]
        return {"rows": np.array(rows, dtype=float)}

    def dataset(self, table, inputs):
        """One variable a property, over eta upwards."""
        etas = inputs[self.sweep].eta.values
        variables = {name: ("eta", table["rows"][:, i], {"units": "1", "long_name": text}) for i, (name, text) in enumerate(FIELDS.items())}
        attributes = {"title": f"Responses of {self.sweep}, impact by impact", "periods": self.periods}
        return xarray.Dataset(variables, {"eta": ("eta", etas)}, attributes).sortby("eta")


def steady(instance, case, eta, start, periods):
    """What a settled response looks like impact by impact, by the names of ``FIELDS``.

    Parameters
    ----------
    instance : EventInstance
    case : Case
    eta : float
    start : tuple of float
        State at phase 0.
    periods : int
    """
    span = period(eta)
    begin(instance, case, eta, start)
    impacts = instance.impacts(0.0, periods * span)
    exponent, error = largest_exponent(impacts, periods * span, eta, case)
    return {**counts(impacts, span, periods), **strengths(impacts, span, periods), "exponent": exponent, "exponent_error": error}


def counts(impacts, span, periods):
    """Numbers of impacts; those of a chattering are all counted."""
    each = np.bincount(np.minimum((impacts.time / span).astype(int), periods - 1), minlength=periods) if len(impacts.time) else np.zeros(1)
    distances = np.diff(impacts.time) / span
    stuck = distances[impacts.sticks[:-1]].sum() if len(distances) else 0.0
    return {
        "impacts": len(impacts.time) / periods,
        "fewest": float(each.min()),
        "most": float(each.max()),
        "contacts": impacts.sticks.sum() / periods,
        "contact_share": stuck / periods,
    }


def strengths(impacts, span, periods):
    """Closing velocities, and times between impacts."""
    distances = np.diff(impacts.time) / span
    return {
        "closing_max": impacts.closing.max(initial=0.0),
        "closing_min": impacts.closing.min(initial=math.inf),
        "closing_sum": impacts.closing.sum() / periods,
        "distance_min": distances.min(initial=math.inf),
        "distance_max": distances.max(initial=0.0),
    }


def steady_job(sweep, resolution):
    """The job that follows a sweep's responses."""
    name = sweep.name.replace("orbit", "steady")
    return SteadyJob(name, sweep.fmu_guid, sweep.name, sweep.plan.case, resolution.steady, len(sweep.plan.etas))
