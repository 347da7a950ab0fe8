"""The compiled loop of responses against the same calls in Python: the same bits."""

import numpy as np
import pytest

from orchestrate.errors import FmuError
from orchestrate.fmu import OSCILLATOR, Instance, find
from orchestrate.model import Excitation, Structure
from orchestrate.response.questions import Point
from orchestrate.response.response_loop import (
    CompiledResponseLoop,
    LoopSettings,
    ResponseLoop,
    response_loop,
    round_state,
)

pytestmark = pytest.mark.usefixtures("exported")


@pytest.fixture
def instance(exported):
    with Instance(find(OSCILLATOR).path) as instance:
        yield instance


def points(seed, count=12):
    """Random structures with a gap, a preload or neither."""
    random = np.random.default_rng(seed)
    for i in range(count):
        structure = Structure.nondimensional(
            mu=random.uniform(0.3, 2.0),
            kappa=random.uniform(0.5, 2.0),
            D=random.uniform(0.002, 0.1),
            e=random.uniform(0.0, 0.95),
        ).replace(clearance=(0.0, random.uniform(-3.0, 3.0))[i % 2])
        eta = float(random.uniform(0.3, 5.0))
        yield Point(structure, Excitation.nondimensional(eta, structure))


def bits(results):
    counts = [results.counts[name] for name in sorted(results.counts)]
    tables = *results[:3], results.deviations, results.peaks
    return b"".join(np.ascontiguousarray(table).tobytes() for table in (*tables, *counts))


@pytest.mark.parametrize("is_chain", [False, True])
def test_the_compiled_loop_has_the_bits_of_python(instance, is_chain, monkeypatch):
    some, random = list(points(3)), np.random.default_rng(4)
    starts = [(0.0,) * 4, *random.uniform(0.0, 1.0, (len(some) - 1, 4)) * (-1, 5, 1, 1)]
    settings = LoopSettings(
        transient=30 if is_chain else [30 + i for i in range(len(some))],
        samples=40,
        tolerance=1e-2,
        decides=True,
        is_chain=is_chain,
        chain_gap=0.5 if is_chain else None,
        peak_periods=8,
    )
    chosen = starts[1:2] if is_chain else starts
    loop = response_loop(instance)
    assert type(loop) is CompiledResponseLoop
    monkeypatch.setattr("orchestrate.response.response_loop.MAX_PERIODS", 200)  # several calls
    compiled = loop.respond(some, chosen, settings)
    assert bits(compiled) == bits(ResponseLoop(instance).respond(some, chosen, settings))
    decided = compiled.counts["multiplicity"], compiled.counts["later_impacts"]
    assert all(np.any(numbers) for numbers in decided)  # of these responses some repeat


def test_repetitions_within_two_tolerances_have_the_bits_of_python(instance):
    some = list(points(9))
    settings = LoopSettings(transient=60, samples=24, tolerance=1e-6, loose=1e-2)
    compiled, python = (
        loop.respond(some, np.zeros((len(some), 4)), settings) for loop in loops(instance)
    )
    assert bits(compiled) == bits(python)
    counts = compiled.counts["multiplicity"], compiled.counts["nearly"]
    assert np.any(counts[0]) and np.any(counts[0] != counts[1]) and np.any(compiled.deviations)


def test_samples_are_more_than_a_step_keeps(instance):
    (point,) = points(5, 1)
    settings = LoopSettings(transient=0, samples=1700)
    results = [loop.respond([point], [(0.0,) * 4], settings) for loop in loops(instance)]
    assert bits(results[0]) == bits(results[1])


def loops(instance):
    return response_loop(instance), ResponseLoop(instance)


@pytest.mark.parametrize("scale", [2.0**-1000, 2.0**-960, 1.0, 2.0**300])
def test_ends_are_rounded_alike(instance, scale):
    (point,) = points(6, 1)
    structure = point.structure.replace(clearance=0.0)
    excitation = point.excitation.replace(amplitude=point.excitation.amplitude * scale)
    settings = LoopSettings(transient=5, samples=3)
    for loop in loops(instance):
        results = loop.respond([Point(structure, excitation)], [(0.0,) * 4], settings)
        assert tuple(results.ends[0]) == round_state(results.states[0, -1])
    assert round_state(np.array([0.25, 0.3, 1.0, -1.0])) == (0.25, 0.30000000000001137, 1.0, -1.0)


def test_what_the_fmu_refuses_is_its_own_message(instance):
    (point,) = points(7, 1)
    with pytest.raises(FmuError, match="x1_start = nan"):
        response_loop(instance).respond(
            [point], [(np.nan, 0.0, 0.0, 0.0)], LoopSettings(transient=5, samples=3)
        )
