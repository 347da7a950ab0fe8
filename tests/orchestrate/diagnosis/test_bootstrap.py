"""Odds by simulated records: their estimator, and where they are asked for."""

import math
from dataclasses import replace

import numpy as np
import pytest

import orchestrate
from orchestrate.diagnosis import search_job
from orchestrate.diagnosis.bootstrap import Bootstrap
from orchestrate.diagnosis.decision_rule import Findings
from orchestrate.diagnosis.simulation import smooth_functions

from .records import BEAM, guess, record
from .test_verdicts import OPENED


def normal(observed, count=200):
    """Logarithms that are normal: sound ones around 0, delaminated ones around 0.5."""
    rng = np.random.default_rng(1)
    sound, delaminated = (np.exp(rng.normal(at, 0.2, count)) for at in (0.0, 0.5))
    return Bootstrap(observed, sound, delaminated)


@pytest.mark.parametrize("at", [0.1, 0.25, 0.4])
def test_odds_are_the_ratio_of_both_densities_within_their_error(at):
    odds, error = normal(math.exp(at)).odds_with_error()
    exact = ((at - 0.0) ** 2 - (at - 0.5) ** 2) / (2.0 * 0.2**2)
    assert 0.05 < error < 0.8
    assert abs(math.log(odds) - exact) < 3.0 * error + 0.3


def test_the_sentence_counts_the_records_that_look_like_the_other_kind():
    made = normal(math.exp(0.25))
    above, below = made.lookalikes
    assert above == np.sum(made.sound >= made.observed) and below > 0
    assert f"sound model, {above} looked as delaminated as this record." in made.sentence()
    assert "sound model, none looked" in normal(50.0).sentence()


def test_few_simulations_exclude_nothing():
    odds, _ = normal(math.exp(3.0)).odds_with_error()
    assert odds < 300.0


def test_what_a_fit_misses_keeps_its_size():
    made = smooth_functions(150, np.random.default_rng(2))
    np.testing.assert_allclose(np.mean(made**2, axis=0), 1.0, atol=0.4)


def test_only_a_word_that_hangs_on_a_border_is_close():
    assert not OPENED.is_close
    for changes in ({"share": 0.6}, {"sound_misfit": 1.3}, {"excess": 1.1}):
        assert replace(OPENED, **changes).is_close, changes


@pytest.mark.slow
def test_simulated_records_of_both_kinds_are_told_apart(monkeypatch):
    """A delaminated record that is taken for close has a ratio of its own kind's."""
    answer = close_answer(BEAM, monkeypatch)
    sound, delaminated = np.log(answer.bootstrap_ratio).median("simulated").values
    assert sound < delaminated and float(answer.odds) > 3.0


@pytest.mark.slow
def test_odds_of_a_bonded_structure_tell_nothing(monkeypatch):
    """Halves that are alike move as one: the delaminated fit is the bonded one."""
    answer = close_answer(BEAM.as_bonded(), monkeypatch)
    sound, delaminated = np.log(answer.bootstrap_ratio).median("simulated").values
    assert delaminated == pytest.approx(sound, abs=0.01) and 0.3 < float(answer.odds) < 3.0


def close_answer(structure, monkeypatch):
    """A verdict whose odds come from simulated records, whatever it hangs on."""
    monkeypatch.setattr(Findings, "is_close", property(lambda self: True))
    monkeypatch.setattr(search_job, "may_be_delaminated", lambda *args: True)
    answer = orchestrate.detect(record(structure, noise=0.02), guess(), jobs=1, progress=False)
    assert int(answer.odds_decided) == 1 and answer.attrs["simulated"]
    return answer
