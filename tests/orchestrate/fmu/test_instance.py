"""What is set is what is read, errors are the FMU's words, states come back bit by bit."""

import math
import shutil
import sys

import numpy as np
import pytest

from orchestrate.errors import FmuError, InputError
from orchestrate.fmu import REST, STATE, EventInstance, Instance, start_motion
from orchestrate.model import Excitation, Structure

from .misbehaving import misbehaving

CHAOS = {"box_amplitude": 1.0 / 1.2**2, "box_frequency": 1.2}
VALUES = ("x1", "x2", "v1", "v2", "x_rel", "x_rel_max", "impact_time", "impact_energy", "phase")


@pytest.fixture
def instance(any_fmu):
    with Instance(any_fmu) as instance:
        instance.initialize(**CHAOS)
        instance.step(0.0, 100.0)
        yield instance


def trajectory(instance, start, steps=25):
    values = []
    for n in range(steps):
        instance.step(start + 2.0 * n, start + 2.0 * n + 2.0)
        values.append(instance.get(*VALUES, "impact_count", "in_contact"))
    return values


def test_initialize_begins_at_a_time(any_fmu):
    with Instance(any_fmu) as instance:
        instance.initialize(start_time=5.0, x1_start=-0.25, **CHAOS)
        assert instance.get("x1") == [-0.25]
        with pytest.raises(FmuError, match=r"currentCommunicationPoint = 0.0 s: .*5\.0 s"):
            instance.step(0.0, 1.0)
        instance.step(5.0, 6.0)


def test_errors_are_the_fmus_words_in_one_line(instance):
    for call, words in (
        (lambda: instance.set(box_amplitude=math.nan), "box_amplitude = nan m"),
        (lambda: instance.restore_state(b"short"), "saved by this FMU"),
    ):
        with pytest.raises(FmuError, match=words) as error:
            call()
        assert "\n" not in str(error.value)


@pytest.mark.skipif(sys.platform != "linux", reason="the bad FMU is made for Linux")
def test_numbers_that_are_none_are_refused(event_fmu, tmp_path):
    if shutil.which("cc") is None and shutil.which("gcc") is None:
        pytest.importorskip("ziglang")
    with Instance(misbehaving(event_fmu, tmp_path / "bad.fmu", "NaN")) as instance:
        instance.initialize()
        with pytest.raises(FmuError, match="answers x1 = nan; expected a finite number"):
            instance.get("x1", "x2")


def test_a_restored_state_gives_the_same_bits(instance, any_fmu):
    state = instance.save_state()
    assert isinstance(state, bytes)
    once = trajectory(instance, 100.0)
    assert len({tuple(values) for values in once}) == len(once)
    instance.restore_state(state)
    assert trajectory(instance, 100.0) == once
    with Instance(any_fmu, name="another") as other:
        other.initialize()
        other.restore_state(state)
        assert trajectory(other, 100.0) == once


def test_every_impact_is_there(event_fmu):
    structure = Structure.nondimensional(mu=0.7, kappa=1.3, D=0.013, e=0.6)
    chaos = Excitation.nondimensional(1.2, structure)
    with EventInstance(event_fmu) as events, Instance(event_fmu) as instance:
        for one in (events, instance):
            start_motion(one, structure, chaos)
        impacts = events.record_impacts(0.0, 300.0)
        instance.step(0.0, 300.0)
        count, last, contacts = instance.get("impact_count", "impact_time", "contact_count")
    assert len(impacts.time) == count > 50
    assert impacts.time[-1] == last and impacts.sticks.sum() == contacts
    assert np.all(np.diff(impacts.time) > 0.0) and np.all(impacts.closing >= 0.0)


def test_begin_sets_all(any_fmu):
    structure = Structure(m1=2.0, m2=3.0, k1=4.0, k2=5.0, d1=0.1, d2=0.2, e=0.3, gamma=1e-5)
    excitation = Excitation(frequency=2.0, amplitude=0.5, phase=1.0)
    with Instance(any_fmu) as instance:
        start_motion(instance, structure, excitation, (0.1, 0.2, 0.3, 0.4))
        values = {**structure.parameters(), **excitation.inputs()}
        assert instance.get(*values) == list(values.values())
        assert instance.get(*STATE, "phase") == [0.1, 0.2, 0.3, 0.4, 1.0]
        assert instance.get("x_rel_max_on") == [False]
        start_motion(instance, structure.as_bonded(), excitation, REST, x_rel_max_on=True)
        assert instance.get("bonded", "x_rel_max_on", "x2") == [True, True, 0.0]


def test_fmi_2_has_no_events(oscillator_in):
    with pytest.raises(InputError, match=r"is FMI 2.0; expected FMI 3.0, which has events"):
        EventInstance(oscillator_in("fmi2-python"))
