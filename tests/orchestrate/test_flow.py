"""Flow and saltation matrices against neighbouring runs of the FMU, exponents against known cases."""

import itertools
import math

import numpy as np
import pytest

from orchestrate.flow import flight, monodromy
from orchestrate.fmu import Instance
from orchestrate.lyapunov import CHAOTIC, PERIODIC, QUASI_PERIODIC, largest_exponent, verdict
from orchestrate.sweep import Case
from orchestrate.trace import REST, STATE, EventInstance, begin, period

from .conftest import exported

CASES = (Case(), Case(e=0.3), Case(D=0.05), Case(mu=1.5, kappa=2.1))


@pytest.fixture(scope="module")
def instances():
    """One instance without and one with events."""
    fmu = exported("fmi3") or pytest.skip("no fmi3 here")
    with Instance(fmu) as plain, EventInstance(fmu) as eventful:
        yield plain, eventful


def after(instance, case, eta, start, periods=1):
    """State of the FMU some periods after a start."""
    begin(instance, case, eta, start)
    instance.step(0.0, periods * period(eta))
    return np.array(instance.get(*STATE))


def differences(instance, case, eta, start, periods):
    """Central differences of the state after some periods: the matrix through the FMU alone."""
    step = 1e-7 * np.abs(start).max()
    columns = [
        (after(instance, case, eta, start + d, periods) - after(instance, case, eta, start - d, periods)) / (2 * step) for d in step * np.eye(4)
    ]
    return np.array(columns).T


@pytest.mark.parametrize(("case", "eta"), list(itertools.product(CASES, (0.3, 0.6, 1.047, 2.0))))
def test_monodromy_equals_differences_of_the_fmu(instances, case, eta):
    plain, eventful = instances
    start = after(plain, case, eta, REST, 200)
    if start[1] - start[0] < 1e-3 * np.abs(start).max():
        pytest.skip("in contact at phase 0: there is no neighbour on the other side")
    begin(eventful, case, eta, start)
    impacts = eventful.impacts(0.0, 2 * period(eta))
    assert len(impacts.time)
    np.testing.assert_allclose(monodromy(impacts, eta, case, 2), differences(plain, case, eta, start, 2), atol=2e-6)


def test_permanent_contact_is_in_the_matrices(instances):
    _, eventful = instances
    begin(eventful, Case(), 0.3, REST)
    assert eventful.impacts(0.0, 3 * period(0.3)).sticks.sum() >= 2


def test_exponent_of_a_periodic_response_is_that_of_its_multipliers(instances):
    plain, eventful = instances
    for case, eta in ((Case(), 1.047), (Case(D=0.05), 0.8), (Case(e=0.3), 0.6)):
        start = after(plain, case, eta, REST, 1500)
        begin(eventful, case, eta, start)
        impacts = eventful.impacts(0.0, 400 * period(eta))
        exponent, error = largest_exponent(impacts, 400 * period(eta), eta, case)
        first = np.searchsorted(impacts.time, period(eta))
        one = type(impacts)(impacts.time[:first], impacts.state[:first], impacts.closing[:first], impacts.sticks[:first])
        multiplier = np.abs(np.linalg.eigvals(monodromy(one, eta, case))).max()
        assert exponent == pytest.approx(math.log(multiplier) / period(eta), abs=2e-4)
        assert 0.0 <= error < 2e-4
        assert verdict(exponent, error, 1e-3) == PERIODIC


def test_exponent_without_impacts_is_minus_d():
    case = Case(D=0.02)
    product = np.linalg.matrix_power(flight(np.array([0.7]), case)[0], 400)
    assert math.log(np.linalg.norm(product)) / 280.0 == pytest.approx(-0.02, abs=3e-3)


def test_a_bonded_structure_decays_with_d_through_the_fmu(instances):
    plain, _ = instances
    case, far = Case(), []
    for shift in (0.0, 1.0):
        begin(plain, case, 1.3, (shift, shift, 0.0, 0.0), bonded=True)
        plain.step(0.0, 100.0 * 2.0 * math.pi / math.sqrt(1.1 - case.D**2))
        far.append(plain.get("x1")[0])
    assert math.log(abs(far[1] - far[0])) / (200.0 * math.pi / math.sqrt(1.1 - case.D**2)) == pytest.approx(-case.D, rel=1e-6)


@pytest.mark.parametrize(("eta", "expected"), [(0.8, CHAOTIC), (1.13, CHAOTIC), (1.047, PERIODIC), (2.655, QUASI_PERIODIC)])
def test_exponent_agrees_with_two_neighbours_of_the_fmu(instances, eta, expected):
    plain, eventful = instances
    case, periods, size = Case(), 400, 1e-8
    start = after(plain, case, eta, REST, 3000)
    begin(eventful, case, eta, start)
    exponent, error = largest_exponent(eventful.impacts(0.0, periods * period(eta)), periods * period(eta), eta, case)
    here, shift, growth = start, size * np.array([0.5, -0.5, 0.5, 0.5]) * np.abs(start).max(), 0.0
    scale = np.linalg.norm(shift)
    for _ in range(periods):
        there, here = after(plain, case, eta, here + shift), after(plain, case, eta, here)
        distance = np.linalg.norm(there - here)
        growth, shift = growth + math.log(distance / scale), (there - here) * scale / distance
        if shift[1] < shift[0] and here[1] - here[0] < 2 * scale:
            shift = -shift  # the neighbour on the side that is free
    assert growth / (periods * period(eta)) == pytest.approx(exponent, abs=3e-3 + 5 * error)
    assert verdict(exponent, error, math.log(10.0) / (periods * period(eta))) == expected
