"""Base class of campaigns: a promise attacked in independent batches, each from a seed."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar


@dataclass(frozen=True)
class BatchOutcome:
    """Result of a batch: units done, findings, counts and notes.

    Attributes
    ----------
    done : int
        Units done: flights, impacts, faults.
    findings : int
        Of these, where the promise did not hold.
    worst : float
        The largest of what the campaign measures; 0 where it measures nothing.
    counts : mapping of str to int
        What else was counted, to be summed.
    notes : tuple of str
        A line a finding, with what is needed to see it again.
    rows : tuple of list
        What was measured of each unit, where the campaign keeps that.
    """

    done: int
    findings: int = 0
    worst: float = 0.0
    counts: Mapping[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    rows: tuple[list[Any], ...] = ()


class Campaign(ABC):
    """A promise, and how a campaign attacks it; subclasses define ``run``.

    Attributes
    ----------
    name, title : str
        For the command line, and for people.
    asks : str
        What must hold, as sentences.
    unit : str
        What is counted.
    target : int
        How many of them are wanted.
    batch : int
        How many make a chunk of the job.
    measures : str
        What ``worst`` is; empty where nothing is measured.
    package : bool
        Whether the package is under test: a digest of its sources then names what was tested, else
        the FMU's GUID.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    asks: ClassVar[str]
    unit: ClassVar[str]
    target: ClassVar[int]
    batch: ClassVar[int]
    measures: ClassVar[str] = ""
    package: ClassVar[bool] = False

    @abstractmethod
    def run(self, fmu: Path, seed: int, count: int) -> BatchOutcome:
        """Attack the promise with ``count`` units from a seed; return the outcome.

        Parameters
        ----------
        fmu : Path
            The native FMI 3.0 FMU of the oscillator.
        seed : int
            All that is drawn depends on it.
        count : int
            Units to do.
        """

    def report(self, rows: Sequence[Sequence[Any]]) -> list[str]:
        """Return Markdown lines for the ledger's page, from the measured rows of all runs."""
        return []

    def draw(self, rows: Sequence[Sequence[Any]], folder: Path) -> list[Path]:
        """Draw the campaign's pictures into the page's folder; return their paths."""
        return []
