"""Where a test shows most, against simulated motion."""

from __future__ import annotations

import numpy as np
import pytest

import orchestrate
from orchestrate.diagnosis.opening import opening_force, sweep_rate
from orchestrate.diagnosis.plan_test import SPLITS, Noise, Sweep, scale_split, smallest_splits
from orchestrate.errors import InputError

HALVES = orchestrate.Structure.from_halves(
    m1=1.5, m2=1.2, f1=42.0, f2=52.0, zeta1=0.03, zeta2=0.02, e=0.5
)
SENSOR = orchestrate.Sensor(bandwidth=400.0, noise=0.004, range=60.0)


@pytest.fixture(scope="module")
def plan(exported):
    return orchestrate.plan_test(
        HALVES,
        sensor=SENSOR,
        levels=[0.01, 0.4, 10.0],
        frequencies=np.linspace(40.0, 54.0, 15),
        progress=False,
    )


@pytest.mark.parametrize("hertz", [20.0, 46.0, 70.0])
def test_the_opening_force_is_that_of_the_bonded_motion(exported, hertz):
    turns = 2.0 * np.pi * hertz
    motion = orchestrate.simulate(
        HALVES.as_bonded(), frequency=turns, amplitude=3.0 / turns**2, transient=200, periods=2
    )
    x2, v2, a2, time = (motion[name].values for name in ("x2", "v2", "a2", "time"))
    # the equation of mass 2: what its spring, its damper and its inertia do not balance
    box = -3.0 * np.sin(turns * time)
    force = HALVES.m2 * (a2 + box) + HALVES.k2 * x2 + HALVES.d2 * v2
    assert np.abs(force).max() == pytest.approx(3.0 * opening_force(HALVES, hertz), rel=2e-3)


def test_halves_that_move_alike_are_never_opened():
    assert sweep_rate(50.0, 0.01) == pytest.approx(0.9)  # Hz/s
    assert opening_force(HALVES, 46.0) > 1.0
    alike = scale_split(HALVES, 0.0)
    assert opening_force(alike, 46.0) < 1e-9
    assert alike.k1 + alike.k2 == pytest.approx(HALVES.k1 + HALVES.k2)
    assert scale_split(HALVES, 1.0).k1 == pytest.approx(HALVES.k1)


def test_the_map_grows_with_the_level_and_peaks_at_the_resonance(plan):
    higher = plan.distance_harmonics
    assert np.allclose(higher.isel(level=2), 25.0 * higher.isel(level=1))
    assert 44.0 <= float(higher.isel(level=1).idxmax("frequency")) <= 49.0
    assert (plan.distance >= plan.distance_first).all()
    assert np.allclose(plan.distance_harmonics.isel(level=0) / 0.01 * plan.smallest_level, 5.0)


def test_the_recommended_sweep_counts_and_does_not_overload(plan):
    assert int(plan.counts) == 1
    assert float(plan.recommended_level) == 0.4
    assert 40.0 <= float(plan.recommended_first) < 46.0 < float(plan.recommended_last) <= 54.0
    assert plan.overload.values.tolist() == [0, 0, 1]
    bonded = HALVES.as_bonded()
    f = np.sqrt((bonded.k1 + bonded.k2) / (bonded.m1 + bonded.m2)) / (2.0 * np.pi)
    zeta = (bonded.d1 + bonded.d2) / (2.0 * np.sqrt((bonded.k1 + bonded.k2) * 2.7))
    span = float(plan.recommended_last - plan.recommended_first)
    assert float(plan.recommended_duration) >= span / sweep_rate(f, zeta) * 0.999


def test_a_preloaded_delamination_shows_from_the_level_that_opens_it(exported):
    force = 0.3  # N; at 46 Hz the faces need 1.9 N for each m/s2
    k1, k2 = HALVES.k1, HALVES.k2
    pressed = HALVES.replace(clearance=-force * (k1 + k2) / (k1 * k2))
    needed = force / float(opening_force(HALVES, np.linspace(44.0, 50.0, 6001)).max())
    plan = orchestrate.plan_test(
        pressed,
        sensor=SENSOR,
        levels=[0.9 * needed, 1.9 * needed, 3.0 * needed],
        frequencies=np.linspace(36.0, 60.0, 25),
        progress=False,
    )
    assert float(plan.opening_level.min()) == pytest.approx(needed, rel=1e-5)  # not of its grid
    shut, near, opened = plan.distance_harmonics.max("frequency").values
    assert plan.opening.isel(level=0).max() < 1e-9 < plan.opening.isel(level=1).max()
    # with a margin, and past the resonance of both together, 46.7 Hz
    assert shut < 0.05 * opened and near > 10.0
    assert (plan.smallest_level > plan.opening_level).all() and np.isinf(plan.smallest_level[0])
    assert float(plan.recommended_level) == 3.0 * needed
    assert float(plan.recommended_first) < 37.0 and float(plan.recommended_last) > 58.0
    assert (plan.closing_force.isel(level=0) < force).all()


