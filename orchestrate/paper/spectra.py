"""Spectra at the delaminated structure's main peak, and at two other frequencies."""

from __future__ import annotations

from dataclasses import dataclass

from ..response.spectra import SpectraJob
from ..running.job import Inputs
from ..structures import Structure
from .derived import DerivedJob


@dataclass(frozen=True, kw_only=True)
class PeakSpectraJob(DerivedJob):
    """Spectra at the largest gap of a sweep, and elsewhere.

    Attributes
    ----------
    sweep : str
        Its name.
    structure : Structure
    others : tuple of float
        Further frequency ratios.
    """

    sweep: str
    structure: Structure
    others: tuple[float, ...] = (0.4, 1.13)

    def needs(self) -> tuple[str, ...]:
        """Return the name of the job of the sweep, in a tuple."""
        return (self.sweep,)

    def count(self) -> int:
        """Return the number of frequencies."""
        return 1 + len(self.others)

    def question(self, inputs: Inputs) -> SpectraJob:
        """Return their spectra."""
        peak = float(inputs[self.sweep].xi_rel_max.idxmax())
        return SpectraJob(name=self.name, structure=self.structure, eta=(peak, *self.others))
