"""Parse texts of options: numbers, lists, ranges, pairs, states and ``NAME=VALUE``.

What is wrong is an :class:`InputError` that names the option, its text and what is expected.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Collection, Iterable
from contextlib import suppress
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Annotated, Any, TypeVar

from ..constants import GRAVITY
from ..errors import InputError, StoreError
from ..lazy import xr
from ..model.ranges import expected_one_of, known_units, number_with_unit

Parsed = TypeVar("Parsed")
Reader = Callable[[str, str], Parsed]
AxisSpec = tuple[str, float, float, int]
MAX_VALUES = 10_000_000
RANGE = "expected FIRST:LAST:STEP with 0 < FIRST <= LAST and STEP > 0, or a list such as 0.4,1.047"

KEYWORD = re.compile(  # in messages of public functions, with a value or without
    r"(?<![\w-])(?P<name>[a-z_]\w*)=(?P<value>\"[^\"]*\"|'[^']*'|\{[^}]*\}|[^\s'\",;)]*)"
)
MAPPING_ITEM = re.compile(r"'([^']*)': '([^']*)'")

SET_NAMES = {"zeta": ("zeta1", "zeta2"), "f1_hz": ("f1",), "f2_hz": ("f2",)}  # and as in a file

COMMA = re.compile(r"-?\d+,\d+ *[a-zA-Z%]*")  # a decimal comma, perhaps with a unit
OF_ONE_MASS = {name: (f"{name}1",) for name in ("m", "k", "d", "f", "zeta")}  # before a stop
SAID = {"gap": "clearance", "restitution": "e", "mass": "m1", "frequency": "f1", "damping": "zeta1"}
OWN_UNITS = {"--g": "g", "--range": "g", "--hz": "Hz", "--rpm": "rpm"}

# -- numbers --------------------------------------------------------------------------------------


def check_digits(text: str) -> None:
    """Raise ``ValueError`` unless a text has plain digits, neither ``1_000`` nor other scripts'."""
    if not text.isascii() or "_" in text:
        raise ValueError(text)


def plain_float(text: str) -> float:
    """Parse a number in plain digits as float; raise ``ValueError`` otherwise."""
    check_digits(text)
    return float(text)


def plain_int(text: str) -> int:
    """Parse an integer in plain digits; raise ``ValueError`` otherwise."""
    check_digits(text)
    return int(text)


def without_own_unit(option: str, text: str) -> str:
    """Take off the unit that an option is named after, where numbers have it: ``--g 0.1g``."""
    unit = OWN_UNITS.get(option)
    pattern = rf"(?<=[0-9.]) *{unit}(?![a-z0-9])"
    return re.sub(pattern, "", text, flags=re.IGNORECASE) if unit else text


def parse(option: str, text: str, expected: str, reader: Callable[[str], Parsed]) -> Parsed:
    """Call ``reader`` on an option's text; turn its ``ValueError`` into an ``InputError``."""
    try:
        return reader(without_own_unit(option, text))
    except ValueError:
        raise InputError(f"{option} {text}: expected {expected}{with_point(text)}") from None


def with_point(text: str) -> str:
    """Return the words on a number that seems to have a decimal comma; nothing on others."""
    return f" (with a decimal point, {text.replace(',', '.')})" if COMMA.fullmatch(text) else ""


def read_float(option: str, text: str) -> float:
    """Parse an option's text as a number."""
    return parse(option, text, "a number", plain_float)


def read_int(option: str, text: str) -> int:
    """Parse an option's text as a whole number."""
    return parse(option, text, "a whole number", plain_int)


def read_choice(choices: Collection[Any], option: str, text: str) -> Any:
    for choice in choices:
        if text == str(choice):
            return choice
    raise InputError(f"{option} {text}: {expected_one_of(text, map(str, choices))}")


def floats(
    expected: str, separator: str = ",", counts: Collection[int] = (), positive: bool = False
) -> Reader[tuple[float, ...]]:
    """Return a reader of numbers between separators (a regular expression), ``counts`` of them."""

    def split(text: str) -> tuple[float, ...]:
        numbers = tuple(plain_float(part) for part in re.split(separator, text))
        if counts and len(numbers) not in counts:
            raise ValueError(text)
        if positive and not all(math.isfinite(number) and number > 0.0 for number in numbers):
            raise ValueError(text)
        return numbers

    return lambda option, text: parse(option, text, expected, split)


