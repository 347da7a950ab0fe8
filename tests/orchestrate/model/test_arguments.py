"""Checks and words that every package shares."""

import numpy as np
import pytest

from orchestrate.errors import InputError
from orchestrate.flags import flag_words
from orchestrate.model.arguments import MAX_COUNT, checked_integer
from orchestrate.running.options import RunOptions


@pytest.mark.parametrize("value", [2, np.int64(2), np.uint8(2)])
def test_integers_of_numpy_are_integers(value):
    result = checked_integer("count", value, 1)
    assert result == 2 and type(result) is int
    assert type(RunOptions(jobs=value).jobs) is int


@pytest.mark.parametrize("value", [True, np.True_, 2.0, "2", None, 0, MAX_COUNT + 1, np.nan])
def test_what_is_no_integer_of_the_range_is_refused(value):
    with pytest.raises(
        InputError, match=f"count = .*: expected a whole number from 1 to {MAX_COUNT}"
    ):
        checked_integer("count", value, 1)


def test_words_of_one_flag_and_of_many():
    assert flag_words({"flag_values": np.int8(3), "flag_meanings": "fold"}) == {3: "fold"}
    words = flag_words({"flag_values": np.int8([0, 1]), "flag_meanings": "no period_doubling"})
    assert words == {0: "no", 1: "period doubling"}
