"""Options and steps that the commands of the weak drive share: voltage, controller, files."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..units import Units, with_readable_lengths, with_units
from .grammar import parse_ends, parse_number_or_ends, parse_rates, plain_float
from .output import (
    Files,
    digest,
    draw_picture,
    print_units_note,
    read_running_options,
    read_units,
    units_ending,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr

    from ..structures import Drive, Structure
    from ..weak_drive.controllers import Controller
    from ..weak_drive.schedule import Schedule

USUAL = {"quick": ("1.2:1.65", 1e-4), "beam": ("1.25:1.6", 5e-6), "rig": ("0.95:1.24", 5e-5)}
RATE = 1e-4  # of eta0, in a time 1/omega


# -- options --------------------------------------------------------------------------------------


def add_only_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--only``: compute the bonded or the delaminated structure alone."""
    only = "one of both (default: both)"
    parser.add_argument("--only", choices=("bonded", "delaminated"), help=only)


def add_voltage_options(group: Any, form: str = "FIRST:LAST", usual: str = "") -> None:
    """Add ``--eta0`` and ``--voltage``: the ends of a ramp, or one voltage."""
    usual = usual or "about the jumps of the averaged theory"
    text = f"voltage as no-load speed over omega (default: {usual})"
    group.add_argument("--eta0", metavar=form, help=text)
    group.add_argument("--voltage", metavar=form, help="the same in V")


def add_schedule_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of the voltage over time: ramp, steps, one value, or a CSV file."""
    group = parser.add_argument_group("voltage over time: a ramp, steps, one value, or a file")
    option = group.add_argument
    add_voltage_options(group, "FIRST:LAST or VALUE")
    option("--duration", type=plain_float, metavar="S", help="time of a single VALUE, in s")
    course = "CSV file with time in s and voltage in V, a row each: straight lines between, instead"
    option("--course", type=Path, metavar="FILE", help=course)
    add_rate_option(group, "RATE", "")
    option("--volt-rate", metavar="RATE", help="the same in V/s")
    steps = "change eta0 in steps of this height, at the same mean rate (default: a ramp)"
    option("--increment", type=plain_float, default=0.0, help=steps)
    add_settle_option(group)
    option("--one-way", action="store_true", help="do not come back")


def add_rate_option(group: Any, form: str, more: str, default: str = "") -> None:
    """Add ``--rate``: the change of eta0 in a time 1/omega."""
    usual = ", ".join(f"{rate:g} for {name}" for name, (_, rate) in USUAL.items())
    default = default or f"{usual}, else {RATE:g}"
    text = f"change of eta0 in a time 1/omega{more} (default: {default})"
    group.add_argument("--rate", metavar=form, help=text)


def add_settle_option(group: Any) -> None:
    """Add ``--settle``: the time at the first voltage, in 1/omega."""
    text = "time at the first voltage, in 1/omega (default: %(default)s)"
    group.add_argument("--settle", type=plain_float, default=300.0, help=text)


def add_step_option(group: Any) -> None:
    """Add ``--step``: the communication step, in 1/omega."""
    text = (
        "communication step, in 1/omega (default: controlled by its defect, at most 0.4; 0.1 where "
        "a controller or a picture takes samples)"
    )
    group.add_argument("--step", type=plain_float, help=text)


def add_hold_option(group: Any) -> None:
    """Add ``--hold``: the longest time for which a test holds a voltage, in 1/omega."""
    text = (
        "longest time for which a voltage is held where the record suggests a jump, 0 for none, in "
        "1/omega (default: 4000 and 200 times the rotor's own)"
    )
    group.add_argument("--hold", type=plain_float, metavar="TIME", help=text)


def add_controller_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of a speed controller: PI control or the speed-gradient method."""
    title = "controller: starts from rest, takes a part of the voltage at every communication step"
    option = parser.add_argument_group(title).add_argument
    option(
        "--speed-control", type=plain_float, metavar="SPEED", help="hold a speed in rad/s, by PI"
    )
    option("--gain", type=plain_float, help="of the PI control, V s/rad (default: 5 K)")
    option("--reset-time", type=plain_float, metavar="S", help="of it, s (default: J R_a/K^2)")
    rise = "rate at which the wanted speed rises, rad/s2 (default: at once)"
    option("--speed-rise", type=plain_float, metavar="RATE", help=rise)
    swing = "swing the rotor across the resonance by the speed-gradient method"
    option("--speed-gradient", action="store_true", help=swing)
    option("--filter-time", type=plain_float, metavar="S", help="of it, s (default: 30/omega)")
    low = "part of the voltage while slower than the mean (default: 0.6)"
    option("--low", type=plain_float, metavar="PART", help=low)


