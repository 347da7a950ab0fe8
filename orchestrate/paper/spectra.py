"""Job: spectra at the main peak of a sweep and at two other frequencies."""

from __future__ import annotations

from dataclasses import dataclass

from ..response.spectra import SpectraJob
from ..running.job import Inputs
from ..structures import Structure
from .derived_job import DerivedJob


@dataclass(frozen=True, kw_only=True)
class PeakSpectraJob(DerivedJob):
    """Job: spectra at the largest gap of a sweep and at other frequencies."""

    sweep: str  # its name
    structure: Structure
    others: tuple[float, ...] = (0.4, 1.13)  # further frequency ratios

    def needs(self) -> tuple[str, ...]:
        """Return the name of the sweep's job, in a tuple."""
        return (self.sweep,)

    def count(self) -> int:
        """Return the number of frequencies."""
        return 1 + len(self.others)

    def derived_job(self, inputs: Inputs) -> SpectraJob:
        """Return the spectra job at the sweep's peak and the other frequencies."""
        peak = float(inputs[self.sweep].xi_rel_max.idxmax())
        return SpectraJob(name=self.name, structure=self.structure, eta=(peak, *self.others))
