"""Commands on the weak drive: cosimulate, couple, capture, passage, jump-voltages, drive-branch."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..lazy import xr
from ..units import range_text, text_of, units_of, with_units
from .answer import answer
from .drive import (
    CONTROLLER,
    DRIVE,
    ETA0,
    HOLD,
    ONLY,
    RESUME,
    SCHEDULE,
    SETTLE,
    STEP,
    VOLTAGE,
    answer_drive,
    averaged_jump_voltages,
    common_files,
    display,
    drive_units,
    format_title,
    make_controller,
    make_schedule,
    parse_ramp_ends,
    picture_title,
    read_drive_options,
    result_name,
    source_names,
    structures_by_name,
    times_in_seconds,
)
from .grammar import parse_rates, plain_float, read_pairs
from .options import START, read_over, read_structure_options, structure_group
from .output import Files, digest, read_running_options, result_groups, user_fmus
from .table import Command, Group, Question
from .text import Columns, columns_of, extents, parameter_column, table

if TYPE_CHECKING:
    from ..model import Drive, Structure
    from ..weak_drive.couple import CoupleJob

    Results = dict[str, xr.Dataset]  # by structure, or by "" if one result is of both

LISTED = ("parameter", "structuralParameter", "input", "output")
PAIR = "NAME=VALUE"


def run_cosimulate(arguments: argparse.Namespace) -> None:
    """Run ``cosimulate``: simulate both FMUs; or list the drive's variables."""
    if arguments.list:
        for line in variable_lines(arguments.drive):
            print(line)
    else:
        answer(arguments)


def ask_cosimulate(arguments: argparse.Namespace) -> tuple[Structure, Question]:
    """Return structure and keywords of ``cosimulate``."""
    structure = read_structure_options(arguments)
    if arguments.structure == "paper" and not arguments.set:
        raise InputError("--structure is missing; expected one in SI units, as the drive has them")
    question = arguments.row.keywords(arguments)
    for name in ("duration", "step"):
        if question[name] is None:
            raise InputError(f"--{name} is missing; expected seconds, such as --{name} 0.01")
    return structure, question | {
        "drive": str(arguments.drive),
        "connect": read_pairs("--connect", split_at_commas(arguments.connect), PAIR),
        "units": read_pairs("--unit", split_at_commas(arguments.unit), "NAME=UNIT"),
        "parameters": read_values("--parameter", arguments.parameter),
        "inputs": read_values("--input", arguments.input),
        "record": split_at_commas(arguments.record),
    }


def split_at_commas(texts: Sequence[str] | None) -> tuple[str, ...]:
    """Return an option's words, split at commas too."""
    return tuple(word for word in ",".join(texts or ()).split(",") if word)


def read_values(option: str, texts: Sequence[str]) -> dict[str, Any]:
    """Return values by name: numbers, true or false; of inputs also files with time and value."""
    from .. import Course

    found: dict[str, Any] = {}
    for name, text in read_pairs(option, texts, PAIR).items():
        try:
            found[name] = text == "true" if text in ("true", "false") else plain_float(text)
        except ValueError:
            if option != "--input":
                raise InputError(
                    f"{option} {name}={text}: expected a number, true or false"
                ) from None
            found[name] = Course.from_csv(text)
    return found


def variable_lines(drive: Path) -> Iterator[str]:
    """Yield the drive's parameters, inputs and outputs, and what could be connected."""
    from ..fmu.description import describe
    from ..weak_drive.connection import MOTION, proposals

    description = describe(drive)
    yield f"{description.name}, FMI {description.fmi_version}"
    for causality in LISTED:
        for name, variable in description.variables.items():
            if variable.causality == causality:
                value = "" if variable.start is None else str(variable.start)
                about = f"{value:>8} {variable.unit or 'no unit':10} {variable.description or ''}"
                yield f"  {causality:10} {name:28} {about}".rstrip()
    if likely := proposals(description):
        links = " ".join(f"{ours}={theirs}" for ours, theirs in likely.items())
        yield f"likely: --connect {links}   (by unit and name; a run checks the sign of the force)"
    else:
        outputs = " ".join(f"{ours}=OUTPUT" for ours in MOTION)
        yield (
            f"units and names do not tell which are the box's: --connect {outputs} box_force=INPUT "
            "(one motion is enough, all are more exact)"
        )


