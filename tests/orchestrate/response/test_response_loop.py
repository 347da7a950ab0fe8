"""The compiled loop of responses: the bits of plain Python, for FMUs of every form."""

import ctypes
import functools

import numpy as np
import pytest

from orchestrate.errors import FmuError, InputError
from orchestrate.fmu import OSCILLATOR, Instance, find, library, sampled
from orchestrate.fmu.oscillator import OscillatorCalls, ResponseProgress, ResponseTask
from orchestrate.model import Excitation
from orchestrate.response.questions import Point
from orchestrate.response.response_loop import LoopSettings, response_loop

from ...draws import draw_structure
from ...sparing import ordinary
from . import reference_loop
from .reference_loop import round_state

pytestmark = pytest.mark.usefixtures("exported")
SETTINGS = {  # of a loop that decides
    "samples": 40,
    "tolerance": 1e-2,
    "decides": True,
    "peak_periods": 8,
}


@pytest.fixture
def instance(exported):
    with Instance(find(OSCILLATOR).path) as instance:
        yield instance


def points(seed, count=12):
    """Random structures with a gap, a preload or neither."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        structure, eta = draw_structure(random)
        yield Point(structure, Excitation.nondimensional(eta, structure))


def bits(results):
    counts = [results.counts[name] for name in sorted(results.counts)]
    tables = (*results[:6], results.must_impact, *counts)
    return b"".join(np.ascontiguousarray(table).tobytes() for table in tables)


@pytest.mark.parametrize("is_chain", [False, True])
@pytest.mark.parametrize("number", ordinary([12, 400]))
def test_the_loop_has_the_bits_of_python(instance, is_chain, number, monkeypatch):
    some, random = list(points(3, number)), np.random.default_rng(4)
    starts = random.uniform(0.0, 1.0, (len(some), 4)) * (-1, 5, 1, 1)
    starts[:, 1] += [max(0.0, -structure.clearance) for structure, _ in some]
    starts[0] = 0.0
    settings = LoopSettings(
        transient=30 if is_chain else [30 + i % 50 for i in range(len(some))],
        is_chain=is_chain,
        chain_gap=0.5 if is_chain else None,
        **SETTINGS,
    )
    chosen = starts[1:2] if is_chain else starts
    expected = reference_loop.respond(instance, some, chosen, settings)
    assert np.any(expected.counts["multiplicity"]) and np.any(expected.impacts)
    for work in (10, 200):  # transients in pieces, and several calls
        monkeypatch.setattr("orchestrate.response.response_loop.MAX_WORK", work)
        assert bits(response_loop(instance).respond(some, chosen, settings)) == bits(expected)


@pytest.mark.parametrize("form", ["fmi2", "fmi2-python", "fmi2-plain"])
def test_every_form_runs_through_the_same_loop(instance, form):
    some = list(points(8, 4))
    settings = LoopSettings(transient=20, is_chain=True, **{**SETTINGS, "samples": 9})
    expected = response_loop(instance).respond(some, np.zeros((1, 4)), settings)
    if form == "fmi2-plain":  # it keeps no states inside a step
        with Instance(find(OSCILLATOR, form).path) as other, pytest.raises(InputError) as caught:
            response_loop(other)
        assert "x1_sample" in str(caught.value)
        return
    with Instance(find(OSCILLATOR, form).path) as other:
        found = response_loop(other).respond(some, np.zeros((1, 4)), settings)
        assert bits(found) == bits(expected)
        with pytest.raises(FmuError, match="x1_start = nan"):
            response_loop(other).respond(some[:1], np.full((1, 4), np.nan), settings)


def test_repetitions_within_two_tolerances_have_the_bits_of_python(instance):
    some = list(points(9))
    settings = LoopSettings(transient=60, samples=24, tolerance=1e-6, loose=1e-2)
    arguments = some, np.zeros((len(some), 4)), settings
    compiled = response_loop(instance).respond(*arguments)
    assert bits(compiled) == bits(reference_loop.respond(instance, *arguments))
    counts = compiled.counts["multiplicity"], compiled.counts["nearly"]
    assert np.any(counts[0]) and np.any(counts[0] != counts[1]) and np.any(compiled.deviations)


def test_samples_are_more_than_a_step_keeps(instance):
    (point,) = points(5, 1)
    arguments = [point], [(0.0,) * 4], LoopSettings(transient=0, samples=1700)
    end, states = 1700 * point.excitation.period, []
    for loop, more in ((response_loop(instance), sampled), (None, reference_loop.sampled)):
        respond = loop.respond if loop else functools.partial(reference_loop.respond, instance)
        states.append(bits(respond(*arguments)) + more(instance, end, end + 9.0, 4500).tobytes())
    assert states[0] == states[1]


@pytest.mark.parametrize("scale", [2.0**-1000, 2.0**-960, 1.0, 2.0**300])
def test_ends_are_rounded(instance, scale):
    (point,) = points(6, 1)
    structure = point.structure.replace(clearance=0.0)
    excitation = point.excitation.replace(amplitude=point.excitation.amplitude * scale)
    settings = LoopSettings(transient=5, samples=3)
    point = Point(structure, excitation)
    results = response_loop(instance).respond([point], [(0.0,) * 4], settings)
    assert tuple(results.ends[0]) == round_state(results.states[0, -1])
    assert round_state(np.array([0.25, 0.3, 1.0, -1.0])) == (0.25, 0.30000000000001137, 1.0, -1.0)


def test_structures_have_the_sizes_of_the_source():
    """A field forgotten on one side would shift all that follow."""
    sizes = (ctypes.c_uint * 3).in_dll(library(), "sizes_of_respond")
    assert list(sizes) == [
        ctypes.sizeof(kind) for kind in (OscillatorCalls, ResponseTask, ResponseProgress)
    ]