parse_ends = floats("FIRST:LAST, two numbers such as 1.2:1.65", ":", (2,))
parse_number_or_ends = floats("a number, or FIRST:LAST such as 1.2:1.65", ":", (1, 2))
Ends = Annotated[tuple[float, ...] | None, parse_ends]
parse_numbers = floats("a number, or a list such as 0.5,1,2")
parse_sensor = floats("HZ or HZ:RATE, such as 10000:25600", ":", (1, 2))
Bandwidth = Annotated[tuple[float, ...] | None, parse_sensor]
parse_rates = floats("a number > 0, or several such as 1e-4,5e-5,2.5e-5", positive=True)


def read_earlier_result(option: str, path: Path) -> xr.Dataset:
    """Read the NetCDF result of an earlier command; raise naming the option if it is not one."""
    from ..running.store import load_foreign

    if not path.is_file():
        raise InputError(f"{option} {path}: no such file; expected a result of an earlier command")
    try:
        data = load_foreign(path)
    except StoreError as error:
        expected = "" if "expected" in str(error) else "; expected a NetCDF file"
        raise InputError(f"{option} {error}{expected}") from None
    try:
        json.loads(data.attrs.get("identity", '{"question": ""}'))["question"]
    except (ValueError, TypeError, KeyError, RecursionError):
        expected = "expected a result of an earlier command"
        raise InputError(f"{option} {path}: its identity is damaged; {expected}") from None
    return data


def float_with_unit(name: str, text: str) -> float:
    """Parse a number of a quantity, with one of its units behind it or none."""
    number = number_with_unit(name, text)
    return plain_float(text) if number is None else number


def parse_state(option: str, text: str) -> tuple[float, ...]:
    """Parse x1, x2, v1, v2, each with or without a unit."""

    def split(text: str) -> tuple[float, ...]:
        pairs = zip(("x1", "x2", "v1", "v2"), text.split(","), strict=True)
        return tuple(float_with_unit(name, part.strip()) for name, part in pairs)

    expected = "X1,X2,V1,V2, four numbers in m and m/s, or with units such as 20um and 3mm/s"
    return parse(option, text, expected, split)


def read_state(option: str, text: str) -> tuple[float, ...] | Path:
    """Parse x1, x2, v1, v2; or the file of an earlier command's result that has states."""
    return Path(text) if text.endswith(".nc") else parse_state(option, text)


State = Annotated[Any, read_state]  # x1, x2, v1, v2, or a file


def positive_number(option: str, text: str) -> float:
    """Parse an option's text as one number > 0."""
    reader = floats(f"a number > 0, such as {option} 0.5", counts=(1,), positive=True)
    return reader(option, text)[0]


def read_length(option: str, text: str) -> float:
    """Parse an option's text as one length from 0 on, in m or with a unit."""

    def split(text: str) -> float:
        if not 0.0 <= (number := float_with_unit("amplitude", text)) < math.inf:
            raise ValueError(text)
        return number

    return parse(option, text, f"a length in m, or with its unit such as {option} 20um", split)


def read_acceleration(option: str, text: str) -> float:
    """Parse an acceleration in m/s2, or in g with that behind it."""
    number = text.removesuffix("g")
    factor = 1.0 if number == text else GRAVITY
    return factor * parse(option, number, "a number in m/s2, or in g such as -1g", plain_float)


Positive = Annotated[float | None, positive_number]
Length = Annotated[float | None, read_length]
Acceleration = Annotated[float | None, read_acceleration]


def parse_noise(option: str, text: str) -> float:
    """Parse a density of noise, in (m/s2)/sqrt(Hz), or of g as data sheets have it: ``30ug``."""

    def split(text: str) -> float:
        plain = text.replace("\u00b5", "u").removesuffix("/sqrt(Hz)").removesuffix("/sqrtHz")
        number = plain.rstrip("ugm ")
        factors = {"": 1.0, "g": GRAVITY, "mg": 1e-3 * GRAVITY, "ug": 1e-6 * GRAVITY}
        if (unit := plain[len(number) :].strip()) not in factors:
            raise ValueError(text)
        return factors[unit] * plain_float(number)

    return parse(option, text, "a number in (m/s2)/sqrt(Hz), or of g such as 30ug or 0.3mg", split)


Noise = Annotated[float | None, parse_noise]


def parse_rate(option: str, text: str) -> float:
    """Parse one rate > 0; name the command that takes several."""
    rates = parse_rates(option, text)
    if len(rates) > 1:
        raise InputError(
            f"{option} {text}: {len(rates)} rates; expected one (jump-voltages takes several)"
        )
    return rates[0]


def parse_orders(option: str, text: str) -> float | tuple[float, ...]:
    """Parse ``N`` or a list of orders such as ``0.5,1,2``; return the number or the list."""
    orders = parse_numbers(option, text)
    return orders if "," in text else orders[0]


