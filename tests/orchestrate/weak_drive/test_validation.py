"""Random sets against the monolithic solution; all of them are marked slow."""

import numpy as np
import pytest

from orchestrate.dynamics.bifurcations import Kind

from ...sparing import ordinary
from .validation import WIDE, bifurcations, random_sets, trajectory_error

SETS = random_sets(5)


def test_a_trajectory():
    error, impacts = trajectory_error(SETS[3], 20.0)
    assert impacts > 2 and error < 1e-6


@pytest.mark.parametrize("system", ordinary(random_sets(12, 5, WIDE), 2), ids=range(12))
def test_a_trajectory_of_a_set_as_users_may_enter(system):
    """Strong dampers of different ratios make the force jump at impacts: a larger error."""
    for one in (system.as_bonded(), system):
        assert trajectory_error(one, 20.0)[0] < 1e-5


def test_a_fold():
    """Located on the branch, and by shooting on the monolithic solution."""
    ((kind, _, voltage, truth),) = bifurcations(SETS[1].as_bonded(), (1.003, 1.012))
    assert kind == Kind.FOLD and voltage == pytest.approx(truth, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("system", SETS, ids=range(5))
def test_a_set(system):
    for one in (system.as_bonded(), system):
        assert trajectory_error(one)[0] < 1e-6
        found = bifurcations(one)
        errors = np.array([voltage - truth for _, _, voltage, truth in found])
        assert (np.abs(errors[np.isfinite(errors)]) < 1e-4).all(), found
        assert np.isfinite(errors[0])