def cosimulate_summary(data: xr.Dataset) -> Iterator[str]:
    """Yield the ranges of both displacements, the impacts, and the coupling's error."""
    yield from extents(data, "x1 x2")
    yield f"impacts: {data.sizes['impact']} in {float(data.time[-1]):.6g} s"
    worst = text_of(data, data.coupling_error.max(), "m", ".2g")
    yield f"coupling error of the displacements: {worst} (from a second run with half the step)"
    if data.attrs["inputs_at_start"]:
        yield f"no input was given for {data.attrs['inputs_at_start']}, which stays so"


COSIMULATE = Command(
    "cosimulate",
    "both FMUs together: the oscillator and a drive of anybody's",
    """  {program} cosimulate --drive shaker.fmu --list
  {program} cosimulate --structure beam --drive shaker.fmu --duration 2 --step 1e-3
      --connect box_acceleration=table_acc box_force=-force --input volts=3 --record amperes
  {program} cosimulate --structure beam --drive shaker.fmu --connect box_velocity=v box_force=f
      --input volts=volts.csv --duration 2 --step 1e-3""",
    (
        structure_group(),
        Group(
            "the drive",
            """
            --drive FMU !  FMI 2.0 or 3.0
            --list  show its variables, propose connections, and end
            --connect OURS=THEIRS +  box_acceleration (or box_velocity, box_position) and box_force,
                by names of the drive; a minus before a name turns its sign
            --unit NAME=UNIT +  units of connected variables that it does not state, or not rightly
            --parameter NAME=VALUE +  its start values
            --input NAME=VALUE +  its other inputs: a number, or a CSV file with time in s and value
            --record NAME +  variables of the drive that are stored
            """,
        ),
        Group(
            "the run",
            "",
            (
                "--duration S  of the run, s (needed)\n--step S  communication step, s (needed)",
                START,
            ),
        ),
        *result_groups(),
    ),
    run_cosimulate,
    ask_cosimulate,
    cosimulate_summary,
)

ERROR_LIMIT = 1e-6  # of the motor's work: larger errors give a warning


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


def run_couple(arguments: argparse.Namespace) -> None:
    """Run ``couple``: compute the coupled runs; print jumps; write files, pictures or SSP."""
    import orchestrate

    from ..fmu import finder
    from ..running.options import RunOptions
    from ..running.runner import answer_all
    from ..running.store import load

    structure, drive = read_drive_options(arguments)
    jobs = make_jobs(arguments, structure, drive)
    if arguments.ssp:
        print(write_package(arguments, drive, jobs[-1], user_fmus(arguments.fmu)))
        return
    files = [Files.from_options(arguments, job.name) for job in jobs]
    running, branches = read_running_options(arguments), None
    answer_all(jobs, arguments.output, RunOptions.from_keywords(running), finder(running))
    states = structures_by_name(arguments, structure)
    results = {state: load(one.result) for state, one in zip(states, files, strict=True)}
    asked, shown = display(arguments, results)
    if arguments.branches:
        digits = digest(structure.as_delaminated().parameters(), drive.parameters())
        store = arguments.output / f"branches_{'_'.join(source_names(arguments))}_{digits}.nc"
        running = read_running_options(arguments, store)
        branches = orchestrate.drive_branch(structure, drive, **running)
        branches = with_units(branches, drive_units(arguments))
        print(*drive_branch_lines({"": branches}), sep="\n")
    print(*couple_lines(shown, drive.volts(structure)), sep="\n")
    for one, data in zip(files, asked.values(), strict=True):
        one.write(data)
    picture = common_files(arguments, jobs[0].name.rpartition("_")[0], files)
    title = picture_title(arguments, shown, format_title(shown, jobs[0].control))
    picture.write_pictures(partial(draw_couple, title, shown, structure, drive, jobs[0], branches))
    if any(data.jumps.notnull().any() for data in results.values()):
        draw = partial(orchestrate.plot, *shown.values(), part="jumps", title=title)
        picture.write_pictures(draw, "jumps")


