"""The rule of the verdict, number by number."""

from dataclasses import replace

import numpy as np
import pytest

from orchestrate.diagnosis.decision_rule import Findings, resampled_share
from orchestrate.diagnosis.evidence import Evidence
from orchestrate.diagnosis.fit import reported_derivatives
from orchestrate.diagnosis.hypotheses import Delaminated

from .records import BEAM, record

OPENED = Findings(
    excess=10.0,
    order2=0.2,
    apart=0.0,
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
)
CASES = {
    "opens, and the halves explain it": ({}, "delaminated"),
    "no order 2, one mass explains it": ({"excess": 0.3, "sound_misfit": 0.3}, "no opening seen"),
    "no order 2, and nothing explains it": (
        {"excess": 0.3, "delaminated_misfit": 3.5, "sound_misfit": 6.0},
        "not described",
    ),
    "no order 2, but the halves alone explain it": ({"excess": 0.3}, "undecided"),
    "order 2, both explain it": ({"sound_misfit": 0.9}, "undecided"),
    "order 2, one mass explains it better": (
        {"sound_misfit": 0.2, "delaminated_misfit": 1.2},
        "undecided",
    ),
    "order 2, and nothing explains it": (
        {"delaminated_misfit": 3.5, "sound_misfit": 6.0},
        "not described",
    ),
    "better, but not in most parts of the record": ({"share": 0.6}, "undecided"),
    "no order 2, but the faces move apart": ({"excess": 0.2, "apart": 4.0}, "delaminated"),
}


@pytest.mark.parametrize("name", CASES)
def test_each_case_has_its_word(name):
    changes, expected = CASES[name]
    findings = replace(OPENED, **changes)
    assert findings.verdict() == expected
    assert findings.next_measurement()
    assert (
        "intact" not in f"{findings.next_measurement()} {findings.reason()} {findings.seen_up_to()}"
    )


def test_the_reason_has_the_numbers_that_decided():
    text = OPENED.reason()
    assert "20 %" in text and "10 times" in text and "0.8" in text and "3.8 times" in text


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
    assert resampled_share(3.0 * one, one) == 1.0
    assert resampled_share(one, one) == 0.0
    burst = one.copy()
    burst[..., 50:60] *= 12.0
    assert 0.02 < resampled_share(burst, one) < 0.98
