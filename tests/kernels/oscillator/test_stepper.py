"""The entry points: the communication grid, the scale and the instance leave no trace in any
bit.
"""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import stepper

from .kernel import CHAOTIC, advanced, examples, outputs, set_inputs, started

STOP = 120.0
GRIDS = st.lists(st.floats(0.0, STOP), max_size=60).map(lambda points: [*sorted(points), STOP])
RUNS = {
    "chaotic": CHAOTIC,
    "chattering": {"e": 0.3},
    "offset": {"box_frequency": 0.9, "box_acceleration": -0.4, "m2": 1.7, "d2": 0.3},
    "overdamped": {"d1": 3.0, "d2": 0.0, "box_frequency": 1.3},
}


@pytest.mark.parametrize("name", RUNS)
@examples(40)
@given(grid=GRIDS, time=st.sampled_from([0.0, -3.7, 1e3]))
def test_the_communication_grid_leaves_no_trace(name, grid, time):
    once = advanced(started(time, **RUNS[name]), time + STOP)
    often = advanced(started(time, **RUNS[name]), *[time + point for point in grid])
    assert outputs(often) == outputs(once)
    assert often[at.ETA : at.END_KIND + 1] == once[at.ETA : at.END_KIND + 1]


CUBIC = {"box_frequency": 1.1, "box_acceleration": 0.1, "box_jerk": -2e-3, "box_crackle": 1e-6}


@examples(25)
@given(grid=GRIDS)
def test_nor_does_it_where_a_cubic_input_runs_on(grid):
    assert outputs(advanced(started(**CUBIC), *grid)) == outputs(advanced(started(**CUBIC), STOP))


def test_a_cubic_begins_anew_where_it_was_set():
    """To the same values too: its acceleration is the first one again."""
    ran_on, set_anew = (advanced(started(**CUBIC), 40.0) for _ in range(2))
    set_anew[at.CUBIC_SET] = 1.0
    advanced(ran_on, 40.5)
    advanced(set_anew, 40.5)
    force = set_anew[at.BOX_IMPULSE] - ran_on[at.BOX_IMPULSE]
    assert outputs(ran_on) != outputs(set_anew)
    assert abs(force) > 1e-3
    assert set_anew[at.CUBIC_SET] == 0.0


@pytest.mark.parametrize("name", RUNS)
@examples(25)
@given(n=st.integers(-200, 200))
def test_a_power_of_two_scales_to_the_last_bit(name, n):
    unit = math.ldexp(1.0, n)
    starts = {"x1_start": -0.1, "x2_start": 0.3, "v1_start": 0.2, "v2_start": -0.5}
    run = {"box_amplitude": 1.0, "box_acceleration": 0.0, **RUNS[name], **starts}
    scaled = {
        key: value * unit
        for key, value in run.items()
        if key in starts or key in ("box_amplitude", "box_acceleration")
    }
    m, big = started(**run), started(**{**run, **scaled})
    for time in (3.0, 11.0, 60.5):
        advanced(m, time)
        advanced(big, time)
        for slot in (
            at.X1,
            at.X2,
            at.V1,
            at.V2,
            at.X_REL,
            at.V_REL,
            at.X_REL_MAX,
            at.BOX_FORCE,
            at.CONTACT_FORCE,
            at.IMPACT_VELOCITY,
        ):
            assert big[slot] == unit * m[slot]
        for slot in (at.BOX_IMPULSE, at.BOX_IMPULSE_MOMENT):
            assert big[slot] == unit * m[slot]
        for slot in (
            at.XI1,
            at.XI2,
            at.XI_REL,
            at.PHASE,
            at.IMPACT_TIME,
            at.IMPACT_COUNT,
            at.IN_CONTACT,
            at.CONTACT_COUNT,
        ):
            assert big[slot] == m[slot]
        assert big[at.IMPACT_ENERGY] == unit * unit * m[at.IMPACT_ENERGY]


@pytest.mark.parametrize("watched", [0.0, 1.0])
@pytest.mark.parametrize("name", [*RUNS, "bonded"])
def test_a_step_on_which_nothing_happens_has_the_bits_of_any_other(name, watched):
    run = {"x_rel_max_on": watched, **RUNS.get(name, {"bonded": 1.0})}
    m, other = started(**run), started(**run)
    coasted = 0
    for i in range(1, 700):
        before, time = list(m), 0.03 * i
        advanced(other, time)
        if stepper.coast(m, time) == at.OK:
            coasted += 1
        else:
            assert m == before
            advanced(m, time)
        assert m[at.X1 : at.SAMPLE_COUNT] == other[at.X1 : at.SAMPLE_COUNT]
        assert m[at.TIME : at.END_KIND + 1] == other[at.TIME : at.END_KIND + 1]
    assert coasted > 200


@pytest.mark.parametrize("change", ["box_amplitude", "sample_count", "box_jerk"])
def test_a_step_on_which_more_happens_is_no_such(change):
    m = started(x1_start=-5.0, x_rel_max_on=0.0)
    assert stepper.coast(m, 1e-3) == at.UNFINISHED  # the walk has not begun
    advanced(m, 1e-3)
    assert stepper.coast(m, 2e-3) == at.OK
    set_inputs(m, **{change: 3.0})
    assert stepper.coast(m, 3e-3) == at.UNFINISHED


def test_such_a_step_out_of_the_range_of_numbers_changes_nothing():
    m = started(bonded=1.0, m1=1e160, k1=1e160, box_amplitude=1e160)
    before = list(m)
    assert stepper.coast(m, 1.0) == at.NOT_FINITE
    assert m == before


def test_bonded_masses_are_one_oscillator():
    m = started(bonded=1.0, x1_start=0.3, x2_start=0.3, v1_start=-0.2, v2_start=-0.2)
    one = started(
        m1=2.0,
        k1=2.2,
        d1=0.02,
        m2=2.0,
        k2=2.2,
        d2=0.02,
        x1_start=0.3,
        x2_start=0.3,
        v1_start=-0.2,
        v2_start=-0.2,
    )
    advanced(m, 77.0)
    advanced(one, 77.0)
    assert m[at.X1] == pytest.approx(one[at.X1], rel=1e-12)
    assert (m[at.X_REL], m[at.IMPACT_COUNT], m[at.IN_CONTACT]) == (0.0, 0.0, 1.0)
