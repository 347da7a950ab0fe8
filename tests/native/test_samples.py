"""States kept inside a step: the same bits as stepping through the same times."""

import pytest

from .conftest import FORMS
from .slave import COMMON, STATE, harmonic, slave

SERIES = ("x1", "x2", "v1", "v2")
ROOM = 200


@pytest.fixture(params=FORMS)
def fmu_path(request, fmus):
    """Path of the FMU of each form."""
    return fmus[request.param]


@pytest.mark.parametrize("count", [1, 2, 16, ROOM])
def test_samples_are_states_of_small_steps(fmu_path, count):
    """Through chaos, impacts between the samples; dyadic times, or times that round."""
    with slave(fmu_path) as fmu, slave(fmu_path) as fine:
        fmu.start(sample_count=count, **harmonic(1.13))
        fine.start(**harmonic(1.13))
        for start, end in ((0.0, 64.0), (64.0, 68.0), (68.0, 100.0)):
            fmu.step(end)
            samples = [fmu.series(f"{name}_sample") for name in SERIES]
            for i in range(count):
                fine.step(start + (end - start) * ((i + 1) / count))
                assert [series[i] for series in samples] == fine.get(*SERIES)
            assert fine.time == end
            assert [series[count - 1] for series in samples] == fmu.get(*SERIES)
            assert fmu.get(*STATE) == fine.get(*STATE)
            assert not any(any(series[count:]) for series in samples)
        assert fmu.one("impact_count") > 10


def test_samples_do_not_change_the_run(fmu_path):
    found = []
    for count in (0, 7, ROOM):
        with slave(fmu_path) as fmu:
            fmu.start(sample_count=count, **harmonic(1.13))
            for k in range(50):
                fmu.step(10.0 * (k + 1))
            found.append(fmu.get(*(name for name in COMMON if name != "x_rel_max")))
            assert any(fmu.series("x1_sample")) == (count > 0)
    assert found[0] == found[1] == found[2]


def test_sample_count_may_change_between_steps(fmu_path):
    with slave(fmu_path) as fmu:
        fmu.start(**harmonic(1.13))
        for count, time in ((3, 16.0), (0, 32.0), (5, 48.0)):
            fmu.set(sample_count=count)
            fmu.step(time)
            if count:
                assert fmu.series("x2_sample")[count - 1] == fmu.one("x2")


@pytest.mark.parametrize("count", [0, 7, ROOM])
def test_largest_gap_is_that_of_small_steps(fmu_path, count):
    """Not below what small steps see, and not above by more than a summit differs from the largest
    of two rounded numbers.
    """
    with slave(fmu_path) as fmu, slave(fmu_path) as fine:
        fmu.start(sample_count=count, **harmonic(1.13))
        fine.start(**harmonic(1.13))
        for k in range(60):
            fmu.step(10.0 * (k + 1))
            largest = seen = 0.0
            for i in range(80):
                fine.step(10.0 * k + 0.125 * (i + 1))
                largest, seen = max(largest, fine.one("x_rel_max")), max(seen, fine.one("x_rel"))
            assert fmu.one("x_rel_max") >= seen
            assert fmu.one("x_rel_max") == pytest.approx(largest, rel=1e-12)


@pytest.mark.parametrize("count", [-1, ROOM + 1])
def test_sample_count_out_of_range(fmus, native_fmu, count):
    with slave(native_fmu) as fmu:
        fmu.start()
        setter = "setInt32" if fmu.third else "setInteger"
        message = fmu.refused(setter, [fmu.variables["sample_count"].valueReference], [count])
        assert f"sample_count = {count}:" in message
        assert f"{ROOM}" in message


def test_samples_of_a_step_that_returns_early_end_where_it_ends(fmus):
    with slave(fmus["fmi3"], event_mode=True, early_return=True) as fmu:
        fmu.start(sample_count=8, **harmonic(1.13))
        while not fmu.step(fmu.time + 8.0)[1]:
            pass
        assert fmu.series("x1_sample")[7] == fmu.one("x1")
