"""Run a campaign as a job of the project's runner, in independent batches."""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from orchestrate.access import OSCILLATOR
from orchestrate.running.job import Inputs, Job, Table

from .ledger_file import digest
from .registry import CAMPAIGNS

HERE = Path(__file__).parent
TOLD = 20  # notes of a batch that are kept


def batch_seed(seed: int, batch: int) -> int:
    """Return the seed of a batch; seeds of neighbouring batches are independent."""
    return int.from_bytes(hashlib.sha256(f"{seed} {batch}".encode()).digest()[:6], "big")


def sources_digest() -> str:
    """Return a digest of the sources of all campaigns and benches."""
    return digest(HERE, HERE.parent / "benches")


@dataclass(frozen=True)
class CampaignJob(Job):
    """Job that runs a campaign, one batch per item."""

    campaign: str = ""
    seed: int = 0
    budget: int = 0
    size: int = 1
    sources: str = ""
    models: ClassVar[tuple[str, ...]] = (OSCILLATOR,)
    item: ClassVar[str] = "batch"

    def count(self) -> int:
        """Return the number of batches."""
        return -(-self.budget // self.size)

    def items(self, inputs: Inputs) -> Sequence[tuple[int, int]]:
        """Return seed and number of units of each batch."""
        left = [self.budget - i * self.size for i in range(self.count())]
        return [(batch_seed(self.seed, i), min(self.size, n)) for i, n in enumerate(left)]

    def work(self, fmus: Mapping[str, Path], items: Sequence[Any], previous: Table | None) -> Table:
        """Run some batches; return a row for each."""
        campaign, rows = CAMPAIGNS[self.campaign], []
        for seed, count in items:
            clock = processor_time()
            outcome = campaign.run(fmus[OSCILLATOR], seed, count)
            notes = [remove_paths(note) for note in outcome.notes[:TOLD]]
            kept = {"counts": dict(outcome.counts), "notes": notes, "rows": outcome.rows}
            told = json.dumps(kept)
            seconds = processor_time() - clock
            rows.append((outcome.done, outcome.findings, outcome.worst, seconds, seed, told))
        names = ("done", "findings", "worst", "seconds", "seed", "told")
        return {
            name: np.array(part) for name, part in zip(names, zip(*rows, strict=True), strict=True)
        }

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return a dataset of all batches."""
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


def remove_paths(note: str) -> str:
    """Return a note without this machine's paths."""
    for folder in (HERE.parents[1], Path(sys.prefix), Path.home()):
        note = note.replace(f"{folder}{os.sep}", "")
    return note


def processor_time() -> float:
    """Return the processor time of this process and its ended children, s."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system
