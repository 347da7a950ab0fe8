"""What is wrong with a verdict."""

import dataclasses

from .lumped import Halves
from .recipe import Setup, Truth
from .verdicts import DELAMINATED, FAILED, NO_OPENING, REFUSED, verdict_problem


def test_what_is_wrong():
    """Sound or shut and called delaminated; open and overlooked, if it could be seen; no answer."""
    beam = {"halves": Halves(), "setup": Setup(4.0, 0.02, 1, "up")}
    sound = Truth(kind="sound", is_delaminated=False, opened=False, touched=False, **beam)
    split = dataclasses.replace(
        sound, is_delaminated=True, opened=True, touched=True, seen_gap=1e-3
    )
    shut = dataclasses.replace(split, opened=False, seen_gap=-1e-6)
    noise = dataclasses.replace(split, setup=dataclasses.replace(split.setup, excitation="random"))
    assert "is sound" in verdict_problem(DELAMINATED, sound)
    assert "did not open" in verdict_problem(DELAMINATED, shut)
    assert "opened by 1 mm" in verdict_problem(NO_OPENING, split)
    assert "where 0.3 mm would have been seen" in verdict_problem(NO_OPENING, split, "", 3e-4)
    assert "refused: why" in verdict_problem(REFUSED, split, "why")
    assert "failed: why" in verdict_problem(FAILED, noise, "why")
    small, apart = (dataclasses.replace(split, **{name: 0.0}) for name in ("seen_gap", "touched"))
    right = [(DELAMINATED, split), *((NO_OPENING, one) for one in (small, apart, shut, sound))]
    right += [("not described", sound), ("undecided", split), (REFUSED, noise)]
    assert not verdict_problem(NO_OPENING, split, "", 2e-3)
    assert [pair for pair in right if verdict_problem(*pair)] == []
