"""The campaign on stated intervals: a trial, and its table."""

from __future__ import annotations

import numpy as np

from tools.trust import intervals
from tools.trust.intervals import IntervalCampaign


def test_a_trial_is_within_some_standard_errors(exported):
    found = IntervalCampaign().run(exported, 1, 1)
    assert found.done == 1 and found.findings == 0 and len(found.rows) == 1
    row = dict(zip(intervals.COLUMNS, found.rows[0], strict=True))
    assert 0.01 <= row["noise"] <= 0.05 and row["misfit"] < 1.0
    assert all(abs(row[name]) < 6.0 for name in intervals.FITTED)
    assert found.worst == max(abs(row[name]) for name in intervals.FITTED)


def test_the_table_has_the_share_of_each_number():
    rng = np.random.default_rng(2)
    rows = [[0.02, 0.3, *rng.standard_normal(5).tolist()] for _ in range(400)]
    for row in rows[:100]:
        row[2] = 3.0
    rows.append([0.02, 0.3, *[None] * 5])
    text = "\n".join(IntervalCampaign().report(rows))
    share = float(text.partition("`f1` | ")[2].partition(" %")[0])
    assert 68.0 < share < 75.0 and "`e` | 9" in text
    assert "In 1 of 401 records" in text
