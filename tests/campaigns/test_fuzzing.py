"""Random calls of the FMU's C shim under sanitizers."""

import re

import pytest

from orchestrate.fmu import MODELS
from tools import importers

from .findings import expect_none

PER_SEQUENCE = 40  # calls, about


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("version", ("fmi2", "fmi3"))
@pytest.mark.budget(2_000)  # calls, of each version and model
def test_calls_in_any_order_make_no_memory_error(fmu, version, model, seed, budget, tmp_path):
    """Any function, variable, number and step on three instances at once, states saved and changed.

    The FMU may not crash, and whatever it refuses comes with a message. That all hostile tests
    reach the shim's branches is for ``tests/native``.
    """
    parts = version, model, fmu.parents[1], tmp_path / "importer", importers.SANITIZE
    program = importers.importer_with_sanitizer(*parts)
    sequences = max(1, budget // PER_SEQUENCE)
    ended = program.run("random", seed % 2**31, sequences, timeout=36_000, success=False)
    match = re.search(r"CHECKS (\d+) FAILURES (\d+)", ended.stdout)
    clean = match and match[2] == "0" and not ended.returncode and not ended.stderr
    findings = [] if clean else [(ended.stdout + ended.stderr)[:300]]
    expect_none(findings, {"calls": match[1] if match else 0})
