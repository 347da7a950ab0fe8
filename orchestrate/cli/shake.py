"""Command ``shake``: time histories under sines, random vibration, shocks and records."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..units import scale_of, text_of
from .grammar import (
    RANGE,
    parse_breakpoints,
    parse_ends,
    parse_state,
    parse_values,
    positive_number,
    whole_number,
)
from .options import (
    Commands,
    add_beside_option,
    add_structure_options,
    join_option_names,
    option_name,
    read_structure_options,
)
from .output import add_result_options, add_units_option, unit_note
from .question import answer_with_bonded

if TYPE_CHECKING:
    import xarray as xr

    from .. import Random, Sampled, Shock, SteppedSine, SweptSine

EXAMPLES = """  {program} shake --structure beam --swept-sine 8:20 --duration 60 --g 0.02 --beside
  {program} shake --structure beam --swept-sine 5:50 --rate 1 --spacing log --g 5:0.01,50:0.05
  {program} shake --structure beam --stepped-sine 10:14:0.1 --settle-cycles 150 --g 0.02
  {program} shake --structure beam --random 5:0.1,100:0.1 --duration 30 --seed 1
  {program} shake --structure beam --shock half-sine --length 0.011 --g 5
  {program} shake --structure beam --record base.csv --unit g"""
KINDS = ("swept_sine", "stepped_sine", "random", "shock", "record")
OF_KINDS = {  # options that only one kind knows
    "rate": "swept_sine",
    "spacing": "swept_sine",
    "settle_cycles": "stepped_sine",
    "measured_cycles": "stepped_sine",
    "seed": "random",
    "length": "shock",
    "delay": "shock",
    "unit": "record",
    "column": "record",
    "scale": "record",
}


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``shake`` with its options."""
    text = "as in the laboratory: motion and impacts under sines, random, shock or a record"
    parser = commands.add("shake", run, text, EXAMPLES)
    add_structure_options(parser)
    add_excitation_options(parser)
    question = commands.add_function_options(parser, "the record")
    rate = "of the record (default: what the excitation needs)"
    question.add("sample_rate", positive_number, metavar="HZ", help=rate)
    start = "state at the start, m and m/s (default: rest)"
    question.add("start", parse_state, metavar="X1,X2,V1,V2", help=start)
    question.declare("accuracy")
    add_beside_option(question)
    add_units_option(parser)
    add_result_options(parser)


def add_excitation_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of the base excitation, such as ``--swept-sine`` and ``--random``."""
    group = parser.add_argument_group("the box's acceleration", "one of the first five")
    option = group.add_argument
    option("--swept-sine", metavar="FIRST:LAST", help="frequencies, Hz; downwards too")
    option("--stepped-sine", metavar="HZ", help=f"frequencies, {RANGE}")
    option("--random", metavar="PSD", help="density as HZ:VALUE,HZ:VALUE,... in (m/s2)^2/Hz")
    option("--shock", metavar="SHAPE", help="half-sine, sawtooth or trapezoid")
    option("--record", metavar="FILE", help="measured: .csv, .txt, .uff, .unv, .mat, .wav, .nc")
    level = "peak acceleration, {}; of sines a profile HZ:VALUE,HZ:VALUE,... too"
    option("--g", metavar="LEVEL", help=level.format("in 9.80665 m/s2"))
    option("--acceleration", metavar="LEVEL", help=level.format("m/s2"))
    option("--duration", metavar="S", help="of all, s")
    option(
        "--rate", metavar="RATE", help="of a swept sine: Hz/s, or octaves/min where --spacing log"
    )
    option("--spacing", metavar="WORD", help="of a swept sine: linear or log (default: linear)")
    cycles = "of a stepped sine: cycles at each frequency {} (default: {})"
    option("--settle-cycles", metavar="N", help=cycles.format("before it is measured", 100))
    option("--measured-cycles", metavar="N", help=cycles.format("that are measured", 50))
    option("--seed", metavar="N", help="of random vibration (default: 0)")
    option("--length", metavar="S", help="of a shock's pulse, s")
    option("--delay", metavar="S", help="quiet before a shock, s (default: 0)")
    option("--unit", metavar="UNIT", help="of a record: m/s2, g ... (default: what the file says)")
    text = "of a record: the box's, by name or number from 0 (default: by usual names, or 1)"
    option("--column", metavar="NAME", help=text)
    option("--scale", metavar="X", help="of a record in a WAV file: m/s2 at its full scale")


def run(arguments: argparse.Namespace) -> None:
    """Run ``shake``: simulate the structure under an excitation; print, store and draw."""
    structure = read_structure_options(arguments)
    question = {"excitation": read_excitation(arguments), **arguments.question.keywords(arguments)}
    if question["sample_rate"] is None:
        del question["sample_rate"]  # a file's name has always been without it
    answer_with_bonded(arguments, structure, question, print_result)


def read_excitation(
    arguments: argparse.Namespace,
) -> Random | Sampled | Shock | SteppedSine | SweptSine:
    """Return the excitation that the options describe, such as a ``SweptSine``."""
    from .. import Random, Shock, SteppedSine, SweptSine

    kind = excitation_kind(arguments)
    if kind == "record":
        return read_record_excitation(arguments)
    numbers = {
        name: positive_number(f"--{name}", getattr(arguments, name))
        for name in ("duration", "rate", "length", "delay")
        if getattr(arguments, name) is not None
    }
    if kind == "random":
        seed = 0 if arguments.seed is None else whole_number("--seed", arguments.seed)
        return Random(psd=parse_breakpoints("--random", arguments.random), seed=seed, **numbers)
    if kind == "shock":
        level = read_level(arguments)
        if not isinstance(level, float):
            raise InputError("--shock: expected one number for its peak, no profile")
        return Shock(peak=level, shape=arguments.shock, **numbers)
    if kind == "stepped_sine":
        frequencies, _ = parse_values("--stepped-sine", arguments.stepped_sine)
        cycles = {
            name: whole_number(option_name(name), getattr(arguments, name))
            for name in ("settle_cycles", "measured_cycles")
            if getattr(arguments, name) is not None
        }
        return SteppedSine(frequencies=frequencies, acceleration=read_level(arguments), **cycles)
    first, last = parse_ends("--swept-sine", arguments.swept_sine)
    spacing = arguments.spacing or "linear"
    return SweptSine(
        first=first, last=last, acceleration=read_level(arguments), spacing=spacing, **numbers
    )


def read_record_excitation(arguments: argparse.Namespace) -> Sampled:
    """Return the box's acceleration of a measured file as an excitation."""
    from .. import Sampled, read_record

    column = arguments.column
    columns = None
    if column is not None:
        columns = {"box_acceleration": int(column) if column.isdecimal() else column}
    scale = None if arguments.scale is None else positive_number("--scale", arguments.scale)
    record = read_record(arguments.record, unit=arguments.unit, columns=columns, scale=scale)
    if note := unit_note(record.attrs):
        print(f"{arguments.record}: {note}")
    return Sampled.from_record(record)


