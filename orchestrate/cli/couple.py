"""Command ``couple``: ramp the motor's voltage with the structure on it; find the speed's jumps."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..units import range_text, units_of, with_units
from .drive_options import (
    add_controller_options,
    add_hold_option,
    add_only_option,
    add_schedule_options,
    add_step_option,
    format_title,
    make_controller,
    make_schedule,
    picture_path,
    result_name,
    structures_by_name,
    times_in_seconds,
    with_display_units,
    with_readable_units,
)
from .grammar import plain_float
from .options import Commands, read_drive_options
from .output import (
    add_result_options,
    check_file_options,
    digest,
    draw_picture,
    export_formats,
    read_running_options,
    units_ending,
    user_fmus,
    with_ending,
)

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Drive, Structure
    from ..weak_drive.couple import CoupleJob

Folds = dict[tuple[str, str], float]  # by structure and direction, V
ERROR_LIMIT = 1e-6  # of the motor's work: larger errors give a warning
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
A ramp shows its jumps late: voltages are those of rate 0, at which the motion is lost.
Interrupted, the same command goes on where it was. A finished result is left as it is."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``couple`` with all its options."""
    text = "the weak drive: structure and motor coupled, the voltage up and down (Figure 2)"
    parser = commands.add_drive_command("couple", run, text, EXAMPLES)
    add_only_option(parser)
    add_schedule_options(parser)
    add_controller_options(parser)
    add_master_options(parser)
    branches = "compute the branches of stationary motions too, and draw them under the ramps"
    parser.add_argument("--branches", action="store_true", help=branches)
    add_result_options(parser, store=False, several=True)
    package = "write the coupled system for other tools instead"
    parser.add_argument("--ssp", type=Path, metavar="FILE", help=package)


