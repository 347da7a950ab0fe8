"""The measures of the paper's claims, by section: each reads numbers and says what holds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from . import equations, influence, limits, peaks, setup, windows


def find_measure(name: str) -> Callable[..., Any]:
    """Return the measure of a name.

    Raises
    ------
    KeyError
        Where there is none.
    """
    modules = (setup, equations, limits, windows, influence, peaks)
    found = {key: value for module in modules for key, value in vars(module).items()}
    measure: Callable[..., Any] = found[name]
    return measure
