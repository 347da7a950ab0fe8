"""Random calls of the FMU's C shim under sanitizers."""

from __future__ import annotations

import functools
import re
from pathlib import Path
from typing import Any

import pytest

from orchestrate.access import MODELS
from tools import importers

from .findings import expect_none
from .programs import temporary_folder

PER_SEQUENCE = 40  # calls, about


@functools.cache
def compile_with_sanitizer(fmu: Path, version: str, model: str, options: tuple[str, ...]) -> Any:
    """Compile importer and shim of a model with sanitizer options; return the importer."""
    folder = temporary_folder() / f"{version}-{model}-{len(options)}{options[0][2:10]}"
    return importers.importer_with_sanitizer(version, model, fmu.parents[1], folder, options)


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("version", ("fmi2", "fmi3"))
@pytest.mark.budget(2_000)  # calls, of each version and model
def test_calls_in_any_order_make_no_memory_error(fmu, version, model, seed, budget):
    """Any function, variable, number and step on three instances at once, states saved and changed.

    The FMU may not crash, and whatever it refuses comes with a message. That all hostile tests
    reach the shim's branches is for ``tests/native``.
    """
    program = compile_with_sanitizer(fmu, version, model, importers.SANITIZE)
    sequences = max(1, budget // PER_SEQUENCE)
    ended = program.run("random", seed % 2**31, sequences, timeout=36_000, success=False)
    match = re.search(r"CHECKS (\d+) FAILURES (\d+)", ended.stdout)
    clean = match and match[2] == "0" and not ended.returncode and not ended.stderr
    findings = [] if clean else [(ended.stdout + ended.stderr)[:300]]
    expect_none(findings, {"calls": match[1] if match else 0})
