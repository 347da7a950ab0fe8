"""The manual's page of the ledger, made from the records."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .campaign import Campaign
from .records import Record
from .registry import CAMPAIGNS

PAGE = Path(__file__).resolve().parents[2] / "docs" / "trust.md"
REPOSITORY = "https://github.com/vibroimpact/vibroimpact/blob/main"
HEAD = f"""\
# The ledger of trust

What is promised is attacked: by campaigns that draw their attacks from a seed and say what they
found. This page is made from their records, [`trust.jsonl`]({REPOSITORY}/docs/trust.jsonl), by
`python -m tools.trust page`; a test keeps both together. A campaign's figures are the sum of its
runs on the FMU (or, where the package is attacked, its sources) that was attacked last; of several
runs with one seed and the same campaigns, that with the most batches counts, and all that any of
them found. Every run has its line, also where it repeats another. Each is
repeated by its command, in a clone; `python -m tools.trust list` names the campaigns.

What a campaign finds becomes a test, then is mended. A short form of each campaign is among the
ordinary tests, a longer one among the slow ones. What is trusted, what is checked and how to
report: [SECURITY.md]({REPOSITORY}/SECURITY.md).

"""
TABLE = ["| campaign | target | reached | findings |", "|---|---|---|---|"]


def together(records: Sequence[Record], campaign: Campaign) -> list[Record]:
    """Return a campaign's runs on the last version it attacked, of each seed the longest."""
    return longest(all_of(records, campaign))


def all_of(records: Sequence[Record], campaign: Campaign) -> list[Record]:
    """Return all of a campaign's runs on the last version it attacked."""
    own = [record for record in records if record.campaign == campaign.name]
    return [record for record in own if same(record, own[-1])]


def batches(record: Record) -> tuple[str, int, str, str]:
    """Return campaign, seed, subject and campaigns' digest: they identify a run's batches."""
    return record.campaign, record.seed, subject(record), record.campaigns


def findings(records: Sequence[Record]) -> int:
    """Count findings; of runs with the same batches only the one with the most counts."""
    most: dict[tuple[str, int, str, str], int] = {}
    for record in records:
        most[batches(record)] = max(most.get(batches(record), 0), record.findings)
    return sum(most.values())


def longest(records: Sequence[Record]) -> list[Record]:
    """Return, for each seed and subject, the run that contains the batches of the others."""
    latest = {batches(r): r for r in sorted(records, key=lambda one: one.budget)}
    return [record for record in records if any(record is other for other in latest.values())]


def same(one: Record, other: Record) -> bool:
    """Return whether two runs attacked the same subject."""
    return subject(one) == subject(other)


def subject(record: Record) -> str:
    """Return what a run attacked."""
    return record.package if CAMPAIGNS[record.campaign].package else record.fmu


def number(value: float) -> str:
    """Format a count with separators."""
    return f"{value:,.0f}"


def summary(records: Sequence[Record]) -> list[str]:
    """Return the lines of a table, one campaign per row."""
    lines = list(TABLE)
    for campaign in CAMPAIGNS.values():
        done = sum(r.done for r in together(records, campaign))
        count_of_findings = findings(all_of(records, campaign))
        target = f"{number(campaign.target)} {campaign.unit}"
        link = f"[{campaign.title}](#trust-{campaign.name})"
        lines.append(f"| {link} | {target} | {number(done)} | {number(count_of_findings)} |")
    return lines


def reached(campaign: Campaign, every: Sequence[Record], before: Sequence[Record]) -> list[str]:
    """Format how much was done and found, and how long the missing part would take."""
    runs = longest(every)
    done, seconds = sum(r.done for r in runs), sum(r.seconds for r in runs)
    count_of_findings = findings(every)
    lines = [
        f"{number(done)} {campaign.unit} of {number(campaign.target)} wanted; "
        f"{number(count_of_findings)} findings.",
        f"Rate: {number(3600.0 * done / max(seconds, 1e-9))} {campaign.unit} an hour of one core.",
    ]
    if done < campaign.target:
        hours = (campaign.target - done) / done * seconds / 3600.0
        lines.append(f"What is missing would take {hours:.1f} hours of one core at this rate.")
    if before:
        done = sum(record.done for record in longest(before))
        lines.append(
            f"Before, on other sources: {number(done)} {campaign.unit}, "
            f"{number(findings(before))} findings."
        )
    if campaign.measures:
        worst = max(runs, key=lambda record: record.worst)
        lines.append(f"Worst {campaign.measures}: {worst.worst:.3g}, in batch {worst.worst_seed}.")
    counts: Counter[str] = Counter()
    for record in runs:
        counts.update(record.counts)
    if counts:
        parts = (f"{name} {number(value)}" for name, value in sorted(counts.items()))
        lines.append(f"Counted: {', '.join(parts)}.")
    return lines


def rows_of(runs: Sequence[Record]) -> list[list[Any]]:
    """Return the measured rows of the longest runs of each seed."""
    return [row for record in longest(runs) for row in record.rows]


def draw(records: Sequence[Record], folder: Path = PAGE.parent) -> None:
    """Draw the pictures of all campaigns."""
    for campaign in CAMPAIGNS.values():
        rows = rows_of(all_of(records, campaign))
        if rows:
            campaign.draw(rows, folder)


def section(campaign: Campaign, runs: Sequence[Record], before: Sequence[Record]) -> list[str]:
    """Return the lines of one campaign."""
    lines = [f"(trust-{campaign.name})=", f"## {campaign.title}", "", campaign.asks, ""]
    if not runs:
        return [*lines, "Not run yet.", ""]
    lines += [*reached(campaign, runs, before), ""]
    rows = rows_of(runs)
    lines += campaign.report(rows) if rows else []
    lines += [f"- {note}" for note in dict.fromkeys(n for record in runs for n in record.notes)]
    if lines[-1]:
        lines.append("")
    lines += ["| command | done | findings | date | version |", "|---|---|---|---|---|"]
    for r in runs:
        cells = [f"`{r.command()}`", number(r.done), number(r.findings), r.date, r.version]
        lines.append(f"| {' | '.join(cells)} |")
    return [*lines, ""]


def about(records: Sequence[Record]) -> list[str]:
    """Format what was attacked, and where."""
    guids = sorted({r.fmu for c in CAMPAIGNS.values() for r in together(records, c)})
    machines = sorted({r.machine for r in records})
    lines = ["## What was attacked, and where", ""]
    lines += [f"- the FMU with the instantiation token `{guid}`" for guid in guids]
    lines += [f"- on: {machine}" for machine in machines]
    return [*lines, ""]


def text(records: Sequence[Record]) -> str:
    """Return the whole page as Markdown."""
    lines = [*summary(records), ""]
    for campaign in CAMPAIGNS.values():
        runs = all_of(records, campaign)
        own = [record for record in records if record.campaign == campaign.name]
        before = [record for record in own if not same(record, runs[-1])]
        lines += section(campaign, runs, before)
    return HEAD + "\n".join([*lines, *about(records)])
