"""What was done: a line of JSON a run, in ``docs/trust.jsonl``; lines are added, never changed."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import time
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from orchestrate.version import __version__

PACKAGE = Path(__file__).resolve().parents[2] / "orchestrate"
RECORDS = Path(__file__).resolve().parents[2] / "docs" / "trust.jsonl"


@dataclass(frozen=True)
class Record:
    """One run of a campaign.

    Attributes
    ----------
    campaign : str
    seed, budget : int
        As given.
    done, findings : int
    worst : float
        The largest of what is measured, and
    worst_seed : int
        the seed of the batch that it was in.
    counts : dict of str to int
    notes : list of str
        Of findings.
    seconds : float
        Of the processor.
    date, version, fmu, package, machine : str
        ``fmu`` is the GUID of the FMU, ``package`` a digest of the sources of ``orchestrate``.
    """

    campaign: str
    seed: int
    budget: int
    done: int
    findings: int
    worst: float
    worst_seed: int
    counts: dict[str, int]
    notes: list[str]
    seconds: float
    date: str
    version: str
    fmu: str
    package: str
    machine: str

    def command(self) -> str:
        """What does it again."""
        return (
            f"python -m tools.trust run {self.campaign} --seed {self.seed} --budget {self.budget}"
        )

    def is_again(self, other: Record) -> bool:
        """Whether another record is of the same run: then it says nothing new."""
        names = ("campaign", "seed", "budget", "fmu", "package")
        return all(getattr(self, name) == getattr(other, name) for name in names)


def record_of(campaign: str, seed: int, budget: int, found: xr.Dataset) -> Record:
    """A finished run's record."""
    told = [json.loads(str(text)) for text in found.told.values]
    counts: Counter[str] = Counter()
    for part in told:
        counts.update(part["counts"])
    return Record(
        campaign=campaign,
        seed=seed,
        budget=budget,
        done=int(found.done.sum()),
        findings=int(found.findings.sum()),
        worst=float(f"{float(found.worst.max()):.3g}"),
        worst_seed=int(found.seed[int(found.worst.values.argmax())]),
        counts=dict(sorted(counts.items())),
        notes=[note for part in told for note in part["notes"]],
        seconds=round(float(found.seconds.sum()), 2),
        date=time.strftime("%Y-%m-%d", time.gmtime()),
        version=__version__,
        fmu=str(found.attrs["fmu_guid"]),
        package=package(),
        machine=machine(),
    )


def package() -> str:
    """A digest of the package's sources."""
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def machine() -> str:
    """The machine in a line: nothing that names its owner."""
    try:
        text = Path("/proc/cpuinfo").read_text("utf-8")
        model = re.findall(r"model name\s*: (.*)", text)[0]
    except (OSError, IndexError):
        model = platform.processor()
    system = f"{platform.system()} {platform.machine()}"
    return f"{model}, {os.cpu_count()} cores, {system}, Python {platform.python_version()}"


def read(path: Path = RECORDS) -> list[Record]:
    """All records, the oldest first."""
    lines = path.read_text("utf-8").splitlines() if path.exists() else []
    return [Record(**json.loads(line)) for line in lines]


def append(record: Record, path: Path = RECORDS) -> bool:
    """Add a record; false where one of the same run is there."""
    if any(record.is_again(other) for other in read(path)):
        return False
    row: dict[str, Any] = asdict(record)
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")
    return True
