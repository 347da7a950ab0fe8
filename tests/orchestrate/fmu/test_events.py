"""Impacts by the clock: all of them, at the same bits as without events."""

import numpy as np
import pytest

from orchestrate.errors import InputError
from orchestrate.fmu import REST, EventInstance, Instance, begin
from orchestrate.model import Excitation, Structure

STRUCTURE = Structure.nondimensional(mu=0.7, kappa=1.3, D=0.013, e=0.6)
CHAOS = Excitation.nondimensional(1.2, STRUCTURE)
END = 300.0
STATE = ("x1", "x2", "v1", "v2")


@pytest.fixture
def events(event_fmu):
    """Make an instance with events."""
    with EventInstance(event_fmu) as instance:
        yield instance


@pytest.fixture
def impacts(events):
    """All impacts of a chaotic motion."""
    begin(events, STRUCTURE, CHAOS)
    return events.impacts(0.0, END)


def test_every_impact_is_there(impacts, event_fmu):
    with Instance(event_fmu) as instance:
        begin(instance, STRUCTURE, CHAOS)
        instance.step(0.0, END)
        count, last, contacts = instance.get("impact_count", "impact_time", "contact_count")
    assert len(impacts.time) == count > 50
    assert impacts.time[-1] == last
    assert impacts.sticks.sum() == contacts
    assert np.all(np.diff(impacts.time) > 0.0) and np.all(impacts.closing >= 0.0)


def test_begin_sets_all(any_fmu):
    structure = Structure(m1=2.0, m2=3.0, k1=4.0, k2=5.0, d1=0.1, d2=0.2, e=0.3, gamma=1e-5)
    excitation = Excitation(frequency=2.0, amplitude=0.5, phase=1.0)
    with Instance(any_fmu) as instance:
        begin(instance, structure, excitation, (0.1, 0.2, 0.3, 0.4))
        values = {**structure.parameters(), **excitation.inputs()}
        assert instance.get(*values) == list(values.values())
        assert instance.get(*STATE, "phase") == [0.1, 0.2, 0.3, 0.4, 1.0]
        assert instance.get("x_rel_max_on") == [False]
        begin(instance, structure.as_bonded(), excitation, REST, x_rel_max_on=True)
        assert instance.get("bonded", "x_rel_max_on", "x2") == [True, True, 0.0]


def test_fmi_2_has_no_events(oscillator_in):
    with pytest.raises(InputError, match=r"is FMI 2.0; expected FMI 3.0, which has events"):
        EventInstance(oscillator_in("fmi2-python"))
