"""``shake``: time histories and impacts under a swept sine, random vibration, a shock, a record."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import (
    Commands,
    add_numbers,
    add_structure,
    ends_of,
    number_of,
    options,
    plain_float,
    plain_int,
    state_of,
    structure_of,
)
from .output import add_results
from .question import carry_out_beside

if TYPE_CHECKING:
    import xarray as xr

    from .. import Random, Sampled, Shock, SweptSine

EXAMPLES = """  {program} shake --structure beam --swept-sine 8:20 --duration 60 --g 0.02 --beside
  {program} shake --structure beam --swept-sine 5:50 --rate 1 --spacing log --g 5:0.01,50:0.05
  {program} shake --structure beam --random 5:0.1,100:0.1 --duration 30 --seed 1
  {program} shake --structure beam --shock half-sine --length 0.011 --g 5
  {program} shake --structure beam --record base.csv --unit g"""
KINDS = ("swept_sine", "random", "shock", "record")
OF_KINDS = {  # options that only one kind knows
    "rate": "swept_sine",
    "spacing": "swept_sine",
    "seed": "random",
    "length": "shock",
    "delay": "shock",
    "unit": "record",
    "column": "record",
}


def add_parser(commands: Commands) -> None:
    """Declare the command."""
    text = "as in the laboratory: motion and impacts under swept sine, random, shock or a record"
    parser = commands.add("shake", run, text, EXAMPLES)
    add_structure(parser)
    add_signals(parser)
    group = parser.add_argument_group("the record")
    option = group.add_argument
    option("--sample-rate", metavar="HZ", help="of the record (default: what the excitation needs)")
    option("--start", metavar="X1,X2,V1,V2", help="state at the start, m and m/s (default: rest)")
    add_numbers(option, accuracy=(1e-6, "of the excitation's cubic pieces, relative to its peak"))
    option("--beside", action="store_true", help="the same of the bonded structure, beside it")
    add_results(parser)


def add_signals(parser: argparse.ArgumentParser) -> None:
    """The excitation."""
    group = parser.add_argument_group("the box's acceleration", "one of the first four")
    option = group.add_argument
    option("--swept-sine", metavar="FIRST:LAST", help="frequencies, Hz; downwards too")
    option("--random", metavar="PSD", help="density as HZ:VALUE,HZ:VALUE,... in (m/s2)^2/Hz")
    option("--shock", metavar="SHAPE", help="half-sine, sawtooth or trapezoid")
    option("--record", metavar="FILE", help="measured: .csv, .txt, .uff, .unv, .mat, .nc")
    level = "peak acceleration, {}; of a swept sine a profile HZ:VALUE,HZ:VALUE,... too"
    option("--g", metavar="LEVEL", help=level.format("in 9.80665 m/s2"))
    option("--acceleration", metavar="LEVEL", help=level.format("m/s2"))
    option("--duration", metavar="S", help="of all, s")
    option(
        "--rate", metavar="RATE", help="of a swept sine: Hz/s, or octaves/min where --spacing log"
    )
    option("--spacing", metavar="WORD", help="of a swept sine: linear or log (default: linear)")
    option("--seed", metavar="N", help="of random vibration (default: 0)")
    option("--length", metavar="S", help="of a shock's pulse, s")
    option("--delay", metavar="S", help="quiet before a shock, s (default: 0)")
    option("--unit", metavar="UNIT", help="of a record: m/s2, g ... (default: what the file says)")
    text = "of a record: the box's, by name or number from 0 (default: by usual names, or 1)"
    option("--column", metavar="NAME", help=text)


def run(arguments: argparse.Namespace) -> None:
    """Carry it out."""
    structure = structure_of(arguments)
    start = state_of("--start", arguments.start)
    question: dict[str, Any] = {
        "excitation": signal_of(arguments),
        "accuracy": arguments.accuracy,
        "start": start,
    }
    if arguments.sample_rate is not None:
        question["sample_rate"] = number_of("--sample-rate", arguments.sample_rate)
    carry_out_beside(arguments, structure, question, report, picture_of)


def signal_of(arguments: argparse.Namespace) -> Random | Sampled | Shock | SweptSine:
    """The excitation that the options describe.

    Raises
    ------
    InputError
    """
    from .. import Random, Shock, SweptSine

    kind = kind_of(arguments)
    if kind == "record":
        return recorded(arguments)
    numbers = {
        name: number_of(f"--{name}", getattr(arguments, name))
        for name in ("duration", "rate", "length", "delay")
        if getattr(arguments, name) is not None
    }
    if kind == "random":
        return Random(
            psd=breakpoints("--random", arguments.random), seed=seed_of(arguments), **numbers
        )
    if kind == "shock":
        level = level_of(arguments)
        if not isinstance(level, float):
            raise InputError("--shock: expected one number for its peak, no profile")
        return Shock(peak=level, shape=arguments.shock, **numbers)
    first, last = ends_of("--swept-sine", arguments.swept_sine)
    spacing = arguments.spacing or "linear"
    return SweptSine(
        first=first, last=last, acceleration=level_of(arguments), spacing=spacing, **numbers
    )


def recorded(arguments: argparse.Namespace) -> Sampled:
    """The box's acceleration of a file, played again."""
    from .. import Sampled, read_record

    column = arguments.column
    columns = None
    if column is not None:
        columns = {"box_acceleration": int(column) if column.isdecimal() else column}
    return Sampled.from_record(read_record(arguments.record, unit=arguments.unit, columns=columns))


