"""What strikes, by its timing, on benches that share no dynamics with the package."""

import math
from dataclasses import replace

import numpy as np
import pytest

from orchestrate.diagnosis.impact_timing import Strikes, strikes
from orchestrate.diagnosis.orders import checked_channels
from tests.benches import recipe
from tests.benches.strikers import STRIKERS

from ...sparing import ordinary

KINDS = {**recipe.KINDS, **STRIKERS}
FACES = Strikes(
    heard=60.0, base=1.2, locked=0.99, one_sided=0.85, blow=0.5, stiffness=1.0,
    place=0.02, spread=0.5, order2=0.2,
)  # fmt: skip
WORDS = {
    "nothing heard": {"heard": 5.0},
    "base strikes": {"base": 30.0},
    "not locked": {"locked": 0.4},
    "kinks": {"blow": 0.02},
    "stop": {"spread": 0.08},
    "stop or softer face": {"stiffness": math.nan},
    "something small strikes": {"order2": 0.02},
    "faces strike": {},
}


@pytest.mark.parametrize("word", WORDS)
def test_each_quantity_has_its_word(word):
    assert replace(FACES, **WORDS[word]).word() == word


def timed(kind, seed):
    """Draw a record of a kind; return what strikes in it, shut faces' frequency 3 % uncertain."""
    rng = np.random.default_rng([seed, 17])
    case = recipe.draw(rng, kind, recipe.Conditions(sensors=1), kinds=KINDS)
    truth, guess = case.truth, case.guess
    masses, turns = np.array([guess.m1, guess.m2]), np.array([truth.f1, truth.f2])
    shut = math.sqrt((masses * turns**2).sum() / masses.sum()) * rng.uniform(0.97, 1.03)
    return strikes(checked_channels(case.record), 1, shut)


@pytest.mark.parametrize("kind", ["delaminated", "stop", *ordinary(["sound", "crack", "play"])])
def test_faces_are_told_from_stops_and_kinks(kind):
    """Order 2, bursts and misfits of both overlap; where and when they strike does not."""
    word = timed(kind, 203).word()
    assert (word == "faces strike") == (kind == "delaminated"), word
    assert (word == "stop") == (kind in ("stop", "play")), word
