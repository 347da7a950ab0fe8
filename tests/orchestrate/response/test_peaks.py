"""Amplitudes and peak accelerations against dense points and both sides of impacts."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrate.fmu import OSCILLATOR, EventInstance, Instance, begin, find, sampled
from orchestrate.model import Excitation, Structure
from orchestrate.response.equations import absolute_accelerations
from orchestrate.response.peaks import PEAKS, POINTS, Motion, cubic_extrema, peaks
from orchestrate.response.questions import Point
from orchestrate.response.response_loop import LoopSettings, periods_to_sample, response_loop

PAPER = Structure.nondimensional()
OWN = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=2.9, e=0.6)
STRONG = Structure.nondimensional(D1=0.3, D2=1.2, mu=0.4, kappa=2.0, e=0.5)
CASES = [
    *((PAPER, eta) for eta in (0.12, 0.4, 0.6, 0.8, 1.047, 1.315, 1.6, 2.5, 4.0, 6.2, 8.0)),
    *((structure, eta) for structure in (OWN, STRONG) for eta in (0.3, 0.9, 1.7, 3.1)),
    (PAPER.as_bonded(), 1.3),
    (OWN.replace(e=0.95, e_slope=0.8), 0.9),
]
PERIODS = 4  # of a dense orbit


def largest(point: Point, start: np.ndarray, periods: int) -> np.ndarray:
    """Of 50,000 states a period, and the states on both sides of impacts."""
    structure, excitation = point
    end = periods * excitation.period
    fmu = find(OSCILLATOR).path
    with Instance(fmu) as plain, EventInstance(fmu) as eventful:
        begin(plain, structure, excitation, start)
        states = sampled(plain, 0.0, end, periods * 50_000)
        begin(eventful, structure, excitation, start)
        impacts = eventful.impacts(0.0, end)
    states = np.concatenate([states, impacts.state, impacts.before(structure)])
    found = np.hstack([states[:, :2], absolute_accelerations(states, structure)])
    return np.abs(found).max(axis=0)


def peaks_of(instance, point, transient, samples, most):
    """Peaks of a response from rest, the periods looked at, and the loop's results."""
    settings = LoopSettings(
        transient=transient,
        samples=samples,
        tolerance=1e-2,
        decides=True,
        peak_periods=most,
        peak_points=POINTS,
    )
    results = response_loop(instance).respond([point], [(0.0, 0.0, 0.0, 0.0)], settings)
    periods = periods_to_sample(int(results.counts["multiplicity"][0]), most)
    return peaks([point], [periods], results.orbits), periods, results


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize(("structure", "eta"), CASES)
def test_against_dense_communication_points(structure, eta):
    point = Point(structure, Excitation.nondimensional(eta, structure))
    with Instance(find(OSCILLATOR).path) as instance:
        found, periods, results = peaks_of(instance, point, 600, 48, PERIODS)
    expected = largest(point, results.states[0, -1], periods)
    errors = [abs(found[name][0] / size - 1.0) for name, size in zip(PEAKS, expected, strict=True)]
    step = 2.0 * np.pi * periods * max(1.0, structure.omega_2 / eta) / 200
    counts = results.counts
    contacts = counts["touching"] or counts["contacts_after"] > counts["contacts_before"]
    chatters = contacts and not structure.bonded
    assert max(errors[:2]) < step**4 / 50
    assert max(errors[2:]) < (0.5 * step if chatters else step**4 / 50)


def test_crests_of_cubics_are_exact():
    random = np.random.default_rng(1)
    for _ in range(100):
        c = random.normal(size=4)
        width = random.uniform(0.1, 2.0)
        slope = np.polynomial.Polynomial(c).deriv()
        ends = [
            Motion(*(np.array([v]) for v in (np.polynomial.Polynomial(c)(t), slope(t), 0.0)))
            for t in (0.0, width)
        ]
        if ends[0].slope[0] * ends[1].slope[0] >= 0.0:
            continue
        inside = [t.real for t in slope.roots() if abs(t.imag) < 1e-12 and 0.0 < t.real < width]
        expected = np.polynomial.Polynomial(c)(inside[0])
        assert cubic_extrema(*ends, width)[0] == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize(("multiplicity", "periods"), [(0, 4), (1, 1), (3, 3), (20, 8)])
def test_periods_looked_at(multiplicity, periods):
    assert periods_to_sample(multiplicity, 8) == periods


@pytest.mark.usefixtures("exported")
def test_structures_of_a_chunk_do_not_mix():
    alone, points, orbits, spans = [], [], [], []
    with Instance(find(OSCILLATOR).path) as instance:
        for structure, eta in CASES[3:8] + CASES[11:]:
            point = Point(structure, Excitation.nondimensional(eta, structure))
            found, periods, results = peaks_of(instance, point, 50, 20, 8)
            spans.append(periods)
            orbits.append(results.orbits[0])
            points.append(point)
            alone.append(found)
    together = peaks(points, spans, np.array(orbits))
    for name in PEAKS:
        np.testing.assert_array_equal(together[name], [one[name][0] for one in alone])