def kind_of(arguments: argparse.Namespace) -> str:
    """Which excitation is asked for; options of others are refused."""
    given = [name for name in KINDS if getattr(arguments, name) is not None]
    if len(given) != 1:
        told = options((name.replace("_", "-") for name in given), " and ") or "nothing"
        names = options(name.replace("_", "-") for name in KINDS)
        raise InputError(f"excitation: {told} given; expected one of {names}")
    (kind,) = given
    for name, owner in OF_KINDS.items():
        if getattr(arguments, name) is not None and owner != kind:
            raise InputError(f"--{name}: expected with --{owner.replace('_', '-')} alone")
    levelled = arguments.g is not None or arguments.acceleration is not None
    if kind == "random" and levelled:
        raise InputError("--random: its density has the level; expected no --g, --acceleration")
    if kind == "record" and (levelled or arguments.duration is not None):
        text = "the file has level and time; expected no --g, --acceleration, --duration"
        raise InputError(f"--record: {text}")
    needed = {"random": "duration", "shock": "length"}.get(kind)
    if needed and getattr(arguments, needed) is None:
        raise InputError(f"--{kind}: expected --{needed} with it, in s")
    return kind


def seed_of(arguments: argparse.Namespace) -> int:
    """The seed of random vibration."""
    if arguments.seed is None:
        return 0
    try:
        return plain_int(arguments.seed)
    except ValueError:
        raise InputError(f"--seed {arguments.seed}: expected a whole number >= 0") from None


def level_of(arguments: argparse.Namespace) -> Any:
    """The peak acceleration in m/s2: a number, or a profile."""
    from ..constants import GRAVITY

    given = [name for name in ("g", "acceleration") if getattr(arguments, name) is not None]
    if len(given) != 1:
        told = options(given, " and ") or "nothing"
        raise InputError(f"level: {told} given; expected one of --g and --acceleration")
    text, unit = getattr(arguments, given[0]), GRAVITY if given[0] == "g" else 1.0
    if ":" not in text:
        return unit * number_of(f"--{given[0]}", text)
    return tuple((f, unit * value) for f, value in breakpoints(f"--{given[0]}", text))


def breakpoints(option: str, text: str) -> tuple[tuple[float, float], ...]:
    """Break points of ``HZ:VALUE,HZ:VALUE,...``.

    Raises
    ------
    InputError
    """
    try:
        pairs = [tuple(map(plain_float, part.split(":"))) for part in text.split(",")]
    except ValueError:
        pairs = []
    if not pairs or any(len(pair) != 2 or not all(map(math.isfinite, pair)) for pair in pairs):
        raise InputError(f"{option} {text}: expected HZ:VALUE,HZ:VALUE,... such as 10:0.5,200:0.5")
    return tuple((pair[0], pair[1]) for pair in pairs)


def picture_of(data: xr.Dataset, bonded: xr.Dataset | None = None) -> Any:
    """The histories."""
    from ..figures.shaken import draw

    return draw(data, bonded=bonded)


def report(data: xr.Dataset) -> None:
    """What was found, in a few lines."""
    names = ("box_acceleration", "a1_abs", "a2_abs")
    felt = [float(abs(data[name]).max()) for name in names]
    text = (
        "largest accelerations: box {:.4g}, masses 1 and 2 between impacts {:.4g} and {:.4g} m/s2"
    )
    print(text.format(*felt))
    print(f"largest gap {float(data.x_rel.max()):.4g} m")
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
