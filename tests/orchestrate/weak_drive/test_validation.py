"""Random sets against the monolithic solution; all of them are marked slow."""

import pytest

from ...sparing import ordinary
from .validation import WIDE, random_sets, trajectory_error

SETS = random_sets(5)


def test_a_trajectory():
    error, impacts = trajectory_error(SETS[3], 20.0)
    assert impacts > 2 and error < 1e-6


@pytest.mark.parametrize("system", ordinary(random_sets(12, 5, WIDE), 2), ids=range(12))
def test_a_trajectory_of_a_set_as_users_may_enter(system):
    """Strong dampers of different ratios make the force jump at impacts: a larger error."""
    for one in (system.as_bonded(), system):
        assert trajectory_error(one, 20.0)[0] < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("system", SETS, ids=range(5))
def test_a_set(system):
    for one in (system.as_bonded(), system):
        assert trajectory_error(one)[0] < 1e-6