def add_master_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of the co-simulation master: step, hold and tolerance."""
    group = parser.add_argument_group("master")
    add_step_option(group)
    add_hold_option(group)
    text = "step-size tolerance: largest defect over the work exchanged in a step (default: 1e-7)"
    group.add_argument("--tolerance", type=plain_float, help=text)


def make_jobs(arguments: argparse.Namespace, structure: Structure, drive: Drive) -> list[CoupleJob]:
    """Return the jobs for the runs asked for, a ``CoupleJob`` per structure, bonded first."""
    from ..weak_drive.couple import couple_job, scheme_from_arguments

    control = make_controller(arguments, structure, drive)
    schedule = make_schedule(arguments, structure, drive, control)
    step, hold = times_in_seconds(arguments, structure, "step", "hold").values()
    scheme = scheme_from_arguments(structure, step, arguments.tolerance, control is not None)
    base_name = result_name(arguments, structure, drive, (schedule, scheme, control, hold))
    return [
        replace(
            couple_job(chosen, drive, schedule, scheme, control=control, hold=hold),
            name=f"{base_name}_{state}",
        )
        for state, chosen in structures_by_name(arguments, structure).items()
    ]


def run(arguments: argparse.Namespace) -> None:
    """Run ``couple``: compute the coupled runs; print jumps; write files, pictures or SSP."""
    from ..access import finder
    from ..running.options import RunOptions
    from ..running.runner import answer_all
    from ..running.store import load

    structure, drive = read_drive_options(arguments)
    jobs = make_jobs(arguments, structure, drive)
    if arguments.ssp:
        print(write_package(arguments, drive, jobs[-1], user_fmus(arguments.fmu)))
        return
    formats, plots = check_file_options(arguments)
    running = read_running_options(arguments)
    paths = [arguments.output / f"{job.name}.nc" for job in jobs]
    fresh = arguments.force or not all(path.exists() for path in paths)
    answer_all(jobs, arguments.output, RunOptions.from_keywords(running), finder(running))
    states = structures_by_name(arguments, structure)
    results = {state: load(path) for state, path in zip(states, paths, strict=True)}
    asked = with_display_units(arguments, results)
    shown = with_readable_units(asked)
    branches = compute_branches(arguments, structure, drive)
    print_results(shown, drive.volts(structure), folds_crossed(branches, structure, drive))
    for data, path in zip(asked.values(), paths, strict=True):
        table = with_ending(path, units_ending(arguments))
        for file in (path, *export_formats(data, table, formats, fresh)):
            print(file)
    picture = picture_path(arguments, jobs[0].name.rpartition("_")[0])
    files = draw_picture(
        picture,
        plots,
        fresh,
        lambda: draw_results(arguments, shown, structure, drive, jobs[0], branches),
    )
    for file in (*files, *draw_jumps(arguments, shown, picture, plots, fresh)):
        print(file)


def write_package(
    arguments: argparse.Namespace, drive: Drive, job: CoupleJob, user_fmus: Mapping[str, Path]
) -> Path:
    """Write the coupled system as an SSP file with its FMUs; return its path."""
    from ..access import find
    from ..weak_drive.ssp import write_ssp

    folder = arguments.build_folder
    fmus = [find(model, "fmi2", folder, user_fmus.get(model)).path for model in job.models]
    voltage, speed = job.schedule.voltage(0.0), job.speed_start
    return write_ssp(
        arguments.ssp, job.structure, drive, voltage=voltage, speed_start=speed, fmus=fmus
    )


def compute_branches(
    arguments: argparse.Namespace, structure: Structure, drive: Drive
) -> xr.Dataset | None:
    """Compute stationary branches, print bifurcations; return None without ``--branches``."""
    from ..weak_drive.drive_branch import drive_branch

    if not arguments.branches:
        return None
    digits = digest(structure.as_delaminated().parameters(), drive.parameters())
    store = arguments.output / f"branches_{Path(arguments.drive).stem}_{digits}.nc"
    branches = drive_branch(structure, drive, **read_running_options(arguments, store))
    for kind, name, volts in zip(
        *(branches[f"bifurcation_{of}"].values for of in ("kind", "structure", "voltage")),
        strict=True,
    ):
        print(f"{name}: {kind} at {volts:.4f} V")
    return branches


def draw_jumps(
    arguments: argparse.Namespace,
    results: dict[str, xr.Dataset],
    picture: Path,
    plots: tuple[str, ...],
    fresh: bool,
) -> list[Path]:
    """Draw speed and amplitude around each jump into a second picture; return its paths, if any."""
    import numpy as np

    if not any(np.isfinite(data.jumps).any() for data in results.values()):
        return []

    def draw() -> Any:
        """Draw the jumps of all runs; return the figure."""
        from ..figures import weak_drive

        return weak_drive.draw_jumps(results, format_title(results, Path(arguments.drive).stem))

    return draw_picture(picture.with_stem(f"{picture.stem}_jumps"), plots, fresh, draw)


def draw_results(
    arguments: argparse.Namespace,
    results: dict[str, xr.Dataset],
    structure: Structure,
    drive: Drive,
    job: CoupleJob,
    branches: xr.Dataset | None,
) -> Any:
    """Draw the runs: ramps with averaged theory and branches, others over time."""
    import numpy as np
    import xarray as xr

    from ..figures.passage import draw_run
    from ..figures.weak_drive import draw
    from ..weak_drive import averaged, own_resonance
    from ..weak_drive.schedule import Ramp

    control = type(job.control).__name__ if job.control else ""
    title = format_title(results, Path(arguments.drive).stem, control)
    if job.control or not isinstance(job.schedule, Ramp):
        resonance = own_resonance.dividing_speed(structure, drive) * structure.omega
        return draw_run(results, resonance, title)
    Omega = np.linspace(0.3, 3.0, 20001)
    volts = averaged.no_load_speed(structure, drive, Omega) * drive.volts(structure)
    amplitude = averaged.amplitude(structure, drive, Omega) * drive.length
    points, stable = averaged.branch_stability(structure, drive)
    part = np.searchsorted([point.Omega for point in points], Omega)
    theory = xr.Dataset(
        {
            "voltage": ("speed", volts),
            "amplitude": ("speed", amplitude, {"units": "m"}),
            "stable": ("speed", np.array(stable)[part]),
        },
        {"speed": ("speed", Omega * structure.omega, {"units": "rad/s"})},
        structure.parameters(),
    )
    units = units_of(next(iter(results.values())))
    under = None if branches is None else with_units(branches, units)
    return draw(results, with_units(theory, units), under, title)


def folds_crossed(branches: xr.Dataset | None, structure: Structure, drive: Drive) -> Folds:
    """Return the voltages, V, of the folds at which slow ramps jump across the resonance, by run.

    A ramp may jump before to another motion on the same side: that fold is not meant.
    """
    from ..weak_drive import own_resonance
    from ..weak_drive.ramp_path import ramp_paths

    folds: Folds = {}
    if branches is None:
        return folds
    volts, speeds = (branches[f"bifurcation_{of}"].values for of in ("voltage", "speed"))
    for name in map(str, branches.structure.values):
        kind = structure.as_bonded() if name == "bonded" else structure.as_delaminated()
        threshold = own_resonance.dividing_speed(kind, drive) * structure.omega
        for jump, path in ramp_paths(branches, name).items():
            for fold, landing in zip(path.jumps, path.landings, strict=False):
                ends = (speeds[fold], landing) if jump == "up" else (landing, speeds[fold])
                if ends[0] < threshold < ends[1]:
                    folds.setdefault((name, jump), float(volts[fold]))
    return folds


def print_results(results: dict[str, xr.Dataset], volts: float, folds: Folds | None = None) -> None:
    """Print a line per structure: revolutions, speeds, jumps and lags; then the run's accuracy."""
    for name, data in results.items():
        texts = [
            format_jump(data.sel(jump=jump), volts, (folds or {}).get((name, str(jump))))
            for jump in data.jump.values
        ]
        passed = float(data.passage_time)
        if not any("V" in text for text in texts) and math.isfinite(passed):
            texts.append(f"beyond the resonance from {passed:.4g} s on")
        print(f"{name}: {format_revolutions(data)}; {'; '.join(texts)}")
        print_accuracy(data)


