"""Records, the page that is made from them, and the command."""

from __future__ import annotations

import dataclasses
import json

import pytest

from tools.trust import __main__ as ledger
from tools.trust import page, records
from tools.trust.campaign import Campaign, Outcome, batch_seed
from tools.trust.registry import CAMPAIGNS


class Count(Campaign):
    """A campaign that finds every seventh."""

    name, title, asks, unit = "count", "Counting", "Nothing is a seventh.", "numbers"
    target, batch, measures = 100, 10, "remainder"
    begun: list[int] = []

    def run(self, fmu, seed, count):
        self.begun.append(count)
        return Outcome(count, count // 7, float(count % 7), {"calls:": 1}, ("a seventh",))


@pytest.fixture
def counting(monkeypatch, exported):
    Count.begun.clear()
    monkeypatch.setitem(CAMPAIGNS, "count", Count())


def test_page_and_records_belong_together():
    assert page.PAGE.read_text("utf-8") == page.text(records.read())


def test_every_record_is_of_a_campaign_and_none_is_there_twice():
    found = records.read()
    assert {record.campaign for record in found} <= set(CAMPAIGNS)
    assert not any(one.is_again(other) for i, one in enumerate(found) for other in found[:i])
    assert all(record.done > 0 and record.seconds > 0.0 for record in found)


def test_a_run_is_recorded_once_and_goes_on_where_it_was(counting, tmp_path, monkeypatch):
    monkeypatch.setattr(records, "RECORDS", tmp_path / "trust.jsonl")
    first = ledger.run(Count(), 3, 25, tmp_path, jobs=1, progress=False)
    assert (first.done, first.findings, first.worst, first.counts) == (25, 2, 5.0, {"calls:": 3})
    assert first.notes == ["a seventh"] * 3 and Count.begun == [10, 10, 5]
    again = ledger.run(Count(), 3, 25, tmp_path, jobs=1, progress=False)
    assert len(Count.begun) == 3, "it was computed again"
    place = tmp_path / "trust.jsonl"
    assert records.append(first, place) and not records.append(again, place)
    assert len(place.read_text().splitlines()) == 1
    assert records.read(place) == [first]
    assert "home" not in place.read_text() and json.loads(place.read_text())["fmu"]


def test_the_page_says_what_is_missing(counting, tmp_path):
    record = ledger.run(Count(), 3, 25, tmp_path, jobs=1, progress=False)
    text = page.text([record])
    assert "25 numbers of 100 wanted; 2 findings." in text
    assert "What is missing would take" in text
    assert "Worst remainder: 5, in batch" in text
    assert "`python -m tools.trust run count --seed 3 --budget 25`" in text


def test_no_batch_counts_twice(counting, tmp_path):
    few, many, other = (
        ledger.run(Count(), seed, budget, tmp_path, jobs=1, progress=False)
        for seed, budget in ((3, 10), (3, 25), (4, 10))
    )
    assert page.together([few, many, other], Count()) == [many, other]
    before = dataclasses.replace(many, fmu="{another}")
    assert page.together([before, few, other], Count()) == [few, other]


def test_seeds_of_batches_have_nothing_in_common():
    assert len({batch_seed(seed, batch) for seed in range(50) for batch in range(50)}) == 2500


def test_the_command(counting, capsys):
    assert ledger.main(["list"]) == 0
    told = capsys.readouterr().out
    assert all(name in told for name in CAMPAIGNS)
    with pytest.raises(SystemExit):
        ledger.main(["run", "nothing", "--seed", "1", "--budget", "1"])
