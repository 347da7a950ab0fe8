"""Saved memories with some numbers changed, on the kernels' Python source: a number that indexes,
counts or bounds a loop is refused, any other makes at worst a wrong motion.

An index out of range, a division by zero and a floor of no number are exceptions here.
"""

import itertools
import math
import operator
import random

import pytest

from fmu_src.kernels.electrodynamic_shaker import memory as coil
from fmu_src.kernels.motor_shaker import memory as shaker
from fmu_src.kernels.oscillator import memory as oscillator
from fmu_src.models.electrodynamic_shaker.model import MODEL as COIL
from fmu_src.models.motor_shaker.model import MODEL as MOTOR
from fmu_src.models.oscillator.model import MODEL as OSCILLATOR
from fmu_src.runtime.table import hidden_slot_problem

from ..sparing import ordinary

LIMIT = 400  # evaluations of a step
NASTY = (math.nan, math.inf, -math.inf, 0.0, -1.0, 0.5, 3.0, 5e-324, 2.0**53, 1e18, 1e300, -1e300)
DRIVE = {"box_amplitude": 0.8, "box_frequency": 1.13}
RUNS = {  # flight, contact, chattering, a resonance, a cubic, preload; limits of the amplifier
    "oscillator": [
        (OSCILLATOR, {**DRIVE, "sample_count": 2, "peaks_on": 1.0}),
        (OSCILLATOR, {**DRIVE, "e": 0.3, "gamma": 1e-7, "k2": 1.9}),
        (OSCILLATOR, {"box_amplitude": 1.0, "box_frequency": 1.0, "d1": 0.0, "d2": 0.0}),
        (OSCILLATOR, {"box_jerk": 0.02, "x2_start": 0.5, "d1": 3.0}),
        (OSCILLATOR, {**DRIVE, "bonded": 1.0}),
        (OSCILLATOR, {**DRIVE, "e": 0.3, "clearance": -0.2, "peaks_on": 1.0}),
    ],
    "motor": [
        (MOTOR, {"voltage": 6.0}),
        (MOTOR, {"armature_inductance": 0.01, "box_force_1": 2.0}),
    ],
    "coil": [
        (COIL, {"command": 3.0, "box_force_1": 5.0, "travel_limit": 1.0}),
        (COIL, {"command": 9.0, "coil_inductance": 0.02, "current_limit": 1.0}),
        (COIL, {"command_1": 9.0, "voltage_limit": 5.0, "current_control": 1.0}),
    ],
}
DERIVED = {
    "oscillator": range(oscillator.OMEGA, oscillator.SEGMENT_INPUTS),
    "motor": [shaker.UNBALANCE],
    "coil": range(coil.VOLTAGE_SPACING, coil.BEGIN),
}


def saved(model, values, times):
    m = [0.0] * model.memory_size
    for variable in model.variables:
        if not variable.calculated:
            m[variable.slot] = values.get(variable.name, variable.start)
    assert model.initialize(m, 0.0) == 0
    for time in times:
        assert model.advance(m, time) == 0
        yield list(m)


def forge(draw, model, m):
    """A memory with up to four of its hidden numbers changed, often one that has a range."""
    m = list(m)
    ranged = [row.first for row in model.ranges if row.lowest <= row.highest]
    for _ in range(draw.randint(1, 4)):
        slot = draw.randrange(len(model.variables), model.memory_size)
        slot = draw.choice(ranged) if draw.random() < 0.4 else slot
        near = (-m[slot], m[slot] * 1.01, m[slot] + 1.0, m[slot] - 1e-3, draw.choice(m))
        m[slot] = draw.choice(NASTY + near)
    return m


def run_on(draw, model, m):
    """Restore and go on, inputs set or not; whether it was taken."""
    if hidden_slot_problem(model, m) or model.restore(m, 0.0):
        return False
    slots = {variable.name: variable.slot for variable in model.variables}
    m[slots["evaluation_limit"]] = LIMIT
    for more in (0.0, 0.1, draw.choice((1e-9, 3.0, 1e6))):
        reached = m[model.time_slot]
        if draw.random() < 0.3:
            m[slots["box_jerk" if "e" in slots else "box_force_1"]] = 0.3
            m[model.set_slot] = 1.0
        before = list(m)
        for entry in (model.coast, model.refresh, model.advance, model.differentiate):
            if entry and entry(m, reached + more):
                m[:] = before
            elif entry == model.advance:
                assert all(math.isfinite(m[v.slot]) for v in model.variables if v.calculated)
    return True


@pytest.mark.parametrize("kind", RUNS)
@pytest.mark.parametrize("seed", ordinary(range(20)))
def test_a_forged_memory_harms_nothing(kind, seed):
    draw = random.Random(f"{kind} {seed}")
    times = [0.0, 0.4, 1.1, 2.5] if kind != "oscillator" else [0.0, 2.6, 3.3, 17.9]
    taken = tried = 0
    for model, values in RUNS[kind]:
        for m, _ in itertools.product(saved(model, values, times), range(5)):
            tried += 1
            taken += run_on(draw, model, forge(draw, model, m))
    assert tried // 5 < taken < tried


@pytest.mark.parametrize("kind", RUNS)
def test_no_loop_and_no_index_is_bounded_by_a_number_out_of_its_range(kind):
    for model, values in RUNS[kind]:
        (m,) = saved(model, values, [0.3])
        assert hidden_slot_problem(model, m) == "" and model.restore(m, 0.0) == 0
        for row in model.ranges:
            if row.lowest > row.highest:
                continue
            for value in (row.lowest - 1.0, row.highest + 1.0, math.nan):
                other = list(m)
                other[row.first] = value
                refused = hidden_slot_problem(model, other)
                assert bool(refused) != row.allows(value)
                assert not refused or f"slot {row.first}" in refused


@pytest.mark.parametrize("kind", RUNS)
def test_what_is_derived_is_not_read(kind):
    model, values = RUNS[kind][1]
    (m,) = saved(model, values, [0.3])
    spoilt = list(m)
    for slot in DERIVED[kind]:
        spoilt[slot] = 1.5 * m[slot] + 1.0
        if hidden_slot_problem(model, spoilt):  # of a fixed range
            spoilt[slot] = m[slot]
    assert sum(map(operator.ne, m, spoilt)) > 0.7 * len(DERIVED[kind])
    assert model.restore(spoilt, 0.0) == 0
    assert all(m[slot] == spoilt[slot] for slot in DERIVED[kind])
