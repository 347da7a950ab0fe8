"""All four exponents: against the mean divergence, a QR method, multipliers, and known maps."""

import math

import numpy as np
import pytest

import orchestrate
from orchestrate.dynamics.impacts_after_transient import follow_impacts
from orchestrate.dynamics.lyapunov_spectrum import (
    kaplan_yorke_dimension,
    lyapunov_spectrum,
)
from orchestrate.dynamics.variational import deviations, period_in_tau
from orchestrate.fmu import OSCILLATOR, REST, STATE, EventInstance, Instance, begin, find
from orchestrate.model import Excitation, Structure
from orchestrate.response.questions import Point

make = Structure.nondimensional


@pytest.fixture(scope="module")
def followed(exported):
    """Impacts of a response after its transient, and its point."""
    fmu = find(OSCILLATOR).path
    with Instance(fmu) as plain, EventInstance(fmu) as eventful:

        def follow(structure, eta, transient, periods):
            point = Point(structure, Excitation.nondimensional(eta, structure))
            begin(plain, *point, REST)
            plain.step(0.0, transient * point.excitation.period)
            start = np.array(plain.get(*STATE))
            return follow_impacts(eventful, point, start, periods), point

        yield follow


@pytest.mark.parametrize(
    ("structure", "eta"),
    [(make(), 0.8), (make(), 1.047), (make(D1=0.02, D2=0.1), 0.9), (make(mu=0.5, kappa=1.9), 1.3)],
)
def test_their_sum_is_the_mean_divergence(exported, structure, eta):
    """Of the flow -2 (D1 + D2), and at each impact 2 log e; the exponents do not know of it."""
    found = orchestrate.lyapunov(structure, eta=[eta], periods=1500, spectrum=True, progress=False)
    impacts = float(found.impacts_per_period[0]) / period_in_tau(eta)
    divergence = -2.0 * (structure.D1 + structure.D2) + 2.0 * impacts * math.log(structure.e)
    assert float(found.exponents[0].sum()) == pytest.approx(divergence, abs=1e-3)
    assert float(found.exponents[0, 0]) == float(found.exponent[0])
    assert (np.diff(found.exponents[0]) < 1e-3).all()


def test_a_qr_method_gives_the_same(followed):
    """Benettin's method, one impact after the other, in chaotic motion."""
    impacts, point = followed(make(), 0.8, 300, 600)
    end = 600 * period_in_tau(0.8)
    found = lyapunov_spectrum(impacts, end, point, 40, 8)
    frame, sums = np.eye(4), np.zeros(4)
    for matrix in deviations(impacts, end, point)[0]:
        frame, upper = np.linalg.qr(matrix @ frame)
        sums += np.log(np.abs(np.diag(upper)))
    np.testing.assert_allclose(found.exponents, sums / end, atol=4e-3)
    assert 3.0 < kaplan_yorke_dimension(found.exponents) < 3.2


def test_permanent_contact_forgets_the_gap(exported):
    structure = make(e=0.3, D=0.05)
    found = orchestrate.lyapunov(structure, eta=[0.6], periods=400, spectrum=True, progress=False)
    assert np.isneginf(found.exponents[0, 2:]).all() and np.isfinite(found.exponents[0, :2]).all()
    assert np.isnan(found.exponent_errors[0, 2:]).all()


@pytest.mark.parametrize(
    ("exponents", "dimension"),
    [
        ((0.41922, -1.62319), 1.2583),  # Henon's map: Sprott, Chaos and Time-Series Analysis, 2003
        ((0.9056, 0.0, -14.5723), 2.0621),  # Lorenz's flow, there too
        ((0.1, -math.inf), 1.0),
        ((-0.1, -0.2), 0.0),
        ((0.2, 0.1), 2.0),
    ],
)
def test_dimension(exponents, dimension):
    assert kaplan_yorke_dimension(np.array(exponents)) == pytest.approx(dimension, abs=1e-4)