# -- what they mean -------------------------------------------------------------------------------


def structures_by_name(arguments: argparse.Namespace, structure: Structure) -> dict[str, Structure]:
    """Return a dict of the bonded and the delaminated structure, or of the one ``--only`` names."""
    both = {"bonded": structure.as_bonded(), "delaminated": structure.as_delaminated()}
    return {arguments.only: both[arguments.only]} if arguments.only else both


def parse_voltages(
    arguments: argparse.Namespace, structure: Structure, drive: Drive
) -> tuple[float, ...]:
    """Return one voltage or a ramp's first and last one, V; by default around the jumps."""
    if arguments.eta0 and arguments.voltage:
        raise InputError("--eta0 and --voltage: expected one of them")
    if arguments.voltage:
        return parse_number_or_ends("--voltage", arguments.voltage)
    volts = drive.volts(structure)
    if arguments.eta0:
        return tuple(volts * value for value in parse_number_or_ends("--eta0", arguments.eta0))
    has_own_parameters = arguments.set or arguments.structure or arguments.rated_voltage is not None
    if arguments.drive in USUAL and not has_own_parameters:
        first, last = parse_ends("--eta0", USUAL[arguments.drive][0])
        return first * volts, last * volts
    down, up = averaged_jump_voltages(arguments, structure, drive)
    return 0.88 * down, 1.06 * up


def parse_ramp_ends(
    arguments: argparse.Namespace, structure: Structure, drive: Drive
) -> tuple[float, float]:
    """Return the first and the last voltage of a ramp, V; raise if only one is given."""
    voltages = parse_voltages(arguments, structure, drive)
    if len(voltages) != 2:
        name = "voltage" if arguments.voltage else "eta0"
        text = getattr(arguments, name)
        raise InputError(f"--{name} {text}: expected FIRST:LAST, two numbers such as 1.2:1.65")
    return voltages


def averaged_jump_voltages(
    arguments: argparse.Namespace, structure: Structure, drive: Drive
) -> tuple[float, float]:
    """Return the averaged theory's jump voltages, down then up, V; raise where it has no jumps."""
    from ..weak_drive import averaged
    from ..weak_drive.couple import require_motor

    require_motor(drive)
    folds = averaged.folds(structure, drive)
    if not folds:
        raise InputError(
            f"--drive {arguments.drive}: by the averaged theory its speed does not jump; expected "
            "--eta0 or --voltage with it"
        )
    volts = drive.volts(structure)
    return folds[-1].eta0 * volts, folds[0].eta0 * volts


def ramp_rate(arguments: argparse.Namespace, structure: Structure, drive: Drive) -> float:
    """Return a ramp's rate, V/s, from ``--rate`` or ``--volt-rate``."""
    if arguments.rate is not None and arguments.volt_rate is not None:
        raise InputError("--rate and --volt-rate: expected one of them")
    if arguments.volt_rate is not None:
        return parse_rates("--volt-rate", arguments.volt_rate, one=True)[0]
    unit = drive.volts(structure) * structure.omega
    if arguments.rate is None:
        return unit * USUAL.get(arguments.drive, ("", RATE))[1]
    return unit * parse_rates("--rate", arguments.rate, one=True)[0]


