"""Make the manual's page docs/trust.md from the ledger's entries."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .campaign import Campaign
from .ledger_file import LedgerEntry
from .registry import CAMPAIGNS

PAGE = Path(__file__).resolve().parents[2] / "docs" / "trust.md"
REPOSITORY = "https://github.com/vibroimpact/vibroimpact/blob/main"
HEAD = f"""\
# The ledger of trust

What is promised is attacked: by campaigns that draw their attacks from a seed and say what they
found. This page is made from their entries, [`trust.jsonl`]({REPOSITORY}/docs/trust.jsonl), by
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


def latest_longest(entries: Sequence[LedgerEntry], campaign: Campaign) -> list[LedgerEntry]:
    """Return a campaign's entries on its last subject, the longest of each seed."""
    return keep_longest(latest_entries(entries, campaign))


def latest_entries(entries: Sequence[LedgerEntry], campaign: Campaign) -> list[LedgerEntry]:
    """Return all of a campaign's entries on the last subject it attacked."""
    own = [entry for entry in entries if entry.campaign == campaign.name]
    return [entry for entry in own if has_same_subject(entry, own[-1])]


def batch_key(entry: LedgerEntry) -> tuple[str, int, str, str]:
    """Return campaign, seed, subject and sources' digest, which identify a run's batches."""
    return entry.campaign, entry.seed, subject(entry), entry.campaigns


def count_findings(entries: Sequence[LedgerEntry]) -> int:
    """Count findings; of runs with the same batches, the one with the most counts."""
    most: dict[tuple[str, int, str, str], int] = {}
    for entry in entries:
        most[batch_key(entry)] = max(most.get(batch_key(entry), 0), entry.findings)
    return sum(most.values())


def keep_longest(entries: Sequence[LedgerEntry]) -> list[LedgerEntry]:
    """Return, for each seed and subject, the run that contains the others' batches."""
    latest = {batch_key(r): r for r in sorted(entries, key=lambda one: one.budget)}
    return [entry for entry in entries if any(entry is other for other in latest.values())]


def has_same_subject(one: LedgerEntry, other: LedgerEntry) -> bool:
    """Return whether two runs attacked the same subject."""
    return subject(one) == subject(other)


def subject(entry: LedgerEntry) -> str:
    """Return what a run attacked: the FMU's GUID or the package's digest."""
    return entry.package if CAMPAIGNS[entry.campaign].package else entry.fmu


def format_count(value: float) -> str:
    """Format a count with thousands separators."""
    return f"{value:,.0f}"


def summary_table(entries: Sequence[LedgerEntry]) -> list[str]:
    """Return the Markdown table of campaigns: target, done, findings."""
    lines = list(TABLE)
    for campaign in CAMPAIGNS.values():
        done = sum(r.done for r in latest_longest(entries, campaign))
        count_of_findings = count_findings(latest_entries(entries, campaign))
        target = f"{format_count(campaign.target)} {campaign.unit}"
        link = f"[{campaign.title}](#trust-{campaign.name})"
        lines.append(
            f"| {link} | {target} | {format_count(done)} | {format_count(count_of_findings)} |"
        )
    return lines


def progress_lines(
    campaign: Campaign, every: Sequence[LedgerEntry], before: Sequence[LedgerEntry]
) -> list[str]:
    """Return lines on how much was done and found, and how long the rest would take."""
    runs = keep_longest(every)
    done, seconds = sum(r.done for r in runs), sum(r.seconds for r in runs)
    count_of_findings = count_findings(every)
    lines = [
        f"{format_count(done)} {campaign.unit} of {format_count(campaign.target)} wanted; "
        f"{format_count(count_of_findings)} findings.",
        f"Rate: {format_count(3600.0 * done / max(seconds, 1e-9))} {campaign.unit} an hour of one "
        "core.",
    ]
    if done < campaign.target:
        hours = (campaign.target - done) / done * seconds / 3600.0
        lines.append(f"What is missing would take {hours:.1f} hours of one core at this rate.")
    if before:
        done = sum(entry.done for entry in keep_longest(before))
        lines.append(
            f"Before, on other sources: {format_count(done)} {campaign.unit}, "
            f"{format_count(count_findings(before))} findings."
        )
    if campaign.measures:
        worst = max(runs, key=lambda entry: entry.worst)
        lines.append(f"Worst {campaign.measures}: {worst.worst:.3g}, in batch {worst.worst_seed}.")
    counts: Counter[str] = Counter()
    for entry in runs:
        counts.update(entry.counts)
    if counts:
        parts = (f"{name} {format_count(value)}" for name, value in sorted(counts.items()))
        lines.append(f"Counted: {', '.join(parts)}.")
    return lines


def measured_rows(runs: Sequence[LedgerEntry]) -> list[list[Any]]:
    """Return the measured rows of each seed's longest run."""
    return [row for entry in keep_longest(runs) for row in entry.rows]


def draw_pictures(entries: Sequence[LedgerEntry], folder: Path = PAGE.parent) -> None:
    """Draw the pictures of all campaigns."""
    for campaign in CAMPAIGNS.values():
        rows = measured_rows(latest_entries(entries, campaign))
        if rows:
            campaign.draw(rows, folder)


def campaign_section(
    campaign: Campaign, runs: Sequence[LedgerEntry], before: Sequence[LedgerEntry]
) -> list[str]:
    """Return the Markdown lines of one campaign."""
    lines = [f"(trust-{campaign.name})=", f"## {campaign.title}", "", campaign.asks, ""]
    if not runs:
        return [*lines, "Not run yet.", ""]
    lines += [*progress_lines(campaign, runs, before), ""]
    rows = measured_rows(runs)
    lines += campaign.report(rows) if rows else []
    lines += [f"- {note}" for note in dict.fromkeys(n for entry in runs for n in entry.notes)]
    if lines[-1]:
        lines.append("")
    lines += ["| command | done | findings | date | version |", "|---|---|---|---|---|"]
    for r in runs:
        cells = [
            f"`{r.command()}`",
            format_count(r.done),
            format_count(r.findings),
            r.date,
            r.version,
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return [*lines, ""]


def machine_section(entries: Sequence[LedgerEntry]) -> list[str]:
    """Return the Markdown lines on the FMUs attacked and the machines used."""
    guids = sorted({r.fmu for c in CAMPAIGNS.values() for r in latest_longest(entries, c)})
    machines = sorted({r.machine for r in entries})
    lines = ["## What was attacked, and where", ""]
    lines += [f"- the FMU with the instantiation token `{guid}`" for guid in guids]
    lines += [f"- on: {machine}" for machine in machines]
    return [*lines, ""]


def page_text(entries: Sequence[LedgerEntry]) -> str:
    """Return the whole page as Markdown."""
    lines = [*summary_table(entries), ""]
    for campaign in CAMPAIGNS.values():
        runs = latest_entries(entries, campaign)
        own = [entry for entry in entries if entry.campaign == campaign.name]
        before = [entry for entry in own if not has_same_subject(entry, runs[-1])]
        lines += campaign_section(campaign, runs, before)
    return HEAD + "\n".join([*lines, *machine_section(entries)])
