"""Read flags: the words of CF flag variables, and runs of true values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any


def flag_words(attributes: Mapping[Any, Any]) -> dict[int, str]:
    """Return a dict from number to word, read from ``flag_values`` and ``flag_meanings`` (CF)."""
    import numpy as np  # keeps --help free of NumPy

    words = str(attributes["flag_meanings"]).split()
    numbers = np.atleast_1d(attributes["flag_values"]).tolist()
    return {int(n): word.replace("_", " ") for n, word in zip(numbers, words, strict=True)}


def flag_word(flag: Any) -> str:
    """Return the word that a scalar flag variable stands for; empty if it is no flag."""
    return flag_words(flag.attrs).get(int(flag), "") if "flag_meanings" in flag.attrs else ""


def runs_of_true(flags: Iterable[Any]) -> list[tuple[int, int]]:
    """Return first and last index of each run of true flags."""
    runs: list[tuple[int, int]] = []
    for index, holds in enumerate(flags):
        if holds and runs and runs[-1][1] == index - 1:
            runs[-1] = (runs[-1][0], index)
        elif holds:
            runs.append((index, index))
    return runs
