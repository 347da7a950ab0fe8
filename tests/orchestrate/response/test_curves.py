"""Phase curves have both sides of each impact, and the three states of Figure 5."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrate.access import OSCILLATOR, REST, EventInstance, begin, find
from orchestrate.response.curves import CONTACT, FLIGHT, SEQUENCE, simulate_curve
from orchestrate.response.questions import Point
from orchestrate.structures import Excitation, Structure

PAPER = Structure.nondimensional()
OWN = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=2.9, e=0.6)

pytestmark = pytest.mark.usefixtures("exported")


def curve(structure, eta, transient, periods, points):
    point = Point(structure, Excitation.nondimensional(eta, structure))
    return simulate_curve(find(OSCILLATOR).path, point, REST, transient, periods, points)


def test_a_curve_has_both_sides_of_each_impact():
    found = curve(PAPER, eta=0.4, transient=200, periods=1, points=500)
    tau, state = found.tau, found.state
    gap, rate = state[:, 1] - state[:, 0], state[:, 3] - state[:, 2]
    assert (np.diff(tau) >= 0.0).all()
    assert tau[0] == 0.0
    assert (gap > -1e-12).all()
    assert set(found.kind.tolist()) == {FLIGHT, SEQUENCE, CONTACT}
    jumps = (np.diff(tau) == 0.0) & (np.diff(state[:, 2]) != 0.0)
    assert jumps.sum() == 30
    assert (np.abs(np.diff(state, axis=0)[jumps][:, :2]) < 1e-9).all(), "displacements jump"
    before, after = rate[:-1][jumps], rate[1:][jumps]
    assert (before < 0.0).all()
    assert after[after != 0.0] == pytest.approx(-0.7 * before[after != 0.0], rel=1e-6)
    momentum = np.diff(state[:, 2] + state[:, 3])[jumps]
    assert np.abs(momentum).max() < 1e-12


def test_other_units_are_the_same_curve():
    unit = Structure.nondimensional(mu=OWN.mu, kappa=OWN.kappa, D1=OWN.D1, D2=OWN.D2, e=OWN.e)
    one, two = (curve(s, eta=0.9, transient=50, periods=2, points=100) for s in (OWN, unit))
    np.testing.assert_allclose(one.tau, two.tau, atol=1e-9)
    np.testing.assert_allclose(one.state, two.state, atol=1e-8)
    np.testing.assert_array_equal(one.kind, two.kind)


def test_impacts_are_those_the_fmu_reports():
    excitation = Excitation.nondimensional(0.4, PAPER)
    found = curve(PAPER, eta=0.4, transient=0, periods=3, points=10)
    with EventInstance(find(OSCILLATOR).path) as instance:
        begin(instance, PAPER, excitation)
        impacts = instance.impacts(0.0, 3 * excitation.period)
    twice = np.repeat(impacts.time, 2)
    assert np.isin(twice, found.tau).all()
    assert len(found.tau) == 31 + len(twice)
