"""What a campaign is: a promise that is attacked by a seed, in batches that know nothing of each
other; and how it is run, by the project's own runner.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from orchestrate.access import OSCILLATOR
from orchestrate.running.job import Inputs, Job, Table

HERE = Path(__file__).parent
TOLD = 20  # notes of a batch that are kept


@dataclass(frozen=True)
class Outcome:
    """What a batch found.

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
    """One promise, and how it is attacked.

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
    def run(self, fmu: Path, seed: int, count: int) -> Outcome:
        """Attack.

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
        """Lines of Markdown for the page, from the rows of all its runs."""
        return []

    def draw(self, rows: Sequence[Sequence[Any]], folder: Path) -> list[Path]:
        """Draw what the report shows as pictures into the folder of the page; which files."""
        return []


def batch_seed(seed: int, batch: int) -> int:
    """The seed of a batch: those of neighbours have nothing in common."""
    return int.from_bytes(hashlib.sha256(f"{seed} {batch}".encode()).digest()[:6], "big")


def sources() -> str:
    """A digest of the sources of all campaigns and benches: other sources, another question."""
    from .records import digest

    return digest(HERE, HERE.parent / "benches")


@dataclass(frozen=True)
class CampaignJob(Job):
    """A campaign as a job of the runner, a batch an item."""

    campaign: str = ""
    seed: int = 0
    budget: int = 0
    size: int = 1
    sources: str = ""
    models: ClassVar[tuple[str, ...]] = (OSCILLATOR,)
    item: ClassVar[str] = "batch"

    def count(self) -> int:
        """Number of batches."""
        return -(-self.budget // self.size)

    def items(self, inputs: Inputs) -> Sequence[tuple[int, int]]:
        """Seed and units of each batch."""
        left = [self.budget - i * self.size for i in range(self.count())]
        return [(batch_seed(self.seed, i), min(self.size, n)) for i, n in enumerate(left)]

    def work(self, fmus: Mapping[str, Path], items: Sequence[Any], previous: Table | None) -> Table:
        """Run batches."""
        from .registry import CAMPAIGNS

        campaign, rows = CAMPAIGNS[self.campaign], []
        for seed, count in items:
            clock = processor_time()
            found = campaign.run(fmus[OSCILLATOR], seed, count)
            notes = [without_places(note) for note in found.notes[:TOLD]]
            kept = {"counts": dict(found.counts), "notes": notes, "rows": found.rows}
            told = json.dumps(kept)
            seconds = processor_time() - clock
            rows.append((found.done, found.findings, found.worst, seconds, seed, told))
        names = ("done", "findings", "worst", "seconds", "seed", "told")
        return {
            name: np.array(part) for name, part in zip(names, zip(*rows, strict=True), strict=True)
        }

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Batches side by side."""
        about = {
            "done": ("1", "units done"),
            "findings": ("1", "units where the promise did not hold"),
            "worst": ("1", "the largest of what is measured"),
            "seconds": ("s", "processor time"),
            "seed": ("1", "seed of the batch"),
            "told": ("1", "further counts and notes, as JSON"),
        }
        return xr.Dataset(
            {
                name: ("batch", table[name], {"units": unit, "long_name": text})
                for name, (unit, text) in about.items()
            }
        )


def without_places(note: str) -> str:
    """A note for a record: where things lie on this machine is nobody else's matter."""
    for folder in (HERE.parents[1], Path(sys.prefix), Path.home()):
        note = note.replace(f"{folder}{os.sep}", "")
    return note


def processor_time() -> float:
    """Seconds that this process and its ended children have used."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system
