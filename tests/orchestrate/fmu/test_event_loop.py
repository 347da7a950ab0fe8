"""The loop through events: the bits of single steps, with pauses and without; refusals."""

import ctypes
import shutil
import sys

import numpy as np
import pytest

from orchestrate.errors import FmuError
from orchestrate.fmu import PLAYED, REST, Player
from orchestrate.fmu import events as loops
from orchestrate.fmu.c_library import load_loop
from orchestrate.fmu.events import EventLoop, PlayerCalls, PlayProgress, PlayTask
from orchestrate.model import Structure

from ...sparing import ordinary
from .misbehaving import misbehaving

STRUCTURE = Structure.nondimensional(mu=0.7, kappa=1.3, D=0.013, e=0.6)
STRUCTURES = {
    "chaos": STRUCTURE,
    "sticking": Structure.nondimensional(e=0.2),
    "bonded": STRUCTURE.as_bonded(),
}
RANDOM = np.random.default_rng(3)
NODES = np.concatenate([[0.0], np.cumsum(RANDOM.uniform(0.1, 0.9, 400))])
CUBIC = loops.CUBICS[loops.BOX]
CUBICS = RANDOM.normal(size=(400, 4)) * (1.0, 1.0, 1.0, 3.0)
SAMPLES = np.sort(np.concatenate([RANDOM.uniform(0.0, NODES[-1], 900), NODES, NODES[7:9]]))


def bits(played):
    impacts = played.impacts
    arrays = (impacts.time, impacts.state, impacts.closing, impacts.sticks)
    return [array.tobytes() for array in (played.rows, played.touching, *arrays)]


def done(fmu, structure):
    with Player(fmu) as player:
        player.start(structure, (0.1, 0.2, 0.0, 0.0) if not structure.bonded else REST)
        played = EventLoop(player, CUBIC, PLAYED).run(NODES, CUBICS, SAMPLES)
        return played, player.save_state()


@pytest.mark.parametrize("name", STRUCTURES)
def test_pauses_change_no_bit(name, event_fmu, monkeypatch):
    """However small the buffer for impacts, and however often the loop returns to Python."""
    structure = STRUCTURES[name]
    expected, end = done(event_fmu, structure)
    count = len(expected.impacts.time)
    assert count == 0 if structure.bonded else count > 50
    assert name != "sticking" or expected.impacts.sticks.sum() > 10
    monkeypatch.setattr(loops, "IMPACT_CAPACITY", 3)
    monkeypatch.setattr(loops, "MAX_STEPS", 7)
    result, end_with_pauses = done(event_fmu, structure)
    assert (bits(result), end_with_pauses) == (bits(expected), end)


@pytest.mark.parametrize("name", STRUCTURES)
def test_rows_and_impacts_are_those_of_single_steps(name, event_fmu):
    """Of an importer that stops at each impact, with the inputs of each node."""
    structure = STRUCTURES[name]
    expected, _ = done(event_fmu, structure)
    rows, times, many = [], [], 60
    with Player(event_fmu) as player:
        player.start(structure, (0.1, 0.2, 0.0, 0.0) if not structure.bonded else REST)
        for values, begin, end in zip(CUBICS[:many].tolist(), NODES, NODES[1:], strict=False):
            player.set(**dict(zip(CUBIC, values, strict=True)))
            for target in (*SAMPLES[(begin <= SAMPLES) & (end > SAMPLES)], end):
                while begin < target:
                    event, _, _, begin = player.call("doStep", begin, float(target) - begin)
                    times += [begin] * bool(event)
                    for change in ("enterEventMode", "updateDiscreteStates", "enterStepMode"):
                        if event:
                            player.call(change)
                if target != end:
                    rows.append(player.get(*PLAYED))
    assert np.array(rows).tobytes() == expected.rows[: len(rows)].tobytes()
    assert times == expected.impacts.time[: len(times)].tolist() and len(rows) > 100


def refusal(fmu, cubics=CUBICS, nodes=NODES, **inputs):
    with Player(fmu) as player:
        player.start(STRUCTURE)
        player.set(**inputs)
        with pytest.raises(FmuError) as caught:
            EventLoop(player, CUBIC, PLAYED).run(nodes, cubics, SAMPLES)
        return str(caught.value)


BAD = CUBICS.copy()
BAD[200, 2] = np.nan
REFUSED = {
    "box_snap = nan": {"cubics": BAD},
    "currentCommunicationPoint = 2.0 s": {"nodes": NODES + 2.0},
    "evaluation_limit": {"evaluation_limit": 2},
}


@pytest.mark.parametrize("words", REFUSED)
def test_a_refusal_is_passed_on(words, event_fmu):
    assert words in refusal(event_fmu, **REFUSED[words])


@pytest.mark.skipif(sys.platform != "linux", reason="the bad FMU is made for Linux")
@pytest.mark.parametrize("first", ordinary([0, 40, 41, 42, 43], [0, 42]))
def test_numbers_that_are_not_finite_are_refused(first, event_fmu, tmp_path):
    """At a time of reading or at an impact, whichever comes first."""
    if shutil.which("cc") is None and shutil.which("gcc") is None:
        pytest.importorskip("ziglang")
    fmu = misbehaving(event_fmu, tmp_path / "bad.fmu", "NaN", first=first)
    assert "answers x1 = nan; expected a finite number" in refusal(fmu)


def test_structures_have_the_sizes_of_the_source():
    """A field forgotten on one side would shift all that follow."""
    sizes = (ctypes.c_uint * 3).in_dll(load_loop("play"), "sizes_of_play")
    assert list(sizes) == [ctypes.sizeof(kind) for kind in (PlayerCalls, PlayTask, PlayProgress)]