def parse_plane_side(option: str, text: str) -> AxisSpec:
    """Parse one side of a basin's plane, ``NAME,FIRST,LAST,COUNT``."""

    def split(text: str) -> AxisSpec:
        name, first, last, count = (part.strip() for part in text.split(","))
        return name, float_with_unit(name, first), float_with_unit(name, last), plain_int(count)

    expected = "NAME,FIRST,LAST,COUNT such as x_rel,0,0.8,60 or x_rel,0,20um,60"
    return parse(option, text, expected, split)


PlaneSide = Annotated[AxisSpec | None, parse_plane_side]


def parse_breakpoints(option: str, text: str) -> tuple[tuple[float, float], ...]:
    """Parse ``HZ:VALUE,HZ:VALUE,...`` into pairs of frequency and value."""

    def split(text: str) -> tuple[tuple[float, float], ...]:
        pairs = [tuple(map(plain_float, part.split(":"))) for part in text.split(",")]
        if not all(len(pair) == 2 and all(map(math.isfinite, pair)) for pair in pairs):
            raise ValueError(text)
        return tuple((first, last) for first, last in pairs)

    return parse(option, text, "HZ:VALUE,HZ:VALUE,... such as 10:0.5,200:0.5", split)


def parse_density(option: str, text: str) -> tuple[tuple[float, float], ...]:
    """Parse a density over frequency in (m/s2)^2/Hz, or in g2/Hz with that unit behind it."""
    squared = 1.0 if text == (number := text.removesuffix("g2/Hz")) else GRAVITY**2
    try:
        return tuple((f, squared * value) for f, value in parse_breakpoints(option, number))
    except InputError:
        expected = "expected HZ:VALUE,HZ:VALUE,... such as 10:0.5,200:0.5, or 10:2e-3,200:2e-3g2/Hz"
        raise InputError(f"{option} {text}: {expected}") from None


Density = Annotated[tuple[tuple[float, float], ...] | None, parse_density]
Orders = Annotated[float | tuple[float, ...] | None, parse_orders]


def read_pairs(option: str, texts: Iterable[str], expected: str) -> dict[str, str]:
    """Return ``NAME=VALUE`` texts as a dict; raise where a part is missing or a name repeats."""
    pairs: dict[str, str] = {}
    for text in texts:
        name, _, value = (part.strip() for part in text.partition("="))
        if not (name and value) or name in pairs:
            raise InputError(f"{option} {text}: expected {expected}, each name once")
        pairs[name] = value
    return pairs


def with_option_names(message: str, chosen: Any) -> str:
    """Return a message in which keywords are options: ``--unit g`` for ``unit = 'g'``."""
    options, renamed = vars(chosen), getattr(chosen, "renamed", {})

    def option_of(name: str) -> str:
        name = renamed.get(name, name)
        return f"--{name.replace('_', '-')}" if name in options else ""

    def given(keyword: re.Match[str]) -> str:  # at the beginning: what is wrong
        name, joint = keyword["name"], keyword["joint"]
        if not (flag := option_of(name)) or (options.get(name) is None) != (joint == " = None"):
            return keyword[0]
        file = f" {options[name]}" if isinstance(options.get(name), Path) else ""
        flag = flag if flag in type(chosen).flags() else ""  # else it has none
        return flag + {" = None": " is missing", " = ": " "}.get(
            joint, f"{file}{joint}".lstrip(" " * (not flag))
        )

    def named(keyword: re.Match[str]) -> str:  # what to do
        value = MAPPING_ITEM.sub(r"\1=\2", keyword["value"]).strip("'{}")
        return f"{flag} {value}".rstrip() if (flag := option_of(keyword["name"])) else keyword[0]

    message = re.sub(r"^(?P<name>[a-z_]\w*)(?P<joint> = None| = |: )", given, message)
    return KEYWORD.sub(named, message)


# -- ranges and lists -----------------------------------------------------------------------------


def parse_values(option: str, text: str, zero: bool = False) -> tuple[tuple[float, ...], bool]:
    """Parse ``FIRST:LAST:STEP`` or ``A,B,...``; return the numbers, and whether it was a range."""
    is_range = ":" in text
    try:
        check_digits(text)
        parts = without_own_unit(option, text).split(":" if is_range else ",")
        numbers = [Decimal(part.strip()) for part in parts]
    except (InvalidOperation, ValueError):
        raise InputError(f"{option} {text}: not numbers; {RANGE}") from None
    finite = all(number.is_finite() for number in numbers)
    if not finite or (is_range and len(numbers) != 3) or min(numbers) < 0:
        raise InputError(f"{option} {text}: {RANGE}")
    if not zero and min(numbers) == 0:
        raise InputError(f"{option} {text}: {RANGE}")
    if is_range:
        first, last, step = numbers
        if last < first:
            raise InputError(f"{option} {text}: {first} > {last}; {RANGE}")
        if step == 0 or (last - first) > MAX_VALUES * step:
            raise InputError(f"{option} {text}: {RANGE}, and at most {MAX_VALUES} values")
        numbers = [first + i * step for i in range(int((last - first) / step) + 1)]
    return tuple(map(float, numbers)), is_range


