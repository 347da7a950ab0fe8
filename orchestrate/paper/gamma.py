"""How far the limits of permanent contact depend on gamma (17): short sweeps past them with gammas over four decades."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import xarray

from ..fmu import Instance
from ..jobs import Job
from ..sweep import Plan, respond
from ..trace import REST
from .resolution import CASES

GAMMAS = (1e-5, 1e-4, 1e-3, 1e-2, 5e-2)
RANGES = {"elastic": (0.400, 0.445), "damped": (0.450, 0.500), "plastic": (0.930, 0.985)}
STEP, TRANSIENT, SAMPLES = 0.001, 250, 40


@dataclass(frozen=True)
class GammaJob(Job):
    """The last frequency with permanent contact, for each case and gamma."""

    CHUNK: ClassVar[int] = 1

    def count(self):
        """Number of short sweeps."""
        return len(CASES) * len(GAMMAS)

    def items(self, inputs):
        """Case and gamma of each."""
        return [(name, gamma) for name in CASES for gamma in GAMMAS]

    def work(self, fmu, items, carry):
        """One short sweep."""
        ((name, gamma),) = items
        case, start, last = replace(CASES[name], gamma=gamma), REST, np.nan
        low, high = RANGES[name]
        with Instance(fmu) as instance:
            for eta in np.round(np.arange(low, high, STEP), 9):
                response = respond(instance, Plan(case, (), TRANSIENT, SAMPLES, 1e-2, ""), float(eta), start)
                start = response.end
                last = float(eta) if response.permanent_contact else last
        return {"last": np.array([last])}

    def dataset(self, table, inputs):
        """The limits over case and gamma."""
        text = {"units": "1", "long_name": "last eta with permanent contact on a short up-sweep from rest"}
        last = ("case", "gamma"), table["last"].reshape(len(CASES), len(GAMMAS)), text
        return xarray.Dataset({"last_contact": last}, {"case": list(CASES), "gamma": list(GAMMAS)}, {"title": "Limits of permanent contact"})


def gamma_job(guid):
    """The job."""
    return GammaJob("gamma", guid)
