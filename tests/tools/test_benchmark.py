"""The benchmark measures what it says."""

import sys
from functools import partial
from pathlib import Path

import pytest

from orchestrate.fmu import OSCILLATOR, find
from orchestrate.model import Structure
from tools import benchmark, sampled_solver, shake_benchmark


def test_periods_and_impacts(exported):
    seconds, impacts = benchmark.time_periods(find(OSCILLATOR).path, 0.4, 20)
    assert 0.0 < seconds < 5.0 and impacts == 20 * 30


def test_a_quiet_step(exported):
    assert 0.0 < benchmark.time_quiet_step(find(OSCILLATOR).path, 100) < 1e-2


def test_one_measurement_in_a_process_of_its_own(exported, capsys, monkeypatch):
    fmu = find(OSCILLATOR, "fmi2-python").path
    monkeypatch.setattr(sys, "argv", ["benchmark", "--once", str(fmu), "1.0", "1"])
    benchmark.main()
    assert float(capsys.readouterr().out) > 0.0


def test_a_version_is_as_fast_as_itself(exported, capsys, monkeypatch):
    root = str(Path(benchmark.__file__).parents[1])
    options = ["--before", root, "--scale", "0.05", "--rounds", "1", "--only", "simulate"]
    monkeypatch.setattr(sys, "argv", ["benchmark", *options])
    benchmark.main()
    row = capsys.readouterr().out.splitlines()[1]
    assert row.startswith("simulate") and 0.1 < float(row.split()[-2]) < 10.0


PAPER = Structure.nondimensional(e=0.7, D=0.005, kappa=1.2)


def test_the_sampled_solver_moves_as_the_fmu_does(exported):
    flight, contact = sampled_solver.equations_of_motion(
        PAPER, partial(benchmark.harmonic_acceleration, 0.4)
    )
    assert flight(0.0, [1.0, 0.0, 1.0, 0.0]) == pytest.approx([0.0, -1.0, 0.0, -1.2])
    assert contact(0.0, [1.0, 0.0, 1.0, 0.0]) == pytest.approx([0.0, -1.1, 0.0, -1.1])


def test_the_sampled_solver_finds_the_impacts_of_a_shaken_beam(exported):
    """Up to where a chaotic motion forgets the start, by their number."""
    seconds, impacts = shake_benchmark.time_solver(0.3)
    ours, expected = shake_benchmark.time_shake(0.3)
    assert seconds > 0.0 and ours > 0.0
    assert impacts == pytest.approx(expected, rel=0.3) and expected > 10


def test_the_shaking_benchmark_prints_ratios(exported, capsys, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["shake_benchmark", "--duration", "0.5", "--solver", "0.1"])
    shake_benchmark.main()
    assert "times as long as shake" in capsys.readouterr().out
