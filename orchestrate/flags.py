"""Read the words of CF flag variables: numbers in a dataset that stand for words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def flag_words(attributes: Mapping[Any, Any]) -> dict[int, str]:
    """Return a dict from number to word, read from ``flag_values`` and ``flag_meanings`` (CF)."""
    import numpy as np  # a help needs none

    words = str(attributes["flag_meanings"]).split()
    numbers = np.atleast_1d(attributes["flag_values"]).tolist()
    return {int(n): word.replace("_", " ") for n, word in zip(numbers, words, strict=True)}
