"""How long responses are run on, by each threshold, and on the FMU."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.dynamics import settling
from orchestrate.dynamics.settling import (
    SettlingSettings,
    run_until_settled,
    transient_periods,
)
from orchestrate.errors import InputError
from orchestrate.fmu import REST
from orchestrate.model import Excitation, Structure
from orchestrate.response.questions import Point

PAPER = Structure.nondimensional()
settling_run = partial(SettlingSettings, transient=400, settle=300.0, samples=48)  # as by default


@pytest.mark.parametrize(
    ("early", "before", "last", "tolerance", "periods"),
    [
        (0.99e-6, 0.0, 0.0, 1e-6, 448),  # `converged`
        (1.01e-6, 1.01e-6, 1.01e-6, 1e-6, 20_448),  # after `longest`, and 400 are kept
        (0.5, 0.99e-3, 0.4e-3, 1e-3, 20_048),  # `apart` times as much, if it dies
        (0.5, 1.01e-3, 0.4e-3, 1e-6, 20_448),
        (0.5, 0.7e-3, 0.34e-3, 1e-3, 20_048),  # by half
        (0.5, 0.7e-3, 0.36e-3, 1e-6, 20_448),
    ],
)
def test_each_threshold_of_a_response_that_is_run_on(
    monkeypatch, early, before, last, tolerance, periods
):
    """By deviations after one period in the first stretches, the one before the last, and there."""
    done = [0]

    def simulate(points, ends, rule):
        done[0] += rule.transient + rule.samples
        deviation = early if done[0] < 1e4 else before if done[0] < 2e4 else last
        n = {"multiplicity": [deviation <= rule.tolerance], "nearly": [deviation <= rule.loose]}
        n["reached"] = [0]
        counts = {name: np.array(one, dtype=int) for name, one in n.items()}
        told = SimpleNamespace(counts=counts, deviations=np.array([deviation]), ends=ends)
        told.select = lambda chosen: told
        return told

    monkeypatch.setattr(settling, "response_loop", lambda _: SimpleNamespace(simulate=simulate))
    monkeypatch.setattr(settling, "responses_from", lambda rows, points, by, *_: [by] * len(points))
    point = Point(PAPER, Excitation.nondimensional(1.0, PAPER))
    (found,) = run_until_settled(None, point, REST, settling_run())
    assert found == (pytest.approx(tolerance), periods)


@pytest.mark.parametrize(
    ("eta", "multiplicity", "least", "most"),
    [
        (1.047, 1, 0, 5_000),
        (2.06, 1, 0, 5_000),  # a deviation turns by half as it dies: 2T repeats earlier than T
        (2.655, 0, 20_000, 21_000),  # a torus, which T nearly is
        (0.8, 0, 20_000, 21_000),  # chaos
    ],
)
def test_a_response_is_run_on_until_it_is_known(instances, eta, multiplicity, least, most):
    point = Point(PAPER, Excitation.nondimensional(eta, PAPER))
    ((response, periods),) = run_until_settled(instances[0], point, REST, settling_run())
    assert response.multiplicity == multiplicity
    assert least <= periods <= most


def test_short_periods_take_more_of_them():
    assert [transient_periods(400, 300.0, eta) for eta in (0.5, 1.5, 8.0)] == [400, 450, 2400]


@pytest.mark.parametrize(
    "wrong", [{"alike": 0.0}, {"longest": -1}, {"near": float("nan")}, {"samples": 3}]
)
def test_settings_out_of_range_are_refused(wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        settling_run(**wrong)
    assert settling_run(samples=4, longest=0).samples == 4
