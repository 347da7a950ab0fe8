"""A state of one structure as the like one of another, as the explorer carries it."""

import math
from ctypes import c_double, c_void_p

import numpy as np
import pytest

from orchestrate import Structure
from orchestrate.fmu import OSCILLATOR, Instance, find_or_export, gaps_of_states, start_motion
from orchestrate.fmu.oscillator import respond_library, traits_for_loops
from orchestrate.model import Excitation


def carried(state, one, other, length=1.0, speed=1.0):
    carry, like = respond_library().carry_state, (c_double * 4)()
    carry.argtypes, carry.restype = [c_void_p] * 3 + [c_double] * 2 + [c_void_p], None
    traits = traits_for_loops(one), traits_for_loops(other)
    carry((c_double * 4)(*state), *traits, length, speed, like)
    return np.array(like)


def drawn(rng, wall):
    clearance = float(rng.choice([0.0, *rng.uniform(-1.0, 1.0, 2)]))
    stroke = float(rng.choice([0.0, max(clearance, 0.0) + rng.uniform(0.05, 1.0)]))
    return Structure(wall=wall, clearance=clearance, stroke=stroke)


@pytest.mark.parametrize("wall", [(True, True), (False, True), (True, False), (False, False)])
def test_a_carried_state_is_one_of_the_other_structure(exported, wall):
    """A wall stays where it is, faces that touch go on touching at their end, none overlap, and
    the FMU takes it.
    """
    rng, touching = np.random.default_rng(65), {0.0: 0, math.inf: 0}
    for _ in range(60):
        one, other = (drawn(rng, is_wall) for is_wall in wall)
        gap = float(rng.choice([0.0, one.stroke, rng.uniform(0.0, 1.0) * (one.stroke or 2.0)]))
        x2, v1, v2 = (0.0, rng.normal(), 0.0) if one.wall else rng.normal(size=3)
        state = [x2 + one.clearance - gap, x2, v1, v2]
        like = carried(state, one, other, *rng.uniform(0.3, 3.0, 2))
        assert not other.wall or like[1] == like[3] == 0.0
        apart = float(gaps_of_states(like[None], other.clearance)[0])
        rounding = 1e-15 * np.abs(like).max()
        assert -rounding <= apart <= (other.stroke or math.inf) + rounding, (state, like)
        if gap == 0.0:
            assert apart == 0.0
            touching[0.0] += 1
        elif gap == one.stroke and other.stroke:
            assert apart == pytest.approx(other.stroke, abs=rounding)
            touching[math.inf] += 1
        with Instance(find_or_export(OSCILLATOR).path) as instance:
            start_motion(instance, other, Excitation(frequency=1.1, amplitude=0.3), like)
    assert min(touching.values()) > 1
