"""Campaign on fuzzing: random calls of the FMU's C shim under sanitizers."""

from __future__ import annotations

import functools
import re
from pathlib import Path
from typing import Any

from orchestrate.access import MODELS
from tools import importers

from .campaign import BatchOutcome, Campaign
from .programs import temporary_folder

VERSIONS = ("fmi2", "fmi3")
PER_INPUT = 12  # calls of a sequence, about
COVERAGE = 400  # sequences of the build that counts branches


@functools.cache
def compile_with_sanitizer(fmu: Path, version: str, model: str, options: tuple[str, ...]) -> Any:
    """Compile importer and shim of a model with sanitizer options; return the importer."""
    folder = temporary_folder() / f"{version}-{model}-{len(options)}{options[0][2:10]}"
    return importers.importer_with_sanitizer(version, model, fmu.parents[1], folder, options)


class FuzzCampaign(Campaign):
    """Campaign: FMU functions called in any order with any argument cause no memory error."""

    name = "fuzzing"
    title = "Call sequences"
    asks = (
        "Sequences of calls drawn at random, of both FMI versions and both models: any function, "
        "variable, number and step on three instances at once, states saved, changed at a place, "
        "sealed again or not, and restored. The shim and the importer have the sanitizers of "
        "addresses and of undefined behaviour in them; the FMU may not crash, and whatever it "
        "refuses comes with a message. A build that counts says how much of the shim the "
        "random calls alone reach; all hostile tests together reach more than 95 % of its lines "
        "and branches, which a slow test checks."
    )
    unit, target, batch = "calls", 100_000_000, 1_000_000
    measures = "share of the shim's branches that random calls alone leave out, in percent"

    def run(self, fmu: Path, seed: int, count: int) -> BatchOutcome:
        """Make random calls; count those that a sanitizer objects to."""
        counts, notes, done = {}, [], 0
        pairs = [(version, model) for version in VERSIONS for model in MODELS]
        for version, model in pairs:
            program = compile_with_sanitizer(fmu, version, model, importers.SANITIZE)
            number = max(1, count // len(pairs) // PER_INPUT)
            ended = program.run("random", seed % 2**31, number, timeout=36_000, success=False)
            match = re.search(r"CHECKS (\d+) FAILURES (\d+)", ended.stdout)
            calls = int(match[1]) if match else 0
            done += calls
            counts[f"{version} {model}:"] = calls
            if not match or match[2] != "0" or ended.returncode or ended.stderr:
                text = (ended.stdout + ended.stderr)[:300]
                notes.append(f"seed {seed}, {version} {model}, {number} sequences: {text}")
        return BatchOutcome(done, len(notes), uncovered_share(fmu, seed), counts, tuple(notes))


def uncovered_share(fmu: Path, seed: int) -> float:
    """Return the percentage of the shim's branches that random calls never take."""
    branches: dict[object, bool] = {}
    for version in VERSIONS:
        for model in MODELS:
            program = compile_with_sanitizer(fmu, version, model, ("--coverage",))
            program.run("random", seed % 2**31, COVERAGE, timeout=3600)
            for unit in importers.shim_files(version):
                importers.read_coverage(program.library.parent, unit, {}, branches)
    return 100.0 * (1.0 - sum(branches.values()) / len(branches))