def write_package(
    arguments: argparse.Namespace, drive: Drive, job: CoupleJob, user_fmus: Mapping[str, Path]
) -> Path:
    """Write the coupled system as an SSP file with its FMUs; return its path."""
    from ..fmu import find
    from ..weak_drive.ssp import write_ssp

    folder = arguments.build_folder
    fmus = [find(model, "fmi2", folder, user_fmus.get(model)).path for model in job.models]
    voltage, speed = job.schedule.voltage(0.0), job.speed_start
    return write_ssp(
        arguments.ssp, job.structure, drive, voltage=voltage, speed_start=speed, fmus=fmus
    )


def draw_couple(
    title: str,
    results: Results,
    structure: Structure,
    drive: Drive,
    job: CoupleJob,
    branches: xr.Dataset | None,
) -> Any:
    """Draw the runs: ramps with averaged theory and branches, others over time."""
    import numpy as np

    from ..show.passage import draw_run
    from ..show.weak_drive import draw
    from ..weak_drive import averaged, own_resonance
    from ..weak_drive.schedule import Ramp

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


def couple_lines(results: Results, volts: float) -> Iterator[str]:
    """Yield revolutions and speeds of each run, a table of jumps, and the runs' accuracy."""
    names = ("structure", "jump", "voltage V", "eta0", "of the ramp V", "decided")
    columns: dict[str, list[str]] = {name: [] for name in names}
    for name, data in results.items():
        ends = float(data.speed.min()), float(data.speed.max())
        passed = float(data.passage_time)
        line = (
            f"{name}: {data.sizes['revolution']} revolutions at {range_text(data, *ends, 'rad/s')}"
        )
        if math.isfinite(passed) and not data.jumps.notnull().any():
            line += f", beyond the resonance from {passed:.4g} s on"
        yield line
        missing, defects = (
            float(data.attrs[f"{key}_over_motor_work"]) for key in ("missing", "defects")
        )
        doubt = f": more than {ERROR_LIMIT:g}, take a shorter --step"
        yield (
            f"  relative energy error {missing:.1e}, coupling error {defects:.1e} of the motor's "
            f"work{doubt if max(abs(missing), defects) > ERROR_LIMIT else ''}"
        )
        for jump in data.jump.values:
            cells = (name, *jump_cells(data.sel(jump=jump), volts))
            for column, cell in zip(columns.values(), cells, strict=True):
                column.append(cell)
    yield from table(columns)


def jump_cells(at: xr.Dataset, volts: float) -> tuple[str, ...]:
    """Return the cells of a jump: direction, voltage, eta0, the ramp's voltage, how decided."""
    voltage, direction = float(at.jumps), str(at.jump.item())
    if not math.isfinite(voltage):
        word = "undecided" if at.decided.item() == "undecided" else "none"
        reason = str(at.no_jump.item()).replace("a longer hold", "a longer --hold")
        return direction, word, "", "", reason
    error = 0.5 * abs(float(at.jump_high) - float(at.jump_low))
    shown, decided = f"{float(at.ramp_voltage):.4f}", str(at.decided.item())
    return direction, f"{voltage:.5f} +- {error:.5f}", f"{voltage / volts:.5f}", shown, decided


