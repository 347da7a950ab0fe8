"""The voltage over time."""

import numpy as np
import pytest

from orchestrate import InputError
from orchestrate.weak_drive.couple import schedule_from_arguments
from orchestrate.weak_drive.schedule import Constant, Course, Ramp

from .coupled import BEAM

SCHEDULES = {  # voltages at times, duration, times and directions
    "ramp": (
        Ramp(1.0, 1.2, 1e-3, 50.0),
        {0: 1.0, 50: 1.0, 150: 1.1, 250: 1.2, 350: 1.1, 450: 1.0, 999: 1.0},
        *(450.0, {0: 0, 50: 0, 51: 1, 249: 1, 251: -1}),
    ),
    "steps": (
        Ramp(1.2, 1.0, 1e-3, 0.0, increment=0.05),
        {0: 1.2, 49: 1.2, 51: 1.15, 199: 1.05, 201: 1.0, 249: 1.0, 251: 1.05, 400: 1.2},
        *(400.0, {199: -1, 201: 1}),
    ),
    "spin up": (
        Ramp(1.4, 1.6, 1e-3, 50.0, spin_up=100.0, low=1.2),
        {0: 1.2, 50: 1.3, 100: 1.4, 150: 1.4, 250: 1.5, 350: 1.6, 450: 1.5, 550: 1.4},
        *(550.0, {10: 0, 120: 0, 151: 1, 351: -1}),
    ),
    "one way": (Ramp(1.0, 1.2, 1e-3, 50.0, back=False), {150: 1.1, 250: 1.2}, 250.0, {51: 1}),
    "constant": (Constant(6.0, 20.0), {7: 6.0}, 20.0, {0: 0, 5: 0}),
    "course": (
        Course((0.0, 100.0, 150.0, 150.0, 250.0), (1.0, 1.5, 1.5, 1.7, 1.2)),
        {0: 1.0, 50: 1.25, 100: 1.5, 149: 1.5, 150: 1.7, 200: 1.45, 250: 1.2, 999: 1.2},
        *(250.0, {10: 1, 120: 0, 200: -1}),
    ),
}


@pytest.mark.parametrize("name", SCHEDULES)
def test_voltages_and_their_direction(name):
    schedule, voltages, duration, trends = SCHEDULES[name]
    found = [schedule.voltage(float(time)) for time in voltages]
    assert found == pytest.approx(list(voltages.values()))
    assert schedule.duration == pytest.approx(duration)
    times = np.array(list(trends), dtype=float)
    assert schedule.trend(times).tolist() == list(trends.values())


def test_what_is_usual_of_a_ramp():
    """A run up that would begin beyond the resonance, near 1.4, spins up from below it."""
    omega, volts = BEAM.structure.omega, BEAM.drive.volts(BEAM.structure)
    for ends, spins in (((1.2, 1.6), False), ((1.5, 1.6), True), ((1.6, 1.5), False)):
        ramp = schedule_from_arguments(*BEAM, tuple(np.multiply(ends, volts)))
        assert ramp.rate == pytest.approx(1e-4 * volts * omega) and ramp.back
        assert ramp.settle == pytest.approx(300.0 / omega)
        assert ramp.spin_up == pytest.approx(600.0 / omega if spins else 0.0)
        assert not spins or 1.1 * volts < ramp.low < 1.4 * volts


@pytest.mark.parametrize("seed", range(3))
def test_means_and_moments_of_a_course_are_exact(seed):
    """With jumps, kinks within steps, and held after its end; a constant's are its bits."""
    rng = np.random.default_rng(seed)
    times = np.sort(np.append(0.0, rng.uniform(0.0, 1.0, 7)))
    times[4] = times[3]  # a jump
    course = Course(tuple(times), tuple(rng.normal(size=8)))
    edges = np.sort(np.append(0.0, rng.uniform(0.0, 1.3, 6)))
    first, last, means, moments = course.ends_means_and_moments(edges)
    for i, (t0, t1) in enumerate(zip(edges, edges[1:], strict=False)):
        fine = np.linspace(t0, t1, 50_001)
        middles = 0.5 * (fine[1:] + fine[:-1])
        values = np.array([course.voltage(time) for time in middles])
        assert means[i] == pytest.approx(values.mean(), abs=1e-4)
        moment = ((middles - 0.5 * (t0 + t1)) * values).mean() * (t1 - t0)
        assert moments[i] == pytest.approx(moment, abs=1e-5)
        assert first[i] == pytest.approx(course.voltage(t0), abs=1e-12)
        assert last[i] == pytest.approx(course.voltage(t1 - 1e-12), abs=1e-9)
    constant = Course((0.0, 1.0), (0.1, 0.1)).ends_means_and_moments(edges)
    assert all((part == 0.1).all() for part in constant[:3]) and not constant[3].any()


FILES = {
    **{"0,1\n": "1 times", "": "times: 0 values", "0,1\n1;2\n": "line 2", "0;1\n1;2\n": "line 1"},
    **{"1,1\n2,2\n": "from 0", "0,1\n2,2\n1,3\n": "from 0", "0,1\n2,nan\n": "voltages = nan"},
}


def test_a_course_from_a_file(tmp_path):
    path = tmp_path / "course.csv"
    path.write_text("time,voltage\n# up\n0,1.3\n20,1.3\n120,1.35\n")
    assert Course.from_csv(path) == Course((0.0, 20.0, 120.0), (1.3, 1.3, 1.35))
    for text, words in FILES.items():
        path.write_text(text)
        with pytest.raises(InputError, match=words):
            Course.from_csv(path)
