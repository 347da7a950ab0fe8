"""``python -m orchestrate paper``: every figure and every number of the paper, and a report."""

import argparse
import os
from functools import partial
from importlib import import_module
from pathlib import Path

from ..errors import UserError
from .sweep_command import MODEL, open_output

FORM = "fmi3"  # has events: each impact at its own time
EPILOG = """examples:
  python -m orchestrate paper                     everything at the paper's resolution, into results/paper/
  python -m orchestrate paper --quick             the same on fewer periods and points, in a minute or two
  python -m orchestrate paper --figures 5,7       some of it
  python -m orchestrate paper --cluster tcp://HOST:8786      on the workers of a running Dask scheduler
Interrupted, the same command goes on where it was. Finished data is left as it is; remove a file to have it computed anew."""


def add_parser(commands):
    """Declare the command."""
    parser = commands.add_parser(
        "paper",
        help="the whole paper through the FMU: figures, claims, report",
        description="Compute the paper's figures and claims through the FMU; write NetCDF, PNG and PDF files and one HTML report.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    option = parser.add_argument
    option("--figures", metavar="NAME,...", help="some of it: 5 to 12, claims, lyapunov, attractors, basin, maps, spectra (default: all)")
    option("--quick", action="store_true", help="reduced resolution: the same frequencies, fewer periods, starts and map points")
    option("--fmu", type=Path, help="FMI 3.0 FMU to use (default: the one in build/, exported first where missing or out of date)")
    option("--output", type=Path, help="folder of the results (default: results/paper, with --quick results/paper-quick)")
    option("--jobs", type=int, default=os.cpu_count() or 1, help="processes at once (default: all cores)")
    option("--cluster", metavar="ADDRESS", help="compute on the workers of the Dask scheduler at this address instead")
    parser.set_defaults(run=run)


def event_fmu(path):
    """Description of the FMU to use, which must have events.

    Parameters
    ----------
    path : Path, optional
        The user's; by default the one in ``build/``.
    """
    from ..build import build, up_to_date
    from ..fmu import describe

    if path is None:
        path = Path("build") / FORM / f"{MODEL}.fmu"
        if not up_to_date(FORM, MODEL, Path("build")):
            print(f"exporting {path} ...", flush=True)
            if not build(Path("build"), [FORM]):
                raise UserError(f"FMU {path}: cannot be made on this machine; give one with --fmu")
    fmu = describe(path, MODEL)
    if not fmu.fmi_version.startswith("3"):
        raise UserError(f"FMU {path}: FMI {fmu.fmi_version}; allowed is an FMI 3.0 one, `python -m orchestrate build` writes it")
    return fmu


def run(arguments):
    """Carry it out."""
    from ..paper import plan, report
    from ..paper.resolution import FULL, QUICK
    from ..pool import run as run_jobs
    from ..pool import spread, workers

    resolution = QUICK if arguments.quick else FULL
    if arguments.jobs < 1:
        raise UserError(f"--jobs {arguments.jobs}: allowed is a whole number >= 1")
    plan.make(resolution, "").choose(arguments.figures)
    fmu = event_fmu(arguments.fmu)
    whole = plan.make(resolution, fmu.guid)
    parts = whole.choose(arguments.figures)
    output = arguments.output or Path("results") / ("paper-quick" if arguments.quick else "paper")
    open_output(output)
    run_jobs(whole.needed(parts), fmu.path, output, partial(workers, arguments.jobs, arguments.cluster))
    drawn = [part for part in parts if part.module]
    pictures = spread(show, [(part, output) for part in drawn], arguments.jobs)
    for picture in pictures:
        print(picture)
    found: dict = {"claims": [], "regions": [], "answers": []}
    for part in parts:
        if part.name == "claims":
            found = findings(output, part.jobs)
    print(report.write(output, drawn, pictures, {"resolution": resolution, "fmu": fmu, **found}))


def findings(output, jobs):
    """The table of claims and what goes beyond them, kept beside the report as JSON too."""
    import json

    from ..paper.claims import answers
    from ..paper.claims import table as check_all
    from ..store import write_whole

    data = {name: load(output, name) for name in jobs}
    found = {"claims": check_all(data), "regions": answers.regions(data), "answers": answers.sentences(data)}
    write_whole(output / "claims.json", (json.dumps(found, indent=1, ensure_ascii=False) + "\n").encode())
    for row in found["claims"]:
        print(f"{row['section']:4} {row['verdict']:7} {row['text']}: paper {row['printed']}, found {row['found']}")
    for row in found["regions"]:
        print(
            f"{row['case']:18} {row['region']:13} {row['verdict']:16} chaotic {row['chaotic']:5} neutral {row['neutral']:5} largest {row['largest']}"
        )
    print("\n".join(found["answers"]))
    return found


def load(output, name):
    """A result's dataset."""
    import xarray

    return xarray.load_dataset(output / f"{name}.nc", engine="netcdf4")


def show(part, output):
    """Draw a part from its data files; returns the path of its PNG."""
    from ..figures.canvas import save

    module = import_module(f"orchestrate.figures.{part.module}")
    path = output / part.module
    save(module.draw(*[load(output, name) for name in part.jobs]), path)
    return Path(f"{path}.png")
