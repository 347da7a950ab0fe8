"""``python -m orchestrate sweep``: orbit diagrams; without options the paper's Figure 6."""

import argparse
import math
import os
from dataclasses import fields
from decimal import Decimal, InvalidOperation
from pathlib import Path

from ..errors import UserError
from ..sweep import Case, Plan

MODEL = "TwoMassImpactOscillator"
EPILOG = """examples:
  python -m orchestrate sweep                              the paper's Figure 6: 7,901 frequencies x 700 periods
  python -m orchestrate sweep --case e=0.7,D=0.05 --case e=0.3        Figures 10 and 11, side by side
  python -m orchestrate sweep --eta 1.0:1.5:0.0005 --direction both   up and down: non-unique responses
  python -m orchestrate sweep --eta 0.4,1.047,2.9 --samples 2000
Interrupted, the same command goes on where it was. A finished result is left as it is; --force computes it anew."""


def add_parser(commands):
    """Declare the command."""
    parser = commands.add_parser(
        "sweep",
        help="frequency sweep through the FMU: orbit diagram (Figure 6), impacts per period, multiplicity",
        description="Sweep the frequency ratio eta, each value started from the end of the last, and write NetCDF and PNG files.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    option = parser.add_argument
    option("--eta", default="0.1:8.0:0.001", help="FIRST:LAST:STEP, both ends included, or a list A,B,... (default: %(default)s)")
    option("--direction", choices=("up", "down", "both"), default="up", help="order of a range; a list is taken as it stands (default: up)")
    option("--case", action="append", metavar="KEY=VALUE,...", help=f"parameter set, of {case_text()}; repeat it for several, run side by side")
    option("--transient", type=int, default=500, help="periods dropped at each eta (default: %(default)s)")
    option("--samples", type=int, default=200, help="stroboscopic samples kept at each eta (default: %(default)s)")
    option("--tolerance", type=float, default=1e-2, help="relative deviation within which a state repeats (default: %(default)s)")
    option("--fmu", type=Path, help="FMU to use (default: the one in build/, exported first where missing or out of date)")
    option("--output", type=Path, default=Path("results"), help="folder of the results (default: %(default)s)")
    option("--jobs", type=int, default=os.cpu_count() or 1, help="processes at once (default: all cores)")
    option("--force", action="store_true", help="compute anew what is there already")
    parser.set_defaults(run=run)


def case_text():
    """The parameters of a case with their default values."""
    return ", ".join(f"{field.name}={field.default:g}" for field in fields(Case))


def parse_etas(text):
    """The values of ``--eta``, and whether they are a range.

    Raises
    ------
    UserError
        With the offending text and the allowed form.
    """
    form = "allowed is FIRST:LAST:STEP with 0 < FIRST <= LAST and STEP > 0, or a list of numbers > 0 such as 0.4,1.047"
    is_range = ":" in text
    try:
        numbers = [Decimal(part.strip()) for part in text.split(":" if is_range else ",")]
    except InvalidOperation:
        raise UserError(f"--eta {text}: not numbers; {form}") from None
    if not all(number.is_finite() for number in numbers) or (is_range and len(numbers) != 3) or min(numbers) <= 0:
        raise UserError(f"--eta {text}: {form}")
    if is_range:
        first, last, step = numbers
        if last < first or (last - first) > 10_000_000 * step:
            raise UserError(f"--eta {text}: {form}, and at most ten million values")
        numbers = [first + i * step for i in range(int((last - first) / step) + 1)]
    if not all(1e-6 <= number <= 1e6 for number in numbers):
        raise UserError(f"--eta {text}: allowed is 1e-6 <= eta <= 1e6")
    return tuple(map(float, numbers)), is_range


def parse_case(text):
    """A case from ``KEY=VALUE,...``."""
    values = {}
    known = {field.name for field in fields(Case)}
    for part in filter(None, (part.strip() for part in text.split(","))):
        key, _, value = (piece.strip() for piece in part.partition("="))
        if key in values:
            raise UserError(f"--case {text}: {key} twice; allowed is each once")
        if key not in known:
            raise UserError(f"--case {text}: {key or part} is no parameter; allowed are {', '.join(sorted(known))}")
        try:
            values[key] = float(value)
        except ValueError:
            raise UserError(f"--case {text}: {key} = {value or 'nothing'} is not a number") from None
    return Case(**values)


SOURCES = {"m2": "mu", "k2": "kappa", "d1": "D", "d2": "D and mu", "e": "e", "gamma": "gamma"}  # of the FMU's parameters, in a case


def check_case(case, fmu):
    """Whether the FMU has the parameters, and allows the values a case gives them."""
    for name, value in case.parameters().items():
        if name not in fmu.variables:
            raise UserError(f"FMU {fmu.path}: has no variable {name}; allowed is one made by `python -m orchestrate build`")
        variable = fmu.variables[name]
        low = float(variable.min) if variable.min is not None else -math.inf
        high = float(variable.max) if variable.max is not None else math.inf
        if not (math.isfinite(value) and low <= value <= high):
            key = SOURCES[name]
            given = ", ".join(f"{part} = {getattr(case, part):g}" for part in key.split(" and "))
            unit = 0.5 if key == "D" else 1.0  # d1 = 2 D
            rule = f"allowed is {unit * low:g} <= {key} <= {unit * high:g}"
            if " and " in key:
                rule = f"makes {name} = {value:g}, allowed is {low:g} <= {name} <= {high:g}"
            raise UserError(f"--case {given}: {rule}")


def check(arguments, cases, fmu):
    """All that can be wrong, before any work is done."""
    for name, lowest in (("transient", 0), ("samples", 1), ("jobs", 1)):
        if getattr(arguments, name) < lowest:
            raise UserError(f"--{name} {getattr(arguments, name)}: allowed is a whole number >= {lowest}")
    if arguments.samples > 1_000_000:
        raise UserError(f"--samples {arguments.samples}: allowed are at most 1000000")
    if not (math.isfinite(arguments.tolerance) and arguments.tolerance > 0.0):
        raise UserError(f"--tolerance {arguments.tolerance}: allowed is a number > 0")
    for case in cases:
        check_case(case, fmu)
    if len(set(cases)) != len(cases):
        raise UserError("--case: the same parameter set twice; allowed is each once")


def plans_of(arguments, fmu):
    """The sweeps to run, by name."""
    etas, is_range = parse_etas(arguments.eta)
    cases = [parse_case(text) for text in arguments.case or [""]]
    check(arguments, cases, fmu)
    if arguments.direction != "up" and not is_range:
        raise UserError(
            f"--direction {arguments.direction} with the list --eta {arguments.eta}: a list is taken in its own order; leave --direction out"
        )
    orders = {"up": etas, "down": etas[::-1]}
    directions = ("up", "down") if arguments.direction == "both" else (arguments.direction,)
    return {
        f"orbit_{case.label()}_{direction if is_range else 'list'}": Plan(
            case, orders[direction], arguments.transient, arguments.samples, arguments.tolerance, fmu.guid
        )
        for case in cases
        for direction in directions
    }


def open_output(folder):
    """Make the output folder, and see that it can be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".writable"
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        raise UserError(f"--output {folder}: {error.strerror or error}; allowed is a folder that can be written") from None


def run(arguments):
    """Carry it out."""
    from ..build import default_fmu
    from ..campaign import journal_path, run_all
    from ..fmu import describe
    from ..store import Journal, difference, read_identity

    parse_etas(arguments.eta)
    fmu = describe(arguments.fmu or default_fmu(MODEL, Path("build")), MODEL)
    plans = plans_of(arguments, fmu)
    open_output(arguments.output)
    todo = {}
    for name, plan in plans.items():
        result = arguments.output / f"{name}.nc"
        if result.exists() and arguments.force:
            result.unlink()
            Journal.discard(journal_path(result))
        if result.exists():
            found, wanted = read_identity(result), Journal.normal(plan.identity())
            if found != wanted:
                raise UserError(f"{result}: holds another run ({difference(found, wanted)}); choose another --output, or --force to replace it")
            print(f"{result}: complete already")
            Journal.discard(journal_path(result))
            if not result.with_suffix(".png").exists():
                draw_result(result)
            continue
        Journal(journal_path(result), plan.identity()).close()
        todo[result] = plan
    run_all(list(todo.values()), fmu.path, list(todo), arguments.jobs)
    for result, plan in todo.items():
        finish(result, plan, fmu)
    for name in plans:
        print(arguments.output / f"{name}.nc")
        print(arguments.output / f"{name}.png")


def draw_result(result):
    """The picture of a result file."""
    import xarray

    from ..figures.orbit_diagram import draw

    with xarray.open_dataset(result, engine="netcdf4") as data:
        draw(data, result.with_suffix(".png"))


def finish(result, plan, fmu):
    """Result file and picture from a complete journal."""
    from ..campaign import journal_path
    from ..orbit import dataset
    from ..store import Journal, write_netcdf

    journal = Journal(journal_path(result), plan.identity())
    write_netcdf(dataset(plan, journal.rows(), fmu), result, plan.identity())
    journal.remove()
    draw_result(result)
