"""The voltage over time."""

import numpy as np
import pytest

from orchestrate import InputError, couple
from orchestrate.weak_drive.schedule import Constant, Course, Ramp

from .coupled import QUICK


def test_ramp():
    ramp = Ramp(1.0, 1.2, 1e-3, 50.0)
    times = (0.0, 50.0, 150.0, 250.0, 350.0, 450.0, 999.0)
    expected = [1.0, 1.0, 1.1, 1.2, 1.1, 1.0, 1.0]
    assert [ramp.voltage(time) for time in times] == pytest.approx(expected)
    assert ramp.duration == pytest.approx(450.0)
    assert ramp.trend(np.array([0.0, 50.0, 51.0, 249.0, 251.0])).tolist() == [0, 0, 1, 1, -1]


def test_steps():
    steps = Ramp(1.2, 1.0, 1e-3, 0.0, increment=0.05)
    times = (0.0, 49.0, 51.0, 199.0, 201.0, 249.0, 251.0, 400.0)
    expected = [1.2, 1.2, 1.15, 1.05, 1.0, 1.0, 1.05, 1.2]
    assert [steps.voltage(time) for time in times] == pytest.approx(expected)
    assert steps.duration == pytest.approx(400.0)


def test_constant():
    constant = Constant(6.0, 20.0)
    assert (constant.voltage(7.0), constant.duration) == (6.0, 20.0)
    assert not constant.trend(np.arange(5.0)).any()


def test_spin_up():
    ramp = Ramp(1.4, 1.6, 1e-3, 50.0, spin_up=100.0, low=1.2)
    times = (0.0, 50.0, 100.0, 150.0, 250.0, 350.0, 450.0, 550.0)
    expected = [1.2, 1.3, 1.4, 1.4, 1.5, 1.6, 1.5, 1.4]
    assert [ramp.voltage(time) for time in times] == pytest.approx(expected)
    assert ramp.duration == pytest.approx(550.0)
    assert ramp.trend(np.array([10.0, 120.0, 151.0, 351.0])).tolist() == [0, 0, 1, -1]


def test_a_course_with_holds_and_steps():
    course = Course((0.0, 100.0, 150.0, 150.0, 250.0), (1.0, 1.5, 1.5, 1.7, 1.2))
    times = (0.0, 50.0, 100.0, 149.0, 150.0, 200.0, 250.0, 999.0)
    expected = [1.0, 1.25, 1.5, 1.5, 1.7, 1.45, 1.2, 1.2]
    assert [course.voltage(time) for time in times] == pytest.approx(expected)
    assert course.duration == 250.0
    assert course.trend(np.array([10.0, 120.0, 200.0])).tolist() == [1, 0, -1]


@pytest.mark.slow
def test_a_course_from_a_file(tmp_path):
    """The same run as the ramp that it describes."""
    path = tmp_path / "course.csv"
    path.write_text("time,voltage\n# up\n0,1.3\n20,1.3\n120,1.35\n")
    course = Course.from_csv(path)
    assert course == Course((0.0, 20.0, 120.0), (1.3, 1.3, 1.35))
    found = couple(*QUICK, voltage=course, progress=False)
    ramp = couple(*QUICK, voltage=(1.3, 1.35), rate=5e-4, settle=20.0, back=False, progress=False)
    assert found.speed.values == pytest.approx(ramp.speed.values, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("0,1\n", ["1 times", "two or more"]),
        ("", ["times: 0 values"]),
        ("0,1\n1;2\n", ["line 2", "1;2"]),
        ("0;1\n1;2\n", ["line 1", "0;1", "a comma"]),
        ("1,1\n2,2\n", ["rising ones from 0"]),
        ("0,1\n2,2\n1,3\n", ["rising ones from 0"]),
        ("0,1\n2,nan\n", ["voltages = nan"]),
    ],
)
def test_mistakes_in_a_course(tmp_path, text, parts):
    path = tmp_path / "course.csv"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        Course.from_csv(path)
    assert all(part in str(caught.value) for part in parts), str(caught.value)
