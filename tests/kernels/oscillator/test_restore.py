"""A state that is restored goes on with the bits it would have had."""

import math
import random
import struct

import pytest

from fmu_src.kernels.numerics.first_root import INFINITE
from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import stepper
from fmu_src.models.oscillator.model import MODEL
from fmu_src.runtime.table import hidden_problem

from ...sparing import ordinary
from .kernel import started

OF_NODES = {at.LEFT_AGE, at.RIGHT_AGE}  # not used in a short flight


def bits(values):
    return struct.pack(f"<{len(values)}d", *values)


def drawn(draw, more):
    """A structure in motion, and its start time."""
    values = {
        "e": draw.choice([0.0, 0.3, 0.7, 0.95, 1.0]),
        "gamma": draw.choice([1e-7, 1e-4, 1e-2]),
        "k2": draw.uniform(0.3, 4.0),
        "m2": draw.choice([0.2, 1.0, 5.0]),
        "d1": draw.choice([0.0, 0.01, 3.0]),
        "d2": draw.choice([0.0, 0.1, 3.0]),
        "box_frequency": draw.choice([0.0, 0.4, 1.9, 6.1]),
        "box_amplitude": draw.choice([0.0, 1.0, 1e-6]),
        "phase_start": draw.uniform(-5.0, 5.0),
        "bonded": draw.random() < 0.2,
        "x_rel_max_on": draw.random() < 0.5,
        "e_slope": draw.choice([0.0, 0.0, 0.5]),
    }
    if not values["bonded"] and draw.random() < 0.4:
        values |= {"x2_start": draw.uniform(0.0, 2.0), "v2_start": draw.uniform(-2.0, 2.0)}
    if draw.random() < 0.2:  # a resonance without damping
        square = values["k2"] / values["m2"] if draw.random() < 0.5 else 1.0
        natural = math.sqrt(
            (1.0 + values["k2"]) / (1.0 + values["m2"]) if values["bonded"] else square
        )
        values |= {"d1": 0.0, "d2": 0.0, "box_frequency": natural, "box_amplitude": 1.0}
    if not values["bonded"] and more.random() < 0.3:
        values |= {"wall": 1.0, "x2_start": 0.0, "v2_start": 0.0}
    if more.random() < 0.3:
        values["stroke"] = 3.0 + more.random()
    start = draw.choice([0.0, 3.3, -1e3])
    return started(start, **values), start


def change_inputs(draw, more, *memories):
    """The same in each of the memories."""
    changes = {
        at.BOX_AMPLITUDE: draw.uniform(-1.0, 1.0),
        at.BOX_FREQUENCY: draw.uniform(0.0, 3.0),
        at.BOX_ACCELERATION: draw.uniform(-1.0, 1.0),
        at.BOX_JERK: draw.choice([0.0, draw.uniform(-1.0, 1.0)]),
    }
    slots = at.FORCE1_AMPLITUDE, at.FORCE1, at.FORCE2_2
    if memories[0][at.E] == 1.0:  # pressed, masses would not stick: impacts without end
        slots = ()
    forces = {slot: more.uniform(-0.3, 0.3) for slot in slots}
    for slot, value in (changes | forces).items():
        if (more if slot in forces else draw).random() < 0.2:
            for m in memories:
                m[slot] = value


def check(seed, steps):
    """A run, and one that is restored before each of its steps."""
    draw, more = random.Random(seed), random.Random(f"family {seed}")
    m, start = drawn(draw, more)
    time = start
    for _ in range(steps):
        other = list(m)
        assert hidden_problem(MODEL, other) == ""
        assert stepper.restore(other, start) == at.OK
        changed = {slot for slot in range(at.SIZE) if bits([m[slot]]) != bits([other[slot]])}
        assert changed <= (OF_NODES if m[at.SERIES] != 0.0 else set()), (seed, time)
        change_inputs(draw, more, m, other)
        m[at.STOP_AT_IMPACT] = other[at.STOP_AT_IMPACT] = float(seed % 3 == 0)
        time += draw.choice([0.05, 0.3, 2.0, 7.0])
        code = stepper.advance(m, time)
        assert stepper.advance(other, time) == code
        if code != at.OK:
            return
        time = m[at.TIME]
        assert bits(m[: at.TIME + 1]) == bits(other[: at.TIME + 1]), (seed, time)


# 5 and 10, long chattering and a resonance without any loss, cost more than the others together;
# 18 and 33 are in a series at half of their points
@pytest.mark.parametrize("seed", ordinary((*range(12), 18, 33), {*range(34)} - {5, 10}))
def test_a_restored_run_has_the_same_bits(seed):
    check(seed, 12)


@pytest.mark.parametrize("values", [{"bonded": 1.0}, {"k2": 1.0, "d2": 0.01}])
def test_a_state_that_nothing_ends_may_be_as_old_as_it_likes(values):
    """Bonded, or pressed together for good: such a state is never written anew."""
    m = started(0.0, **values)
    for time in (2000.0, 1e7):
        stepper.advance(m, time)
        assert m[at.CLEAR] == INFINITE and m[at.NODE] > 1024.0
        other = list(m)
        assert stepper.restore(other, 0.0) == at.OK
        assert stepper.advance(other, time + 3.3) == at.OK
        assert stepper.advance(m, time + 3.3) == at.OK
        assert bits(m[: at.TIME + 1]) == bits(other[: at.TIME + 1])
