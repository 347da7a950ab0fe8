"""How long a search goes on, and what its residuals say of errors: made-up misfits, no motions."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.diagnosis import multistart
from orchestrate.diagnosis.detect import assumed_halves
from orchestrate.diagnosis.hypotheses import Bonded
from orchestrate.diagnosis.misfit import soft_l1_loss
from orchestrate.diagnosis.multistart import (
    Search,
    Solution,
    with_distinct_misfits,
    without_neighbours,
)
from orchestrate.diagnosis.settings import SETTINGS, checked_settings
from orchestrate.diagnosis.standard_errors import covariance_of_numbers
from orchestrate.errors import InputError

HERE = {"f": 34.0, "log_zeta": -4.0}


class MadeUp(Search):
    """A search whose residuals are a function of both numbers."""

    def __init__(self, residuals):
        record = {"settings": SETTINGS, "resonance": 34.0, "has_floor": False}
        super().__init__(Bonded(), SimpleNamespace(**record))
        self.function = residuals

    def compute_residuals(self, values):
        self.evaluations += 1
        x, y = values["f"] / 34.0 - 1.0, values["log_zeta"] + 4.0
        return np.array(self.function(x, y), dtype=float)


@pytest.fixture(autouse=True)
def bounds(monkeypatch):
    wide = {"f": (20.0, 50.0), "log_zeta": (-9.0, -1.0)}
    monkeypatch.setattr(Bonded, "bounds", lambda *_: wide)


@pytest.mark.parametrize(("is_rugged", "count"), [(False, 2), (True, 4)])
def test_one_goes_downhill_from_starts_that_differ(monkeypatch, is_rugged, count):
    """Halves that change places are two solutions, however near each other."""
    begun, search = [], MadeUp(lambda x, y: [x, y])
    monkeypatch.setattr(Bonded, "is_rugged", is_rugged)
    monkeypatch.setattr(search, "minimise", lambda values: begun.append(values) or Solution({}, 1))
    search.find_minima([{**HERE, "f": f} for f in (40.0, 35.0, 36.0, 39.0, 38.0)])
    assert [values["f"] for values in begun] == [35.0, 36.0, 38.0, 39.0][:count]
    one, near, other = (Solution({"split": s, "e": 0.5}, 0.2) for s in (0.015, 0.02, -0.015))
    assert without_neighbours([one, near, other]) == [one, other]


def motions(function):
    """Motions of a way downhill, its end again among them, without those for derivatives."""
    search, places = MadeUp(function), []
    derivatives = search.residual_derivatives
    search.residual_derivatives = lambda *at: places.append(1) or derivatives(*at)
    search.minimise({"f": 36.0, "log_zeta": -3.5})
    return search.evaluations - 2 * len(places)


def test_a_way_downhill_ends_after_eight_motions_or_a_gain_below_a_thousandth():
    narrow = lambda x, y: [1e-3 * (1.0 + 30.0 * y + 1e4 * x), 1.0 - np.tanh(4.0 * y)]  # noqa: E731
    assert motions(narrow) == 1 + 8
    for gain, steps in ((0.99e-3, 2), (1.01e-3, 3)):
        away = 0.5 * np.sqrt(gain / (1.0 - gain)) / 0.25
        assert motions(lambda x, y, away=away: [1e-2, 1e-2 * away * y]) == 1 + steps


@pytest.mark.parametrize(("gain", "sizes"), [(2.1e-3, [1.0, 1.0, 1.0]), (1.9e-3, [0.2, 0.04])])
def test_four_regressions_at_most_and_three_that_gain_little(monkeypatch, gain, sizes):
    """Of clouds of the whole size, and then a fifth of it and a twenty-fifth."""
    done = []

    def fit_to_cloud(residuals, bounds, values, covariance, seed, points):
        assert points == 3
        done.append(covariance[0, 0])
        lowest = (1.0 - gain) ** len(done) if gain > 2e-3 else 1.0 - gain
        model = {"best": HERE, "lowest": lowest, "damped_minima": lambda *_: [HERE]}
        return SimpleNamespace(**model, cloud_covariance=lambda: np.eye(2))

    monkeypatch.setattr(multistart, "LinearModel", SimpleNamespace(fit_to_cloud=fit_to_cloud))
    MadeUp(lambda x, y: [9.0]).polish(Solution(HERE, 1.0))
    assert done[1:] == pytest.approx(sizes)


@pytest.mark.parametrize(("times", "more"), [(1.29, False), (1.31, True)])
def test_squares_are_beyond_noise_from_1_3_times_its_own(monkeypatch, times, more):
    """A tenth of what is beyond is hidden: a number is as uncertain as that moves it."""
    noise = np.full((1, 1, 60), 0.01)
    search = MadeUp(lambda x, y: np.full((1, 1, 60), 0.01 * np.sqrt(times)))
    monkeypatch.setattr(
        "orchestrate.diagnosis.standard_errors.simulate_scatter_changes", lambda residuals: [noise]
    )
    rows = np.zeros((60, 2))
    model = {"weighted_slopes": rows, "slopes": rows.reshape(1, 1, 60, 2)}
    model |= {"scatter": np.zeros((3, 60)), "minus_inverse_normal_matrix": -4.0 * np.eye(2)}
    search.evidence.settings = replace(SETTINGS, contact_misfit=1e9)
    found = covariance_of_numbers(search, HERE, SimpleNamespace(**model))
    squares = soft_l1_loss(noise).sum()
    beyond = max(soft_l1_loss(noise * np.sqrt(times)).sum() - 1.3 * squares, 0.0)
    assert (beyond > 0.0) == more
    assert found[0, 0] == pytest.approx(0.1 * 4.0 * beyond, rel=1e-6, abs=1e-12)


def test_settings_that_are_assumed_differ_or_are_refused():
    """Two minima are two from misfits of 1.03 on; without a guess halves lie around a resonance."""
    for ratio, count in ((1.029, 1), (1.031, 2)):
        pair = [Solution(HERE, ratio * 0.5), Solution(HERE, 0.5)]
        assert len(with_distinct_misfits(pair, SETTINGS.distinct)) == count
    guess = assumed_halves(40.0, SETTINGS)
    assert (guess.f1, guess.f2, guess.zeta1, guess.e) == pytest.approx((38.0, 42.0, 0.01, 0.6))
    made = checked_settings({"steps": 1, "ratio": 0.5, "delay": 0.99e6})
    assert (made.steps, made.ratio, made.rounds) == (1, 0.5, SETTINGS.rounds)
    for wrong in ({"steps": 0.9}, {"ratio": -0.1}, {"ratio": 1.01e6}, {"rate": 2.0}):
        with pytest.raises(InputError, match=f"settings.*'{next(iter(wrong))}'"):
            checked_settings(wrong)
