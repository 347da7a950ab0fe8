"""The benchmark measures what it says."""

from __future__ import annotations

import sys

import pytest

from orchestrate.access import OSCILLATOR, find
from tools import benchmark, sampled_solver


def test_periods_and_impacts(exported):
    seconds, impacts = benchmark.periods(find(OSCILLATOR).path, 0.4, 20)
    assert 0.0 < seconds < 5.0 and impacts == 20 * 30


def test_a_quiet_step(exported):
    assert 0.0 < benchmark.quiet_step(find(OSCILLATOR).path, 100) < 1e-2


def test_one_measurement_in_a_process_of_its_own(exported, capsys, monkeypatch):
    fmu = find(OSCILLATOR, "fmi2-python").path
    monkeypatch.setattr(sys, "argv", ["benchmark", "--once", str(fmu), "1.0", "1"])
    benchmark.main()
    assert float(capsys.readouterr().out) > 0.0


def test_the_sampled_solver_moves_as_the_fmu_does(exported):
    flight, contact = sampled_solver.motions(0.4, 0.005, 1.2)
    assert flight(0.0, [1.0, 0.0, 1.0, 0.0]) == pytest.approx([0.0, -1.0, 0.0, -1.2])
    assert contact(0.0, [1.0, 0.0, 1.0, 0.0]) == pytest.approx([0.0, -1.1, 0.0, -1.1])
    assert sampled_solver.seconds(1.2, 1) > 0.0