def times_in_seconds(
    arguments: argparse.Namespace, structure: Structure, *names: str
) -> dict[str, float | None]:
    """Convert options in 1/omega, such as ``--step``, to s; return a dict, None where not given."""
    values = {name: getattr(arguments, name) for name in names}
    omega = structure.omega
    return {name: None if time is None else time / omega for name, time in values.items()}


def make_schedule(
    arguments: argparse.Namespace, structure: Structure, drive: Drive, control: Controller | None
) -> Schedule:
    """Return the voltage over time (a ``Schedule``) that the options describe."""
    from ..weak_drive.couple import schedule_from_arguments
    from ..weak_drive.schedule import Course

    rate, omega = ramp_rate(arguments, structure, drive), structure.omega
    if arguments.course:
        others = [name for name in ("eta0", "voltage", "duration") if getattr(arguments, name)]
        if others:
            raise InputError(f"--course and --{others[0]}: expected one of them")
        return Course.from_csv(arguments.course)
    ends = parse_voltages(arguments, structure, drive)
    if len(ends) == 1:
        if arguments.duration is None:
            raise InputError(f"one voltage, {ends[0]:g} V: expected --duration with it, in s")
        return schedule_from_arguments(structure, drive, ends[0], duration=arguments.duration)
    if arguments.duration is not None:
        raise InputError("--duration: expected one voltage with it, not FIRST:LAST")
    return schedule_from_arguments(
        structure,
        drive,
        (ends[0], ends[1]),
        rate=rate,
        settle=arguments.settle / omega,
        increment=arguments.increment * drive.volts(structure),
        back=not arguments.one_way,
        spin_up=0.0 if control else None,
    )


def make_controller(
    arguments: argparse.Namespace, structure: Structure, drive: Drive
) -> Controller | None:
    """Return the controller that the options describe; None if they ask for none."""
    from ..weak_drive import own_resonance
    from ..weak_drive.controllers import SpeedControl, SpeedGradient
    from ..weak_drive.couple import require_motor

    of_pi = {"gain": arguments.gain, "reset_time": arguments.reset_time}
    of_pi["rise"] = arguments.speed_rise
    of_swing = {"filter_time": arguments.filter_time, "low": arguments.low}
    if arguments.speed_control is not None and arguments.speed_gradient:
        raise InputError("--speed-control and --speed-gradient: expected one of them")
    lone = {} if arguments.speed_control is not None else {**of_pi}
    lone |= {} if arguments.speed_gradient else of_swing
    for name, value in lone.items():
        if value is not None:
            option = {"rise": "speed-rise"}.get(name, name.replace("_", "-"))
            needed = "--speed-control" if name in of_pi else "--speed-gradient"
            raise InputError(f"--{option} {value:g}: expected {needed} with it")
    require_motor(drive)
    constant = drive.motor_constant
    if arguments.speed_control is not None:
        slow = drive.rotor_inertia * drive.armature_resistance / constant**2
        usual = {"gain": 5.0 * constant, "reset_time": slow, "rise": math.inf}
        return SpeedControl(speed=arguments.speed_control, **{**usual, **without_none(of_pi)})
    if arguments.speed_gradient:
        passed = own_resonance.dividing_speed(structure, drive) * structure.omega
        swing = {"filter_time": 30.0 / structure.omega, "low": 0.6, **without_none(of_swing)}
        return SpeedGradient(passed=passed, **swing)
    return None


def without_none(values: Mapping[str, float | None]) -> dict[str, float]:
    """Return the entries of a mapping whose values are not None."""
    return {name: value for name, value in values.items() if value is not None}


# -- answers --------------------------------------------------------------------------------------


def drive_units(arguments: argparse.Namespace) -> Units:
    """Return the display units from ``--units``; rpm by default if the motor's speed is in rpm."""
    in_rpm = arguments.no_load_rpm is not None
    return read_units(arguments).with_defaults(Units("rpm" if in_rpm else ""))


