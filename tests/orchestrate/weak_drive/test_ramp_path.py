"""What slow ramps meet on made-up branches of stationary motions."""

import numpy as np
import pytest
import xarray as xr

from orchestrate.weak_drive.ramp_path import ramp_paths

LEGS = ("from below", "from above", "first doubled", "second doubled")
S_CURVE = [(1.0, 0.9, 1), (1.2, 0.95, 1), (1.4, 1.0, 1), (1.3, 1.1, 0), (1.2, 1.2, 0)]
S_CURVE += [(1.3, 1.3, 1), (1.5, 1.5, 1)]
FOLDS = [("fold", 1.41, 1.03, 1), ("fold", 1.19, 1.22, 1)]


def made(legs, bifurcations, ends=("limit",) * 4):
    """Branches by leg: voltage, speed, whether stable; bifurcations with their revolutions."""
    most = max(map(len, legs.values()))
    table = np.full((len(LEGS), most, 3), np.nan)
    for name, motions in legs.items():
        table[LEGS.index(name), : len(motions)] = motions
    along = ("structure", "leg", "point")
    values = {
        "voltage": (along, table[None, ..., 0]),
        "speed": (along, table[None, ..., 1]),
        "stable": (along, np.nan_to_num(table[None, ..., 2]) > 0),
        "revolutions": (along, np.where([[[name.endswith("ed")] * most for name in LEGS]], 2, 1)),
        "end": (along[:2], [list(ends)]),
    }
    names = ("kind", "voltage", "speed", "revolutions")
    for name, column in zip(names, zip(*bifurcations, strict=True), strict=True):
        values[f"bifurcation_{name}"] = ("bifurcation", list(column))
    values["bifurcation_structure"] = ("bifurcation", ["delaminated"] * len(bifurcations))
    return xr.Dataset(values, {"structure": ["delaminated"], "leg": list(LEGS)})


def paths(legs, bifurcations, **more):
    return ramp_paths(made(legs, bifurcations, **more), "delaminated")


def test_a_branch_with_two_folds():
    both = paths({"from below": S_CURVE}, FOLDS)
    assert both["up"].jumps == [0] and both["down"].jumps == [1]
    assert both["up"].landings == [pytest.approx(1.41)]
    assert both["down"].landings == [pytest.approx(0.9475)]
    assert not (both["up"].end or both["down"].end or both["up"].slow_losses)


def test_of_two_folds_up_the_ramp_takes_that_of_its_own_branch():
    """The other one ends a stable stretch of the leg from above, which a ramp does not come to."""
    above = [(1.5, 1.5, 1), (1.3, 1.3, 1), (1.2, 1.2, 0), (1.42, 1.06, 0), (1.4, 1.02, 1)]
    above += [(1.3, 1.01, 0)]
    legs = {"from below": S_CURVE[:5], "from above": above}
    ends = ("most points", "limit", "limit", "limit")
    both = paths(legs, [*FOLDS, ("fold", 1.43, 1.05, 1)], ends=ends)
    assert both["up"].jumps == [0] and both["down"].jumps == [1]


def test_a_jump_that_lands_before_another_fold():
    """The ramp goes on there, and jumps once more."""
    legs = [*S_CURVE[:5], (1.3, 1.25, 1), (1.6, 1.35, 1), (1.5, 1.4, 0), (1.45, 1.5, 0)]
    legs += [(1.5, 1.52, 1), (1.7, 1.6, 1)]
    folds = [*FOLDS, ("fold", 1.61, 1.37, 1), ("fold", 1.44, 1.48, 1)]
    up = paths({"from below": legs}, folds)["up"]
    assert up.jumps == [0, 2] and len(up.landings) == 2 and up.landings[0] < 1.3 < up.landings[1]


def test_a_slow_loss_before_the_fold():
    """Down, a Neimark-Sacker point comes first; the ramp goes on to the fold."""
    motions = [*S_CURVE[:4], (1.2, 1.2, 0), (1.25, 1.27, 0), (1.3, 1.3, 1), (1.5, 1.5, 1)]
    torus = ("Neimark-Sacker", 1.27, 1.28, 1)
    down = paths({"from below": motions}, [*FOLDS, torus])["down"]
    assert down.slow_losses == [2] and down.jumps == [1]
    near = paths({"from below": S_CURVE}, [*FOLDS, ("Neimark-Sacker", 1.22, 1.24, 1)])["down"]
    assert near.slow_losses == [2] and near.jumps == [1]  # both within one step


def test_a_period_doubling_is_followed_to_the_fold_of_the_doubled_motion():
    below = [(1.0, 0.9, 1), (1.2, 0.95, 1), (1.3, 0.97, 0), (1.4, 1.0, 0), (1.3, 1.1, 0)]
    below += [(1.2, 1.2, 0), (1.3, 1.3, 1), (1.5, 1.5, 1)]
    doubled = [(1.255, 0.961, 1), (1.33, 0.98, 1), (1.3, 1.0, 0)]
    flip, fold = ("period doubling", 1.25, 0.96, 1), ("fold", 1.34, 0.99, 2)
    legs, places = {"from below": below, "first doubled": doubled}, [*FOLDS, flip, fold]
    assert paths(legs, places)["up"].jumps == [3]
    alone = paths({"from below": below}, places)["up"]
    assert not alone.jumps and alone.end.startswith("its period doubles at 1.25")


def test_what_the_branches_do_not_tell():
    """No stable motion to begin with; a branch that ends; nothing to jump to."""
    lost = [(1.0, 0.9, 0), (1.2, 0.95, 0), (1.1, 1.0, 0), (1.3, 1.1, 1)]
    assert "no stable motion" in paths({"from below": lost}, FOLDS)["up"].end
    ends = ("grazing of a flight", *("limit",) * 3)
    short = paths({"from below": S_CURVE[:3]}, FOLDS, ends=ends)
    assert short["up"].end == "its motion ends at 1.40000 V: grazing of a flight"
    assert "no stable motion" in short["down"].end
    nowhere = paths({"from below": S_CURVE[:5]}, FOLDS)["up"]
    assert nowhere.jumps == [0] and "no stable motion at 1.41" in nowhere.end
