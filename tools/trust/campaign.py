"""Base class of campaigns: a promise attacked in independent batches, each from a seed."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar


@dataclass(frozen=True)
class BatchOutcome:
    """Result of a batch: units done, findings, counts and notes."""

    done: int  # units done: flights, impacts, faults
    findings: int = 0  # of these, where the promise did not hold
    worst: float = 0.0  # the largest of what the campaign measures; 0 where it measures nothing
    counts: Mapping[str, int] = field(default_factory=dict)  # what else was counted, to be summed
    notes: tuple[str, ...] = ()  # A line a finding, with what is needed to see it again
    # what was measured of each unit, where the campaign keeps that
    rows: tuple[list[Any], ...] = ()


class Campaign(ABC):
    """A promise, and how a campaign attacks it; subclasses define ``run``."""

    # for the command line, and for people
    name: ClassVar[str]
    title: ClassVar[str]
    asks: ClassVar[str]  # what must hold, as sentences
    unit: ClassVar[str]  # what is counted
    target: ClassVar[int]  # how many of them are wanted
    batch: ClassVar[int]  # how many make a chunk of the job
    measures: ClassVar[str] = ""  # what `worst` is; empty where nothing is measured
    # whether the package is under test: a digest of its sources then names what was tested, else
    # the FMU's GUID
    package: ClassVar[bool] = False

    @abstractmethod
    def run(self, fmu: Path, seed: int, count: int) -> BatchOutcome:
        """Attack the promise with ``count`` units from a seed; return the outcome."""

    def report(self, rows: Sequence[Sequence[Any]]) -> list[str]:
        """Return Markdown lines for the ledger's page, from the measured rows of all runs."""
        return []

    def draw(self, rows: Sequence[Sequence[Any]], folder: Path) -> list[Path]:
        """Draw the campaign's pictures into the page's folder; return their paths."""
        return []
