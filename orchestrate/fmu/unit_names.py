"""Units by name, for FMUs that define none by base units: ``mm/s2``, ``kN``, ``N.m``."""

from __future__ import annotations

import re
from typing import NamedTuple


class Unit(NamedTuple):
    """Describe a unit: the exponents of SI base units that are not 0, and what one of it is."""

    exponents: dict[str, int]
    factor: float = 1.0


WITHOUT_PREFIX = {
    "m": Unit({"m": 1}),
    "s": Unit({"s": 1}),
    "min": Unit({"s": 1}, 60.0),
    "g": Unit({"kg": 1}, 1e-3),
    "A": Unit({"A": 1}),
    "K": Unit({"K": 1}),
    "rad": Unit({"rad": 1}),
    "N": Unit({"kg": 1, "m": 1, "s": -2}),
    "V": Unit({"kg": 1, "m": 2, "s": -3, "A": -1}),
}
PREFIXES = {"": 1.0, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6, "\u00b5": 1e-6, "\u03bc": 1e-6}
SYMBOLS = {
    prefix + symbol: Unit(unit.exponents, factor * unit.factor)
    for symbol, unit in WITHOUT_PREFIX.items()
    for prefix, factor in PREFIXES.items()
}
PART = re.compile(r"(?P<symbol>[^\W\d_]+)\^?\(?(?P<power>-?\d*)\)?")
SEPARATED = re.compile(r"([./*\u00b7 ])")
AMBIGUOUS = ("g",)  # gram, or an acceleration


def parse_unit(name: str) -> Unit | None:
    """Return the unit that a name such as ``mm/s2`` stands for; None if it is not understood."""
    text = name.strip().replace("\u00b2", "2").replace("\u00b3", "3").replace("**", "^")
    if not text or text in AMBIGUOUS:
        return None
    exponents: dict[str, int] = {}
    factor, sign = 1.0, 1
    for number, part in enumerate(SEPARATED.split(text)):
        if number % 2:  # all behind a slash is divided by
            sign = -1 if part == "/" else sign
            continue
        match = PART.fullmatch(part)
        symbol = SYMBOLS.get(match["symbol"]) if match else None
        if match is None or symbol is None:
            return None
        power = sign * int(match["power"] or 1)
        factor *= symbol.factor**power
        for base, exponent in symbol.exponents.items():
            exponents[base] = exponents.get(base, 0) + power * exponent
    return Unit({base: power for base, power in exponents.items() if power}, factor)
