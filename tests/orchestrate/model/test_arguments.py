"""Checks and words that every package shares."""

import math
from functools import partial

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate.errors import InputError
from orchestrate.model.arguments import MAX_COUNT, checked_integer
from orchestrate.model.ranges import checked_range
from orchestrate.model.structure import Structure

QUICK = Structure.from_file("quick"), orchestrate.Drive.from_file("quick")


def test_an_error_is_a_printable_line():
    assert str(InputError("one\ntwo\x1b[2J")) == r"one\ntwo\x1b[2J"


@pytest.mark.parametrize("value", [True, np.True_, 2.0, "2", None, 0, MAX_COUNT + 1, np.nan])
def test_what_is_no_integer_of_the_range_is_refused(value):
    expected = f"expected a whole number from 1 to {MAX_COUNT}"
    with pytest.raises(InputError, match=f"count = .*: {expected}"):
        checked_integer("count", value, 1)


@pytest.mark.parametrize(
    ("running", "text"),
    [
        *(({name: 1}, rf"{name} = 1") for name in ("progress", "force", "keep_stale")),
        *(({name: 7}, f"{name} = 7: expected a path") for name in ("store", "build_folder", "fmu")),
        ({"progress": print}, "progress = "),
        ({"store": b"a.nc"}, "store = b'a.nc'"),
        ({"fmu": {"TwoMassImpactOscillator": 7}}, "fmu = 7: expected a path"),
        ({"store": "a\0.nc"}, "store = 'a.*NUL"),
        ({"store": f"folder/{'a' * 300}.nc"}, "store: the name a+... has 303 bytes"),
        ({"store": "é" * 130}, "store: the name é+... has 260 bytes"),
    ],
)
def test_wrong_keywords_on_how_to_compute(running, text):
    with pytest.raises(InputError, match=text):
        orchestrate.simulate(Structure(), eta=1.1, **running)


CURVE = partial(orchestrate.resonance_curve, frequency=[1, 2, 3, 4], amplitude1=[1, 2, 3, 4])
MASKED = np.ma.array([0.9, 1.0, 1.1, 1.2], mask=[0, 1, 0, 0])


@pytest.mark.parametrize(
    ("name", "ask"),
    [
        ("eta", lambda: orchestrate.sweep(Structure(), eta=MASKED)),
        ("frequency", lambda: orchestrate.sweep(Structure(), frequency=MASKED, amplitude=1.0)),
        ("start", lambda: orchestrate.simulate(Structure(), eta=1.0, start=MASKED)),
        ("acceleration", lambda: orchestrate.Sampled(acceleration=MASKED, sample_rate=9.0)),
        ("level", lambda: CURVE(level=MASKED)),
        ("voltages", lambda: orchestrate.Course(times=[0, 1, 2, 3], voltages=MASKED)),
        ("voltage", lambda: orchestrate.couple(*QUICK, voltage=MASKED[:2])),
    ],
)
def test_masked_entries_are_refused(name, ask):
    """Their data are what was there before they were masked."""
    text = rf"{name}: 1 of \d entries are masked; expected all to be numbers"
    with pytest.raises(InputError, match=text):
        ask()


def test_a_range_takes_numbers_of_every_kind_and_nothing_infinite():
    """Warnings are errors here: the largest double is infinite as a float32."""
    for value in (np.float32(1.5), np.array(1.5), 1.5, xr.DataArray(1.5)):
        assert checked_range("hold", value, "s", low=0.0) == 1.5
    for wrong in (np.float32("inf"), math.nan, 10**400, True, "1.5", np.array([1.5])):
        with pytest.raises(InputError, match=r"^hold = .* s: expected 0 <= hold$"):
            checked_range("hold", wrong, "s", low=0.0)
    for ends in ({"open_low": True}, {"open_high": True}):
        with pytest.raises(InputError, match="0 <=? part <=? 0"):
            checked_range("part", 0.0, low=0.0, high=0.0, **ends)
