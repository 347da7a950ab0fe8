"""Lyapunov exponents against neighbours, multipliers, linear cases, a QR method and known maps."""

import math

import numpy as np
import pytest

import orchestrate
from orchestrate.dynamics.impacts_after_transient import simulate_nondimensional_impacts
from orchestrate.dynamics.lyapunov import (
    CHAOTIC,
    NEUTRAL,
    PERIODIC,
    classify_exponents,
    exponent_from_impacts,
    lyapunov,
    min_impacts,
)
from orchestrate.dynamics.lyapunov_spectrum import kaplan_yorke_dimension, lyapunov_spectrum
from orchestrate.dynamics.variational import deviation_matrices_and_contacts, period_in_tau
from orchestrate.errors import InputError
from orchestrate.fmu import REST
from orchestrate.model import Excitation, Structure
from orchestrate.response.questions import Point
from orchestrate.response.sweep import sweep

from .stroboscopic import after

make = Structure.nondimensional
PAPER = make()
LOSSY = make(D1=0.05, D2=0.02, kappa=1.5)
PUSHED = {"force1": 0.3, "force2": -0.4, "box_acceleration": 0.1}


@pytest.mark.parametrize(
    ("eta", "pushes", "expected"),
    [
        *((0.8, {}, CHAOTIC), (1.13, {}, CHAOTIC), (1.047, {}, PERIODIC), (2.655, {}, NEUTRAL)),
        *((0.8, PUSHED, CHAOTIC), (1.047, PUSHED, PERIODIC)),
    ],
)
def test_it_agrees_with_two_neighbours_of_the_fmu(instances, eta, pushes, expected):
    plain, eventful = instances
    point, periods = Point(PAPER, Excitation.nondimensional(eta, PAPER, **pushes)), 400
    start, span = after(plain, point, REST, 3000), period_in_tau(eta)
    impacts = simulate_nondimensional_impacts(eventful, point, start, periods)
    exponent, error = exponent_from_impacts(impacts, periods * span, point)
    here, growth = start, 0.0
    shift = 1e-8 * np.array([0.5, -0.5, 0.5, 0.5]) * np.abs(start).max()
    scale = np.linalg.norm(shift)

    for _ in range(periods):
        there, here = after(plain, point, here + shift), after(plain, point, here)
        distance = np.linalg.norm(there - here)
        growth += math.log(distance / scale)
        shift = (there - here) * scale / distance
        if shift[1] < shift[0] and here[1] - here[0] < 2 * scale:
            shift = -shift  # the neighbour on the side that is free
    assert growth / (periods * span) == pytest.approx(exponent, abs=3e-3 + 5 * error)
    assert classify_exponents(exponent, error, math.log(10.0) / (periods * span)) == expected


def test_too_few_impacts_are_no_uncertainty(exported):
    with pytest.raises(InputError, match=r"10 impacts at eta = 4.* 16 impacts \(periods >= 32\)"):
        lyapunov(PAPER, eta=4.0, transient=2000, periods=20)
    assert lyapunov(PAPER, eta=4.0, transient=2000, periods=40).standard_error > 0.0
    assert min_impacts(5) == 10


def test_a_sweep_s_responses_are_followed_on(exported):
    etas = [1.2, 1.13, 0.8]
    swept = sweep(PAPER, eta=etas, transient=100, samples=20)
    found = lyapunov(PAPER, eta=etas, start=swept, transient=0, periods=60)
    alone = lyapunov(PAPER, eta=0.8, start=swept.end_state.values[2], transient=0, periods=60)
    assert alone.exponent[0] == found.exponent[2]
    for start, words in ((swept, "the same values"), (swept.end_state[:2], "2 states; expected")):
        with pytest.raises(InputError, match=words):
            lyapunov(PAPER, eta=[*etas, 0.9], start=start)


@pytest.mark.parametrize(
    ("structure", "pushes", "damping"),
    [
        (make(D1=0.3, D2=0.5, bonded=True), {}, 0.4),
        (make(D=3.0, bonded=True), {}, 3.0 - math.sqrt(9.0 - 1.1)),
        (make(D=0.03, mu=1.4, kappa=1.4), {}, 0.03),  # alike: they never press each other
        (LOSSY.replace(clearance=0.2), {"box_acceleration": -30.0}, 0.035),  # together, by gravity
        (LOSSY.replace(clearance=0.2), {"box_acceleration": 0.1, "force1": 0.1}, 0.02),
        (LOSSY.replace(clearance=0.2, stroke=0.5), {"force2": 0.1}, 0.02),
        (LOSSY.replace(clearance=0.2, stroke=0.25), {"force1": -5.0}, None),
        (LOSSY.replace(clearance=-0.3), {"force1": 0.1}, 0.035),
        (LOSSY.replace(clearance=1.0, wall=True), {"force1": 0.1}, 0.05),
        (LOSSY.replace(clearance=-1.0, wall=True), {"force1": 0.1}, np.inf),
        (LOSSY.replace(clearance=1.0, wall=True, stroke=1.001), {"force1": 0.1}, None),
    ],
)
def test_a_response_without_impacts_has_its_exact_exponent(exported, structure, pushes, damping):
    """That of free masses, or of both together; a wall leaves nothing that deviates."""
    asked = {"frequency": 0.4, "amplitude": 0.0 if pushes else 1.0, **pushes, "progress": False}
    found = lyapunov(structure, **asked, transient=200, periods=150)
    assert (found.impacts_per_period > 0.0) == (damping is None)
    if damping is None:
        orbit = orchestrate.orbit(structure, **asked)
        assert float(found.exponent[0]) == pytest.approx(float(orbit.exponent), rel=0.05)
    else:
        assert float(found.exponent[0]) == pytest.approx(-damping, abs=1e-12)
        assert float(found.verdict[0]) == PERIODIC