def with_display_units(
    arguments: argparse.Namespace, results: Mapping[str, xr.Dataset]
) -> dict[str, xr.Dataset]:
    """Return runs marked to be displayed in the units of ``--units``; the numbers stay in SI."""
    return {state: with_units(data, drive_units(arguments)) for state, data in results.items()}


def with_readable_units(asked: Mapping[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """Return runs for print and picture: display lengths in m, mm or um, by their size."""
    return dict(zip(asked, with_readable_lengths(*asked.values()), strict=True))


def picture_path(arguments: argparse.Namespace, base_name: str) -> Path:
    """Return the path of the picture of both structures, or of the one ``--only`` names."""
    parts = [base_name, arguments.only or "", units_ending(arguments)]
    return Path(arguments.output) / f"{'_'.join(filter(None, parts))}.nc"


def result_name(
    arguments: argparse.Namespace, structure: Structure, drive: Drive, question: Any
) -> str:
    """Return a result's file name, unique for its command, structure, drive and arguments."""
    digits = digest(structure.as_delaminated().parameters(), drive.parameters(), question)
    return f"{arguments.command.replace('-', '_')}_{Path(arguments.drive).stem}_{digits}"


def answer_each_structure(
    arguments: argparse.Namespace,
    structure: Structure,
    drive: Drive,
    question: Mapping[str, Any],
    draw: Callable[[dict[str, xr.Dataset]], Any],
    print_result: Callable[[str, xr.Dataset], None],
) -> None:
    """Call a command's public function for each structure; print, write files, draw one picture."""
    import orchestrate

    ask = getattr(orchestrate, arguments.command.replace("-", "_"))
    base_name = result_name(arguments, structure, drive, question)
    states = structures_by_name(arguments, structure)
    files = {state: Files.from_options(arguments, f"{base_name}_{state}") for state in states}
    results = {}
    for state, chosen in states.items():
        running = read_running_options(arguments, files[state].result)
        results[state] = ask(chosen, drive, **question, **running)
    asked = with_display_units(arguments, results)
    shown = with_readable_units(asked)
    for state, data in shown.items():
        print_result(state, data)
    print_units_note(arguments, *shown.values())
    for state, data in asked.items():
        files[state].write(data, None)
    fresh = any(one_file.fresh for one_file in files.values())
    plots = next(iter(files.values())).plots
    path = picture_path(arguments, base_name)
    for file in draw_picture(path, plots, fresh, lambda: draw(shown)):
        print(file)


def answer_both_structures(
    arguments: argparse.Namespace,
    structure: Structure,
    drive: Drive,
    question: Mapping[str, Any],
    draw: Callable[[xr.Dataset], Any] | None,
    print_result: Callable[[xr.Dataset], None],
) -> None:
    """Call a command's function that computes both structures at once; print, write, draw."""
    import orchestrate

    ask = getattr(orchestrate, arguments.command.replace("-", "_"))
    files = Files.from_options(arguments, result_name(arguments, structure, drive, question))
    data = ask(structure, drive, **question, **read_running_options(arguments, files.result))
    asked = with_display_units(arguments, {"": data})
    (shown,) = with_readable_units(asked).values()
    print_result(shown)
    print_units_note(arguments, shown)
    files.write(asked[""], partial(draw, shown) if draw else None)


def format_title(runs: Mapping[str, xr.Dataset], name: str, control: str = "") -> str:
    """Format a picture's title: the drive's name, the runs' voltages, rate and controller."""
    import numpy as np

    changes = [
        np.abs(np.diff(data.voltage.values) / np.diff(data.time.values)) for data in runs.values()
    ]
    rates, volts = np.concatenate(changes), np.concatenate([data.voltage for data in runs.values()])
    rate = float(np.median(rates[rates > 0.0])) if (rates > 0.0).any() else 0.0
    low, high = float(volts.min()), float(volts.max())
    ends = f"{high:.4g} V" if low == high else f"{low:.4g} V to {high:.4g} V"
    moving = f", {rate:.2g} V/s" if rate and not control else ""
    return f"{name}: {ends}{moving}{', ' + control if control else ''}"
