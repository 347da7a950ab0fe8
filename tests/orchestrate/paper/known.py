"""Datasets of the paper that a test makes up: verdicts follow from them alone."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from orchestrate.dynamics.stable_windows import StableWindow
from orchestrate.paper.claims import judge, read_claims
from orchestrate.paper.datasets import Datasets
from orchestrate.paper.measures import find_measure
from orchestrate.paper.resolution import FULL

WINDOWS = {  # exact limits, rounded
    **{"T, contact": (0.40, 0.42), "T/2": (0.89, 1.06), "T/1": (1.30, 2.65)},
    **{"2T/1": (3.60, 4.75), "3T/1": (5.70, 6.84), "4T/1": (7.79, 8.94)},
}


def known(windows=None, **answers):
    """Datasets whose methods answer as told, whatever their arguments, and never compute."""
    data = Datasets(Path("nowhere"), FULL, {})
    limits = {**WINDOWS, **(windows or {})}

    def windows_of_branch(case, orbit):
        return [StableWindow(*limits.get(orbit, (1.0, 1.3)), "fold", "fold")]

    data.windows_of_branch = windows_of_branch
    data.get_or_compute = lambda name, *_, **__: pytest.fail(f"{name}: would be computed")
    for name, answer in answers.items():
        setattr(data, name, answer if callable(answer) else lambda *_, answer=answer: answer)
    return data


def measured(row, data):
    """What the measure of a claim says: by its number in the table, or by its function's name."""
    table = read_claims()
    claim = table[row] if isinstance(row, int) else next(c for c in table if c.measure == row)
    return find_measure(claim.measure)(data, claim, **claim.parse_arguments())


def verdict(row, data):
    return judge(measured(row, data).parts)


def along_eta(etas, **columns):
    """A dataset over eta; ``xi_rel`` has 201 samples."""
    variables = {name: ("eta", np.asarray(values)) for name, values in columns.items()}
    variables["xi_rel"] = ("eta", "sample"), np.zeros((len(etas), 201))
    return xr.Dataset(variables, {"eta": np.asarray(etas, dtype=float)})


def responses(etas, multiplicity, impacts, **more):
    """A sweep's responses that repeat after so many periods with so many impacts in them."""
    n = np.broadcast_to(multiplicity, len(etas))
    rate = np.broadcast_to(impacts, len(etas)) / np.maximum(n, 1)
    more.setdefault("xi_rel_max", np.linspace(1.0, 2.0, len(etas)))
    return along_eta(etas, multiplicity=n, impacts_per_period=rate, **more)