def test_exponents_at_a_wall_and_in_a_play_are_those_of_their_orbits(exported):
    wall = Structure.one_mass(m=1.0, k=1.0, d=0.05, e=0.7, clearance=0.2)
    play = make(e=0.6, D=0.05).replace(clearance=0.3, stroke=1.0)
    for structure, eta in ((wall, 1.7), (play, 0.9)):
        found = lyapunov(structure, eta=eta, transient=300, periods=600, spectrum=True)
        orbit = orchestrate.orbit(structure, eta=eta)
        assert float(found.exponent[0]) == pytest.approx(float(orbit.exponent), abs=5e-4)
        expected = np.log(np.hypot(*orbit.multipliers.values.T)[:2]) * eta / (2.0 * np.pi)
        assert found.exponents[0, :2].values == pytest.approx(expected, abs=5e-4)
        assert np.isinf(found.exponents[0, 2:]).all() == structure.wall
        over = orchestrate.map(structure, eta=[eta], e=[structure.e], exponent=True)
        assert float(over.exponent[0, 0]) == pytest.approx(float(orbit.exponent), abs=2e-3)


@pytest.mark.parametrize(
    ("structure", "eta"),
    [(make(), 0.8), (make(), 1.047), (make(D1=0.02, D2=0.1), 0.9), (make(mu=0.5, kappa=1.9), 1.3)],
)
def test_their_sum_is_the_mean_divergence(exported, structure, eta):
    """Of the flow -2 (D1 + D2), and at each impact 2 log e; the exponents do not know of it."""
    found = lyapunov(structure, eta=[eta], periods=1500, spectrum=True, progress=False)
    impacts = float(found.impacts_per_period[0]) / period_in_tau(eta)
    divergence = -2.0 * (structure.D1 + structure.D2) + 2.0 * impacts * math.log(structure.e)
    assert float(found.exponents[0].sum()) == pytest.approx(divergence, abs=1e-3)
    assert float(found.exponents[0, 0]) == float(found.exponent[0])
    assert (np.diff(found.exponents[0]) < 1e-3).all()


def test_a_qr_method_gives_the_same(instances):
    """Benettin's method, one impact after the other, in chaotic motion."""
    point, end = Point(PAPER, Excitation.nondimensional(0.8, PAPER)), 600 * period_in_tau(0.8)
    impacts = simulate_nondimensional_impacts(
        instances[1], point, after(instances[0], point, REST, 300), 600
    )
    found = lyapunov_spectrum(impacts, end, point, 40, 8)
    frame, sums = np.eye(4), np.zeros(4)
    for matrix in deviation_matrices_and_contacts(impacts, end, point)[0]:
        frame, upper = np.linalg.qr(matrix @ frame)
        sums += np.log(np.abs(np.diag(upper)))
    np.testing.assert_allclose(found.exponents, sums / end, atol=4e-3)
    assert 3.0 < kaplan_yorke_dimension(found.exponents) < 3.2


def test_permanent_contact_forgets_the_gap(exported):
    structure = make(e=0.3, D=0.05)
    found = lyapunov(structure, eta=[0.6], periods=400, spectrum=True, progress=False)
    assert np.isneginf(found.exponents[0, 2:]).all() and np.isfinite(found.exponents[0, :2]).all()
    assert np.isnan(found.exponent_errors[0, 2:]).all()


@pytest.mark.parametrize(
    ("exponents", "dimension"),
    [
        ((0.41922, -1.62319), 1.2583),  # Henon's map: Sprott, Chaos and Time-Series Analysis, 2003
        ((0.9056, 0.0, -14.5723), 2.0621),  # Lorenz's flow, there too
        *(((0.1, -math.inf), 1.0), ((-0.1, -0.2), 0.0), ((0.2, 0.1), 2.0)),
    ],
)
def test_dimension(exponents, dimension):
    assert kaplan_yorke_dimension(np.array(exponents)) == pytest.approx(dimension, abs=1e-4)
