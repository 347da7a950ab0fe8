"""The rule of the verdict, number by number."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.diagnosis.decision_rule import Findings, factor_outside, resampled_share
from orchestrate.diagnosis.detect import stated_hypotheses
from orchestrate.diagnosis.evidence import Evidence
from orchestrate.diagnosis.fit import reported_derivatives
from orchestrate.diagnosis.hypotheses import Delaminated, PositiveStop
from orchestrate.diagnosis.settings import SETTINGS

from .records import BEAM, record

OPENED = Findings(
    excess=10.0,
    order2=0.2,
    apart=0.0,
    bursts=50.0,
    sound="bonded",
    sound_misfit=3.0,
    delaminated="delaminated",
    delaminated_misfit=0.8,
    share=1.0,
    sensors=1,
    low=1.0,
    high=5.0,
    first=20.0,
    last=90.0,
    smallest=1e-6,
    hidden=0.01,
    clipped=0.0,
    end_response=0.2,
    resonance=46.0,
    guessed=(42.0, 52.0),
)
QUIET = replace(OPENED, excess=0.3, sound_misfit=0.3, bursts=0.8)
CASES = """
opens, and the halves explain it: -> delaminated
no order 2, one mass explains it: excess=0.3 misfit=0.3 bursts=0.8 -> no opening seen
the same, sampled too slowly for impacts: excess=0.3 misfit=0.3 bursts=nan -> no opening seen
no order 2, one mass explains it, but something strikes: excess=0.3 misfit=0.3 bursts=5 -> undecided
no order 2, and nothing explains it: excess=0.3 other=3.5 misfit=6 -> not described
no order 2, but the halves alone explain it: excess=0.3 bursts=5 -> undecided
order 2, and impacts are as in a loose clamp: bursts=21 -> undecided
the same, sampled too slowly for impacts: bursts=nan -> undecided
the same, and the faces move apart: bursts=2.8 apart=4 -> delaminated
order 2, both explain it: misfit=0.9 -> undecided
order 2, one mass explains it better: misfit=0.2 other=1.2 -> undecided
order 2, and nothing explains it: other=3.5 misfit=6 -> not described
better, but not in most parts of the record: share=0.6 -> undecided
no order 2, but the faces move apart, impacts are heard: excess=0.2 apart=4 bursts=5 -> delaminated
the faces differ as by a torsion mode: excess=0.25 bursts=0.8 apart=40 misfit=1.4 -> undecided
the same, and nothing hears impacts: excess=0.25 bursts=nan apart=40 misfit=1.4 -> undecided
faces alone differ, halves are far better: excess=0.25 bursts=0.8 apart=40 misfit=9 -> delaminated
a channel is saturated: clipped=0.01 -> undecided
the sweep does not pass the resonance: end_response=0.98 -> undecided
the times are in ms: resonance=0.046 -> undecided
the halves explain it hardly better: misfit=1.1 -> undecided
the same, and the faces move apart: misfit=1.0 apart=4 -> delaminated
they move apart, and one mass explains it as well: misfit=0.86 apart=4 -> undecided
they move apart, and nothing explains it: other=3.5 misfit=4.77 apart=4 -> not described
"""  # what is changed of a record that opens -> its verdict
MISFITS = {"misfit": "sound_misfit", "other": "delaminated_misfit"}


STOPS = {  # and what is named
    "saturated": ({"clipped": 0.012}, "1.2 % of a channel's samples", "larger range"),
    "a short sweep": ({"end_response": 0.98}, "does not pass the resonance", "passes the reson"),
    "times in ms": ({"resonance": 0.046}, "a factor of 913 from the guess's", "in s"),
    "noise": ({"hidden": 0.19}, "hides an order 2 of up to 19 %", "less noise"),
    "misfit": ({"sound_misfit": 1.3}, "1.3, where at most 1.2 describes", ""),
}


@pytest.mark.parametrize("name", STOPS)
def test_what_keeps_a_quiet_record_from_its_verdict_is_named(name):
    changes, reason, advice = STOPS[name]
    assert QUIET.verdict() == "no opening seen" and not QUIET.stops
    stopped = replace(QUIET, **changes)
    assert stopped.verdict() == "undecided"
    assert reason in stopped.reason() and advice in stopped.next_measurement()


def test_what_keeps_a_record_from_being_called_delaminated_is_named():
    partly = replace(OPENED, sound_misfit=1.216, share=0.7)
    assert "the first is 1.52 times the second" in partly.reason()
    assert "exceeds 1.5 in 0.7 of the records" in partly.reason() and "0.75" in partly.reason()
    cracked = replace(OPENED, alike=PositiveStop.alike, sound_misfit=1)
    assert "a breathing crack or a clamp with play describes it" in cracked.reason()
    missed = replace(OPENED, apart=4.0, sound_misfit=4.77, delaminated_misfit=3.5)
    assert "misfit is 3.5, where at most 3 describes" in missed.reason()
    torsion = replace(OPENED, excess=0.25, bursts=0.8, apart=40.0, sound_misfit=1.4)
    assert "two modes of a sound beam" in torsion.reason()
    assert "opposite" in torsion.next_measurement()
    assert OPENED.stops == []


@pytest.mark.parametrize("case", CASES.strip().splitlines())
def test_each_case_has_its_word(case):
    changes, _, expected = case.rpartition(": ")[2].partition("-> ")
    pairs = (change.split("=") for change in changes.split())
    findings = replace(OPENED, **{MISFITS.get(n, n): float(value) for n, value in pairs})
    assert findings.verdict() == expected
    advice = findings.next_measurement()
    assert advice and "intact" not in f"{advice} {findings.reason()} {findings.seen_up_to()}"


def test_the_reason_has_the_numbers_that_decided():
    text = OPENED.reason()
    assert "misfit of 1 is" in text
    assert "20 %" in text and "10 times" in text and "0.8" in text and "3.8 times" in text


def test_a_verdict_by_a_model_that_describes_the_record_only_so_well_says_so():
    hardly_better = replace(OPENED, sound_misfit=1.0, apart=4.0)
    fits = SimpleNamespace(job=SimpleNamespace(sound=[1]), misfit=np.array([3.0, 0.8, 3.1]))
    assert hardly_better.verdict() == "delaminated"
    assert "describe this structure only so well" in hardly_better.reason()
    assert not stated_hypotheses(fits, hardly_better).any()
    assert "only so well" not in replace(OPENED, apart=4.0).reason()
    assert stated_hypotheses(fits, replace(OPENED, apart=4.0)).tolist() == [False, True, False]
    assert "the first is 1.2 times the second, where 1.1 times is enough" in hardly_better.reason()


def test_what_strikes_is_named_and_what_was_not_listened_for_too():
    assert "strikes" not in QUIET.reason() and "too slowly" not in QUIET.seen_up_to()
    assert "strikes once a period" in replace(QUIET, bursts=3.0).reason()
    assert "sampled too slowly" in replace(QUIET, bursts=float("nan")).seen_up_to()
    assert "sampled too slowly" in replace(OPENED, bursts=float("nan")).reason()


def test_numbers_at_their_bounds_are_reported_with_slopes():
    evidence = Evidence.from_record(record())
    hypothesis = Delaminated(BEAM)
    values = {**hypothesis.values_from_structure(BEAM, evidence), "e": 0.0}
    del values["clearance"]
    for e in (0.0, 1.0):
        with_e = {**values, "e": e}
        slopes = reported_derivatives(hypothesis, with_e, evidence)
        assert slopes.shape == (5, 5) and np.isfinite(slopes).all()
    assert slopes[0, 0] == pytest.approx(BEAM.f1 / values["common"], rel=1e-4)


def test_a_ratio_that_one_part_of_the_record_makes_is_not_certain():
    rng = np.random.default_rng(1)
    one = rng.standard_normal((1, 4, 200))
    assert resampled_share(3.0 * one, one, 1.5) == 1.0
    assert resampled_share(one, one, 1.5) == 0.0
    burst = one.copy()
    burst[..., 50:60] *= 12.0
    assert 0.02 < resampled_share(burst, one, 1.5) < SETTINGS.share


def test_a_factor_outside_a_range():
    assert (factor_outside(10.0, 20.0, 30.0), factor_outside(45.0, 20.0, 30.0)) == (2.0, 1.5)


def test_a_number_beyond_its_limit_is_not_written_as_the_limit():
    """It read: a misfit of 1.2, where at most 1.2 describes a record."""
    beyond = replace(QUIET, sound_misfit=1.203, delaminated_misfit=1.203)
    assert "misfit is 1.203, where at most 1.2 describes" in replace(beyond).reason()
    assert "1.004 times the size" in replace(OPENED, excess=1.0041).reason()