def excitation_kind(arguments: argparse.Namespace) -> str:
    """Return which kind of excitation is chosen; raise for options of another kind."""
    chosen = [name for name in KINDS if getattr(arguments, name) is not None]
    if len(chosen) != 1:
        words = join_option_names((name.replace("_", "-") for name in chosen), " and ") or "nothing"
        names = join_option_names(name.replace("_", "-") for name in KINDS)
        raise InputError(f"excitation: {words} given; expected one of {names}")
    (kind,) = chosen
    for name, owner in OF_KINDS.items():
        if getattr(arguments, name) is not None and owner != kind:
            option, kinds = (word.replace("_", "-") for word in (name, owner))
            raise InputError(f"--{option}: expected with --{kinds} alone")
    levelled = arguments.g is not None or arguments.acceleration is not None
    if kind == "random" and levelled:
        raise InputError("--random: its density has the level; expected no --g, --acceleration")
    if kind == "record" and (levelled or arguments.duration is not None):
        text = "the file has level and time; expected no --g, --acceleration, --duration"
        raise InputError(f"--record: {text}")
    if kind == "stepped_sine" and arguments.duration is not None:
        raise InputError("--stepped-sine: its cycles have the time; expected no --duration")
    needed = {"random": "duration", "shock": "length"}.get(kind)
    if needed and getattr(arguments, needed) is None:
        raise InputError(f"--{kind}: expected --{needed} with it, in s")
    return kind


def read_level(arguments: argparse.Namespace) -> Any:
    """Return the peak acceleration, m/s2: a number, or a profile over frequency."""
    from ..constants import GRAVITY

    chosen = [name for name in ("g", "acceleration") if getattr(arguments, name) is not None]
    if len(chosen) != 1:
        words = join_option_names(chosen, " and ") or "nothing"
        raise InputError(f"level: {words} given; expected one of --g and --acceleration")
    text, unit = getattr(arguments, chosen[0]), GRAVITY if chosen[0] == "g" else 1.0
    if ":" not in text:
        return unit * positive_number(f"--{chosen[0]}", text)
    return tuple((f, unit * value) for f, value in parse_breakpoints(f"--{chosen[0]}", text))


def print_result(data: xr.Dataset) -> None:
    """Print a record's largest accelerations and gap, and its impacts."""
    names = ("box_acceleration", "a1_abs", "a2_abs")
    factor, unit = scale_of(data, "m/s2")
    accelerations = [float(abs(data[name]).max()) / factor for name in names]
    text = "largest accelerations: box {:.4g}, masses 1 and 2 between impacts {:.4g} and {:.4g} {}"
    print(text.format(*accelerations, unit))
    print(f"largest gap {text_of(data, data.x_rel.max(), 'm', '.4g')}")
    over = float(data.transient_time)
    print(f"the start is forgotten after {over:.3g} s where the motion is linear")
    count = data.sizes["impact"]
    if not count:
        print("no impacts")
        return
    hardest = int(data.impulse.values.argmax())
    at = float(data.impact_time[hardest])
    print(f"{count} impacts, the hardest of {float(data.impulse[hardest]):.4g} N s at {at:.4g} s")
    sticks = int(data.sticks.sum())
    print(f"{sticks} of them begin permanent contact" if sticks else "no permanent contact begins")
