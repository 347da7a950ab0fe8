"""Parameter maps: impacts per period, multiplicity, peak and largest impulse over (eta, e), (eta, D) and (eta, kappa).

Each point starts from rest: points are independent, and where attractors coexist a map shows the one reached from rest.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import xarray

from ..attractors import settling
from ..fmu import Instance
from ..jobs import Job
from ..sweep import Plan, respond
from ..trace import REST, EventInstance, begin, period
from .resolution import ELASTIC

ETAS = (0.4, 2.2)
RANGES = {"e": (0.05, 0.95), "D": (0.005, 0.15), "kappa": (1.02, 2.0)}  # D on a logarithmic scale
FIELDS = {
    "impacts_per_period": "impacts per excitation period",
    "multiplicity": "multiplicity; 0: not periodic",
    "xi_rel_max": "largest xi_Rel",
    "impulse_max": "largest impulse over m_1 omega a eta^2",
}


def impulse(case, closing):
    """Impulse of an impact over ``m1 omega a eta^2``, from its closing velocity (15)."""
    return (1.0 + case.e) * case.mu / (1.0 + case.mu) * closing


@dataclass(frozen=True)
class MapJob(Job):
    """One map.

    Attributes
    ----------
    parameter : str
        Of ``RANGES``; the other parameters are those of Figure 6.
    etas, rows : int
        Values along the sides.
    settle, keep : int
        Periods dropped and kept.
    """

    parameter: str = "e"
    etas: int = 121
    rows: int = 41
    settle: int = 300
    keep: int = 60
    CHUNK: ClassVar[int] = 1

    def count(self):
        """Number of values of the parameter."""
        return self.rows

    def values(self):
        """The parameter's values."""
        low, high = RANGES[self.parameter]
        return np.geomspace(low, high, self.rows) if self.parameter == "D" else np.linspace(low, high, self.rows)

    def items(self, inputs):
        """The parameter's values."""
        return list(map(float, self.values()))

    def work(self, fmu, items, carry):
        """Some rows of the map."""
        etas = np.linspace(*ETAS, self.etas)
        with Instance(fmu) as instance, EventInstance(fmu) as eventful:
            cases = [replace(ELASTIC, **{self.parameter: value}) for value in items]
            rows = [[self.point(instance, eventful, case, float(eta)) for eta in etas] for case in cases]
        return {"rows": np.array(rows)}

    def point(self, instance, eventful, case, eta):
        """One point of the map, in the order of ``FIELDS``."""
        response = respond(instance, Plan(case, (), settling(self.settle, eta), self.keep, 1e-2, ""), eta, REST)
        begin(eventful, case, eta, response.end)
        closing = eventful.impacts(0.0, self.keep // 2 * period(eta)).closing.max(initial=0.0)
        return [response.impacts_per_period, response.multiplicity, response.xi_rel_max, impulse(case, closing)]

    def dataset(self, table, inputs):
        """The fields over both parameters."""
        variables = {
            name: ((self.parameter, "eta"), table["rows"][:, :, i], {"units": "1", "long_name": text})
            for i, (name, text) in enumerate(FIELDS.items())
        }
        coordinates = {self.parameter: self.values(), "eta": np.linspace(*ETAS, self.etas)}
        return xarray.Dataset(variables, coordinates, {"title": f"Map over (eta, {self.parameter}) from rest"})


def map_jobs(resolution, guid):
    """All three maps."""
    sizes = (resolution.map_etas, resolution.map_rows, resolution.map_settle, resolution.map_keep)
    return [MapJob(f"map_{parameter}", guid, parameter, *sizes) for parameter in RANGES]
