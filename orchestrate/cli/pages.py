"""Commands beside the questions: build, explore, report, paper."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..lazy import xr
from .answer import read_earlier_result
from .grammar import parse_changes
from .options import read_structure_options, structure_group
from .output import (
    COLUMNS,
    READING,
    UNITS,
    check_output,
    read_running_options,
    read_units,
    refuse_units,
    running_group,
)
from .stored import print_difference, structure_of
from .table import Command, Group, values_of


def run_build(arguments: argparse.Namespace) -> None:
    """Run ``build``: export the FMUs of the chosen models and forms; print their paths."""
    refuse_units(arguments, "FMUs are in SI")
    from ..fmu import FORMS, PLAIN_FORMS, build, build_libraries, build_web_kernels, sources_of

    if arguments.folder is not None:
        check_output(arguments.folder, "--folder")
    forms = PLAIN_FORMS if arguments.plain else FORMS
    platforms = [name for name in (arguments.platforms or "").split(",") if name]
    if arguments.sources_only:
        if platforms:
            raise InputError("--platforms with --sources-only: expected one of them")
        forms = sources_of(forms)
    made = build(arguments.folder, forms, platforms=platforms)
    if not (arguments.plain or arguments.sources_only):
        made += build_libraries(arguments.folder, platforms)
        made += build_web_kernels(arguments.folder)
    for path in made:
        print(f"{path}  {path.stat().st_size / 1024:.0f} kB")


BUILD = Command(
    "build",
    "export the FMUs, each form with the same variables and numbers, and compile the master "
    "and the explorer's kernels",
    """  {program} build
  {program} build --folder /tmp/fmus
  {program} build --platforms all
  {program} build --plain
  {program} build --sources-only""",
    (
        Group(
            options="""
            --folder FOLDER  where to (default: build/ of a clone, else a cache folder of the
                user's)
            --platforms LIST  binaries in the native FMUs: all, this, or names such as
                aarch64-linux,x86_64-darwin (default: Linux and Windows on x86-64, and this machine)
            --plain  instead, into fmi2-plain/ and fmi3-plain/: native FMUs for tools that stumble
                over arrays, clocks or long lists of variables; the same numbers
            --sources-only  instead, into fmi2-sources/ and fmi3-sources/ (with --plain:
                fmi2-plain-sources/, fmi3-plain-sources/): native FMUs without binaries, for targets
                that compile the C sources inside; no compiler is needed here
            """
        ),
        UNITS,
    ),
    run_build,
)


def read_diagram(arguments: argparse.Namespace, branches: xr.Dataset | None) -> Any:
    """Return the sweep of RESULT, or else the structure: asked for, of ``--branches``, or usual."""
    drawn = None if branches is None else structure_of("--branches", arguments.branches, branches)
    data: Any
    if arguments.result is not None:
        if arguments.set or arguments.structure:
            raise InputError(f"{arguments.result} with --structure or --set: expected one of them")
        data = read_earlier_result("RESULT", arguments.result)
        structure = structure_of("RESULT", arguments.result, data) if drawn else None
    elif drawn and not arguments.structure:
        data = structure = drawn.replace(**parse_changes(arguments.set))
    else:
        arguments.structure = arguments.structure or "paper"
        data = structure = read_structure_options(arguments)
    if drawn and structure:
        print_difference("--branches", arguments.branches, drawn, structure)
    return data


def read_record_option(arguments: argparse.Namespace) -> xr.Dataset | None:
    """Read the file of ``--record``; None without one."""
    from .. import read_record

    reading = values_of(arguments, (COLUMNS, READING))
    given = [name for name, value in reading.items() if value]
    if arguments.record is None and given:
        raise InputError(f"--{given[0].replace('_', '-')}: expected with --record alone")
    return None if arguments.record is None else read_record(arguments.record, **reading)


def run_explore(arguments: argparse.Namespace) -> None:
    """Run ``explore``: write the explorer's HTML page and open it in the browser."""
    from ..explorer.page import explore

    record = read_record_option(arguments)
    branches = arguments.branches and read_earlier_result("--branches", arguments.branches)
    data = read_diagram(arguments, branches)
    page = explore(
        data,
        output=arguments.output,
        branches=branches,
        record=record,
        units=read_units(arguments),
        build_folder=arguments.build_folder,
    )
    print(f"{page}  {page.stat().st_size / 1024:.0f} kB")
    if not arguments.no_open:
        import webbrowser

        webbrowser.open(page.resolve().as_uri())


EXPLORE = Command(
    "explore",
    "open a page that shows orbit diagrams and motions, computed in the browser",
    """  {program} explore                              the paper's Figure 6
  {program} explore results/sweep_paper_7e3015.nc   an own sweep: a click replays its responses
  {program} explore --set e=0.3 --no-open --output page.html
  {program} explore --structure beam --record run.csv --unit g    a measurement beside the model""",
    (
        Group(
            options="result RESULT ?  NetCDF file of a sweep along the frequency (default: the "
            "paper's Figure 6)"
        ),
        structure_group("RESULT or --branches"),
        Group(
            "page",
            """
            --branches FILE  NetCDF file of branches over eta, drawn over the diagram
            --record FILE  measured record, drawn over the spectrum of a beam in Hz: of a swept sine
                its orders at the frequency that is shown
            --output FILE = explorer.html  the page
            --no-open  only write it
            --build-folder FOLDER  where the compiled kernel is looked for and put
            """,
        ),
        Group("how to read the record", (COLUMNS, READING)),
        UNITS,
    ),
    run_explore,
)


def run_report(arguments: argparse.Namespace) -> None:
    """Run ``report``: write stored results as one HTML page; print its path."""
    import orchestrate

    from ..files import open_folder

    check_output(arguments.output)
    answers = [read_earlier_result("FILE", path) for path in arguments.results]
    page = open_folder(arguments.output) / f"report_{arguments.results[0].stem}.html"
    words = {"title": arguments.title or "", "notes": arguments.notes or ""}
    print(orchestrate.report(*answers, output=page, **words, units=read_units(arguments)))


REPORT = Command(
    "report",
    "stored results as one page with pictures and numbers, to read, print and sign",
    """  {program} report results/sweep.nc --title Beam --notes November
  {program} report results/map.nc results/resonance.nc --output study""",
    (
        Group(
            options="results FILE.nc +  results of earlier commands; a verdict of diagnose is first"
        ),
        Group(
            "page",
            """
            --title WORDS  by default that of the first result
            --notes WORDS  below the title: what, who, when
            --output FOLDER = results  folder of the page
            """,
        ),
        UNITS,
    ),
    run_report,
)


def run_paper(arguments: argparse.Namespace) -> None:
    """Run ``paper``: compute its figures and numbers; print the claims; write the report."""
    refuse_units(arguments, "figures and numbers are those of the paper, ratios")
    from ..paper.reproduce import reproduce
    from ..paper.resolution import FULL, QUICK

    folder = Path("results") / ("paper-quick" if arguments.quick else "paper")
    output = arguments.output or folder
    check_output(output)
    figures = None if arguments.figures is None else arguments.figures.split(",")
    resolution = QUICK if arguments.quick else FULL
    outcome = reproduce(output, resolution, figures, read_running_options(arguments))
    for line in claim_lines(outcome.found):
        print(line)
    for picture in outcome.pictures.values():
        print(picture)
    print(outcome.report)


def claim_lines(verdicts: Mapping[str, Any]) -> Iterator[str]:
    """Yield the verdicts of claims and regions, a line each."""
    for row in verdicts["claims"]:
        text, printed = row["text"], row["printed"]
        verdict = f"{row['section']:4} {row['verdict']:7}"
        yield f"{verdict} {text}: paper {printed}, found {row['found']}"
    for row in verdicts["regions"]:
        shares = f"chaotic {row['chaotic']:5} neutral {row['neutral']:5}"
        where = f"{row['case']:18} {row['region']:13} {row['verdict']:16}"
        yield f"{where} {shares} largest {row['largest']}"


PAPER = Command(
    "paper",
    "the whole paper through the FMU: figures, claims, report",
    """  {program} paper                     all at the paper's resolution, into results/paper/
  {program} paper --quick             on fewer periods and points, in a minute or two
  {program} paper --figures 5,7       some of it
  {program} paper --cluster tcp://HOST:8786      on the workers of a running Dask scheduler
Repeat the command to resume an interrupted run. Finished data is left as it is.""",
    (
        Group(
            "question",
            """
            --figures NAME,...  some of it: 5 to 12, claims, lyapunov, attractors, basin, maps,
                spectra (default: all)
            --quick  reduced resolution: the same frequencies, fewer periods, starts and map points
            """,
        ),
        UNITS,
        running_group(
            "--output FOLDER  folder of the results (default: results/paper, with --quick "
            "results/paper-quick)"
        ),
    ),
    run_paper,
)
