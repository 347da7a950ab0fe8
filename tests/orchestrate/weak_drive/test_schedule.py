"""The voltage over time."""

import numpy as np
import pytest

from orchestrate.weak_drive.schedule import Constant, Ramp


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
