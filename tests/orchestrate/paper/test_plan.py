"""What the paper consists of: jobs after those they need, parts with pictures, all claims."""

from __future__ import annotations

import pytest

from orchestrate.access import finder
from orchestrate.errors import InputError
from orchestrate.paper import plan
from orchestrate.paper.captions import CAPTIONS
from orchestrate.paper.cases import CASES, MAPS, map_values
from orchestrate.paper.claims import CLAIMS
from orchestrate.paper.pictures import DRAW
from orchestrate.paper.resolution import FULL, QUICK
from orchestrate.running.identity import identity_of

from ...sparing import ordinary

PARTS = {"claims", *map(str, range(5, 13)), "lyapunov", "attractors", "basin", "maps", "spectra"}
PRINTED = (
    "0.43 1.37 0.89 21.56 1.045 1.07 2.61 3.77 0.48 0.85 1.08 2.63 1.056 1.1 1.11 1.33 0.97 1.02 "
    "1.23 16.41 1.048"
)


@pytest.mark.parametrize(
    "resolution", ordinary([QUICK, FULL]), ids=lambda resolution: resolution.name
)
def test_jobs_come_after_what_they_need(resolution):
    seen: set[str] = set()
    for name, job in plan.make_plan(resolution).jobs.items():
        assert job.name == name and set(job.needs()) <= seen
        assert job.count() > 0
        seen.add(name)


def test_every_part_is_drawn_and_described():
    parts = plan.make_plan(FULL).parts
    assert set(parts) == PARTS
    assert set(CAPTIONS) == set(DRAW) == PARTS - {"claims"}
    assert all(part.picture for name, part in parts.items() if name != "claims")


def test_what_a_part_needs():
    whole = plan.make_plan(FULL)
    needed = [job.name for job in whole.jobs_for(whole.choose(["5"]))]
    assert needed == ["orbit_e0.7_D0.005_up", "figure5"]
    basin = [job.name for job in whole.jobs_for(whole.choose(["basin"]))]
    assert basin == ["orbit_e0.7_D0.005_up", "attractors", "basin"]


def test_an_unknown_part_is_refused():
    with pytest.raises(InputError, match="unknown figure '4'; choose from claims, 5"):
        plan.make_plan(FULL).choose(["4"])


def test_the_resolution_is_part_of_the_identity(exported):
    find, questions = finder({}), []
    for resolution in (FULL, QUICK):
        known: dict = {}
        for name, job in plan.make_plan(resolution).jobs.items():
            known[name] = identity_of(job, {model: find(model) for model in job.models}, known)
        questions.append(known)
    same = {name for name in questions[0] if questions[0][name] == questions[1][name]}
    assert same == {"gamma", "low_speed", "chattering"}


def test_the_full_resolution_decides():
    assert FULL.decides and not QUICK.decides


def test_cases_and_maps():
    assert [(case.e, case.get("D")) for case in CASES.values()] == [
        (0.7, 0.005),
        (0.7, 0.05),
        (0.3, 0.005),
    ]
    for parameter, (low, high) in MAPS.items():
        values = map_values(parameter, 5)
        assert (values[0], values[-1]) == pytest.approx((low, high))


def test_claims_are_of_all_sections():
    assert {claim.section for claim in CLAIMS} == {"1", "2", "3", "3.1", "3.2", "4.1", "4.2", "5"}
    printed = " ".join(claim.printed for claim in CLAIMS).split()
    assert [number for number in PRINTED.split() if number not in printed] == []
