"""Random calls of the FMU's C shim under sanitizers."""

import math
import random
import re
from collections import Counter

import pytest

from fmu_src.export import forms
from fmu_src.export.sources import load_model
from fmu_src.runtime.table import BOOLEAN, INTEGER, format_message
from orchestrate.fmu import MODELS, find_or_export
from tests import importers

from .findings import expect_none


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("version", ("fmi2", "fmi3"))
@pytest.mark.budget(2_000)  # sequences of calls, of each version and model
def test_steps_end_in_the_whole_declared_range(fmu, version, model, seed, budget, tmp_path):
    """Values from anywhere between the declared minimum and maximum of each variable, steps of any
    length, with sanitizers in the kernel too; a sequence that takes a minute is a finding.

    Replay one: ``importer BINARY replay declared < FILE``.
    """
    parts = find_or_export(model, version).path.parents[1], tmp_path, importers.SANITIZE
    program = importers.importer_with_sanitizer(version, model, *parts)
    sequence = tmp_path / "sequence"
    arguments = "declared", seed % 2**31, budget, sequence
    ended = program.run(*arguments, timeout=36_000, success=False)
    match = re.search(r"CHECKS (\d+) FAILURES (\d+)", ended.stdout)
    clean = match and match[2] == "0" and not ended.returncode and not ended.stderr
    shown = f"code {ended.returncode}: {(ended.stdout + ended.stderr)[:2000]}"
    findings = [] if clean else [f"{shown}\n{sequence.read_text()}"]
    expect_none(findings, {"sequences": budget, "checks": match[1] if match else 0})


DOUBTS = (OverflowError, ValueError, ZeroDivisionError)  # what Python knows and C does not say


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.budget(1_000)  # runs of each model
def test_the_python_kernel_raises_nothing_in_the_declared_range(model, seed, budget):
    """No division by zero, no whole number of what is none; outputs of a step done are finite."""
    kernel, codes = load_model(forms.MODELS[model]), Counter()
    findings = []
    for number in range(budget):
        rng = random.Random(f"{seed} {number}")
        try:
            run_declared(kernel, rng, codes)
        except (*DOUBTS, AssertionError) as error:
            findings.append(f"run {number}: {error!r}")
    assert codes[0] > budget // 2
    expect_none(findings, codes)


def run_declared(kernel, rng, codes):
    """Set anything, and do some steps of any length; count the codes of the entry points."""
    memory = [0.0] * kernel.memory_size
    settable = [variable for variable in kernel.variables if not variable.calculated]
    memory[: len(kernel.variables)] = [float(variable.start) for variable in kernel.variables]
    for variable in rng.sample(settable, rng.randrange(len(settable))):
        memory[variable.slot] = draw_declared(rng, variable)
    limit = next(variable for variable in settable if variable.name == "evaluation_limit")
    memory[limit.slot] = rng.choice((1.0, 10.0, 300.0))
    code = kernel.initialize(memory, rng.choice((0.0, 0.0, 10.0 ** rng.uniform(-300.0, 300.0))))
    for _ in range(0 if code else 4):
        for variable in rng.sample([v for v in settable if not v.fixed and v is not limit], 2):
            memory[variable.slot] = draw_declared(rng, variable)
            if variable.slot in kernel.set_flag_by_slot and rng.random() < 0.5:
                memory[kernel.set_flag_by_slot[variable.slot]] = 1.0
        before = list(memory)
        size = 10.0 ** rng.choice((rng.uniform(-2.0, 2.0), rng.uniform(-300.0, 300.0)))
        code = kernel.advance(memory, before[kernel.time_slot] + size)
        codes[code] += 1
        assert not code or format_message(kernel, memory, code)
        memory = before if code else memory
        wrong = [v.name for v in kernel.variables if not math.isfinite(memory[v.slot])]
        assert not wrong, wrong
        kernel.differentiate(list(memory), memory[kernel.time_slot])


def draw_declared(rng, variable):
    """Draw a value of a variable's declared range: an end, about 1, or of any size."""
    if variable.type == BOOLEAN:
        return float(rng.random() < 0.3)
    low, high = variable.minimum, variable.maximum
    first = math.log10(low) if low > 0.0 else -rng.choice((1.0, 10.0)) * math.log10(high)
    size = 10.0 ** rng.choice((rng.uniform(first, math.log10(high)), rng.uniform(-3.0, 3.0)))
    value = rng.choice((low, high, 0.0, variable.start, size, size, size, -size, -size))
    value = min(max(value, low), high)
    return float(math.floor(value)) if variable.type == INTEGER else value
