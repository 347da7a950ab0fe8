"""``python -m orchestrate couple``: the weak drive; without options the parameter set ``quick``, bonded and delaminated, up and down."""

import argparse
import math
from pathlib import Path

from ..errors import UserError
from ..setups import SETUPS

DEFAULTS = {"quick": ("1.2:1.65", 1e-4), "beam": ("1.25:1.6", 5e-6)}  # voltages and rate
STRUCTURES = ("bonded", "delaminated", "both")
EPILOG = """examples:
  python -m orchestrate couple                                   quick: voltage up and down, bonded and delaminated
  python -m orchestrate couple --setup beam                      the beam's set-up
  python -m orchestrate couple --eta0 1.4:1.62 --rate 1e-5       a slower ramp over less
  python -m orchestrate couple --increment 0.005                 in steps of the voltage, each with time to settle (increment/rate)
  python -m orchestrate couple --ssp weakdrive.ssp               the coupled system as a package for other tools
Interrupted, the same command goes on where it was. A finished result is left as it is; --force computes it anew."""


def add_parser(commands):
    """Declare the command."""
    parser = commands.add_parser(
        "couple",
        help="the weak drive: two FMUs coupled, voltage up and down (Figure 2, Sommerfeld effect)",
        description="Couple structure and motor, take the voltage up and down, and write NetCDF and PNG files.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    option = parser.add_argument
    option("--setup", default="quick", help=f"parameter set, of {', '.join(SETUPS)} (default: %(default)s)")
    option("--structure", default="both", help=f"of {', '.join(STRUCTURES)} (default: %(default)s)")
    option("--eta0", help="FIRST:LAST, voltage as no-load speed over omega (default: 1.2:1.65 for quick, 1.25:1.6 for beam)")
    option("--rate", type=float, help="change of eta0 in a time 1/omega (default: 1e-4 for quick, 5e-6 for beam)")
    option("--increment", type=float, default=0.0, help="change in steps of this height, at the same mean rate (default: a ramp)")
    option("--settle", type=float, default=300.0, help="time at the first voltage, in 1/omega (default: %(default)s)")
    option("--one-way", action="store_true", help="do not come back")
    option("--step", type=float, default=0.1, help="communication step, in 1/omega (default: %(default)s)")
    option("--tolerance", type=float, default=0.0, help="halve steps with a larger defect, over the work exchanged in them (default: never)")
    option("--algorithm", default="rollback", help="master, see docs/coupling.md (default: %(default)s)")
    option("--oscillator", type=Path, help="FMU of the structure (default: the one in build/, exported first where missing or out of date)")
    option("--shaker", type=Path, help="FMU of the motor (default: likewise)")
    option("--output", type=Path, default=Path("results"), help="folder of the results (default: %(default)s)")
    option("--ssp", type=Path, help="write the coupled system as an SSP file, and nothing else")
    option("--force", action="store_true", help="compute anew what is there already")
    parser.set_defaults(run=run)


def one_of(name, value, allowed):
    """A choice."""
    if value not in allowed:
        raise UserError(f"--{name} {value}: allowed are {', '.join(allowed)}")


def number(name, value, low, high):
    """A number in a range, both ends included."""
    if not (math.isfinite(value) and low <= value <= high):
        raise UserError(f"--{name} {value}: allowed is {low:g} <= {name} <= {high:g}")


def parse_range(text):
    """Both ends of ``--eta0``."""
    form = "allowed is FIRST:LAST with 0 <= FIRST, LAST <= 100 and FIRST != LAST, such as 1.2:1.65"
    try:
        first, last = (float(part) for part in text.split(":"))
    except ValueError:
        raise UserError(f"--eta0 {text}: {form}") from None
    if not (0.0 <= first <= 100.0 and 0.0 <= last <= 100.0 and first != last):
        raise UserError(f"--eta0 {text}: {form}")
    return first, last


def plans_of(arguments, guids):
    """The runs, by name."""
    from ..coupling import ALGORITHMS, Scheme
    from ..schedule import Plan, Schedule

    one_of("setup", arguments.setup, tuple(SETUPS))
    one_of("structure", arguments.structure, STRUCTURES)
    one_of("algorithm", arguments.algorithm, ALGORITHMS)
    default_range, default_rate = DEFAULTS[arguments.setup]
    first, last = parse_range(arguments.eta0 or default_range)
    rate = default_rate if arguments.rate is None else arguments.rate
    number("rate", rate, 1e-9, 1.0)
    number("step", arguments.step, 1e-4, 1.0)
    number("increment", arguments.increment, 0.0, abs(last - first))
    number("settle", arguments.settle, 0.0, 1e7)
    schedule = Schedule(first, last, rate, arguments.settle, arguments.increment, not arguments.one_way)
    if schedule.duration / arguments.step > 1e9:
        raise UserError(f"--rate {rate}: the run would take {schedule.duration / arguments.step:.2g} steps; allowed are 1e9")
    structures = ("bonded", "delaminated") if arguments.structure == "both" else (arguments.structure,)
    scheme, setup = Scheme(arguments.algorithm, arguments.step, tolerance=arguments.tolerance), SETUPS[arguments.setup]
    return {
        f"couple_{setup.name}_{name}": Plan(setup.as_bonded() if name == "bonded" else setup, schedule, scheme, first, guids) for name in structures
    }


def run(arguments):
    """Carry it out."""
    from ..build import default_fmu
    from ..exchange import OSCILLATOR, SHAKER
    from ..fmu import describe
    from .sweep_command import open_output

    given = ((arguments.oscillator, OSCILLATOR), (arguments.shaker, SHAKER))
    plans_of(arguments, ())
    fmus = [describe(path or default_fmu(model, Path("build")), model) for path, model in given]
    plans = plans_of(arguments, tuple(fmu.guid for fmu in fmus))
    if arguments.ssp:
        print(write_ssp(arguments.ssp, next(iter(plans.values())), fmus))
        return
    open_output(arguments.output)
    results = {name: carry_out(arguments.output / f"{name}.nc", plan, fmus, arguments.force) for name, plan in plans.items()}
    draw_results(list(results.values()), plans, arguments.output / f"couple_{arguments.setup}.png")
    for result in results.values():
        report(result)


def write_ssp(path, plan, fmus):
    """The package for other tools."""
    from .. import ssp

    try:
        return ssp.write(path, plan.setup, [fmu.path for fmu in fmus], plan.schedule.first, plan.speed)
    except OSError as error:
        raise UserError(f"--ssp {path}: {error.strerror or error}; allowed is a file that can be written") from None


def carry_out(result, plan, fmus, force):
    """One run to its result file; returns its path."""
    from tqdm import tqdm

    from ..campaign import journal_path
    from ..driveresult import dataset
    from ..store import Journal, Lock, difference, read_identity, write_netcdf
    from ..weakdrive import run as run_plan

    if result.exists() and not force:
        found, wanted = read_identity(result), Journal.normal(plan.identity())
        if found != wanted:
            raise UserError(f"{result}: holds another run ({difference(found, wanted)}); choose another --output, or --force to replace it")
        return result
    lock = Lock(result)
    try:
        if force and result.exists():  # once: interrupted, it goes on as any other
            result.unlink()
            Journal.discard(journal_path(result))
        journal = Journal(journal_path(result), plan.identity())
        with tqdm(total=plan.steps, unit="step", unit_scale=True, desc=result.stem, dynamic_ncols=True) as bar:
            rows = run_plan(plan, [fmu.path for fmu in fmus], journal, lambda done: bar.update(done - bar.n))
        if not len(rows):
            raise UserError(
                f"{result}: not one revolution of the motor in {plan.schedule.duration:g}/omega; allowed is a voltage that turns it, and time"
            )
        write_netcdf(dataset(plan, rows, fmus), result, plan.identity())
        journal.remove()
    finally:
        lock.release()
    return result


def draw_results(results, plans, path):
    """The picture of all runs."""
    import numpy as np
    import xarray

    from .. import averaged
    from ..figures.weak_drive import draw

    setup = next(iter(plans.values())).setup
    Omega = np.linspace(0.3, 3.0, 20001)
    theory = {"Omega": Omega, "eta0": averaged.no_load_speed(setup, Omega), "amplitude": averaged.amplitude(setup, Omega)}
    draw([xarray.load_dataset(result, engine="netcdf4") for result in results], theory, path)
    print(path)


def report(result):
    """What was found, in a few lines."""
    import xarray

    from ..driveresult import LIMIT

    with xarray.open_dataset(result, engine="netcdf4") as data:
        found = data.attrs
        up, down = (f"at eta0 = {found[name]:.4f}" if math.isfinite(found[name]) else "none" for name in ("jump_up", "jump_down"))
        print(f"{result}: {data.sizes['revolution']} revolutions; jump up {up}, jump down {down}")
        missing, defects = found["missing_over_motor_work"], found["defects_over_motor_work"]
        print(f"  of the motor's work {missing:.1e} is missing, the steps' defects are {defects:.1e} (small ones alone do not prove accuracy)")
        if max(abs(missing), defects) > LIMIT:
            print(f"  warning: that is more than {LIMIT:g}; take a shorter --step")
