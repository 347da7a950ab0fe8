"""Attractors carried along a parameter: found as far as they exist, matched, with their shares."""

from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.dynamics.attractors import attractors
from orchestrate.dynamics.global_continuation import BY_NEWTON, BY_SIMULATION, matching_pairs
from orchestrate.dynamics.settled_motion import SettledMotion
from orchestrate.dynamics.settling import AttractorSettings
from orchestrate.model import Excitation, Structure
from orchestrate.model.outcomes import ORBIT
from orchestrate.response.questions import Point

PAPER = Structure.nondimensional()
POINT = Point(Structure(), Excitation(frequency=1.0, amplitude=1.0))
pytestmark = pytest.mark.usefixtures("exported")


@pytest.fixture(scope="module")
def line(exported):
    """T and 2T with three impacts: from the period doubling of T on, as far as 2T exists."""
    return attractors(PAPER, eta=np.arange(1.31, 1.381, 0.01).round(3), starts=8, seed=2)


def test_an_attractor_has_one_number_as_far_as_it_exists(line):
    there = line.decided_by.values == ORBIT
    for k in range(line.sizes["attractor"]):
        n = line.multiplicity.values[there[:, k], k]
        assert (n == n[0]).all()
        assert (np.diff(np.flatnonzero(there[:, k])) == 1).all()  # no value is left out
    assert line.sizes["attractor"] == 2
    assert line.multiplicity.values[0].tolist() == [1.0, 2.0]
    assert line.first_found.values.tolist() == [1.31, 1.31]
    assert line.last_found.values.tolist() == [1.38, 1.36]  # 2T ends in a fold at 1.3657


def test_shares_count_random_starts_alone(line):
    np.testing.assert_allclose(line.share.sum("attractor"), 1.0)
    labels = line.attractor_of.values
    for i in range(line.sizes["eta"]):
        np.testing.assert_array_equal(line.share[i], np.bincount(labels[i], minlength=2) / 8)
    carried = (line.decided_by.values == ORBIT) & (line.share.values == 0.0)
    assert carried.any()  # found by carrying alone


def test_motions_are_numbered_by_what_they_are():
    rows = [(1, 2.0, 3.0), (2, 1.0, 3.0), (2, 1.5, 1.0), (2, 1.5, 2.0), (0, 0.5, 0.5)]
    ordered = [SettledMotion(POINT, ORBIT, np.eye(4), *row) for row in rows]
    assert sorted(ordered[2:] + ordered[:2], key=lambda motion: motion.sort_key) == ordered
    assert ordered[0].state_of_least_x1.tolist() == [0.0, 0.0, 0.0, 1.0]


def value(*motions, apart=0.0):
    return SimpleNamespace(motions=[motion(*one, apart) for one in motions])


def motion(n, impacts, apart):
    own = {"multiplicity": n, "impacts_per_period": impacts, "states": np.ones((max(n, 1), 4))}
    return SimpleNamespace(**own, point=POINT, nearest_state=lambda state: (0, apart))


T, TWO, FOUR, OTHER = (1, 1.0), (2, 1.5), (4, 1.5), (3, 2.0)


@pytest.mark.parametrize(
    ("before", "after", "forth", "back", "expected"),
    [
        ([T, TWO], [TWO, FOUR], [1, 0], [1, 0], [(0, 1), (1, 0)]),  # they lead to each other
        ([T, TWO], [T], [0, 0], [0], [(0, 0)]),  # one jumps to the other and ends
        ([TWO], [T, TWO], [(1, BY_NEWTON)], [0, 0], [(0, 1)]),  # followed, though it leads away
        ([T, OTHER], [TWO], [0, 0], [1], [(1, 0)]),  # a jump joins none that do not look alike
    ],
)
def test_which_attractors_of_neighbours_are_one(before, after, forth, back, expected):
    links = {}
    for i, leads in ((0, forth), (1, back)):
        for k, to in enumerate(leads):
            links[i, k, 1 - i] = to if isinstance(to, tuple) else (to, BY_SIMULATION)
    found = matching_pairs(value(*before), value(*after), 0, links, 0.0)
    assert sorted(found) == expected


@pytest.mark.parametrize(("apart", "expected"), [(0.19, [(0, 0), (1, 1)]), (0.21, [(1, 1)])])
def test_neighbours_that_one_leads_to_are_one_if_they_are_near(apart, expected):
    leads = {(0, 0, 1): 0, (0, 1, 1): 1, (1, 0, 0): 1, (1, 1, 0): 1}
    links = {key: (to, BY_SIMULATION) for key, to in leads.items()}
    near = value(T, T, apart=apart)
    distance = AttractorSettings().neighbour
    assert sorted(matching_pairs(near, near, 0, links, distance)) == expected
