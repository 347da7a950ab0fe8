"""The campaign on verdicts: its drives, what it takes for wrong, and a short form of it."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from orchestrate.weak_drive import averaged
from tools.trust import verdicts
from tools.trust.verdicts import FOLD, NONE, TORUS, UNKNOWN, Answer, Truth, Verdicts, complaint

LOST = Answer("lost", 1.5, 1.5001, True)
SEEN = Answer("lost", 1.52, 1.52, False)
NOTHING = Answer("none", np.nan, np.nan, True)
OPEN = Answer("undecided", np.nan, np.nan, True)


def test_drives_with_folds_and_near_their_edge():
    rng = np.random.default_rng(1)
    for _ in range(5):
        system = verdicts.with_folds(rng)
        assert averaged.folds(*system) and averaged.least_slope(*system) < 0.0
        edge = verdicts.with_slope(system, 0.05)
        assert not averaged.folds(*edge)
        assert averaged.least_slope(*edge) == pytest.approx(0.05, abs=1e-6)
        assert edge.drive.b(edge.structure) == pytest.approx(system.drive.b(system.structure))


@pytest.mark.parametrize(
    ("answer", "known", "wrong"),
    [
        (LOST, Truth(FOLD, 1.50005, 1.50005), False),
        (LOST, Truth(FOLD, 1.5008, 1.5008), True),
        (LOST, Truth(FOLD, 1.499, 1.499), True),
        (LOST, Truth(TORUS, 1.49, 1.52), False),
        (LOST, Truth(NONE), True),
        (LOST, Truth(UNKNOWN), False),
        (SEEN, Truth(FOLD, 1.5, 1.5), False),
        (SEEN, Truth(FOLD, 1.53, 1.53), True),
        (NOTHING, Truth(FOLD, 1.5, 1.5), True),
        (NOTHING, Truth(NONE), False),
        (OPEN, Truth(FOLD, 1.5, 1.5), False),
    ],
)
def test_what_is_wrong(answer, known, wrong):
    """On the way up: the jump of a ramp is late."""
    assert bool(complaint(answer, known, "up")) is wrong


def test_the_jump_of_a_ramp_down_is_late_downward():
    assert not complaint(SEEN, Truth(FOLD, 1.53, 1.53), "down")
    assert complaint(SEEN, Truth(FOLD, 1.5, 1.5), "down")


def test_answers_that_change_with_the_rate_are_findings(monkeypatch):
    said = iter([(LOST, NOTHING), (OPEN, NOTHING), (NOTHING, NOTHING), (LOST, NOTHING)])
    monkeypatch.setattr(verdicts, "answers", lambda *_: next(said))
    system = verdicts.with_folds(np.random.default_rng(1))
    found = list(
        verdicts.judged(system, "delaminated", dict.fromkeys(verdicts.WAYS, Truth(UNKNOWN)))
    )
    problems = [problem for _, problem in found if problem]
    assert problems == ["delaminated, up: lost at some rates, none at others"]
    assert [name for name, _ in found].count("undecided") == 1


def branch(stable, end):
    """A branch up to a fold at 1.2 V, at 1.3 rad/s; stable or not; another one folds beside it."""
    count = len(stable)
    legs = {
        "voltage": np.linspace(1.0, 1.2, count),
        "speed": np.linspace(1.0, 1.3, count),
        "stable": np.array(stable),
        "revolutions": np.ones(count),
    }
    return xr.Dataset(
        {name: (("leg", "point"), values[np.newaxis]) for name, values in legs.items()}
        | {
            "end": ("leg", [end]),
            "bifurcation_structure": ("bifurcation", ["bonded"] * 2),
            "bifurcation_kind": ("bifurcation", ["fold"] * 2),
            "bifurcation_voltage": ("bifurcation", [1.195, 1.2]),
            "bifurcation_speed": ("bifurcation", [1.295, 1.3]),
            "bifurcation_revolutions": ("bifurcation", [2.0, 1.0]),
        },
        {"leg": ["from below"]},
    )


def test_where_a_branch_loses_its_motion():
    found = verdicts.truth(branch([True] * 20 + [False], "limit"), "bonded", "up", (1.0, 1.0))
    assert found == Truth(FOLD, 1.2, 1.2)
    whole = branch([True] * 20, "limit")
    assert verdicts.truth(whole, "bonded", "up", (1.0, 1.0)).kind == NONE
    assert verdicts.truth(branch([True] * 20, "stuck"), "bonded", "up", (1.0, 1.0)).kind == UNKNOWN
    other = whole.assign(stable=~whole.stable)
    assert verdicts.truth(other, "bonded", "up", (1.0, 1.0)).kind == UNKNOWN


@pytest.mark.slow
def test_one_drive(exported):
    found = Verdicts().run(None, 3, 1)
    assert found.done == 1 and found.findings == 0, found.notes
    assert found.counts["truth fold:"] >= 2
