"""Read the words of CF flag variables: numbers in a dataset that stand for words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def flag_words(attributes: Mapping[Any, Any]) -> dict[int, str]:
    """Return a dict from number to word, read from ``flag_values`` and ``flag_meanings`` (CF).

    Examples
    --------
    >>> flag_words({"flag_values": [0, 1], "flag_meanings": "irregular period_doubling"})
    {0: 'irregular', 1: 'period doubling'}
    """
    import numpy as np  # a help needs none

    words = str(attributes["flag_meanings"]).split()
    numbers = np.atleast_1d(attributes["flag_values"]).tolist()
    return {int(n): word.replace("_", " ") for n, word in zip(numbers, words, strict=True)}
