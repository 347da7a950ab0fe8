"""No root is missed: adversarial states against a dense search, and in high precision."""

from pathlib import Path

import mpmath as mp
import numpy as np

from tools import exact_motion as truth

from . import flights

ROOT = Path(__file__).resolve().parents[3]


def counts(verdicts):
    """How many flights have each verdict."""
    return [int(n) for n in np.bincount(verdicts, minlength=5)]


def test_thousands_of_states_end_on_their_first_root():
    _, verdicts, ends = flights.campaign(1, 1050)
    ok, missed, wrong, unfinished, skipped = counts(verdicts)
    assert missed == wrong == unfinished == 0
    assert skipped < 150
    assert np.count_nonzero((ends > 0.0) & (ends < 3.0)) > 250


def test_a_sample_in_high_precision():
    rows, verdicts, ends = flights.campaign(2, 70)
    for i, (row, verdict, end) in enumerate(zip(rows, verdicts, ends, strict=True)):
        if verdict != flights.OK:
            continue
        values = {"m1": 1.0, "k1": 1.0, **dict(zip(flights.NAMES, map(float, row), strict=True))}
        state = [values[f"{name}_start"] for name in ("x1", "v1", "x2", "v2")]
        phase, kind = mp.mpf(values["phase_start"]), i % len(flights.CLASSES)
        if kind == flights.CONTACT:
            gap = truth.contact_motion(values, *state[:2], phase)[1]
        else:
            first, second = truth.free_motion(values, state, phase)
            gap = second - first
        touching = kind != flights.CONTACT and values["x1_start"] == values["x2_start"]
        blind = 0.5 * float(end) if touching else 0.0
        root = truth.first_root(gap, float(end) + 0.1, blind)
        if end == flights.HORIZONS[kind]:
            assert root is None or root > end * (1.0 - 1e-12), i
        else:
            assert root is not None, i
            slope = abs(float(gap.derivative()(root)))
            terms = sum(abs(complex(c)) for c, _ in gap.terms)
            terms += sum(abs(float(q)) * float(end) ** k for k, q in enumerate(gap.polynomial))
            assert abs(float(root) - end) <= 1e-14 * (1.0 + end) * (1.0 + terms / slope), i
