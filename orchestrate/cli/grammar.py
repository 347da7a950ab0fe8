"""Parse texts of options: numbers, lists, ranges, pairs, states and ``NAME=VALUE``.

What is wrong is an :class:`InputError` that names the option, its text and what is expected.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Collection, Iterable
from decimal import Decimal
from pathlib import Path
from typing import Any, TypeVar

from ..constants import GRAVITY
from ..errors import InputError, StoreError
from ..lazy import xr
from ..model import PARAMETERS, ranges
from ..model.spelling import expected_one_of

Parsed = TypeVar("Parsed")
Reader = Callable[[str, str], Parsed]
MAX_VALUES = 10_000_000
RANGE = "expected FIRST:LAST:STEP with 0 < FIRST <= LAST and STEP > 0, or a list such as 0.4,1.047"
BREAKPOINTS = "HZ:VALUE,HZ:VALUE,... such as 10:0.5,200:0.5"
KEYWORD = re.compile(  # in messages of public functions, with a value or without
    r"(?<![\w-])(?P<name>[a-z_]\w*)=(?P<value>\"[^\"]*\"|'[^']*'|\{[^}]*\}|[^\s'\",;)]*)"
)
MAPPING_ITEM = re.compile(r"'([^']*)': '([^']*)'")
COMMA = re.compile(r"-?\d+,\d+ *[a-zA-Z%]*")  # a decimal comma, perhaps with a unit
SET_NAMES = {"zeta": ("zeta1", "zeta2"), "f1_hz": ("f1",), "f2_hz": ("f2",)}  # and as in a file
OF_ONE_MASS = {name: (f"{name}1",) for name in ("m", "k", "d", "f", "zeta")}  # before a stop
MEANT = {
    **{"gap": "clearance", "restitution": "e", "mass": "m1"},
    **{"frequency": "f1", "damping": "zeta1"},
}

# -- numbers --------------------------------------------------------------------------------------


def parse_plain_float(text: str, kind: Callable[[str], Any] = float) -> Any:
    """Parse a number in plain digits; raise ``ValueError`` for ``1_000`` and other scripts."""
    if not text.isascii() or "_" in text:
        raise ValueError(text)
    return kind(text)


def parse_plain_int(text: str) -> int:
    return int(parse_plain_float(text, int))


def parse_quantity(name: str, text: str) -> float:
    """Parse a number of a quantity in SI, or with one of its units behind it."""
    with_unit = ranges.parse_number_with_unit(name, text.strip())
    return float(parse_plain_float(text)) if with_unit is None else with_unit


def quantity_of_option(option: str) -> str:
    return option.lstrip("-").replace("-", "_")


def decimal_point_hint(text: str) -> str:
    """Return a remark on a number that seems to have a decimal comma; nothing on others."""
    return f" (with a decimal point, {text.replace(',', '.')})" if COMMA.fullmatch(text) else ""


def reader(expected: str) -> Callable[[Callable[[str, str], Parsed]], Reader[Parsed]]:
    """Turn a function that raises ``ValueError`` into the reader of an option's text.

    The function takes the quantity that the option is, whose units texts may have, and the text.
    """

    def decorate(split: Callable[[str, str], Parsed]) -> Reader[Parsed]:
        def read(option: str, text: str) -> Parsed:
            try:
                return split(quantity_of_option(option), text)
            except ValueError:
                words = f"expected {expected}{decimal_point_hint(text)}"
                raise InputError(f"{option} {text}: {words}") from None

        return read

    return decorate


def numbers_reader(
    expected: str, separator: str = ",", counts: Collection[int] = (), positive: bool = False
) -> Reader[tuple[float, ...]]:
    """Return a reader of numbers between separators (a regular expression), ``counts`` of them."""

    @reader(expected)
    def read(name: str, text: str) -> tuple[float, ...]:
        numbers = tuple(parse_quantity(name, part) for part in re.split(separator, text))
        wrong = counts and len(numbers) not in counts
        if wrong or (positive and not all(0.0 < one < math.inf for one in numbers)):
            raise ValueError(text)
        return numbers

    return read


read_int = reader("a whole number")(lambda _, text: parse_plain_int(text))
parse_ends = numbers_reader("FIRST:LAST, two numbers such as 1.2:1.65", ":", (2,))
parse_number_or_ends = numbers_reader("a number, or FIRST:LAST such as 1.2:1.65", ":", (1, 2))
parse_rates = numbers_reader("a number > 0, or several such as 1e-4,5e-5,2.5e-5", positive=True)
parse_sensor = numbers_reader("HZ or HZ:RATE, such as 10000:25600", ":", (1, 2))


@reader("X1,X2,V1,V2, four numbers in m and m/s, or with units such as 20um and 3mm/s")
def parse_state(_: str, text: str) -> tuple[float, ...]:
    pairs = zip(("x1", "x2", "v1", "v2"), text.split(","), strict=True)
    return tuple(parse_quantity(name, part) for name, part in pairs)


def parse_state_or_file(option: str, text: str) -> tuple[float, ...] | Path:
    """Parse x1, x2, v1, v2; or the file of an earlier command's result that has states."""
    return Path(text) if text.endswith(".nc") else parse_state(option, text)


