"""Checks of integer and word arguments, for all packages."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from .errors import InputError

MAX_COUNT = 1_000_000  # periods, samples, values: more is a typing error
REQUIRES_DELAMINATED = "bonded = True: expected a delaminated structure (bonded = false)"


def checked_integer(name: str, value: Any, minimum: int, maximum: int = MAX_COUNT) -> int:
    """Return ``value`` as int; raise ``InputError`` unless whole and from minimum to maximum."""
    is_integer = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not is_integer or not minimum <= value <= maximum:
        raise InputError(f"{name} = {value!r}: expected a whole number from {minimum} to {maximum}")
    return int(value)


def checked_word(name: str, value: Any, known: Iterable[str]) -> str:
    """Return ``value`` as a string; raise ``InputError`` unless it is one of the ``known``
    words.
    """
    words = tuple(known)
    if value not in words:
        raise InputError(f"{name} = {value!r}: expected one of {', '.join(words)}")
    return str(value)
