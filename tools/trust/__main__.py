"""``python -m tools.trust list``, ``run CAMPAIGN --seed S --budget N``, ``keep``, ``page``.

A run enters a entry and writes the page anew. Of a run that was stopped, ``keep`` with the same
seed and budget enters what was done: the entry of a run with that smaller budget.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from orchestrate.access.exported import finder
from orchestrate.errors import InputError, VibroimpactError
from orchestrate.files import write_whole
from orchestrate.running.identity import identity_of
from orchestrate.running.options import RunOptions
from orchestrate.running.progress import Progress
from orchestrate.running.provenance import with_provenance
from orchestrate.running.runner import answer
from orchestrate.running.store import open_store

from . import ledger_file, ledger_page
from .campaign import Campaign
from .job import CampaignJob, sources_digest
from .registry import CAMPAIGNS

STORE = Path(__file__).resolve().parents[2] / "results" / "trust"


def print_campaigns() -> None:
    """Print the campaigns with their targets."""
    for campaign in CAMPAIGNS.values():
        print(f"{campaign.name:10s}{campaign.target:>14,} {campaign.unit}: {campaign.title}")


def run_campaign(
    campaign: Campaign, seed: int, budget: int, store: Path = STORE, **running: object
) -> ledger_file.LedgerEntry:
    """Run a campaign, or continue it; finished batches are reused; return its ledger entry."""
    job = make_job(campaign, seed, budget)
    path = store / f"{campaign.name}-{seed}-{budget}-{job.sources[:6]}.nc"
    result = answer(job, {"store": path, **running}, finder(running))
    return ledger_file.make_entry(campaign.name, seed, budget, result)


def keep_partial_run(
    campaign: Campaign, seed: int, budget: int, store: Path = STORE
) -> ledger_file.LedgerEntry:
    """Return a ledger entry for the first finished batches of a run that was stopped."""
    job = make_job(campaign, seed, budget)
    path = store / f"{campaign.name}-{seed}-{budget}-{job.sources[:6]}.nc"
    find = finder({})
    fmus = {model: find(model) for model in job.models}
    identity = identity_of(job, fmus, {})
    kept = open_store(job.name, identity, RunOptions.from_keywords({"store": path}))
    try:
        done = Progress(job, kept, identity, fmus).done_chunks
        count = next(number for number in range(len(done) + 1) if number not in done)
        if not count:
            raise InputError(f"{path}: holds no batch; expected a run that was begun")
        part = replace(job, budget=min(count * job.chunk_size * campaign.batch, budget))
        result = part.dataset(kept.table(count), {})
        result = with_provenance(result, part, identity, fmus, kept.begun)
    finally:
        kept.close()
    return ledger_file.make_entry(campaign.name, seed, part.budget, result)


def make_job(campaign: Campaign, seed: int, budget: int) -> CampaignJob:
    """Return a run of a campaign as a ``CampaignJob`` for the package's runner."""
    return CampaignJob(
        name=campaign.name,
        campaign=campaign.name,
        seed=seed,
        budget=budget,
        size=campaign.batch,
        sources=sources_digest(),
    )


def write_page() -> None:
    """Write docs/trust.md and its pictures from all ledger entries."""
    ledger_page.draw_pictures(ledger_file.read_entries())
    text = ledger_page.page_text(ledger_file.read_entries())
    write_whole(ledger_page.PAGE, lambda path: path.write_text(text, "utf-8"))


def parse_arguments(arguments: list[str] | None) -> argparse.Namespace:
    """Parse the command line's arguments."""
    parser = argparse.ArgumentParser(prog="python -m tools.trust", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("list", help="campaigns and their targets")
    commands.add_parser("page", help="write docs/trust.md from the entries")
    one = commands.add_parser("run", help="run a campaign, or go on with it")
    part = commands.add_parser("keep", help="enter what a run has done that was stopped")
    for parser_of in (one, part):
        parser_of.add_argument("campaign", choices=CAMPAIGNS)
        parser_of.add_argument("--seed", type=int, required=True)
        parser_of.add_argument("--budget", type=int, required=True, help="units to do")
    one.add_argument("--jobs", type=int, default=1, help="processes at once")
    one.add_argument("--cluster", help="address of a Dask scheduler")
    one.add_argument("--force", action="store_true", help="begin anew")
    return parser.parse_args(arguments)


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; return 1 if a campaign had findings."""
    options = parse_arguments(arguments)
    if options.command == "list":
        print_campaigns()
        return 0
    if options.command == "page":
        write_page()
        return 0
    what = CAMPAIGNS[options.campaign], options.seed, options.budget
    try:
        if options.command == "keep":
            entry = keep_partial_run(*what)
        else:
            running = {"jobs": options.jobs, "cluster": options.cluster, "force": options.force}
            entry = run_campaign(*what, **running)
    except VibroimpactError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    ledger_file.append_entry(entry)
    write_page()
    print(f"{entry.done:,} done, {entry.findings} findings, {entry.seconds:.1f} s")
    print("\n".join(entry.notes))
    return 1 if entry.findings else 0


if __name__ == "__main__":
    sys.exit(main())