def test_smaller_differences_are_told_at_higher_levels(plan):
    splits = plan.smallest_split.values
    assert splits[0] == np.inf and 1.0 > splits[1] > splits[2] > 0.0
    assert 0.0 < float(plan.smallest_opening[1]) < float(plan.opening.isel(level=1).max())


def test_splits_between_the_computed_ones_are_powers():
    assert SPLITS == (1.0, 0.2)
    levels, distances = np.array([1.0, 2.0, 4.0, 20.0]), np.array([100.0, 20.0])
    assert smallest_splits(levels, 99.0, distances) == pytest.approx([np.inf, np.inf, np.inf, 0.99])
    assert smallest_splits(levels, 2.0, distances) == pytest.approx([0.4, 0.2, 0.1, 0.02])


def test_noise_is_that_of_least_squares_in_a_window():
    """White noise fitted as :func:`orchestrate.track_orders` does, against the closed form."""
    rate, hertz, density = 2000.0, 50.0, 0.02
    generator = np.random.default_rng(4)
    time = np.arange(int(60 * rate)) / rate
    noisy = density * np.sqrt(0.5 * rate) * generator.normal(size=len(time))
    record = orchestrate.record(
        time=time, box_acceleration=np.sin(2.0 * np.pi * hertz * time), acceleration1=noisy
    )
    found = orchestrate.track_orders(record, orders=(1, 2), periods=16).sel(order=2)
    square = float((found.amplitude.sel(channel="acceleration1") ** 2).mean())
    nothing = np.zeros((1, 3, 1), dtype=complex)
    one = nothing.copy()
    one[0, 1] = np.sqrt(square)
    sweep = Sweep(one, nothing, np.zeros(1), 0.0, 1.0)
    noise = Noise(np.array([density]), 16.0, 0.0)
    assert noise.distances(sweep, np.array([hertz]))[1] == pytest.approx(1.0, rel=0.08)


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        ({"levels": [0.0]}, "levels"),
        ({"frequencies": [50.0, 40.0]}, "frequencies"),
        ({"frequencies": 50.0}, "two at least"),
        ({"sensor": orchestrate.Sensor(bandwidth=400.0)}, "noise = 0.0"),
        ({"sensor": {"box_acceleration": SENSOR}}, "box alone"),
        ({"structure": HALVES.as_bonded()}, "bonded"),
        ({"threshold": 0.0}, "threshold"),
        ({"margin": 0.5}, "margin"),
        ({"store": "plan.nc"}, "store"),
        ({"g": 0.1}, "levels and g: expected one"),
        ({"levels": None, "g": [-1.0]}, "g = "),
    ],
)
def test_mistakes_are_one_line(wrong, text):
    asked = {"sensor": SENSOR, "levels": [1.0], "frequencies": [40.0, 50.0], **wrong}
    with pytest.raises(InputError, match=text):
        orchestrate.plan_test(asked.pop("structure", HALVES), **asked)


def test_usual_sensor_levels_and_frequencies(exported):
    """Levels in g are those in m/s2; without any, nine from 0.01 to 1 g around the resonances."""
    few = {"frequencies": [42.0, 47.0, 52.0], "progress": False}
    in_g, in_si = (
        orchestrate.plan_test(HALVES, **few, **level)
        for level in ({"g": 0.1}, {"levels": 0.980665})
    )
    assert np.array_equal(in_g.distance, in_si.distance)
    usual = orchestrate.plan_test(HALVES, progress=False)
    assert np.allclose(usual.level[[0, -1]] / 9.80665, [0.01, 1.0]) and usual.sizes["level"] == 9
    assert np.allclose(usual.frequency[[0, -1]], [0.8 * 42.0, 1.2 * 52.0])