COUPLE = Command(
    "couple",
    "the weak drive: structure and motor coupled, the voltage up and down (Figure 2)",
    f"""  {{program}} couple                               quick: bonded, delaminated, up and down
  {{program}} couple --drive beam                  a delaminated beam on a small motor
  {{program}} couple --drive motor.toml            a motor, box and structure of your own
  {{program}} couple --eta0 1.4:1.62 --rate 1e-5   a slower ramp over less
  {{program}} couple --drive beam --voltage 5.6:7.2 --volt-rate 0.01
  {{program}} couple --drive beam --voltage 6.5 --duration 10 --speed-control 110
  {{program}} couple --increment 0.005             in steps of the voltage, each with time to settle
  {{program}} couple --course voltage.csv          any course of the voltage
  {{program}} couple --ssp weak_drive.ssp          the coupled system as a package for other tools
{ETA0}
A ramp shows its jumps late: voltages are those of rate 0, at which the motion is lost.
{RESUME}""",
    (
        *DRIVE,
        ONLY,
        SCHEDULE,
        CONTROLLER,
        Group(
            "master",
            (
                STEP,
                HOLD,
                """
                --tolerance X  step-size tolerance: largest defect over the work exchanged in a step
                    (default: 1e-7)
                """,
            ),
        ),
        Group(
            options="""
            --branches  compute the branches of stationary motions too, and draw them under the
                ramps
            --ssp FILE  write the coupled system for other tools instead
            """
        ),
        *result_groups(store=False, several=True),
    ),
    run_couple,
)

UNDECIDED, NEITHER = "undecided", "settled at the resonance"
REASONS = {
    UNDECIDED: "undecided: the speed had not settled; give a longer --time",
    NEITHER: "neither passed nor captured: the speed settles at the resonance",
}


def ask_capture(arguments: argparse.Namespace) -> tuple[Structure, Drive, Question]:
    """Return structure, drive and keywords of ``capture``."""
    structure, drive = read_drive_options(arguments)
    values = read_over(arguments)
    if arguments.eta0 or arguments.voltage:
        ends = parse_ramp_ends(arguments, structure, drive)
    else:
        down, up = averaged_jump_voltages(arguments, structure, drive)
        ends = down, 1.06 * up
    question = arguments.row.keywords(arguments)
    question |= {"voltage": ends, "over": arguments.over, "values": values and values[0]}
    question["control"] = make_controller(arguments, structure, drive)
    return structure, drive, question | times_in_seconds(arguments, structure, "step")


def capture_title(_: Results, question: Question) -> str:
    """Return a part of the picture's title: how the motor is started, and the voltages."""
    control = question["control"]
    switched = f"controlled by {type(control).__name__}" if control else "switched on from rest"
    return "{}, {:.4g} V to {:.4g} V".format(switched, *question["voltage"])


def capture_lines(results: Results) -> Iterator[str]:
    """Yield a table of the threshold voltages, undecided starts, and warnings."""
    rows: list[dict[str, str]] = []
    notes: list[str] = []
    for state, data in results.items():
        (over,) = {str(dim) for dim in data.passes.dims} - {"voltage"} or {""}
        for part in [data.sel({over: value}) for value in data[over].values] if over else [data]:
            where = {over: f"{float(part[over]):g}"} if over else {}
            rows.append({"structure": state, **where, **threshold_cells(part)})
            for decision, reason in REASONS.items():
                tried = part.voltage.values[part.decision.values == decision]
                if tried.size:
                    notes.append(f"{state}, {', '.join(f'{v:.5g}' for v in tried)} V {reason}")
            if float(part.above_fold):
                fold = f"{float(part.fold):.5f} V"
                notes.append(
                    f"warning: {state}, above the fold at {fold}, beyond which the averaged theory "
                    "has no motion below the resonance"
                )
    yield from table({title: [row[title] for row in rows] for title in rows[0]}, len(rows))
    yield from notes


def threshold_cells(data: xr.Dataset) -> dict[str, str]:
    """Return the cells of one threshold: voltage, counts of starts, speeds, passage time."""
    passes = int((data.passes.values > 0).sum())
    open_ones = int(data.decision.isin(list(REASONS)).sum())
    low, high = float(data.border_low), float(data.border_high)
    border = "none"
    if math.isfinite(float(data.border)):
        narrow = high - low <= float(data.border.attrs["tolerance"])
        error = f"{0.5 * (high - low):.1g}"
        border = f"{float(data.border):.5f} +- {error}" if narrow else f"{low:.5f} to {high:.5f}"
    speeds = (
        "" if math.isnan(float(data[name])) else text_of(data, data[name], "rad/s", ".4g")
        for name in ("speed_low", "speed_high")
    )
    titles = ("passes from V", "pass", "captured", "undecided", "speed below", "beyond")
    counts = (str(passes), str(data.decision.size - passes - open_ones), str(open_ones))
    return dict(zip(titles, (border, *counts, *speeds), strict=True))


