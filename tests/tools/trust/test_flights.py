"""Short forms of the campaigns on flights: they find nothing, and would find what is wrong."""

from __future__ import annotations

import dataclasses
import sys

import numpy as np
import pytest

from orchestrate.access import OSCILLATOR, find
from tools.trust import flights, programs
from tools.trust.flights import EnergyCampaign, ImpactCampaign, RootCampaign

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="programs for Linux")


@pytest.fixture(scope="module")
def fmu(exported):
    return find(OSCILLATOR).path


def test_no_root_is_missed_and_none_made_up(fmu):
    found = RootCampaign().run(fmu, 1, 20_000)
    assert found.done >= 20_000 and found.findings == 0, found.notes
    assert len(found.counts) == 8 and min(found.counts.values()) > 200


def test_impacts_balance(fmu):
    found = EnergyCampaign().run(fmu, 1, 20_000)
    assert found.done >= 20_000 and found.findings == 0, found.notes
    assert 1e-17 < found.worst < 1e-12


def test_impacts_agree_with_50_digits(fmu):
    found = ImpactCampaign().run(fmu, 1, 60)
    assert found.done == 60 and found.findings == 0, found.notes
    assert 1e-4 < found.worst <= 1.0


def test_what_is_wrong_is_found(fmu):
    """A structure, a restitution and an end that differ by a billionth from the FMU's."""
    lines = programs.run_program(fmu, "roots", 1, 2000, "wrong").splitlines()
    wrong = [sum(map(int, line.split()[1:3])) for line in lines if not line.startswith("FLIGHT")]
    assert sum(wrong) > 500
    assert all(number > 20 for number in wrong[:6]), wrong
    numbers = programs.run_program(fmu, "energy", 1, 2000, "wrong").split()
    assert float(numbers[4]) > 1e-11
    flight = next(flight for flight in flights.iterate_flights(fmu, 1, 50) if flight.impact)
    later = dataclasses.replace(flight, end=flight.end * (1.0 + 1e-9))
    assert flights.deviation(flight) <= 1.0 < flights.deviation(later)


def test_half_of_the_flights_have_a_gap_or_a_preload(fmu):
    """Of each kind, to either side, over six decades or more."""
    lines = programs.run_program(fmu, "roots", 3, 3000, "show").splitlines()
    flown = [flights.Flight.read(line) for line in lines if line.startswith("FLIGHT")]
    clearances = np.array([flight.values["clearance"] for flight in flown])
    assert 0.4 < np.mean(clearances != 0.0) < 0.6
    for kind in range(flights.CONTACT + 1):
        own = clearances[[flight.kind == kind for flight in flown]]
        assert (own > 0.0).any() and (own < 0.0).any()
    sizes = np.abs(clearances[clearances != 0.0])
    assert sizes.max() / sizes.min() > 1e6


@pytest.mark.slow
def test_middle_forms(fmu):
    for campaign, count in (
        (RootCampaign(), 2_000_000),
        (EnergyCampaign(), 5_000_000),
        (ImpactCampaign(), 3000),
    ):
        found = campaign.run(fmu, 2, count)
        assert found.done >= count and found.findings == 0, found.notes
