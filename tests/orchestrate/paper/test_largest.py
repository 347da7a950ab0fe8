"""The largest exponent of a region is that of a run of its own, not the largest of many."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from orchestrate.access import OSCILLATOR, REST, find
from orchestrate.dynamics.long_runs import ENDED, NOT_RUN, STEADY, UNDECIDED, LongRun
from orchestrate.dynamics.lyapunov import Exponent
from orchestrate.paper.cases import CASES
from orchestrate.paper.largest_exponents import (
    LOST,
    Candidate,
    LargestExponentJob,
    RegionCandidates,
    largest_exponent,
)
from orchestrate.paper.regions import COUNT, list_regions
from orchestrate.response.questions import Point
from orchestrate.structures import Excitation

from .limits import make_limits

DAMPED = CASES["damped"]
ENDS = {  # of the damped case, shortened
    "T, contact": (0.42, 0.46),
    "T/2": (0.73, 1.08),
    "T/1": (1.26, 2.79),
    "2T/1": (3.47, 4.82),
    "3T/1": (5.61, 6.91),
    "4T/1": (7.71, 8.9),
}


def limits():
    """What the limits job gives, of the damped case."""
    return make_limits("damped", ENDS)


def job(**changes):
    names = {"exponents": "exponents", "settled": "settled", "limits": "limits"}
    return LargestExponentJob(name="largest", case="damped", structure=DAMPED, **names, **changes)


def test_regions_are_windows_and_what_lies_between():
    found = list_regions(limits(), "damped")
    assert len(found) == COUNT
    assert [region.name for region in found][-4:] == [
        "2T/1 to 3T/1",
        "3T/1",
        "3T/1 to 4T/1",
        "4T/1",
    ]
    adds = [region.name for region in found if region.adds_a_period]
    assert adds == ["T/1 to 2T/1", "2T/1 to 3T/1", "3T/1 to 4T/1"]
    assert [region.is_window for region in found] == [False, True] * 5
    assert found[-1].high == 8.0


def test_candidates_are_those_with_the_largest_exponents_of_each_region():
    etas = np.array([2.0, 5.0, 5.1, 5.2, 5.3])
    exponents = xr.Dataset({"exponent": ("eta", [0.9, 0.1, 0.3, 0.2, np.nan])}, {"eta": etas})
    states = np.arange(20.0).reshape(5, 4)
    settled = xr.Dataset({"end_state": (("eta", "coordinate"), states)}, {"eta": etas})
    inputs = {"exponents": exponents, "settled": settled, "limits": limits()}
    items = job(candidates=2).items(inputs)
    region = next(item for item in items if item.number == 6)  # 2T/1 to 3T/1
    assert [one.screened for one in region.candidates] == [0.3, 0.2]
    point = region.candidates[0].point
    assert point.excitation.eta(DAMPED) == pytest.approx(5.1)
    assert region.candidates[0].start == pytest.approx(tuple(states[2] * point.scale))
    assert [len(item.candidates) for item in items] == [0, 0, 0, 1, 0, 0, 2, 0, 0, 0]


def test_the_quoted_exponent_agrees_with_an_independent_long_run(exported):
    """The largest of 157 at D = 0.05 was 0.2777 +- 0.0031; a long run gives 0.2581 +- 0.0020."""
    point = Point(DAMPED, Excitation.nondimensional(5.175, DAMPED))
    asked = job(periods=1500, parts=6)
    item = RegionCandidates(6, [Candidate(point, REST, 0.2777)])
    row = asked.work({OSCILLATOR: find(OSCILLATOR).path}, [item], None)["rows"][0, 0]
    eta, screened, exponent, error, outcome = row
    assert (eta, screened, outcome) == (pytest.approx(5.175), 0.2777, STEADY)
    assert abs(exponent - 0.2581) < 3.0 * np.hypot(error, 0.0020)
    assert abs(screened - 0.2581) > 3.0 * np.hypot(0.0031, 0.0020)  # what was quoted before


def found(*rows):
    """What the job gives of one region: eta, screened, exponent, error, outcome each."""
    table = np.full((1, 10, 5), np.nan)
    table[..., -1] = NOT_RUN
    table[0, : len(rows)] = rows
    names = ("eta", "screened", "exponent", "standard_error", "outcome")
    dims = "region", "candidate"
    variables = {name: (dims, table[..., k]) for k, name in enumerate(names)}
    return xr.Dataset(variables, {"region": ["T/1 to 2T/1"]})


def test_what_is_quoted():
    name = "T/1 to 2T/1"
    steady = (5.2, 0.17, 0.16, 0.001, STEADY)
    quoted = largest_exponent(found(steady), name)
    assert quoted[:3] == (0.16, 0.001, 5.2)
    assert quoted.text() == "0.1600 ± 0.0010 at 5.200"
    ended = largest_exponent(found((5.125, 0.1747, 0.008, 0.0005, ENDED), steady), name)
    assert ended[:3] == (0.16, 0.001, 5.2)
    assert "0.1747 at 5.125: the parts of its long run did not agree" in ended.text()
    lost = largest_exponent(found((3.11, 0.0824, -0.0095, 0.0001, LOST), steady), name)
    assert lost[:3] == (0.16, 0.001, 5.2)
    assert "0.0824 at 3.110 did not last, -0.0095 ± 0.0001 in its long run" in lost.text()
    undecided = largest_exponent(found((5.1, 0.2, 0.1, 0.05, UNDECIDED)), name)
    assert np.isnan(undecided.exponent) and undecided.text().startswith("undecided (0.2000 at")
    assert largest_exponent(found((5.1, 0.2, 0.3, 0.05, UNDECIDED), steady), name).eta == 5.2


@pytest.mark.parametrize(
    ("screened", "value", "outcome"),
    [
        (0.0824, -0.0095, LOST),  # chaos that has died out, or another attractor
        (0.1747, 0.008, LOST),
        (0.2777, 0.2581, STEADY),
        (1e-5, -3e-5, STEADY),  # neutral: a deviation wanders
        (-0.0004, -0.0009, STEADY),
    ],
)
def test_a_response_that_is_not_what_it_was_chosen_for(screened, value, outcome):
    run = LongRun(Exponent(value, 1e-4), STEADY, 110_000)
    assert job().classify_run(run, screened, 3.11) == outcome
    assert job().classify_run(run._replace(outcome=UNDECIDED), screened, 3.11) == UNDECIDED
