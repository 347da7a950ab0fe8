"""Capture from rest: the border against simulations of the whole system."""

import numpy as np
import pytest

from orchestrate import InputError, capture

from . import bonded
from .coupled import QUICK, rest
from .monolithic import Monolith

SHORT = {"step": 0.2, "progress": False}


def passes(voltage, time=900.0):
    """Whether the bonded system passes, by the plain simulation."""
    speeds, _ = bonded.run(QUICK.as_bonded(), lambda *_: voltage, 0.1, round(10 * time))
    return np.mean(speeds[-100:]) > 1.35


def test_the_border_is_that_of_the_whole_system():
    """Between two voltages 2e-4 V apart; the one found lies in the middle, to 1e-4 V."""
    found = capture(*QUICK.as_bonded(), voltage=(1.5442, 1.5446), count=2, time=900.0, **SHORT)
    border = float(found.border)
    assert found.passes.values.tolist() == [0, 1]
    assert not passes(border - 1e-4) and passes(border + 1e-4)
    assert border == pytest.approx(1.54443, abs=1e-4)


@pytest.mark.slow
def test_the_border_with_impacts():
    found = capture(*QUICK, voltage=(1.53, 1.55), count=3, time=900.0, progress=False)
    border = float(found.border)
    times = np.arange(0.0, 900.0, 0.5)
    ends = [
        Monolith(*QUICK, border + side).solve(rest(), times)[0][-20:, 7].mean()
        for side in (-2e-4, 2e-4)
    ]
    assert ends[0] < 1.35 < ends[1]


def test_over_a_second_parameter():
    """A heavier rotor takes more voltage; it is the one of the drive that varies."""
    inertia = [800.0, 1400.0]
    asked = {"voltage": (1.5, 1.6), "count": 2, "tolerance": 0.02, "time": 450.0, **SHORT}
    found = capture(*QUICK.as_bonded(), over="rotor_inertia", values=inertia, **asked)
    assert found.passes.dims == ("rotor_inertia", "voltage")
    assert found.rotor_inertia.attrs["units"] == "kg.m2"
    assert 1.52 < found.border[0] < found.border[1] < 1.57
    alone = QUICK.drive.replace(rotor_inertia=1400.0)
    other = capture(QUICK.structure.as_bonded(), alone, **asked)
    assert float(other.border) == float(found.border[1])
    assert other.passage_time.values == pytest.approx(found.passage_time[1].values, nan_ok=True)


def test_no_border():
    asked = {"count": 2, "time": 450.0, **SHORT}
    low = capture(*QUICK.as_bonded(), voltage=(1.0, 1.1), **asked)
    high = capture(*QUICK.as_bonded(), voltage=(1.7, 1.8), **asked)
    assert not low.passes.any() and high.passes.all()
    assert np.isnan(low.border) and np.isnan(high.border)


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ({"voltage": 1.5}, ["voltage = 1.5", "(lowest, highest)"]),
        ({"voltage": (1.6, 1.5)}, ["voltage = (1.6, 1.5)", "(lowest, highest)"]),
        ({"voltage": (-1.0, 1.5)}, ["voltage = -1.0", "0 <= voltage"]),
        ({"count": 1}, ["count = 1", ">= 2"]),
        ({"tolerance": 0.0}, ["tolerance = 0.0", "0 < tolerance"]),
        ({"time": -1.0}, ["time = -1.0", "0 < time"]),
        ({"stay": 0}, ["stay = 0", ">= 1"]),
        ({"over": "D"}, ["over = 'D'", "both"]),
        ({"over": "colour", "values": [1.0]}, ["colour", "no parameter"]),
        ({"over": "rotor_inertia", "values": [-1.0]}, ["rotor_inertia = -1.0", "<="]),
        ({"over": "D", "values": []}, ["values = []", "one number or more"]),
        ({"over": "D", "values": ["x"]}, ["values = ['x']", "numbers"]),
        ({"step": 9.0}, ["step = 9.0", "<= 1"]),
        ({"control": 3}, ["control = 3", "SpeedControl"]),
    ],
)
def test_mistakes(arguments, parts):
    with pytest.raises(InputError) as caught:
        capture(*QUICK, progress=False, **{"voltage": (1.4, 1.6), **arguments})
    assert all(part in str(caught.value) for part in parts), str(caught.value)
    assert "\n" not in str(caught.value)
