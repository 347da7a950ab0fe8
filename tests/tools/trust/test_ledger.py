"""Records, the page that is made from them, and the command."""

from __future__ import annotations

import dataclasses
import json
import shutil

import pytest

from tools.trust import __main__ as ledger
from tools.trust import ledger_file, ledger_page
from tools.trust.campaign import BatchOutcome, Campaign
from tools.trust.job import batch_seed, sources_digest
from tools.trust.registry import CAMPAIGNS


class Count(Campaign):
    """A campaign that finds every seventh."""

    name, title, asks, unit = "count", "Counting", "Nothing is a seventh.", "numbers"
    target, batch, measures = 100, 10, "remainder"
    begun: list[int] = []

    def run(self, fmu, seed, count):
        self.begun.append(count)
        return BatchOutcome(count, count // 7, float(count % 7), {"calls:": 1}, ("a seventh",))


@pytest.fixture
def counting(monkeypatch, exported):
    Count.begun.clear()
    monkeypatch.setitem(CAMPAIGNS, "count", Count())


def test_page_and_records_belong_together():
    assert ledger_page.PAGE.read_text("utf-8") == ledger_page.page_text(ledger_file.read_entries())


def test_every_record_is_of_a_campaign_and_no_run_is_there_twice():
    found = ledger_file.read_entries()
    assert {record.campaign for record in found} <= set(CAMPAIGNS)
    assert not any(one.is_copy(other) for i, one in enumerate(found) for other in found[:i])
    assert all(record.done > 0 and record.seconds > 0.0 for record in found)


def test_a_run_is_recorded_once_and_goes_on_where_it_was(counting, tmp_path, monkeypatch):
    monkeypatch.setattr(ledger_file, "LEDGER", tmp_path / "trust.jsonl")
    first = ledger.run_campaign(Count(), 3, 25, tmp_path, jobs=1, progress=False)
    assert (first.done, first.findings, first.worst, first.counts) == (25, 2, 5.0, {"calls:": 3})
    assert first.notes == ["a seventh"] * 3 and Count.begun == [10, 10, 5]
    again = ledger.run_campaign(Count(), 3, 25, tmp_path, jobs=1, progress=False)
    assert len(Count.begun) == 3, "it was computed again"
    place = tmp_path / "trust.jsonl"
    assert ledger_file.append_entry(first, place) and not ledger_file.append_entry(again, place)
    assert len(place.read_text().splitlines()) == 1
    assert ledger_file.read_entries(place) == [first]
    assert "home" not in place.read_text() and json.loads(place.read_text())["fmu"]


def test_every_run_has_its_line_and_what_it_found_counts(counting, tmp_path):
    """The same command found nothing at first; a later run of it does."""
    place = tmp_path / "trust.jsonl"
    later = ledger.run_campaign(Count(), 3, 25, tmp_path, jobs=1, progress=False)
    first = dataclasses.replace(later, findings=0, notes=[], seconds=0.5)
    shorter = dataclasses.replace(later, budget=10, done=10, findings=3, notes=["a third"])
    for record in (first, later, shorter):
        assert ledger_file.append_entry(record, place)
    found = ledger_file.read_entries(place)
    assert found == [first, later, shorter]
    text = ledger_page.page_text(found)
    assert "25 numbers of 100 wanted; 3 findings." in text
    assert "| 100 numbers | 25 | 3 |" in text
    assert text.count("- a seventh") == 1 and "- a third" in text
    assert text.count("`python -m tools.trust run count --seed 3") == 3


@pytest.mark.parametrize("name", ["weak_drive/compiled.c", "explorer/page/app.js", "errors.py"])
def test_what_was_attacked_is_known_by_all_of_its_sources(tmp_path, name):
    folder = tmp_path / "orchestrate"
    shutil.copytree(ledger_file.PACKAGE, folder, ignore=shutil.ignore_patterns("__pycache__"))
    before = ledger_file.digest(folder)
    assert before == ledger_file.digest(ledger_file.PACKAGE)
    (folder / name).write_text((folder / name).read_text() + "\n")
    changed = ledger_file.digest(folder)
    (folder / name).rename(folder / f"other{(folder / name).suffix}")
    assert len({before, changed, ledger_file.digest(folder)}) == 3


def test_a_record_says_by_which_campaigns(counting, tmp_path):
    record = ledger.run_campaign(Count(), 3, 25, tmp_path, jobs=1, progress=False)
    assert record.campaigns == sources_digest()
    other = dataclasses.replace(record, campaigns="another")
    assert ledger_page.latest_longest([record, other], Count()) == [record, other]


def test_the_page_says_what_is_missing(counting, tmp_path):
    record = ledger.run_campaign(Count(), 3, 25, tmp_path, jobs=1, progress=False)
    text = ledger_page.page_text([record])
    assert "25 numbers of 100 wanted; 2 findings." in text
    assert "What is missing would take" in text
    assert "Worst remainder: 5, in batch" in text
    assert "`python -m tools.trust run count --seed 3 --budget 25`" in text


def test_no_batch_counts_twice(counting, tmp_path):
    few, many, other = (
        ledger.run_campaign(Count(), seed, budget, tmp_path, jobs=1, progress=False)
        for seed, budget in ((3, 10), (3, 25), (4, 10))
    )
    assert ledger_page.latest_longest([few, many, other], Count()) == [many, other]
    before = dataclasses.replace(many, fmu="{another}")
    assert ledger_page.latest_longest([before, few, other], Count()) == [few, other]


def test_seeds_of_batches_have_nothing_in_common():
    assert len({batch_seed(seed, batch) for seed in range(50) for batch in range(50)}) == 2500


def test_the_command(counting, capsys):
    assert ledger.main(["list"]) == 0
    told = capsys.readouterr().out
    assert all(name in told for name in CAMPAIGNS)
    with pytest.raises(SystemExit):
        ledger.main(["run", "nothing", "--seed", "1", "--budget", "1"])