CAPTURE = Command(
    "capture",
    "voltages switched on from rest: which pass the resonance, which are captured",
    f"""  {{program}} capture                                       quick, bonded and delaminated
  {{program}} capture --drive beam --voltage 6.1:6.9
  {{program}} capture --over rotor_inertia --values 600:1600:200
  {{program}} capture --drive beam --set armature_resistance=120 --voltage 7:10 --speed-gradient
{ETA0}
The motor is switched on at once and followed until its speed has settled.
{RESUME}""",
    (
        *DRIVE,
        ONLY,
        Group(
            "question",
            (
                """
                --eta0 LOWEST:HIGHEST  voltage as no-load speed over omega (default: from the jump
                    down to above the jump up)
                --voltage LOWEST:HIGHEST  the same in V
                --over NAME  a second parameter, of drive or structure
                --values VALUES  its values, FIRST:LAST:STEP or a list A,B,...
                """,
                STEP,
            ),
            declared="count tolerance time",
        ),
        CONTROLLER,
        *result_groups(store=False, several=True),
    ),
    answer_drive,
    ask_capture,
    capture_lines,
    title=capture_title,
)


def ask_passage(arguments: argparse.Namespace) -> tuple[Structure, Drive, Question]:
    """Return structure, drive and keywords of ``passage``."""
    from ..weak_drive.schedule import Constant

    structure, drive = read_drive_options(arguments)
    if arguments.revolutions < 1:
        raise InputError(f"--revolutions {arguments.revolutions}: expected a whole number >= 1")
    control = make_controller(arguments, structure, drive)
    schedule = make_schedule(arguments, structure, drive, control)
    around = arguments.around
    if around is None and not isinstance(schedule, Constant):
        around = 300.0 / structure.omega
    times = times_in_seconds(arguments, structure, "step", "hold")
    return structure, drive, {"voltage": schedule, "around": around, "control": control, **times}


def first_stored_interval(data: xr.Dataset) -> xr.Dataset:
    """Return the samples of the first jump where a run is stored around several."""
    import numpy as np

    gaps = np.diff(data.time.values)
    breaks = np.flatnonzero(gaps > 1.5 * np.median(gaps))
    return data.isel(time=slice(0, int(breaks[0]) + 1)) if breaks.size else data


def passage_title(results: Results, question: Question) -> str:
    """Return a part of the picture's title: voltages, rate and controller."""
    shown = {state: first_stored_interval(data) for state, data in results.items()}
    return format_title(shown, question["control"])


def draw_passage(results: Results, arguments: argparse.Namespace, title: str) -> Any:
    """Draw passages with waterfalls of their spectra; return the figure."""
    from .. import waterfall
    from ..show.passage import draw

    spectra = {"revolutions": arguments.revolutions, "mass": arguments.mass}
    shown = {state: first_stored_interval(data) for state, data in results.items()}
    falls = {state: waterfall(data, **spectra) for state, data in shown.items()}
    return draw(shown, falls, title)


def passage_lines(results: Results) -> Iterator[str]:
    """Yield a line per structure: samples, times, jumps or passage."""
    from ..show.passage import format_jumps

    for state, data in results.items():
        count, first, last = data.sizes["time"], float(data.time[0]), float(data.time[-1])
        samples = f"{count} samples, {first:.4g} s to {last:.4g} s ({data.attrs['kept']})"
        moved = text_of(data, abs(data.x1).max(), "m", ".4g")
        speed = text_of(data, abs(data.speed).max(), "rad/s", ".4g")
        yield f"{state}: {format_jumps(data)}; {samples}; largest |x1| {moved}, speed up to {speed}"


