"""The campaign on attractors: a short form, and that it sees what is wrong."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

import orchestrate
from orchestrate.access import OSCILLATOR, find
from orchestrate.structures import Structure
from tools.trust.attractors import AttractorCampaign, DrawnStructure, ReportedMotion, draw, findings

PAPER = Structure.nondimensional()


@pytest.fixture(scope="module")
def fmu(exported):
    return find(OSCILLATOR).path


@pytest.fixture(scope="module")
def told(fmu):
    """T with one impact, and 2T with three."""
    asked = {"eta": 1.315, "starts": 24, "jobs": 1, "progress": False}
    found = orchestrate.attractors(PAPER, **asked).isel(eta=0)
    return {int(found.multiplicity[k]): found.isel(attractor=k) for k in range(2)}


def wrong(fmu, told, **changes):
    changed = told.assign({name: told[name] * 0 + value for name, value in changes.items()})
    return " / ".join(ReportedMotion(fmu, PAPER, 1.315, changed).problems())


def test_a_few_structures(fmu):
    found = AttractorCampaign().run(fmu, 3, 4)
    assert (found.done, found.findings) == (4, 0), found.notes
    assert found.counts["orbit:"] > 0


def test_structures_are_those_of_their_seed():
    one, two, other = (draw(np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert one == two != other
    assert one.etas[1] > one.etas[0]


@pytest.mark.parametrize(
    ("n", "changes", "text"),
    [
        (1, {}, ""),
        (2, {}, ""),
        (2, {"multiplicity": 1.0}, "the FMU does not return after 1 T"),
        (1, {"multiplicity": 2.0}, "the FMU returns after 1 T already, not 2 T"),
        (2, {"impacts_per_period": 1.0}, "9 impacts in 3 times 2 T, not 3 x 2"),
        (2, {"impacts_per_period": 1.3}, "2.6 impacts in 2 T are no whole number"),
        (2, {"multiplier": 0.5}, "orbit: a multiplier of 0.94"),
        (1, {"multiplicity": 2.0}, "orbit: period = 2: no orbit found"),
    ],
)
def test_what_is_wrong_is_seen(fmu, told, n, changes, text):
    found = wrong(fmu, told[n], **changes)
    assert text in found if text else not found


def test_one_attractor_twice_is_seen(fmu, monkeypatch):
    plain = orchestrate.attractors

    def doubled(*args, **asked):
        found = plain(*args, **asked)
        return found.isel(attractor=[0, 0])

    monkeypatch.setattr(orchestrate, "attractors", doubled)
    lines = list(findings(fmu, DrawnStructure(PAPER, (1.28, 1.285)), 1, Counter()))
    assert lines and all("is there twice" in line for line in lines)
