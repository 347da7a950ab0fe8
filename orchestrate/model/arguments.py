"""Checks of arguments, for all packages: an error names the argument, its value, what is expected.

The type of a public function's keyword carries its check, as ``Annotated[int, whole(1)]``: see
:func:`checks_by_field`.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike

from ..errors import NOT_NUMBERS, InputError
from .ranges import checked_flag

MAX_COUNT = 1_000_000  # periods, samples, values: more is a typing error
MAX_NAME = 255  # bytes of a file's name, the limit of most systems
Numbers = float | tuple[float, ...]
Check = Callable[[str, Any], Any]  # takes an argument's name and value, returns the value to use


def checked_integer(name: str, value: Any, minimum: int, maximum: int = MAX_COUNT) -> int:
    is_integer = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not is_integer or not minimum <= value <= maximum:
        raise InputError(f"{name} = {value!r}: expected a whole number from {minimum} to {maximum}")
    return int(value)


def checked_word(name: str, value: Any, known: Iterable[str]) -> str:
    words = tuple(known)
    if not isinstance(value, str) or value not in words:
        raise InputError(f"{name} = {value!r}: expected one of {', '.join(words)}")
    return str(value)


def checked_text(name: str, value: Any) -> str | None:
    if value is not None and not (isinstance(value, str) and value.isprintable()):
        raise InputError(f"{name} = {value!r}: expected printable text, or None")
    return value


def checked_texts(name: str, value: Any) -> tuple[str, ...]:
    """Return one text or several as a tuple; none for None."""
    try:
        texts = () if value is None else (value,) if isinstance(value, str) else tuple(value)
    except TypeError:
        texts = (None,)
    if not all(isinstance(one, str) for one in texts):
        raise InputError(f"{name} = {value!r}: expected a list of texts")
    return tuple(map(str, texts))


def checked_mapping(name: str, value: Any) -> dict[str, Any]:
    """Return a mapping from names as a dict; an empty one for None."""
    found = {} if value is None else value
    if not isinstance(found, Mapping) or not all(isinstance(key, str) for key in found):
        raise InputError(f"{name} = {value!r}: expected a mapping from names, such as {{'a': ...}}")
    return dict(found)


def checked_path(name: str, value: Any) -> Path:
    """Return ``value`` as a path; raise ``InputError`` where no file can have it as its name."""
    text = os.fspath(value) if isinstance(value, (str, os.PathLike)) else value
    if not isinstance(text, str):
        raise InputError(f"{name} = {value!r}: expected a path, as a text or a pathlib.Path")
    if "\0" in text:
        raise InputError(f"{name} = {value!r}: expected a path without NUL characters")
    for part in Path(text).parts:
        if len(os.fsencode(part)) > MAX_NAME:
            length = f"{name}: the name {part[:12]}... has {len(os.fsencode(part))} bytes"
            raise InputError(f"{length}; expected at most {MAX_NAME}")
    return Path(text)


def checked_unmasked(name: str, value: Any) -> Any:
    if np.ma.is_masked(value):
        number, count = int(np.ma.getmaskarray(value).sum()), np.size(value)
        text = "expected all to be numbers (compressed() leaves masked ones out)"
        raise InputError(f"{name}: {number} of {count} entries are masked; {text}")
    return value


def checked_numbers(
    name: str, value: ArrayLike | None, check: Callable[[Any], float] = float, positive: str = ""
) -> Numbers | None:
    """Return a finite float or a tuple of them, > 0 with a text ``positive``; None for None."""
    if value is None:
        return None
    checked_unmasked(name, value)
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "iuf":
            raise ValueError
        array = array.astype(float)
    except NOT_NUMBERS:
        raise InputError(f"{name} = {value!r}: expected a number or a list of numbers") from None
    if array.ndim > 1 or not 1 <= array.size <= MAX_COUNT:
        shape = "x".join(map(str, array.shape))
        raise InputError(f"{name}: {shape} values; expected a number or a list of 1 to {MAX_COUNT}")
    result = tuple(check(number) for number in array.ravel().tolist())
    bad = [number for number in result if not math.isfinite(number) or (positive and number <= 0.0)]
    if bad:
        raise InputError(f"{name} = {bad[0]!r}: expected finite numbers{positive}")
    return result if array.ndim else result[0]


def checked_number(name: str, value: Any, expected: str = "one number") -> float:
    number = checked_numbers(name, value)
    if not isinstance(number, float):
        raise InputError(f"{name} = {value!r}: expected {expected}")
    return number


def checked_list(name: str, value: Any) -> tuple[float, ...]:
    """Return one finite number or several as a tuple."""
    numbers = checked_numbers(name, () if value is None else value)
    assert numbers is not None  # of a value that is given
    return numbers if isinstance(numbers, tuple) else (numbers,)


def checked_pair(name: str, value: Any, expected: str) -> tuple[float, float]:
    pair = checked_numbers(name, value)
    if not isinstance(pair, tuple) or len(pair) != 2:
        raise InputError(f"{name} = {value!r}: expected {expected}")
    return pair[0], pair[1]


def checked_positive(name: str, value: Any) -> float:
    number = checked_numbers(name, value)
    if not isinstance(number, float) or number <= 0.0:
        raise InputError(f"{name} = {value!r}: expected a number > 0")
    return number


OF_PLAIN_TYPES: dict[Any, Check] = {bool: checked_flag, str | None: checked_text}


def whole(minimum: int, maximum: int = MAX_COUNT) -> Check:
    return partial(checked_integer, minimum=minimum, maximum=maximum)


@cache
def checks_by_field(kind: type) -> dict[str, Check]:
    """Return the checks that the types of a dataclass's fields carry, or that are known of them."""
    types = get_type_hints(kind, include_extras=True)
    checks: dict[str, Check] = {}
    for name, one in ((field.name, types[field.name]) for field in fields(kind)):
        if hasattr(one, "__metadata__"):
            checks[name] = one.__metadata__[0]
        elif get_origin(one) is Literal:
            checks[name] = partial(checked_word, known=get_args(one))
        elif one in OF_PLAIN_TYPES:
            checks[name] = OF_PLAIN_TYPES[one]
    return checks


def check_and_convert_fields(instance: Any) -> None:
    """Check the fields of a dataclass whose types have a check; set them to what it returns."""
    kind: type = type(instance)
    for name, check in checks_by_field(kind).items():
        object.__setattr__(instance, name, check(name, getattr(instance, name)))


# Types of keywords that several public functions have, each with its check: `Annotated` is a type
# for editors and type checkers, and `checks_by_field` finds the check. Those of words
# (`Literal`) and flags (`bool`) need no more.
Transient = Annotated[int, whole(0)]  # periods dropped
Count = Annotated[int, whole(1)]  # periods, samples, points: at least one
Positive = Annotated[float, checked_positive]
Number = Annotated[float, checked_number]
