"""Random sets against the monolithic solution; all of them, and jumps, are marked slow."""

import numpy as np
import pytest

from orchestrate import couple
from orchestrate.dynamics.bifurcations import Kind
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.couple_all import voltage_range

from .validation import (
    below_resonance,
    bifurcations,
    extrapolated_jumps,
    first_fold,
    ramp_jumps,
    random_sets,
    trajectory_error,
)

SETS = random_sets(5)
STRONGER = {"b": (0.02, 0.5), "epsilon": (1e-4, 2e-3)}


def test_a_trajectory():
    error, impacts = trajectory_error(SETS[3], 20.0)
    assert impacts > 2 and error < 1e-6


def test_a_fold():
    """Located on the branch, and by shooting on the monolithic solution."""
    ((kind, _, voltage, truth),) = bifurcations(SETS[1].as_bonded(), (1.003, 1.012))
    assert kind == Kind.FOLD and voltage == pytest.approx(truth, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("system", SETS, ids=range(5))
def test_a_set(system):
    folds, smooth = [], []
    for one in (system.as_bonded(), system):
        assert trajectory_error(one)[0] < 1e-6
        found = bifurcations(one)
        errors = np.array([voltage - truth for _, _, voltage, truth in found])
        assert (np.abs(errors[np.isfinite(errors)]) < 1e-4).all(), found
        assert np.isfinite(errors[0])
        folds.append(first_fold(found)[2])
        smooth.append(found[0][0] == Kind.FOLD)  # else it has left this branch before
        here, whole = ramp_jumps(one, folds[-1])
        assert here == pytest.approx(whole, abs=1e-3)
    jumps = extrapolated_jumps(system, max(folds))
    assert smooth[0]
    for jump, fold, first in zip(jumps, folds, smooth, strict=True):
        assert not first or jump == pytest.approx(fold, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("system", random_sets(15, 17, STRONGER), ids=range(15))
def test_a_jump_is_where_a_fold_is(system):
    """Nowhere else; where it cannot be told from a steep branch, that is said."""
    bonded = system.as_bonded()
    omega, volts = system.structure.omega, system.drive.volts(system.structure)
    speed, first = below_resonance(system)
    last = volts * voltage_range(*bonded)[1]
    start = {"speed_start": speed, "settle": 200.0 / omega, "back": False, "progress": False}
    found = couple(*bonded, voltage=(first, last), rate=1e-4 * volts * omega, **start)
    jumps, why = bool(np.isfinite(found.jumps[0])), str(found.no_jump.values[0])
    assert jumps == bool(averaged.folds(*bonded)) or "not told from a steep branch" in why
