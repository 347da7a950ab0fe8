"""Cubic inputs that the importer does not touch run on: over steps, early returns and event mode.

What is compared is bits: however the way is divided, the motion is that of one step.
"""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ..kernels.oscillator.kernel import examples
from .slave import STATE, harmonic, slave

CUBIC = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
TICKS = 2.0**-12  # s: sums of dyadic steps are exact, all grids reach the same time
COEFFICIENTS = st.just(0.0) | st.floats(-0.1, 0.1)


@st.composite
def motions(draw):
    """Start values, the end, and five splits of the way there."""
    values = harmonic(draw(st.floats(0.3, 3.0)))
    values |= {name: draw(COEFFICIENTS) for name in CUBIC}
    values |= {"e": draw(st.sampled_from((0.0, 0.3, 0.7, 1.0))), "bonded": draw(st.just(False))}
    values["x2_start"] = draw(st.sampled_from((0.0, 0.4)))
    ticks = draw(st.integers(2**13, 2**16))
    splits = [
        sorted({*draw(st.lists(st.integers(1, ticks - 1), max_size=12)), ticks}) for _ in range(5)
    ]
    return values, [[tick * TICKS for tick in split] for split in splits]


def run(path, values, grid, **options):
    """Outputs at the grid's end; in event mode with all that an importer does there."""
    with slave(path, **options) as fmu:
        fmu.start(**values)
        for point in grid:
            while fmu.time < point:
                told = fmu.step(point)
                if options and told[0]:
                    fmu.fmu.enterEventMode()
                    fmu.update()
                    fmu.fmu.enterStepMode()
        return fmu.get(*STATE, *CUBIC)


@examples(15)
@given(motion=motions())
def test_five_splits_event_mode_and_early_return_are_one_step(fmus, motion):
    values, splits = motion
    end = [splits[0][-1]]
    expected = run(fmus["fmi3"], values, end)
    for grid in splits:
        for form in ("fmi3", "fmi2"):
            assert run(fmus[form], values, grid) == expected
        for early in (False, True):
            found = run(fmus["fmi3"], values, grid, event_mode=True, early_return=early)
            assert found == expected
    assert run(fmus["fmi3"], values, end, event_mode=True, early_return=True) == expected


def test_early_return_with_a_jerk_is_the_plain_motion(fmus):
    """Where an importer noticed that the cubic began again at each early return."""
    values = {**harmonic(2.9), "box_jerk": 0.05}
    grid = [2.5 * k for k in range(1, 9)]
    plain = run(fmus["fmi3"], values, [20.0])
    assert plain[STATE.index("impact_count")] > 2
    assert run(fmus["fmi3"], values, grid) == plain
    assert run(fmus["fmi3"], values, grid, event_mode=True, early_return=True) == plain


def at_end(fmu, *times):
    """Outputs after steps without a touch of the inputs."""
    for time in times:
        fmu.step(time)
    return fmu.get(*STATE)


@pytest.mark.parametrize("form", ["fmi2", "fmi3"])
def test_inputs_read_as_they_were_set_while_the_cubic_runs(fmus, form):
    values = dict(zip(CUBIC, (0.1, -0.03, 0.02, 0.01), strict=True))
    with slave(fmus[form]) as fmu:
        fmu.start(**values)
        at_end(fmu, 1.5, 4.0)
        assert fmu.get(*CUBIC) == list(values.values())


@pytest.mark.parametrize("form", ["fmi2", "fmi3"])
@pytest.mark.parametrize("name", CUBIC)
def test_a_cubic_begins_where_one_of_its_inputs_is_set(fmus, form, name):
    """To the value that it has already, too: it is the one at the time of setting."""
    values = dict(zip(CUBIC, (0.1, -0.03, 0.02, 0.01), strict=True))
    with slave(fmus[form]) as fmu, slave(fmus[form]) as all_set, slave(fmus[form]) as untouched:
        for one in (fmu, all_set, untouched):
            one.start(**values)
            one.step(3.0)
        fmu.set(**{name: values[name]})
        all_set.set(**values)
        begun, also, other = (at_end(one, 5.0) for one in (fmu, all_set, untouched))
    assert begun == also
    assert begun != other