PASSAGE = Command(
    "passage",
    "a run through the resonance at full resolution: speed, motion, power, waterfall",
    f"""  {{program}} passage --eta0 1.4:1.65 --one-way               quick through its resonance
  {{program}} passage --drive rig --one-way --around 3
  {{program}} passage --drive beam --voltage 6.5 --duration 10 --speed-control 110
{ETA0}
{RESUME}""",
    (
        *DRIVE,
        ONLY,
        SCHEDULE,
        CONTROLLER,
        Group(
            "what is kept and drawn",
            (
                """
                --around S  time before and after the jump, or the passage where there is no jump,
                    in s (default: 300/omega; all of a run at one voltage)
                --revolutions N = 8  revolutions of each spectrum of the waterfall
                --mass {1,2} = 1  whose acceleration the spectra are of
                """,
                STEP,
                HOLD,
            ),
        ),
        *result_groups(store=False, several=True),
    ),
    answer_drive,
    ask_passage,
    passage_lines,
    draw_passage,
    title=passage_title,
)

USUAL_LIST = "1e-4,5e-5,2.5e-5"


def ask_jump_voltages(arguments: argparse.Namespace) -> tuple[Structure, Drive, Question]:
    """Return structure, drive and keywords of ``jump-voltages``."""
    structure, drive = read_drive_options(arguments)
    unit = drive.volts(structure) * structure.omega
    question: Question = {
        "voltage": parse_ramp_ends(arguments, structure, drive),
        "rates": [rate * unit for rate in parse_rates("--rate", arguments.rate or USUAL_LIST)],
        "back": not arguments.one_way,
    }
    if (values := read_over(arguments)) is not None:
        question |= {"over": arguments.over, "values": values[0]}
    return structure, drive, question | times_in_seconds(arguments, structure, "settle", "step")


def jump_voltages_title(_: Results, question: Question) -> str:
    """Return a part of the picture's title: the ramps' voltages and rates."""
    ends = "{:.4g} V to {:.4g} V".format(*question["voltage"])
    rates = dict.fromkeys(f"{end(question['rates']):.2g} V/s" for end in (min, max))
    return f"{ends}, {' to '.join(rates)}, and at rate 0"


def jump_voltage_lines(results: Results) -> Iterator[str]:
    """Yield a table of the jump voltages at rate 0, and advice if one is missing."""
    (data,) = results.values()
    # a direction in which no ramp went has not been decided
    data = data.sel(jump=[jump for jump in data.jump.values if data.decided.sel(jump=jump).any()])
    (over,) = {str(dim) for dim in data.jumps.dims} - {"structure", "jump"} or {""}
    rows: Columns = {"jump at rate 0": [str(jump) for jump in data.jump.values]}
    if over:
        count, parts = data.sizes["jump"], data[over].values
        rows = parameter_column(data, over, [v for v in parts for _ in range(count)])
        rows["jump at rate 0"] = [str(jump) for _ in parts for jump in data.jump.values]
        data = data.stack(row=(over, "jump"), create_index=False)
    for name in map(str, data.structure.values):
        at = data.sel(structure=name)
        cells = zip(at.jumps.values, at.standard_error.values, at.decided.values, strict=True)
        rows[f"{name} V"] = [
            f"{value:.5f} +- {error:.5f}"
            if math.isfinite(value)
            else ("undecided" if decided == "undecided" else "none")
            for value, error, decided in cells
        ]
    changes = data.jumps.isel(structure=1) - data.jumps.isel(structure=0)
    rows["change V"] = ["" if math.isnan(change) else f"{change:.5f}" for change in changes.values]
    yield from table(rows, len(rows["change V"]))
    if (data.decided == "undecided").any():
        yield "undecided by constant voltages; drive-branch shows which motions are stable"


