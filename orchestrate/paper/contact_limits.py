"""Job: how the limit of permanent contact depends on gamma (17)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..access import OSCILLATOR, REST, Instance
from ..response.labels import variable
from ..response.questions import Point
from ..response.respond import follow_responses
from ..running.job import Inputs, Job, Table
from ..structures import Excitation, Structure
from .cases import CASES

if TYPE_CHECKING:
    import xarray as xr

RANGES = {"elastic": (0.400, 0.445), "damped": (0.450, 0.500), "plastic": (0.930, 0.985)}


@dataclass(frozen=True, kw_only=True)
class ContactLimitJob(Job):
    """Job: last frequency with permanent contact, by a short sweep per case and gamma."""

    structures: tuple[Structure, ...] = tuple(CASES.values())
    # of eta, for each of them
    ranges: tuple[tuple[float, float], ...] = tuple(RANGES[name] for name in CASES)
    gammas: tuple[float, ...] = (1e-5, 1e-4, 1e-3, 1e-2, 5e-2)
    step: float = 0.001  # of eta
    # periods dropped and kept at each frequency
    transient: int = 250
    samples: int = 40

    def items(self, inputs: Inputs) -> list[tuple[Structure, tuple[float, float]]]:
        """Return structure and frequency range of each short sweep."""
        return [
            (structure.replace(gamma=gamma), ends)
            for structure, ends in zip(self.structures, self.ranges, strict=True)
            for gamma in self.gammas
        ]

    def work(
        self,
        fmus: Mapping[str, Path],
        items: Sequence[tuple[Structure, tuple[float, float]]],
        previous: Table | None,
    ) -> Table:
        """Compute one short sweep; return its last frequency with permanent contact."""
        ((structure, ends),) = items
        etas = np.round(np.arange(*ends, self.step), 9)
        points = [Point(structure, Excitation.nondimensional(float(e), structure)) for e in etas]
        settings = self.transient, self.samples, 1e-2
        last = np.nan
        with Instance(fmus[OSCILLATOR]) as instance:
            responses = follow_responses(instance, points, REST, *settings)
            for eta, response in zip(etas, responses, strict=True):
                last = eta if response.permanent_contact else last
        return {"last": np.array([last])}

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the limits as a dataset over case and gamma."""
        import xarray as xr

        text = "last eta with permanent contact on a short up-sweep from rest"
        last = table["last"].reshape(len(self.structures), len(self.gammas))
        coordinates = {
            "case": variable("case", list(CASES), "1", "the paper's structure"),
            "gamma": variable("gamma", np.array(self.gammas), "1", "end of chattering (17)"),
        }
        variables = {"last_contact": variable(("case", "gamma"), last, "1", text)}
        return xr.Dataset(variables, coordinates, {"title": "Limits of permanent contact"})