@pytest.mark.parametrize("form", ["fmi2", "fmi3"])
def test_a_cubic_runs_on_where_other_inputs_are_set(fmus, form):
    """Bonded and without a harmonic: another amplitude changes nothing, so the cubic is to be the
    one of a single step.
    """
    values = dict(zip(CUBIC, (0.1, -0.03, 0.02, 0.01), strict=True))
    values |= {"bonded": True, "box_amplitude": 0.0, "box_frequency": 0.0}
    with slave(fmus[form]) as fmu, slave(fmus[form]) as whole:
        for one in (fmu, whole):
            one.start(**values)
        fmu.step(2.0)
        fmu.set(box_amplitude=0.5)
        fmu.step(3.0)
        fmu.set(box_amplitude=0.25, x_rel_max_on=False)
        found, expected = at_end(fmu, 5.0), at_end(whole, 5.0)
    for name in ("x1", "v1", "box_force"):
        place = STATE.index(name)
        assert found[place] == pytest.approx(expected[place], rel=1e-13)


def saved(fmu, serialised):
    """A state, and a function that sets it in an instance."""
    state = fmu.fmu.getFMUState()
    if not serialised:
        return lambda one: one.fmu.setFMUState(state)
    data = fmu.fmu.serializeFMUState(state)
    fmu.fmu.freeFMUState(state)

    def restore(one):
        read = one.fmu.deserializeFMUState(data)
        one.fmu.setFMUState(read)
        one.fmu.freeFMUState(read)

    return restore


@pytest.mark.parametrize("form", ["fmi2", "fmi3"])
@pytest.mark.parametrize("serialised", [False, True])
@pytest.mark.parametrize("touched", [False, True])
def test_the_time_of_setting_belongs_to_the_state(fmus, form, serialised, touched):
    """A state saved while the cubic runs; or after an input was set, before the step."""
    values = {**harmonic(1.13), **dict(zip(CUBIC, (0.1, -0.03, 0.02, 0.001), strict=True))}
    with slave(fmus[form]) as fmu, slave(fmus[form]) as other:
        fmu.start(**values)
        other.start()
        fmu.step(3.0)
        if touched:
            fmu.set(box_jerk=values["box_jerk"])
        restore = saved(fmu, serialised)
        expected = at_end(fmu, 4.0, 9.0)
        for one in (fmu, other) if serialised else (fmu,):
            restore(one)
            one.time = 3.0
            assert at_end(one, 4.5, 9.0) == expected
        undisturbed = at_end(other.__class__(fmus[form]).start(**values), 9.0)
        assert (expected == undisturbed) == (not touched)


def test_a_reset_forgets_when_inputs_were_set(fmus):
    values = {**harmonic(1.13), "box_jerk": -0.03}
    with slave(fmus["fmi3"]) as fmu:
        found = []
        for _ in range(2):
            fmu.start(**values)
            fmu.step(2.0)
            fmu.set(box_snap=0.01)
            found.append(at_end(fmu, 3.0, 7.0))
            fmu.set(box_crackle=0.1)  # pending, and forgotten
            fmu.fmu.reset()
    assert found[0] == found[1]


def test_input_derivatives_of_fmi2_begin_a_cubic(fmus):
    with slave(fmus["fmi2"]) as fmu, slave(fmus["fmi2"]) as twin, slave(fmus["fmi2"]) as untouched:
        reference = fmu.variables["box_acceleration"].valueReference
        for one in (fmu, twin, untouched):
            one.start(**harmonic(1.13), box_jerk=0.03)
            one.step(3.0)
        fmu.fmu.setRealInputDerivatives([reference], [1], [0.03])
        twin.set(box_jerk=0.03)
        found, expected, other = (at_end(one, 4.0, 9.0) for one in (fmu, twin, untouched))
    assert found == expected != other


def test_impulses_of_the_steps_on_which_a_cubic_runs_add_up(fmus):
    """Their sum is that of one step, and the moments are about each step's own beginning."""
    values = {**harmonic(1.13), **dict(zip(CUBIC, (0.1, -0.03, 0.02, -0.005), strict=True))}
    with slave(fmus["fmi3"]) as whole, slave(fmus["fmi3"]) as parts:
        whole.start(**values)
        parts.start(**values)
        whole.step(8.0)
        impulse = moment = 0.0
        for begin, end in itertools.pairwise((0.0, 0.001, 0.0025, 1.0, 2.75, 5.5, 5.504, 8.0)):
            parts.step(end)
            part, part_moment = parts.get("box_impulse", "box_impulse_moment")
            impulse += part
            moment += part_moment + begin * part
        expected = whole.get("box_impulse", "box_impulse_moment")
    assert [impulse, moment] == pytest.approx(expected, rel=1e-11)
