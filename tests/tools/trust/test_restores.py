"""The campaign on saved states: a short form, and that it would see what a state lacks."""

from __future__ import annotations

import sys

import pytest

from orchestrate.access import OSCILLATOR, Instance, find
from tools.trust import restores
from tools.trust.restores import CUBIC, RestoreCampaign

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")
RESTORE = Instance.restore_state


@pytest.fixture(scope="module")
def fmu(exported):
    return find(OSCILLATOR).path


def test_a_few_restored_states(fmu):
    found = RestoreCampaign().run(fmu, 3, 1200)
    assert found.done >= 1200 and found.findings == 0, found.notes
    assert all(found.counts.values())


@pytest.mark.slow
def test_many_restored_states(fmu):
    found = RestoreCampaign().run(fmu, 4, 60_000)
    assert found.done >= 60_000 and found.findings == 0, found.notes


def test_the_same_seed_is_the_same_course():
    assert restores.draw_course(5, 7) == restores.draw_course(5, 7) != restores.draw_course(5, 8)


def forget_all(instance, data):
    """As if nothing had been restored."""


def forget_when_inputs_were_set(instance, data):
    """As if the time of setting were no part of the state: a cubic begins again."""
    RESTORE(instance, data)
    if "box_snap" in instance.description.variables:
        instance.set(**dict(zip(CUBIC, instance.get(*CUBIC), strict=True)))


@pytest.mark.parametrize("fault", [forget_all, forget_when_inputs_were_set])
def test_a_state_that_lacks_something_is_found(fmu, monkeypatch, fault):
    monkeypatch.setattr(Instance, "restore_state", fault)
    found = RestoreCampaign().run(fmu, 3, 100)
    assert found.findings > 0 and found.notes
