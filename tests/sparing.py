"""Which cases of a parametrized test an ordinary run takes, and which only ``-m slow``."""

from collections.abc import Collection, Iterable
from typing import Any

import pytest


def ordinary(
    values: Iterable[Any], kept: Collection[Any] | int = 1, *, several_names: bool = False
) -> list[Any]:
    """Mark all values of a parameter as slow but the first ``kept`` ones, or those in ``kept``.

    For tests whose cases prove the same for other numbers, each at the price of seconds. With
    ``several_names`` a value is a tuple, one item for each name.
    """
    every = list(values)
    chosen = every[:kept] if isinstance(kept, int) else kept
    marks = [[] if one in chosen else [pytest.mark.slow] for one in every]
    rows = every if several_names else [(one,) for one in every]
    return [pytest.param(*row, marks=mark) for row, mark in zip(rows, marks, strict=True)]