@reader("NAME,FIRST,LAST,COUNT such as x_rel,0,0.8,60 or x_rel,0,20um,60")
def parse_plane_side(_: str, text: str) -> tuple[str, float, float, int]:
    name, first, last, count = (part.strip() for part in text.split(","))
    return name, parse_quantity(name, first), parse_quantity(name, last), parse_plain_int(count)


@reader(BREAKPOINTS)
def parse_breakpoints(_: str, text: str) -> tuple[tuple[float, float], ...]:
    pairs = [tuple(map(parse_plain_float, part.split(":"))) for part in text.split(",")]
    if not all(len(pair) == 2 and all(map(math.isfinite, pair)) for pair in pairs):
        raise ValueError(text)
    return tuple((frequency, value) for frequency, value in pairs)


@reader(f"{BREAKPOINTS}, or 10:2e-3,200:2e-3g2/Hz")
def parse_density(option: str, text: str) -> tuple[tuple[float, float], ...]:
    """Parse a density over frequency in (m/s2)^2/Hz, or in g2/Hz with that unit behind it."""
    pairs = parse_breakpoints(option, text.removesuffix("g2/Hz"))
    unit = GRAVITY**2 if text.endswith("g2/Hz") else 1.0
    return tuple((frequency, unit * value) for frequency, value in pairs)


@reader("a number, or a list such as 0.5,1,2")
def parse_orders(_: str, text: str) -> float | tuple[float, ...]:
    orders = tuple(map(parse_plain_float, text.split(",")))
    return orders if "," in text else orders[0]


def parse_number(option: str, text: str, name: str = "", other: str = "") -> float:
    try:
        return parse_quantity(name or quantity_of_option(option), text)
    except ValueError:
        units = " or ".join([*ranges.written_unit_factors(name or quantity_of_option(option))][:4])
        words = f", with {units} if you like" if units else other
        text = f"{text}: expected a number{words}{decimal_point_hint(text)}"
        raise InputError(f"{option}{'' if option.endswith('=') else ' '}{text}") from None


def parse_positive_number(option: str, text: str) -> float:
    expected = f"a number > 0, such as {option} 0.5"
    return numbers_reader(expected, counts=(1,), positive=True)(option, text)[0]


def parse_single_rate(option: str, text: str) -> float:
    """Parse one rate > 0; name the command that takes several."""
    rates = parse_rates(option, text)
    if len(rates) > 1:
        text = f"{option} {text}: {len(rates)} rates"
        raise InputError(f"{text}; expected one (jump-voltages takes several)")
    return rates[0]


def parse_choice(choices: Collection[Any], option: str, text: str) -> Any:
    for choice in choices:
        if text == str(choice):
            return choice
    raise InputError(f"{option} {text}: {expected_one_of(text, map(str, choices))}")


def load_earlier_result(option: str, path: Path) -> xr.Dataset:
    from ..running.store import load_foreign_result

    expected = "expected a result of an earlier command"
    if not path.is_file():
        raise InputError(f"{option} {path}: no such file; {expected}")
    try:
        data = load_foreign_result(path)
    except StoreError as error:
        netcdf = "" if "expected" in str(error) else "; expected a NetCDF file"
        raise InputError(f"{option} {error}{netcdf}") from None
    try:
        json.loads(data.attrs.get("identity", '{"question": ""}'))["question"]
    except (ValueError, TypeError, KeyError, RecursionError):
        raise InputError(f"{option} {path}: its identity is damaged; {expected}") from None
    return data


