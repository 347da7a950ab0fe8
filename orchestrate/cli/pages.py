"""Commands other than the questions: build, explore, report, paper."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import orchestrate

from ..errors import InputError
from ..lazy import xr
from .command import Command, option, option_names
from .grammar import load_earlier_result
from .options import OfStored, print_structure_difference, stored_structure
from .output import HowRun, InFolder, InUnits, Reading, check_output_folder


class Build(Command):
    """Export the FMUs, each form with the same variables and numbers, and compile the master and
    the explorer's kernels.
    """

    folder: Path | None = option(
        "where to (default: build/ of a clone, else a cache folder of the user's)", value="FOLDER"
    )
    platforms: str | None = option(
        "binaries in the native FMUs: all, this, or names such as aarch64-linux,x86_64-darwin "
        "(default: Linux and Windows on x86-64, and this machine)",
        value="LIST",
    )
    plain: bool = option(
        "instead, into fmi2-plain/ and fmi3-plain/: native FMUs for tools that stumble over "
        "arrays, clocks or long lists of variables; the same numbers"
    )
    sources_only: bool = option(
        "instead, into fmi2-sources/ and fmi3-sources/ (with --plain: fmi2-plain-sources/, "
        "fmi3-plain-sources/): native FMUs without binaries, for targets that compile the C "
        "sources inside; no compiler is needed here"
    )
    examples = """
  {program} build
  {program} build --folder /tmp/fmus --platforms all"""

    def __call__(self) -> None:
        from .. import fmu

        if self.folder is not None:
            check_output_folder(self.folder, "--folder")
        forms = fmu.PLAIN_FORMS if self.plain else fmu.FORMS
        platforms = [name for name in (self.platforms or "").split(",") if name]
        if self.sources_only:
            if platforms:
                raise InputError("--platforms with --sources-only: expected one of them")
            forms = fmu.source_forms_of(forms)
        made = fmu.build(self.folder, forms, platforms=platforms)
        if not (self.plain or self.sources_only):
            made += fmu.build_libraries(self.folder, platforms)
            made += fmu.build_web_kernels(self.folder)
        for path in made:
            print(f"{path}  {path.stat().st_size / 1024:.0f} kB")


class Explore(OfStored, Reading, InUnits, Command):
    """Open a page that shows orbit diagrams and motions, computed in the browser."""

    result: Path | None = option(
        "NetCDF file of a sweep along the frequency (default: the paper's Figure 6)",
        value="RESULT",
        position=True,
    )
    branches: Path | None = option("NetCDF file of branches over eta, drawn over the diagram")
    record: Path | None = option(
        "measured record, drawn over the spectrum of a beam in Hz: of a swept sine its orders at "
        "the frequency that is shown"
    )
    output: Path = option("the page", Path("explorer.html"))
    no_open: bool = option("only write it")
    build_folder: Path | None = option(
        "where the compiled kernel is looked for and put", value="FOLDER"
    )
    examples = """
  {program} explore                              the paper's Figure 6
  {program} explore results/sweep_paper_7e3015.nc   an own sweep: a click replays its responses
  {program} explore --set e=0.3 --no-open --output page.html
  {program} explore --structure beam --record run.csv --unit g    a measurement with the model"""

    def __call__(self) -> None:
        from ..explorer.page import explore

        record, branches = self.read_record(), None
        if self.branches is not None:
            branches = load_earlier_result("--branches", self.branches)
        more: Any = {"branches": branches, "record": record, "units": self.read_units()}
        more |= {"output": self.output, "build_folder": self.build_folder}
        page = explore(self.read_sweep_or_structure(branches), **more)
        print(f"{page}  {page.stat().st_size / 1024:.0f} kB")
        if not self.no_open:
            import webbrowser

            webbrowser.open(page.resolve().as_uri())

    def read_record(self) -> xr.Dataset | None:
        reading = self.given_options(Reading)
        if self.record is not None:
            return orchestrate.read_record(self.record, **reading)
        if reading:
            raise InputError(f"{option_names(list(reading)[:1])}: expected only with --record")
        return None

    def read_sweep_or_structure(self, branches: xr.Dataset | None) -> Any:
        """Return the sweep of RESULT, or the structure: given, of ``--branches``, or usual."""
        if self.result is not None:
            if self.set or self.structure:
                raise InputError(f"{self.result} with --structure or --set: expected one of them")
            data = load_earlier_result("RESULT", self.result)
            if branches is not None:
                drawn = stored_structure("--branches", self.branches, branches)
                structure = stored_structure("RESULT", self.result, data)
                print_structure_difference("--branches", self.branches, drawn, structure)
            return data
        if branches is not None:
            return self.stated_or_stored_structure("--branches", self.branches, branches)
        self.structure = self.structure or "paper"
        return self.read_and_report_structure()


class Report(InUnits, InFolder, Command):
    """Stored results as one page with pictures and numbers, to read, print and sign."""

    results: list[Path] = option(
        "results of earlier commands; a verdict of diagnose is first",
        value="FILE.nc",
        position=True,
        needed=True,
    )
    title: str | None = option("by default that of the first result", value="WORDS")
    notes: str | None = option("below the title: what, who, when", value="WORDS")
    examples = """
  {program} report results/sweep.nc --title Beam --notes November
  {program} report results/map.nc results/resonance.nc --output study"""

    def __call__(self) -> None:
        from ..files import make_writable_folder

        check_output_folder(self.output)
        answers = [load_earlier_result("FILE", path) for path in self.results]
        page = make_writable_folder(self.output) / f"report_{self.results[0].stem}.html"
        words = {"title": self.title or "", "notes": self.notes or ""}
        print(orchestrate.report(*answers, output=page, **words, units=self.read_units()))


CLAIM = "{section:4} {verdict:7} {text}: paper {printed}, found {found}"
REGION = (
    "{case:18} {region:13} {verdict:16} chaotic {chaotic:5} neutral {neutral:5} largest {largest}"
)


class Paper(InFolder, HowRun, Command):
    """The whole paper through the FMU: figures, claims, report."""

    figures: str | None = option(
        "some of it: 5 to 12, claims, lyapunov, attractors, basin, maps, spectra (default: all)",
        value="NAME,...",
    )
    quick: bool = option(
        "reduced resolution: the same frequencies, fewer periods, starts and map points"
    )
    output: Path | None = option(  # type: ignore[assignment]
        "folder of the results (default: results/paper, with --quick results/paper-quick)",
        value="FOLDER",
    )
    examples = """
  {program} paper                     all at the paper's resolution, into results/paper/
  {program} paper --quick             on fewer periods and points, in a minute or two
  {program} paper --figures 5,7       some of it
  {program} paper --cluster tcp://HOST:8786      on the workers of a running Dask scheduler"""

    def __call__(self) -> None:
        from ..paper.reproduce import reproduce
        from ..paper.resolution import FULL, QUICK

        output = self.output or Path("results", "paper-quick" if self.quick else "paper")
        check_output_folder(output)
        figures = None if self.figures is None else self.figures.split(",")
        resolution = QUICK if self.quick else FULL
        outcome = reproduce(output, resolution, figures, self.running_keywords())
        for kind, line in (("claims", CLAIM), ("regions", REGION)):
            for row in outcome.claims_and_regions[kind]:
                print(line.format(**row))
        print(*outcome.pictures.values(), outcome.report, sep="\n")
