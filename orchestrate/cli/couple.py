"""``couple``: the weak drive; without options the set ``quick``, bonded and delaminated."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .drives import (
    ETA0,
    add_control,
    add_hold,
    add_only,
    add_schedule,
    add_step,
    check_files,
    control_of,
    file_name,
    hold_of,
    schedule_from,
    states_of,
    step_of,
    title_of_runs,
)
from .options import Commands, add_drive, described, plain_float
from .output import add_results, digest, drawn, exported, own_fmus, running_of

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Drive, Structure
    from ..weak_drive.couple import CoupleJob

LIMIT = 1e-6  # of the motor's work: where more is missed, a warning
EXAMPLES = """\
  {program} couple                               quick: bonded, delaminated, up and down
  {program} couple --drive beam                  a delaminated beam on a small motor
  {program} couple --drive motor.toml            a motor, box and structure of your own
  {program} couple --eta0 1.4:1.62 --rate 1e-5   a slower ramp over less
  {program} couple --drive beam --voltage 5.6:7.2 --volt-rate 0.01
  {program} couple --drive beam --voltage 6.5 --duration 10 --speed-control 110
  {program} couple --increment 0.005             in steps of the voltage, each with time to settle
  {program} couple --course voltage.csv          any course of the voltage
  {program} couple --ssp weak_drive.ssp          the coupled system as a package for other tools
{eta0}
A ramp's jumps come late: jump-voltages finds them at rate 0.
Interrupted, the same command goes on where it was. A finished result is left as it is."""


def add_parser(commands: Commands) -> None:
    """Declare the command."""
    text = "the weak drive: structure and motor coupled, the voltage up and down (Figure 2)"
    parser = commands.add("couple", run, text, EXAMPLES.replace("{eta0}", ETA0))
    add_drive(parser)
    add_only(parser)
    add_schedule(parser)
    add_control(parser)
    add_master(parser)
    branches = "compute the branches of stationary motions too, and draw them under the ramps"
    parser.add_argument("--branches", action="store_true", help=branches)
    add_results(parser, store=False, several=True)
    package = "write the coupled system for other tools instead"
    parser.add_argument("--ssp", type=Path, metavar="FILE", help=package)


def add_master(parser: argparse.ArgumentParser) -> None:
    """How both FMUs are stepped."""
    group = parser.add_argument_group("master")
    add_step(group)
    add_hold(group)
    text = "of that control: largest defect over the work exchanged in a step (default: 1e-8)"
    group.add_argument("--tolerance", type=plain_float, help=text)
    text = "master, see the manual (default: %(default)s)"
    group.add_argument("--algorithm", default="rollback", help=text)


def jobs_of(arguments: argparse.Namespace, structure: Structure, drive: Drive) -> list[CoupleJob]:
    """The runs, bonded first."""
    from ..weak_drive.couple import couple_job, scheme_of

    control = control_of(arguments, structure, drive)
    schedule = schedule_from(arguments, structure, drive, control)
    step = step_of(arguments, structure)
    given = (arguments.algorithm, arguments.tolerance, control is not None)
    scheme = scheme_of(structure, step, *given)
    hold = hold_of(arguments, structure)
    stem = file_name(arguments, structure, drive, (schedule, scheme, control, hold))
    return [
        replace(
            couple_job(chosen, drive, schedule, scheme, control=control, hold=hold),
            name=f"{stem}_{state}",
        )
        for state, chosen in states_of(arguments, structure).items()
    ]


def run(arguments: argparse.Namespace) -> None:
    """Carry it out."""
    from ..access import finder
    from ..running.options import RunOptions
    from ..running.runner import answer_all
    from ..running.store import load

    structure, drive = described(arguments)
    jobs = jobs_of(arguments, structure, drive)
    if arguments.ssp:
        print(write_package(arguments, drive, jobs[-1], own_fmus(arguments.fmu)))
        return
    formats, plots = check_files(arguments)
    running = running_of(arguments)
    places = [arguments.output / f"{job.name}.nc" for job in jobs]
    fresh = arguments.force or not all(place.exists() for place in places)
    answer_all(jobs, arguments.output, RunOptions.of(running), finder(running))
    states = states_of(arguments, structure)
    results = {state: load(place) for state, place in zip(states, places, strict=True)}
    tell(results, drive.volts(structure))
    for data, place in zip(results.values(), places, strict=True):
        for path in (place, *exported(data, place, formats, fresh)):
            print(path)
    name = jobs[0].name.rpartition("_")[0] + (f"_{arguments.only}" if arguments.only else "")
    picture = arguments.output / f"{name}.nc"
    for path in drawn(
        picture, plots, fresh, lambda: picture_of(arguments, results, structure, drive, jobs[0])
    ):
        print(path)


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
    own = digest(structure.as_delaminated().parameters(), drive.parameters())
    store = arguments.output / f"branches_{Path(arguments.drive).stem}_{own}.nc"
    found = drive_branch(structure, drive, **running_of(arguments, store))
    for kind, name, volts in zip(
        *(found[f"bifurcation_{of}"].values for of in ("kind", "structure", "voltage")), strict=True
    ):
        print(f"{name}: {kind} at {volts:.4f} V")
    return found


def picture_of(
    arguments: argparse.Namespace,
    results: dict[str, xr.Dataset],
    structure: Structure,
    drive: Drive,
    job: CoupleJob,
) -> Any:
    """All runs; of ramps the averaged theory too, and branches where they are wanted."""
    import numpy as np
    import xarray as xr

    from ..figures import run_history
    from ..figures.weak_drive import draw
    from ..weak_drive import averaged
    from ..weak_drive.schedule import Ramp

    control = type(job.control).__name__ if job.control else ""
    title = title_of_runs(results, Path(arguments.drive).stem, control)
    if job.control or not isinstance(job.schedule, Ramp):
        resonance = averaged.dividing_speed(structure, drive) * structure.omega
        return run_history.draw(results, resonance, title)
    Omega = np.linspace(0.3, 3.0, 20001)
    volts = averaged.no_load_speed(structure, drive, Omega) * drive.volts(structure)
    amplitude = averaged.amplitude(structure, drive, Omega) * drive.length
    along = {"voltage": ("speed", volts), "amplitude": ("speed", amplitude)}
    theory = xr.Dataset(along, {"speed": Omega * structure.omega})
    return draw(results, theory, branches_of(arguments, structure, drive), title)


def tell(results: dict[str, xr.Dataset], volts: float) -> None:
    """What was found, in a few lines.

    Parameters
    ----------
    results : dict of xarray.Dataset
        By structure.
    volts : float
        Voltage at eta0 = 1.
    """
    lags = results["bonded"].jump_lag.values if "bonded" in results else [math.nan, math.nan]
    for name, data in results.items():
        told = [told_jump(data.sel(jump=jump), volts, lags[i]) for i, jump in enumerate(data.jump)]
        passed = float(data.passage_time)
        if not any("V" in text for text in told) and math.isfinite(passed):
            told.append(f"beyond the resonance from {passed:.4g} s on")
        print(f"{name}: {data.sizes['revolution']} revolutions; {'; '.join(told)}")
        balance(data)


def told_jump(at: xr.Dataset, volts: float, lag: float) -> str:
    """A jump with its lag, or why there is none.

    Parameters
    ----------
    at : xarray.Dataset
        Of one direction.
    volts : float
        Voltage at eta0 = 1.
    lag : float
        Of the bonded structure, by the averaged theory, V; NaN where it is not known.
    """
    voltage, jump = float(at.jumps), at.jump.item()
    if at.decided.item() == "undecided":
        why = str(at.no_jump.item()).replace("a longer hold", "a longer --hold")
        return f"jump {jump} {why}"
    if not math.isfinite(voltage):
        return f"jump {jump} none ({at.no_jump.item()})"
    text = f"jump {jump} at {voltage:.4f} V (eta0 = {voltage / volts:.4f})"
    held = float(at.held_jumps)
    if math.isfinite(held):
        error = float(at.held_error)
        return f"{text}, told by held voltages: the motion is lost at {held:.4f} +- {error:.4f} V"
    if math.isfinite(lag):
        kind = str(at.averaged_kind.item()) if "averaged_kind" in at else ""
        by = f" ({kind})" if kind not in ("", "fold") else ""
        about = f", about {voltage - lag:.4f} V at rate 0{by}"
        return f"{text}, {abs(lag):.4f} V late at this rate{about}"
    return f"{text}, late by what jump-voltages tells"


def balance(data: xr.Dataset) -> None:
    """What the coupling has lost, and a warning where it is much."""
    missing, defects = (
        float(data.attrs[key]) for key in ("missing_over_motor_work", "defects_over_motor_work")
    )
    print(
        f"  of the motor's work {missing:.1e} is missing, the steps' defects are {defects:.1e} "
        "(small ones alone do not prove accuracy)"
    )
    if max(abs(missing), defects) > LIMIT:
        print(f"  warning: that is more than {LIMIT:g}; take a shorter --step")
