"""The compiled loop of responses: however it is cut in pieces, for FMUs of every form."""

import ctypes
from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.errors import FmuError
from orchestrate.fmu import (
    OSCILLATOR,
    Instance,
    find_or_export,
    respond_library,
    sample_stroboscopically,
    start_motion,
)
from orchestrate.fmu.oscillator import OscillatorCalls, ResponseProgress, ResponseTask
from orchestrate.model import Excitation, Structure
from orchestrate.response.multiplicity import nearest_state
from orchestrate.response.questions import Point
from orchestrate.response.response_loop import LoopSettings, response_loop

from ...draws import draw_structure

pytestmark = pytest.mark.usefixtures("exported")
SETTINGS = {"samples": 40, "tolerance": 1e-2, "decides": True, "peak_periods": 8}


@pytest.fixture
def instance(exported):
    with Instance(find_or_export(OSCILLATOR).path) as instance:
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
def test_pauses_change_no_bit(instance, is_chain, monkeypatch):
    """Transients in pieces, and several calls."""
    some, random = list(points(3)), np.random.default_rng(4)
    starts = random.uniform(0.0, 1.0, (len(some), 4)) * (-1, 5, 1, 1)
    starts[:, 1] += [max(0.0, -structure.clearance) for structure, _ in some]
    starts[0] = 0.0
    transient = 30 if is_chain else [30 + i % 50 for i in range(len(some))]
    own = {"transient": transient, "is_chain": is_chain, "chain_gap": 0.5 if is_chain else None}
    settings = LoopSettings(**own, **SETTINGS)
    chosen = starts[1:2] if is_chain else starts
    expected = response_loop(instance).simulate(some, chosen, settings)
    assert np.any(expected.counts["multiplicity"]) and np.any(expected.impacts)
    for work in (10, 200):
        monkeypatch.setattr("orchestrate.response.response_loop.MAX_WORK", work)
        assert bits(response_loop(instance).simulate(some, chosen, settings)) == bits(expected)


def test_a_chain_goes_on_from_the_end_before_it_with_the_same_gap(instance):
    some, gap = list(points(3)), 0.5
    settings = LoopSettings(transient=30, is_chain=True, chain_gap=gap, **SETTINGS)
    chain, start = response_loop(instance).simulate(some, [(0.0, 2.0, 0.1, 0.0)], settings), None
    assert len({point.structure.gap_offset for point in some}) > 3
    for i, point in enumerate(some):
        start = chain.ends[i - 1].copy() if i else np.array([0.0, 2.0, 0.1, 0.0])
        offset = point.structure.gap_offset
        start[1] = max(start[1] + (gap - offset if np.any(start) else 0.0), start[0] - offset)
        alone = LoopSettings(transient=30, **SETTINGS)
        found = response_loop(instance).simulate([point], [start], alone)
        assert found.states.tobytes() == chain.states[i].tobytes(), i
        gap, speeds = offset, chain.ends[i, 2:]
        digit = np.ldexp(1.0, np.frexp(np.abs(speeds).max())[1] - 44)  # ends are rounded to 44 bits
        assert not (speeds % digit).any()
        assert speeds == pytest.approx(chain.states[i, -1, 2:], abs=0.51 * digit)


@pytest.mark.parametrize("form", ["fmi2", "fmi2-python"])
def test_every_form_runs_through_the_same_loop(instance, form):
    some = list(points(8, 4))
    settings = LoopSettings(transient=20, is_chain=True, **{**SETTINGS, "samples": 9})
    expected = response_loop(instance).simulate(some, np.zeros((1, 4)), settings)
    with Instance(find_or_export(OSCILLATOR, form).path) as other:
        found = response_loop(other).simulate(some, np.zeros((1, 4)), settings)
        assert bits(found) == bits(expected)
        with pytest.raises(FmuError, match="x1_start = nan"):
            response_loop(other).simulate(some[:1], np.full((1, 4), np.nan), settings)


@pytest.mark.parametrize("same", [0.3, 1e-2, 1e-3, 1e-9])
def test_a_response_ends_where_it_comes_near_a_known_motion(instance, same):
    """Where it is nearer than at the look before, when it was within the tolerance."""
    structure = Structure.nondimensional()
    point = Point(structure, Excitation.nondimensional(1.0, structure))
    frequency, period = point.excitation.frequency, point.excitation.period
    start_motion(instance, *point, (0.0, 1.0, 0.0, 0.0))
    states, gap = sample_stroboscopically(instance, period, 0, 960)
    orbit = SimpleNamespace(states=states[-1:], gap=gap)
    far = SimpleNamespace(states=states[-2:] + 20.0, gap=gap)
    seen = (states[k - 1] for k in range(16, 401, 16))
    away = [nearest_state(orbit.states, frequency, gap, state)[1] for state in seen]
    pairs = enumerate(zip([np.inf, *away], away, strict=False))
    looks = [look for look, (before, now) in pairs if before < same and now < before]
    settings = LoopSettings(transient=400, samples=8, same=same, known=(far, orbit))
    results = response_loop(instance).simulate([point] * 2, [(0.0, 1.0, 0.0, 0.0)] * 2, settings)
    assert results.counts["reached"].tolist() == [3 if looks else 0] * 2  # of all states
    assert bool(looks) == (same > 1e-8)
    if looks:
        assert results.ends == pytest.approx(states[[16 * looks[0] + 15] * 2], rel=1e-9, abs=1e-9)


def test_structures_have_the_sizes_of_the_source():
    """A field forgotten on one side would shift all that follow."""
    sizes = (ctypes.c_uint * 3).in_dll(respond_library(), "sizes_of_respond")
    kinds = (OscillatorCalls, ResponseTask, ResponseProgress)
    assert list(sizes) == [ctypes.sizeof(kind) for kind in kinds]