def parse_list(option: str, text: str) -> tuple[float, ...]:
    """Parse ``FIRST:LAST:STEP`` or ``A,B,...``; return the numbers."""
    return parse_values(option, text)[0]


Listed = Annotated[tuple[float, ...] | None, parse_list]


def parse_listed(name: str, text: str) -> tuple[tuple[float, ...], bool]:
    """Parse a parameter's values, units in a list; return them, and whether it was a range."""
    if ":" in text:
        with suppress(ValueError):  # what is no number is said below
            pairs = [(one, number_with_unit(name, one.strip())) for one in text.split(":")]
            text = ":".join(one if number is None else repr(number) for one, number in pairs)
        return parse_values("--values", text, zero=True)
    option = f"--over {name} --values "
    return tuple(parse_with_unit(option, name, one.strip()) for one in text.split(",")), False


def is_single_number(text: str) -> bool:
    """Return whether a text is a single number, rather than a range or a list."""
    return not (":" in text or "," in text)


def parse_one_or_more(option: str, text: str, one: bool = False) -> float | tuple[float, ...]:
    """Parse one number as float, a range or list as tuple; with ``one``, one number only."""
    return (
        parse_single_number(option, text)
        if one or is_single_number(text)
        else parse_values(option, text)[0]
    )


def parse_single_number(option: str, text: str) -> float:
    """Parse a single number > 0; raise if the text is a range or a list."""
    values, _ = parse_values(option, text)
    if len(values) != 1:
        raise InputError(
            f"{option} {text}: {len(values)} values; expected one, such as {option} 1.2 (sweep "
            f"varies one parameter, map two, resonance also the level){with_point(text)}"
        )
    return values[0]


# -- names and values -----------------------------------------------------------------------------


def parse_changes(texts: Iterable[str], wall: bool = False) -> dict[str, float | bool]:
    """Parse the texts ``NAME=VALUE`` of ``--set`` into a dict from parameter to value."""
    changes: dict[str, float | bool] = {}
    pairs = read_pairs("--set", texts, "NAME=VALUE such as e=0.3")
    alone = wall or pairs.get("wall") == "true"
    known = {**SET_NAMES, **(OF_ONE_MASS if alone else {})}
    for name, text in pairs.items():
        names = known.get(name, (name,))
        value = parse_changed_value(names[0], text)
        if name == "preload":  # as a length: in N it depends on the springs
            if text[-1:] != "m" or value < 0.0:
                raise InputError(f"--set preload={text}: expected a length above 0, such as 20um")
            names, value = ("clearance",), -value
        if twice := changes.keys() & set(names):
            raise InputError(f"--set {name}={text}: {min(twice)} is set already; expected once")
        changes |= dict.fromkeys(names, value)
    return changes


def parse_changed_value(name: str, value: str) -> float | bool:
    """Parse the VALUE of ``--set NAME=VALUE``: true, false, or a number with or without a unit."""
    if value in ("true", "false"):
        return value == "true"
    return parse_with_unit(f"--set {name}=", name, value, ", or true or false")


def parse_with_unit(option: str, name: str, value: str, other: str = "") -> float:
    """Parse a number, with a unit if the parameter of this name allows it."""
    try:
        return float_with_unit(name, value)
    except ValueError:
        check_name(name)  # before its unit
        known = " or ".join(known_units(name))
        words = f", with {known} if you like" if known else other
        text = f"{value} is not a number; expected one{words}{with_point(value)}"
        raise InputError(f"{option}{value}: {text}") from None


def check_name(name: str) -> None:
    """Raise unless a name is that of a parameter of the structure or of a drive."""
    from ..model import PARAMETERS
    from ..model.ranges import DRIVE

    known = (*PARAMETERS, "bonded", "wall", "preload", *SET_NAMES)
    if name not in (*known, *DRIVE):
        expected = expected_one_of(name, known).partition(" (did")[0] if name in SAID else ""
        said = f"{expected} (did you mean {SAID[name]}?)" if expected else ""
        raise InputError(f"--set {name}: no parameter; {said or expected_one_of(name, known)}")
