"""Amplitudes and peak accelerations against dense points and both sides of impacts."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrate.fmu import (
    OSCILLATOR,
    EventInstance,
    Impacts,
    Instance,
    find_or_export,
    sample_evenly,
    start_motion,
)
from orchestrate.model import Excitation, Structure
from orchestrate.response.equations import absolute_accelerations_unforced
from orchestrate.response.questions import Point
from orchestrate.response.response_loop import LoopSettings, response_loop

PAPER = Structure.nondimensional()
OWN = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=2.9, e=0.6)
STRONG = Structure.nondimensional(D1=0.3, D2=1.2, mu=0.4, kappa=2.0, e=0.5)
CASES = [
    *((PAPER, eta) for eta in (0.12, 0.4, 0.6, 0.8, 1.047, 1.315, 1.6, 2.5, 4.0, 6.2, 8.0)),
    *((structure, eta) for structure in (OWN, STRONG) for eta in (0.3, 0.9, 1.7, 3.1)),
    (PAPER.as_bonded(), 1.3),
    (OWN.replace(e=0.95, e_slope=0.8), 0.9),
    (PAPER.replace(clearance=-0.8), 1.05),
    (PAPER.replace(clearance=0.6), 0.9),
    (PAPER.replace(d1=0.0, d2=0.0), 1.0),  # driven on a natural frequency without damping
]
PERIODS = 4  # of a dense orbit
DENSE = 20_000  # states a period


def states_before(impacts: Impacts, mu: float) -> np.ndarray:
    """States just before impacts, by (15) read backwards."""
    state, part = impacts.state.copy(), impacts.closing / (1.0 + mu)
    common = (state[:, 2] + mu * state[:, 3]) / (1.0 + mu)
    state[:, 2], state[:, 3] = common + mu * part, common - part
    return state


def largest(point: Point, start: np.ndarray, periods: int) -> np.ndarray:
    """Of dense states, and the states on both sides of impacts."""
    structure, excitation = point
    end = periods * excitation.period
    fmu = find_or_export(OSCILLATOR).path
    with Instance(fmu) as plain, EventInstance(fmu) as eventful:
        start_motion(plain, structure, excitation, start)
        states = sample_evenly(plain, 0.0, end, periods * DENSE)
        start_motion(eventful, structure, excitation, start)
        impacts = eventful.record_impacts(0.0, end)
    states = np.concatenate([states, impacts.state, states_before(impacts, structure.mu)])
    signals = np.hstack([states[:, :2], absolute_accelerations_unforced(states, structure)])
    return np.abs(signals).max(axis=0)


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize(("structure", "eta"), CASES)
def test_against_dense_communication_points(structure, eta):
    point = Point(structure, Excitation.nondimensional(eta, structure))
    asked = {"transient": 60, "samples": 48, "tolerance": 1e-2, "peak_periods": PERIODS}
    settings = LoopSettings(**asked, decides=True)
    with Instance(find_or_export(OSCILLATOR).path) as instance:
        results = response_loop(instance).simulate([point], [(0.0, 0.0, 0.0, 0.0)], settings)
    multiplicity = int(results.counts["multiplicity"][0])
    periods = min(multiplicity, PERIODS) or (PERIODS + 1) // 2
    expected = largest(point, results.states[0, -1], periods)
    # what a sample may miss of a summit
    step = 2.0 * np.pi * max(1.0, structure.omega_2 / eta, 1.0 / eta) / DENSE
    ratios = results.peaks[0] / expected
    assert (ratios >= 1.0 - 1e-12).all()
    assert (ratios <= 1.0 + step**2 / 4.0 + 1e-12).all()