def parse_pairs(option: str, texts: Iterable[str], expected: str) -> dict[str, str]:
    """Parse ``NAME=VALUE`` texts to a dict; raise where a part is missing or a name repeats."""
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

    def flag_of(name: str) -> str:
        name = renamed.get(name, name)
        return f"--{name.replace('_', '-')}" if name in options else ""

    def replace_subject(keyword: re.Match[str]) -> str:  # at the beginning: what is wrong
        name, joint = keyword["name"], keyword["joint"]
        if not (flag := flag_of(name)) or (options.get(name) is None) != (joint == " = None"):
            return keyword[0]
        file = f" {options[name]}" if isinstance(options.get(name), Path) else ""
        flag = flag if flag in type(chosen).flags() else ""  # else it has none
        after = f"{file}{joint}" if flag else f"{file}{joint}".lstrip()
        return flag + {" = None": " is missing", " = ": " "}.get(joint, after)

    def replace_advice(keyword: re.Match[str]) -> str:  # what to do
        value = MAPPING_ITEM.sub(r"\1=\2", keyword["value"]).strip("'{}")
        return f"{flag} {value}".rstrip() if (flag := flag_of(keyword["name"])) else keyword[0]

    message = re.sub(r"^(?P<name>[a-z_]\w*)(?P<joint> = None| = |: )", replace_subject, message)
    return KEYWORD.sub(replace_advice, message)


# -- ranges and lists -----------------------------------------------------------------------------


def parse_values(
    option: str, text: str, allow_zero: bool = False, name: str = ""
) -> tuple[float, ...]:
    """Parse ``FIRST:LAST:STEP`` or ``A,B,...`` of numbers > 0, or >= 0; ``name``: the quantity."""
    parts, quantity = text.split(":" if ":" in text else ","), name or quantity_of_option(option)
    try:
        exact = [Decimal(repr(parse_quantity(quantity, part))) for part in parts]
    except ValueError:
        raise InputError(f"{option} {text}: not numbers; {RANGE}") from None
    finite = all(one.is_finite() for one in exact)
    wrong = not finite or (":" in text and len(exact) != 3) or min(exact) < 0
    if wrong or (not allow_zero and min(exact) == 0):
        raise InputError(f"{option} {text}: {RANGE}")
    if ":" in text:
        first, last, step = exact
        if last < first:
            raise InputError(f"{option} {text}: {first} > {last}; {RANGE}")
        if step == 0 or (last - first) > MAX_VALUES * step:
            raise InputError(f"{option} {text}: {RANGE}, and at most {MAX_VALUES} values")
        exact = [first + i * step for i in range(int((last - first) / step) + 1)]
    return tuple(map(float, exact))


def parse_over_values(parameter: str, text: str) -> tuple[float, ...]:
    """Parse ``--values`` of ``--over PARAMETER``, in its unit; zero is a value like any other."""
    if ":" in text:
        return parse_values("--values", text, allow_zero=True, name=parameter)
    option = f"--over {parameter} --values"
    return tuple(parse_number(option, one, parameter) for one in text.split(","))


def is_single_number(text: str) -> bool:
    return not (":" in text or "," in text)


def parse_one_or_more(option: str, text: str, only_one: bool = False) -> float | tuple[float, ...]:
    """Parse one number as float, a range or list as tuple; with ``only_one`` refuse several."""
    values = parse_values(option, text)
    if only_one and len(values) != 1:
        raise InputError(
            f"{option} {text}: {len(values)} values; expected one, such as {option} 1.2 (sweep "
            f"varies one parameter, map two, resonance also the level){decimal_point_hint(text)}"
        )
    return values[0] if only_one or is_single_number(text) else values


# -- names and values -----------------------------------------------------------------------------


def parse_changes(texts: Iterable[str], wall: bool = False) -> dict[str, float | bool]:
    """Parse the texts ``NAME=VALUE`` of ``--set`` into a dict from parameter to value."""
    changes: dict[str, float | bool] = {}
    pairs = parse_pairs("--set", texts, "NAME=VALUE such as e=0.3")
    known = {**SET_NAMES, **(OF_ONE_MASS if wall or pairs.get("wall") == "true" else {})}
    for name, text in pairs.items():
        names = known.get(name, (name,))
        value: float | bool = text == "true"
        if text not in ("true", "false"):
            of_structure = (*PARAMETERS, "bonded", "wall", "preload", *SET_NAMES)
            if names[0] not in (*of_structure, *ranges.DRIVE):
                expected = expected_one_of(MEANT.get(names[0], names[0]), of_structure)
                raise InputError(f"--set {names[0]}: no parameter; {expected}")
            value = parse_number(f"--set {names[0]}=", text, names[0], ", or true or false")
        if name == "preload":  # as a length: in N it depends on the springs
            if text[-1:] != "m" or value < 0.0:
                raise InputError(f"--set preload={text}: expected a length above 0, such as 20um")
            names, value = ("clearance",), -value
        if twice := changes.keys() & set(names):
            raise InputError(f"--set {name}={text}: {min(twice)} is set already; expected once")
        changes |= dict.fromkeys(names, value)
    return changes
