"""The loop through events: the bits of plain Python, equal refusals."""

import ctypes
import shutil
import sys

import numpy as np
import pytest

from orchestrate.errors import FmuError
from orchestrate.fmu import PLAYED, REST, Player, play
from orchestrate.fmu import event_loop as loops
from orchestrate.fmu.c_library import loaded_loop
from orchestrate.fmu.event_loop import EventLoop, Played, PlayerCalls, PlayProgress, PlayTask
from orchestrate.fmu.impacts import EVENT_OUTPUTS, Impacts
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
CUBIC = play.CUBICS[play.BOX]
CUBICS = RANDOM.normal(size=(400, 4)) * (1.0, 1.0, 1.0, 3.0)
SAMPLES = np.sort(np.concatenate([RANDOM.uniform(0.0, NODES[-1], 900), NODES, NODES[7:9]]))


class PythonEventLoop:
    """The loop by calls of the FMU one after the other: slow, to compare."""

    def __init__(self, instance, inputs, outputs):
        self.instance, self.inputs, self.outputs = instance, inputs, outputs

    def run(self, nodes, derivatives, samples):
        call, get = self.instance.call, self.instance.get
        rows, touching, table = [], [], []

        def advance(time, target):
            while time < target:
                event, _, _, time = call("doStep", time, target - time)
                if event:
                    table.append([time, *get(*EVENT_OUTPUTS), *get("in_contact")])
                    for change in ("enterEventMode", "updateDiscreteStates", "enterStepMode"):
                        call(change)
            return time

        def read():
            rows.append(get(*self.outputs))
            touching.append(*get("in_contact"))

        time, done = float(nodes[0]), 0
        ends = np.searchsorted(samples, nodes[1:], side="left")
        for values, target, last in zip(derivatives.tolist(), nodes[1:], ends, strict=True):
            self.instance.set(**dict(zip(self.inputs, values, strict=True)))
            for sample in samples[done:last]:
                time = advance(time, float(sample))
                read()
            time, done = advance(time, float(target)), last
        for _ in samples[done:]:  # at the last node
            read()
        return Played(np.array(rows), np.array(touching), Impacts.from_table(np.array(table)))


def bits(played):
    """All that a loop answers."""
    impacts = played.impacts
    arrays = (impacts.time, impacts.state, impacts.closing, impacts.sticks)
    return [array.tobytes() for array in (played.rows, played.touching, *arrays)]


def done(kind, fmu, structure, nodes=NODES, cubics=CUBICS, samples=SAMPLES):
    """What a loop answers, and the instance's state at the end."""
    with Player(fmu) as player:
        player.start(structure, (0.1, 0.2, 0.0, 0.0) if not structure.bonded else REST)
        played = kind(player, CUBIC, PLAYED).run(nodes, cubics, samples)
        return played, player.save_state()


@pytest.mark.parametrize("name", STRUCTURES)
def test_the_same_bits(name, event_fmu):
    structure = STRUCTURES[name]
    expected, end = done(PythonEventLoop, event_fmu, structure)
    result, compiled_end = done(EventLoop, event_fmu, structure)
    assert bits(result) == bits(expected)
    assert compiled_end == end
    count = len(expected.impacts.time)
    assert count == 0 if structure.bonded else count > 50
    assert name != "sticking" or expected.impacts.sticks.sum() > 10


def test_pauses_change_no_bit(event_fmu, monkeypatch):
    """However small the buffer for impacts, and however often the loop returns to Python."""
    expected, end = done(PythonEventLoop, event_fmu, STRUCTURE)
    monkeypatch.setattr(loops, "IMPACT_CAPACITY", 3)
    monkeypatch.setattr(loops, "MAX_STEPS", 7)
    result, compiled_end = done(EventLoop, event_fmu, STRUCTURE)
    assert (bits(result), compiled_end) == (bits(expected), end)


def test_an_open_instance_serves_any_number_of_motions(event_fmu):
    """After another structure, and after a refusal, the motion is that of a new instance."""
    expected, _ = done(EventLoop, event_fmu, STRUCTURE)
    with Player(event_fmu) as player:
        for structure in (*STRUCTURES.values(), STRUCTURE):
            player.start(structure)
            player.play(NODES, CUBICS, SAMPLES)
        with pytest.raises(FmuError, match="box_acceleration = nan"):
            player.play(NODES + NODES[-1], CUBICS * np.nan, SAMPLES)
        player.start(STRUCTURE, (0.1, 0.2, 0.0, 0.0))
        assert bits(player.play(NODES, CUBICS, SAMPLES)) == bits(expected)


def refusal(kind, fmu, cubics=CUBICS, nodes=NODES, **inputs):
    """What is said where the FMU refuses a call."""
    with Player(fmu) as player:
        player.start(STRUCTURE)
        player.set(**inputs)
        with pytest.raises(FmuError) as caught:
            kind(player, CUBIC, PLAYED).run(nodes, cubics, SAMPLES)
        return str(caught.value)


def bad_row(value):
    """Cubics of which one has a bad number."""
    cubics = CUBICS.copy()
    cubics[200, 2] = value
    return cubics


@pytest.mark.parametrize(
    ("words", "arguments"),
    [
        ("box_snap = nan", {"cubics": bad_row(np.nan)}),
        ("currentCommunicationPoint = 2.0 s", {"nodes": NODES + 2.0}),
        ("evaluation_limit", {"evaluation_limit": 2}),
    ],
    ids=["input", "time", "discarded"],
)
def test_a_refusal_is_passed_on(words, arguments, event_fmu):
    text = refusal(EventLoop, event_fmu, **arguments)
    assert text == refusal(PythonEventLoop, event_fmu, **arguments)
    assert words in text


@pytest.mark.skipif(sys.platform != "linux", reason="the bad FMU is made for Linux")
@pytest.mark.parametrize("first", ordinary([0, 40, 41, 42, 43], [0, 42]))
def test_numbers_that_are_not_finite_are_refused(first, event_fmu, tmp_path):
    """At a time of reading or at an impact, whichever comes first."""
    if shutil.which("cc") is None and shutil.which("gcc") is None:
        pytest.importorskip("ziglang")
    found = []
    for kind in (PythonEventLoop, EventLoop):  # each with a count of readings of its own
        fmu = misbehaving(event_fmu, tmp_path / f"{kind.__name__}.fmu", "NaN", first=first)
        found.append(refusal(kind, fmu))
    assert found[0] == found[1]
    assert "answers x1 = nan; expected a finite number" in found[0]


def test_shapes_that_do_not_fit_are_refused(event_fmu):
    with Player(event_fmu) as player:
        player.start(STRUCTURE)
        with pytest.raises(ValueError, match=r"derivatives of shape \(400, 3\) for 401 nodes"):
            player.play(NODES, CUBICS[:, :3], SAMPLES)


def test_structures_have_the_sizes_of_the_source():
    """A field forgotten on one side would shift all that follow."""
    sizes = (ctypes.c_uint * 3).in_dll(loaded_loop("play"), "sizes_of_play")
    assert list(sizes) == [ctypes.sizeof(kind) for kind in (PlayerCalls, PlayTask, PlayProgress)]
