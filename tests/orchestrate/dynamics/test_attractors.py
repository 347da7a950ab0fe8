"""Coexisting attractors: reproducible starts, known attractors, states that stay on them."""

from unittest.mock import patch

import numpy as np
import pytest

from orchestrate.dynamics.attractors import AttractorsJob, attractors
from orchestrate.dynamics.settling import AttractorSettings, transient_periods
from orchestrate.model import Structure
from orchestrate.model.outcomes import IRREGULAR, ORBIT, UNDECIDED
from orchestrate.response.sweep import sweep

PAPER = Structure.nondimensional()
TWO = 1.315  # eta at which a response T and one 2T coexist
ASKED = {"eta": [1.2, TWO], "starts": 10, "seed": 3, "transient": 300}

pytestmark = pytest.mark.usefixtures("exported")


def test_the_same_seed_gives_the_same_starts():
    found = attractors(PAPER, **ASKED)
    with patch.object(AttractorsJob, "chunk_size", 7):
        again = attractors(PAPER, **ASKED)
    np.testing.assert_allclose(again.features, found.features, rtol=1e-9)
    np.testing.assert_array_equal(again.attractor_of, found.attractor_of)
    other = attractors(PAPER, **{**ASKED, "seed": 4})
    assert (other.features != found.features).any()


def test_scale_is_three_times_the_largest_gap_from_rest():
    dropped = transient_periods(300, 300.0, TWO)
    gap = float(sweep(PAPER, eta=TWO, transient=dropped, samples=48).xi_rel_max[0])
    asked = {**ASKED, "eta": TWO, "starts": 4}
    one, two = attractors(PAPER, **asked), attractors(PAPER, **asked, scale=3.0 * gap)
    np.testing.assert_allclose(one.features, two.features, rtol=1e-9)


@pytest.mark.parametrize(
    ("eta", "e", "expected"), [(2.9, 0.7, [ORBIT, UNDECIDED]), (0.8, 0.9, [IRREGULAR])]
)
def test_irregular_motion_that_starts_still_leave_is_undecided(eta, e, expected):
    """At 2.9 it lasts some ten thousand periods."""
    asked = {"eta": eta, "starts": 24, "transient": 200, "settle": 1.0}
    settings = AttractorSettings(longest=4000)
    there = attractors(Structure.nondimensional(e=e, D=0.005), **asked, settings=settings)
    assert there.decided_by.values.ravel().tolist() == expected