def format_revolutions(data: xr.Dataset) -> str:
    """Format a run's number of revolutions and its range of speeds."""
    ends = (float(data.speed.min()), float(data.speed.max()))
    speeds = range_text(data, *ends, "rad/s")
    return f"{data.sizes['revolution']} revolutions at {speeds}"


def format_jump(at: xr.Dataset, volts: float, fold: float | None = None) -> str:
    """Format a jump with its voltage and lag, or why there is none."""
    voltage, jump = float(at.jumps), at.jump.item()
    if at.decided.item() == "undecided":
        why = str(at.no_jump.item()).replace("a longer hold", "a longer --hold")
        return f"jump {jump} {why}"
    if not math.isfinite(voltage):
        return f"jump {jump} none ({at.no_jump.item()})"
    error = 0.5 * abs(float(at.jump_high) - float(at.jump_low))
    text = f"jump {jump} at {voltage:.5f} +- {error:.5f} V (eta0 = {voltage / volts:.5f})"
    text += f", shown at {float(at.ramp_voltage):.4f} V by the ramp"
    return text if fold is None else f"{text}; its branch has a fold at {fold:.4f} V"


def print_accuracy(data: xr.Dataset) -> None:
    """Print a run's energy and coupling errors, and a warning if they are large."""
    missing, defects = (
        float(data.attrs[key]) for key in ("missing_over_motor_work", "defects_over_motor_work")
    )
    print(
        f"  relative energy error {missing:.1e}, coupling error {defects:.1e} of the motor's work "
        "(small values alone do not prove accuracy)"
    )
    if max(abs(missing), defects) > ERROR_LIMIT:
        print(f"  warning: that is more than {ERROR_LIMIT:g}; take a shorter --step")
