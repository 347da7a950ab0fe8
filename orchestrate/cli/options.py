"""What commands share of what is asked: structures, motors and frequencies, from their options."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass, fields
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError

if TYPE_CHECKING:
    from ..structures import Drive, Structure

MOST_VALUES = 10_000_000
RANGE = "expected FIRST:LAST:STEP with 0 < FIRST <= LAST and STEP > 0, or a list such as 0.4,1.047"
SETS = Path(__file__).resolve().parents[1] / "structures" / "sets"


@dataclass(frozen=True)
class Commands:
    """Where commands declare themselves.

    Attributes
    ----------
    subparsers : argparse._SubParsersAction
    program : str
        How the command line was called, for examples.
    """

    subparsers: Any
    program: str

    def add(
        self, name: str, run: Callable[[argparse.Namespace], None], text: str, examples: str
    ) -> argparse.ArgumentParser:
        """A command.

        Parameters
        ----------
        name : str
        run : callable
            Carries it out.
        text : str
            What it does, in a line.
        examples : str
            For ``--help``, with ``{program}`` for how the command line was called.
        """
        parser: argparse.ArgumentParser = self.subparsers.add_parser(
            name,
            help=text,
            description=f"{text[0].upper()}{text[1:]}.",
            epilog=f"examples:\n{examples.format(program=self.program)}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )
        debug = "show where in the program an error came from"
        parser.add_argument("--debug", action="store_true", default=argparse.SUPPRESS, help=debug)
        parser.set_defaults(run=run)
        return parser


def sets_text() -> str:
    """The shipped sets, a line each: the first sentence of its file."""
    lines = []
    for path in sorted(SETS.glob("*.toml")):
        above = path.read_text(encoding="utf-8").partition("\n\n")[0]
        words = above.replace("#", "").split()
        lines.append(f"  {path.stem:8}{' '.join(words).partition('. ')[0].rstrip('.')}")
    return "\n".join(lines)


# -- structures -----------------------------------------------------------------------------------


def add_structure(parser: argparse.ArgumentParser, default: str = "paper") -> None:
    """``--structure`` and ``--set``."""
    group = parser.add_argument_group("structure")
    group.add_argument(
        "--structure",
        default=default,
        metavar="FILE",
        help="TOML file with a [structure], or the name of a set (default: %(default)s)",
    )
    add_set(
        group,
        "one of its parameters, SI (m1 m2 k1 k2 d1 d2 e gamma) or the paper's (mu kappa "
        "D D1 D2 omega); may be repeated",
    )


def add_set(group: Any, text: str) -> None:
    """``--set``."""
    group.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help=text)


def changes_of(texts: list[str]) -> dict[str, float | bool]:
    """Names and values of ``--set``.

    Raises
    ------
    InputError
    """
    found: dict[str, float | bool] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals):
            raise InputError(f"--set {text}: expected NAME=VALUE, such as e=0.3")
        if name in found:
            raise InputError(f"--set {text}: {name} is set twice; expected once")
        found[name] = value_of(text, value)
    return found


def value_of(text: str, value: str) -> float | bool:
    """A value of ``--set``."""
    if value in ("true", "false"):
        return value == "true"
    try:
        return float(value)
    except ValueError:
        raise InputError(
            f"--set {text}: {value or 'nothing'} is no number; expected one, or true or false"
        ) from None


def structure_of(arguments: argparse.Namespace) -> Structure:
    """The structure that the options describe."""
    from ..structures import Structure

    return Structure.from_file(arguments.structure).replace(**changes_of(arguments.set))


def title_of(structure: Structure) -> str:
    """A structure for the title of a picture: restitution and damping, and what is not default."""
    from ..figures.labels import parameters_text

    one_ratio = structure.D1 == structure.D2
    names = ["e", *(("D",) if one_ratio else ("D1", "D2"))]
    usual = type(structure)()
    for name in ("mu", "kappa", "gamma", "omega"):
        if structure.get(name) != usual.get(name):
            names.append(name)
    return parameters_text({name: structure.get(name) for name in names})


# -- motor and box ---------------------------------------------------------------------------------


def add_drive(parser: argparse.ArgumentParser) -> None:
    """``--drive``, ``--structure`` and ``--set``."""
    group = parser.add_argument_group("structure, motor and box")
    text = (
        "TOML file with [motor], [box] and [structure], or a set: quick, beam (default: "
        "%(default)s)"
    )
    group.add_argument("--drive", default="quick", metavar="FILE", help=text)
    other = "file or set with another [structure] than that of --drive"
    group.add_argument("--structure", metavar="FILE", help=other)
    add_set(group, "a parameter of the structure, or of motor and box in SI; may be repeated")


def described(arguments: argparse.Namespace) -> tuple[Structure, Drive]:
    """Structure and drive, with what is set of either."""
    from ..structures import Drive, Structure

    drive = Drive.from_file(arguments.drive)
    structure = Structure.from_file(arguments.structure or arguments.drive)
    changes = changes_of(arguments.set)
    own = {field.name for field in fields(Drive)}
    of_drive = {name: float(value) for name, value in changes.items() if name in own}
    of_structure = {name: value for name, value in changes.items() if name not in own}
    return structure.replace(**of_structure), drive.replace(**of_drive)


# -- frequencies ----------------------------------------------------------------------------------


def values_of(option: str, text: str, zero: bool = False) -> tuple[tuple[float, ...], bool]:
    """Numbers of ``FIRST:LAST:STEP`` or ``A,B,...``, and whether they are a range.

    Parameters
    ----------
    option : str
        Its name, for messages.
    text : str
    zero : bool
        Whether a number may be 0.

    Raises
    ------
    InputError
    """
    is_range = ":" in text
    try:
        numbers = [Decimal(part.strip()) for part in text.split(":" if is_range else ",")]
    except InvalidOperation:
        raise InputError(f"{option} {text}: not numbers; {RANGE}") from None
    finite = all(number.is_finite() for number in numbers)
    if not finite or (is_range and len(numbers) != 3) or min(numbers) < 0:
        raise InputError(f"{option} {text}: {RANGE}")
    if not zero and min(numbers) == 0:
        raise InputError(f"{option} {text}: {RANGE}")
    if is_range:
        first, last, step = numbers
        if step == 0 or last < first or (last - first) > MOST_VALUES * step:
            raise InputError(f"{option} {text}: {RANGE}, and at most {MOST_VALUES} values")
        numbers = [first + i * step for i in range(int((last - first) / step) + 1)]
    return tuple(map(float, numbers)), is_range


def one_value(option: str, text: str) -> float:
    """A single number > 0.

    Raises
    ------
    InputError
    """
    found, _ = values_of(option, text)
    if len(found) != 1:
        raise InputError(
            f"{option} {text}: {len(found)} values; expected one, such as {option} 1.2"
        )
    return found[0]


def ends_of(option: str, text: str) -> tuple[float, float]:
    """Both numbers of ``FIRST:LAST``.

    Raises
    ------
    InputError
    """
    try:
        first, last = (float(part) for part in text.split(":"))
    except ValueError:
        raise InputError(
            f"{option} {text}: expected FIRST:LAST, two numbers such as 1.2:1.65"
        ) from None
    return first, last