JUMP_VOLTAGES = Command(
    "jump-voltages",
    "voltages at which the speed jumps, at rate 0 and on ramps of several rates",
    f"""  {{program}} jump-voltages                                 quick, up and down
  {{program}} jump-voltages --rate 1e-4,3e-5,1e-5 --one-way
  {{program}} jump-voltages --over clearance --values 0,1e-5,3e-5 --drive beam --one-way
  {{program}} jump-voltages --drive beam --eta0 1.33:1.57 --rate 4e-5,2e-5,1e-5 --one-way
{ETA0}
{RESUME}""",
    (
        *DRIVE,
        Group(
            "ramps",
            (
                VOLTAGE,
                f"""
                --rate A,B,...  change of eta0 in a time 1/omega, a list (default: {USUAL_LIST})
                {SETTLE}
                --one-way  do not come back: jumps up only
                --over NAME  a parameter that the bonded structure ignores, such as clearance
                --values VALUES  its values, FIRST:LAST:STEP or a list A,B,...
                """,
                STEP,
            ),
        ),
        *result_groups(several=True),
    ),
    answer_drive,
    ask_jump_voltages,
    jump_voltage_lines,
    title=jump_voltages_title,
)


def ask_drive_branch(arguments: argparse.Namespace) -> tuple[Structure, Drive, Question]:
    """Return structure, drive and keywords of ``drive-branch``."""
    return *read_drive_options(arguments), arguments.row.keywords(arguments)


def drive_branch_title(results: Results, _: Question) -> str:
    """Return a part of the picture's title: the voltages."""
    voltage = results[""].voltage
    return f"stationary motions, {float(voltage.min()):.4g} V to {float(voltage.max()):.4g} V"


def unlocated_changes(leg: xr.Dataset, located: Any) -> str:
    """Return the speeds at which a branch's stability changes without a located bifurcation."""
    at = leg.dropna("point", subset=["voltage"])
    stable, speeds = at.stable.values.astype(int), []
    for i in (stable[1:] != stable[:-1]).nonzero()[0]:
        low, high = sorted(at.speed.values[i : i + 2])
        if not ((located > 2.0 * low - high) & (located < 2.0 * high - low)).any():
            speeds.append(text_of(at, low, "rad/s", ".5g"))
    return ", ".join(speeds)


def drive_branch_lines(results: Results) -> Iterator[str]:
    """Yield tables of the bifurcations and of the branches."""
    (data,) = results.values()
    if count := data.sizes["bifurcation"]:
        yield from table(columns_of(data, "structure kind voltage speed", "bifurcation_"), count)
    else:
        yield "no bifurcations"
    legs = [data.sel(structure=name, leg=leg) for name in data.structure for leg in data.leg]
    legs = [leg for leg in legs if leg.voltage.notnull().any()]
    columns = {
        "branch": [f"{leg.structure.item()}, {leg.leg.item()}" for leg in legs],
        "motions": [str(int(leg.voltage.notnull().sum())) for leg in legs],
        "stable": [str(int(leg.stable.sum())) for leg in legs],
        "ends by": [str(leg.end.item()) for leg in legs],
    }
    unlocated = [unlocated_changes(leg, data.bifurcation_speed.values) for leg in legs]
    if any(unlocated):
        columns["stability changes near, not located (--period)"] = unlocated
    yield from table(columns, len(legs))


DRIVE_BRANCH = Command(
    "drive-branch",
    "stationary motions of structure and motor, stable and unstable, and their bifurcations",
    """  {program} drive-branch                              quick, bonded and delaminated
  {program} drive-branch --drive beam --speed 92:110
Branches go round their folds. Repeat the command to resume an interrupted run.""",
    (
        *DRIVE,
        Group(
            "question",
            "",
            "--speed FIRST:LAST  range of mean speeds, rad/s (default: 0.95 and 1.25 times the "
            "resonance)",
            "longest most period steps settle",
        ),
        *result_groups(several=True),
    ),
    answer_drive,
    ask_drive_branch,
    drive_branch_lines,
    title=drive_branch_title,
)

COMMANDS = (COSIMULATE, COUPLE, CAPTURE, PASSAGE, JUMP_VOLTAGES, DRIVE_BRANCH)
