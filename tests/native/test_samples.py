"""States kept inside a step: the same bits as stepping through the same times."""

import pytest

from ..fmu.driver import FMUS, FORMS
from ..fmu.programs.driver import STATE, harmonic, open_fmu

SERIES = ("x1", "x2", "v1", "v2")
ROOM = 200
forms = pytest.mark.parametrize("form", FORMS)


@forms
@pytest.mark.parametrize("count", [1, 16, ROOM])
def test_samples_are_states_of_small_steps(fmus, form, count):
    """Through chaos, impacts between the samples; dyadic times, or times that round."""
    f = open_fmu(FMUS[form]).start(sample_count=count, **harmonic(1.13))
    fine = open_fmu(FMUS[form]).start(**harmonic(1.13))
    for start, end in ((0.0, 64.0), (64.0, 68.0), (68.0, 100.0)):
        f.step(end)
        samples = [f.series(f"{name}_sample") for name in SERIES]
        for i in range(count):
            fine.step(start + (end - start) * ((i + 1) / count))
            assert [series[i] for series in samples] == fine.get(*SERIES)
        assert f.get(*STATE) == fine.get(*STATE)
        assert not any(any(series[count:]) for series in samples)
    assert f.one("impact_count") > 10


@forms
def test_a_saved_state_has_the_samples_of_its_step_and_no_others(fmus, form):
    """By its handle: also if only one of both has any, or the number of samples is 0 by now."""
    f, states = open_fmu(FMUS[form]).start(**harmonic(1.13)), []
    for k, count in enumerate((0, 5, 0, ROOM)):
        f.set(sample_count=count).step(10.0 * (k + 1))
        states.append((f.call("getFMUState"), [f.series(f"{name}_sample") for name in SERIES]))
    for k in (0, 1, 2, 3, 0, 3, 2, 0):
        state, samples = states[k]
        f.call("setFMUState", state)
        assert [f.series(f"{name}_sample") for name in SERIES] == samples, k
    assert not any(map(any, states[0][1])) and all(map(any, states[1][1]))
    other = open_fmu(FMUS[form]).start(**harmonic(1.13))
    for k in (1, 0):
        other.call("setFMUState", states[k][0])
        assert [other.series(f"{name}_sample") for name in SERIES] == states[k][1]
