"""Ledger entries of campaign runs: lines of JSON in docs/trust.jsonl, only ever added.

Every run has its line, also where the same command was run before: it may have found something.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import time
from collections import Counter
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import xarray as xr

from orchestrate.version import __version__

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "orchestrate"
LEDGER = ROOT / "docs" / "trust.jsonl"
SOURCES = (
    ".py",
    ".c",
    ".h",
    ".js",
    ".css",
    ".j2",
    ".html",
    ".toml",
)  # a program's


@dataclass(frozen=True)
class LedgerEntry:
    """One run of a campaign as an entry of the ledger."""

    campaign: str
    # as given
    seed: int
    budget: int
    done: int
    findings: int
    worst: float  # the largest of what is measured, and
    worst_seed: int  # the seed of the batch that it was in
    counts: dict[str, int]
    notes: list[str]  # of findings
    seconds: float  # of the processor
    # `fmu` is the GUID of the FMU, `package` a digest of the sources of `orchestrate`,
    date: str
    version: str
    fmu: str
    package: str
    machine: str
    # and this one of the campaigns' own and the benches'; empty in entries from before there was
    # one
    campaigns: str = ""
    # what was measured of each unit, where the campaign keeps that
    rows: list[list[Any]] = field(default_factory=list)

    def command(self) -> str:
        """Return the command that repeats the run."""
        return (
            f"python -m tools.trust run {self.campaign} --seed {self.seed} --budget {self.budget}"
        )

    def is_copy(self, other: LedgerEntry) -> bool:
        """Return whether another entry is a copy of this run, its stored result read again."""
        return {**asdict(self), "date": ""} == {**asdict(other), "date": ""}


def make_entry(campaign: str, seed: int, budget: int, answer: xr.Dataset) -> LedgerEntry:
    """Return the ledger entry of a finished run's dataset."""
    details = [json.loads(str(text)) for text in answer.told.values]
    counts: Counter[str] = Counter()
    for part in details:
        counts.update(part["counts"])
    return LedgerEntry(
        campaign=campaign,
        seed=seed,
        budget=budget,
        done=int(answer.done.sum()),
        findings=int(answer.findings.sum()),
        worst=float(f"{float(answer.worst.max()):.3g}"),
        worst_seed=int(answer.seed[int(answer.worst.values.argmax())]),
        counts=dict(sorted(counts.items())),
        notes=[note for part in details for note in part["notes"]],
        seconds=round(float(answer.seconds.sum()), 2),
        date=time.strftime("%Y-%m-%d", time.gmtime()),
        version=__version__,
        fmu=str(answer.attrs["fmu_guid"]),
        package=digest(PACKAGE),
        machine=describe_machine(),
        campaigns=str(answer.attrs["sources"]),
        rows=[row for part in details for row in part["rows"]],
    )


def digest(*folders: Path) -> str:
    """Return a digest of the sources in some folders, with their names."""
    hashed = hashlib.sha256()
    for folder in folders:
        for path in sorted(path for path in folder.rglob("*") if path.suffix in SOURCES):
            content, name = path.read_bytes(), path.relative_to(folder).as_posix()
            hashed.update(f"{name} {len(content)}\n".encode() + content)
    return hashed.hexdigest()[:16]


def describe_machine() -> str:
    """Return a description of the machine in one line, without its owner."""
    try:
        text = Path("/proc/cpuinfo").read_text("utf-8")
        model = re.findall(r"model name\s*: (.*)", text)[0]
    except (OSError, IndexError):
        model = platform.processor()
    system = f"{platform.system()} {platform.machine()}"
    return f"{model}, {os.cpu_count()} cores, {system}, Python {platform.python_version()}"


def read_entries(path: Path = LEDGER) -> list[LedgerEntry]:
    """Return all ledger entries, the oldest first."""
    lines = path.read_text("utf-8").splitlines() if path.exists() else []
    return [LedgerEntry(**json.loads(line)) for line in lines]


def append_entry(entry: LedgerEntry, path: Path = LEDGER) -> bool:
    """Append an entry to the ledger's file; return False if it is there already."""
    if any(entry.is_copy(other) for other in read_entries(path)):
        return False
    row: dict[str, Any] = asdict(entry)
    if not entry.rows:
        del row["rows"]
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")
    return True
