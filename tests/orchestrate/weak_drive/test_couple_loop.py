"""Revolutions of the motor from the compiled steps' record."""

import math

import numpy as np

from orchestrate.constants import TURN
from orchestrate.weak_drive.connection import MOTOR
from orchestrate.weak_drive.revolutions import Revolutions
from orchestrate.weak_drive.step_record import LEADING, Record

from .coupled import QUICK


def completed(time, angle, speed, impacts):
    """Where whole turns are new, one or more further from the last, to its side."""
    last, begin, before, found = 0, 0.0, 0.0, []
    for i, turns in enumerate((angle / TURN).tolist()):
        if abs(turns - last) >= 1.0:
            turn = math.floor(turns) if turns > last else math.ceil(turns)
            end = time[i] - (angle[i] - turn * TURN) / speed[i]
            found.append((i, end, (turn - last) * TURN / (end - begin), impacts[i] - before))
            last, begin, before = turn, end, impacts[i]
    return found


def test_revolutions_are_the_turns_that_are_new():
    """To and fro, across zero, several at once, exact ones, and over records that follow."""
    rng, names = np.random.default_rng(8), (*LEADING, *MOTOR.outputs)
    turns = np.concatenate([np.cumsum(rng.normal(0.0, 0.8, 400)), [-3.0, 2.0, -2.5, 0.0, 0.5]])
    count = len(turns)
    columns = {"time": np.arange(1.0, count + 1), "angle": TURN * turns}
    columns |= {"speed": rng.uniform(20.0, 30.0, count), "impacts": np.arange(count) // 3.0}
    table = np.zeros((len(names), count))
    table[[names.index(name) for name in columns]] = np.array(list(columns.values()))
    revolutions, found = Revolutions(QUICK.structure), []
    for ends in np.split(np.arange(count), [7, 100, 101]):
        found += revolutions.completed(Record(names, table, ends)).tolist()
    expected = completed(*columns.values())
    assert len(found) > 100 and len({row[2] > 0.0 for row in found}) == 2
    assert [tuple(row) for row in found] == expected
