"""``couple``: the weak drive; without options the set ``quick``, bonded and delaminated."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import Commands, add_drive, described, ends_of, values_of
from .output import (
    FORMATS,
    PLOTS,
    add_files,
    add_running,
    check_output,
    drawn,
    endings_of,
    exported,
    own_fmus,
    running_of,
)

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Drive, Structure
    from ..weak_drive.couple import CoupleJob

USUAL = {"quick": ("1.2:1.65", 1e-4), "beam": ("1.25:1.6", 5e-6)}  # ends of eta0, and rate
RATE = 1e-4
LIMIT = 1e-6  # of the motor's work: where more is missed, a warning
EXAMPLES = """\
  {program} couple                               quick: bonded, delaminated, up and down
  {program} couple --drive beam                  a delaminated beam on a small motor
  {program} couple --eta0 1.4:1.62 --rate 1e-5   a slower ramp over less
  {program} couple --rate 1e-4,5e-5,2.5e-5       jumps at rate 0 with their standard error
  {program} couple --drive beam --voltage 5.6:7.2
  {program} couple --increment 0.005             in steps of the voltage, each with time to settle
  {program} couple --ssp weak_drive.ssp          the coupled system as a package for other tools
eta0 = U/(K omega) is the voltage as no-load speed over omega = sqrt(k1/m1).
Interrupted, the same command goes on where it was. A finished result is left as it is."""


def add_parser(commands: Commands) -> None:
    """Declare the command."""
    text = "the weak drive: structure and motor coupled, the voltage up and down (Figure 2)"
    parser = commands.add("couple", run, text, EXAMPLES)
    add_drive(parser)
    only = "one of both (default: both)"
    parser.add_argument("--only", choices=("bonded", "delaminated"), help=only)
    add_schedule(parser)
    branches = "compute the branches of stationary motions too, and draw them under the ramps"
    parser.add_argument("--branches", action="store_true", help=branches)
    add_files(parser, store=False)
    add_running(parser, several=True)
    package = "write the coupled system for other tools instead"
    parser.add_argument("--ssp", type=Path, metavar="FILE", help=package)


def add_schedule(parser: argparse.ArgumentParser) -> None:
    """The voltage over time, and how it is computed."""
    option = parser.add_argument_group("voltage over time").add_argument
    option(
        "--eta0",
        metavar="FIRST:LAST",
        help="voltage as no-load speed over omega (default: "
        + ", ".join(f"{ends} for {name}" for name, (ends, _) in USUAL.items())
        + ")",
    )
    option("--voltage", metavar="FIRST:LAST", help="the same in V")
    course = "CSV file with time in s and voltage in V, a row each: straight lines between, instead"
    option("--course", type=Path, metavar="FILE", help=course)
    option(
        "--rate",
        metavar="A,B,...",
        help="change of eta0 in a time 1/omega; several give the jumps at rate 0, with a standard "
        "error (default: "
        + ", ".join(f"{rate:g} for {name}" for name, (_, rate) in USUAL.items())
        + f", else {RATE:g})",
    )
    option(
        "--increment",
        type=float,
        default=0.0,
        help="change eta0 in steps of this height, at the same mean rate (default: a ramp)",
    )
    option(
        "--settle",
        type=float,
        default=300.0,
        help="time at the first voltage, in 1/omega (default: %(default)s)",
    )
    option("--one-way", action="store_true", help="do not come back")
    option(
        "--step",
        type=float,
        help="communication step, in 1/omega (default: controlled by its defect, at most 0.4)",
    )
    option(
        "--tolerance",
        type=float,
        help="of that control: largest defect over the work exchanged in a step (default: 1e-8)",
    )
    option("--algorithm", default="rollback", help="master, see the manual (default: %(default)s)")


def ends_in_volts(arguments: argparse.Namespace, volts: float) -> tuple[float, float]:
    """Both ends of the voltage, V.

    Parameters
    ----------
    arguments : argparse.Namespace
    volts : float
        Voltage at eta0 = 1.
    """
    if arguments.eta0 and arguments.voltage:
        raise InputError("--eta0 and --voltage: expected one of them")
    if arguments.voltage:
        return ends_of("--voltage", arguments.voltage)
    if arguments.eta0 is None and arguments.drive not in USUAL:
        raise InputError(f"--drive {arguments.drive}: expected --eta0 or --voltage with it")
    first, last = ends_of("--eta0", arguments.eta0 or USUAL[arguments.drive][0])
    return first * volts, last * volts


def rates_of(arguments: argparse.Namespace) -> tuple[float, ...]:
    """Rates of eta0."""
    if arguments.rate is None:
        return (USUAL.get(arguments.drive, ("", RATE))[1],)
    return values_of("--rate", arguments.rate)[0]


def jobs_of(arguments: argparse.Namespace, structure: Structure, drive: Drive) -> list[CoupleJob]:
    """The runs, bonded first."""
    from ..weak_drive.couple import couple_job, schedule_of, scheme_of
    from ..weak_drive.schedule import Course

    omega, volts = structure.omega, drive.volts(structure)
    rate = rates_of(arguments)[0]
    course = arguments.course
    schedule = schedule_of(
        structure,
        drive,
        Course.from_csv(course) if course else ends_in_volts(arguments, volts),
        rate=rate * volts * omega,
        settle=arguments.settle / omega,
        increment=arguments.increment * volts,
        back=not arguments.one_way,
    )
    step = arguments.step and arguments.step / omega
    scheme = scheme_of(structure, step, arguments.algorithm, arguments.tolerance)
    states = {"bonded": structure.as_bonded(), "delaminated": structure.as_delaminated()}
    chosen = [arguments.only] if arguments.only else list(states)
    drive_name = Path(arguments.drive).stem
    return [
        replace(
            couple_job(states[state], drive, schedule, scheme),
            name=f"couple_{drive_name}_{state}",
        )
        for state in chosen
    ]


def run(arguments: argparse.Namespace) -> None:
    """Carry it out."""
    from ..access import finder
    from ..running.options import RunOptions
    from ..running.runner import answer_all
    from ..running.store import load

    structure, drive = described(arguments)
    formats = endings_of("--format", arguments.format, FORMATS)
    plots = endings_of("--plot", arguments.plot, PLOTS)
    if len(rates_of(arguments)) > 1:
        extrapolated(arguments, structure, drive)
        return
    jobs = jobs_of(arguments, structure, drive)
    own = own_fmus(arguments.fmu)
    running = {**running_of(arguments), "fmu": own}
    if arguments.ssp:
        print(write_package(arguments, drive, jobs[-1], own))
        return
    check_output(arguments.output)
    fresh = any(not (arguments.output / f"{job.name}.nc").exists() for job in jobs)
    paths = answer_all(jobs, arguments.output, RunOptions.of(running), finder(running))
    results = {job.name.rpartition("_")[2]: load(paths[job.name]) for job in jobs}
    name = Path(arguments.drive).stem
    pictures = drawn(
        arguments.output / f"couple_{name}.nc",
        plots,
        fresh or arguments.force,
        lambda: picture_of(
            results, structure, drive, branches_of(arguments, structure, drive), name
        ),
    )
    for state, data in results.items():
        report(state, data)
    for state, data in results.items():
        path = paths[f"couple_{name}_{state}"]
        for place in (path, *exported(data, path, formats, fresh or arguments.force)):
            print(place)
    for picture in pictures:
        print(picture)


def extrapolated(arguments: argparse.Namespace, structure: Structure, drive: Drive) -> None:
    """Ramps at several rates: a table of the jumps at rate 0, bonded against delaminated."""
    from ..weak_drive.jump_voltages import jump_voltages

    check_output(arguments.output)
    omega, volts = structure.omega, drive.volts(structure)
    store = arguments.output / f"jump_voltages_{Path(arguments.drive).stem}.nc"
    running = running_of(arguments, store)
    running["fmu"] = own_fmus(arguments.fmu)
    found = jump_voltages(
        structure,
        drive,
        voltage=ends_in_volts(arguments, volts),
        rates=[rate * volts * omega for rate in rates_of(arguments)],
        back=not arguments.one_way,
        settle=arguments.settle / omega,
        step=arguments.step and arguments.step / omega,
        **running,
    )
    print(f"{'jump':6}{'bonded':>24}{'delaminated':>24}{'change':>12}   in V, at rate 0")
    for jump in found.jump.values:
        at = found.sel(jump=jump)
        pairs = zip(at.jumps.values, at.standard_error.values, strict=True)
        texts = [f"{value:.4f} +- {error:.4f}" for value, error in pairs]
        change = float(at.jumps[1] - at.jumps[0])
        print(f"{jump:6}{texts[0]:>24}{texts[1]:>24}{change:>12.4f}")
    print(store)


def write_package(
    arguments: argparse.Namespace, drive: Drive, job: CoupleJob, own: Mapping[str, Path]
) -> Path:
    """The coupled system as an SSP file, by default with the FMI 2.0 FMUs that most tools read."""
    from ..access import find
    from ..weak_drive.ssp import write_ssp

    folder = arguments.build_folder
    fmus = [find(model, "fmi2", folder, own.get(model)).path for model in job.models]
    voltage, speed = job.schedule.voltage(0.0), job.speed_start
    return write_ssp(
        arguments.ssp, job.structure, drive, voltage=voltage, speed_start=speed, fmus=fmus
    )


def branches_of(
    arguments: argparse.Namespace, structure: Structure, drive: Drive
) -> xr.Dataset | None:
    """The branches, where they are asked for; their bifurcations are told."""
    from ..weak_drive.drive_branch import drive_branch

    if not arguments.branches:
        return None
    store = arguments.output / f"branches_{Path(arguments.drive).stem}.nc"
    running = running_of(arguments, store)
    running["fmu"] = own_fmus(arguments.fmu)
    found = drive_branch(structure, drive, **running)
    for kind, name, volts in zip(
        *(found[f"bifurcation_{of}"].values for of in ("kind", "structure", "voltage")), strict=True
    ):
        print(f"{name}: {kind} at {volts:.4f} V")
    return found


def title_of_runs(results: dict[str, xr.Dataset], name: str) -> str:
    """Set, volts and rate of the runs, for the picture."""
    import numpy as np

    data = next(iter(results.values()))
    volts, change = data.voltage.values, data.voltage.diff("revolution").values
    rates = abs(change) / data.time.diff("revolution").values
    low, high, rate = (
        volts.min(),
        volts.max(),
        float(np.median(rates[rates > 0.0])) if rates.any() else 0.0,
    )
    return f"{name}: {low:.4g} V to {high:.4g} V, {rate:.2g} V/s"


def picture_of(
    results: dict[str, xr.Dataset],
    structure: Structure,
    drive: Drive,
    branches: xr.Dataset | None,
    name: str,
) -> Any:
    """All runs and the averaged theory."""
    import numpy as np
    import xarray as xr

    from ..figures.weak_drive import draw
    from ..weak_drive import averaged

    Omega = np.linspace(0.3, 3.0, 20001)
    volts = averaged.no_load_speed(structure, drive, Omega) * drive.volts(structure)
    amplitude = averaged.amplitude(structure, drive, Omega) * drive.length
    along = {"voltage": ("speed", volts), "amplitude": ("speed", amplitude)}
    theory = xr.Dataset(along, {"speed": Omega * structure.omega})
    return draw(results, theory, branches, title_of_runs(results, name))


def report(name: str, data: xr.Dataset) -> None:
    """What was found, in a few lines."""
    found = []
    for jump in ("up", "down"):
        volts = float(data.jumps.sel(jump=jump))
        eta0 = volts * float(data.eta0[0] / data.voltage[0])
        there = f"at {volts:.4f} V (eta0 = {eta0:.4f})"
        lag = float(data.jump_lag.sel(jump=jump))
        late = f", {abs(lag):.4f} V late at this rate" if math.isfinite(lag) else ""
        none = f"none ({data.no_jump.sel(jump=jump).item()})"
        found.append(f"jump {jump} {there + late if math.isfinite(volts) else none}")
    print(f"{name}: {data.sizes['revolution']} revolutions; {'; '.join(found)}")
    missing, defects = (
        float(data.attrs[key]) for key in ("missing_over_motor_work", "defects_over_motor_work")
    )
    print(
        f"  of the motor's work {missing:.1e} is missing, the steps' defects are {defects:.1e} "
        "(small ones alone do not prove accuracy)"
    )
    if max(abs(missing), defects) > LIMIT:
        print(f"  warning: that is more than {LIMIT:g}; take a shorter --step")
