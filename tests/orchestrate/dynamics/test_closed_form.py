"""Closed form and equations of orbits: one source in Python and C, exact derivatives."""

import dataclasses
import itertools

import numpy as np
import pytest
from scipy.linalg import expm

from fmu_src.kernels import orbits
from orchestrate.constants import TURN
from orchestrate.dynamics.closed_form import FREE, OUTER, ClosedForm
from orchestrate.dynamics.periodic_orbit import ImpactSequence, PeriodicOrbit
from orchestrate.fmu.c_library import load_loop
from orchestrate.model import Excitation, Structure

ENTRIES = {
    "find_flows": (orbits.write_free_flows, 2, 8),
    "find_steady": (orbits.write_steady_states, 2, 4),
    "find_rates": (orbits.write_rates_of_states, 6, 4),
    "find_motion": (orbits.write_later_states, 7, 8),
    "find_segments": (orbits.write_segment_equations, 7, 44),
}


def random_orbit(seed):
    """Nodes that close no orbit: with a stroke at both ends, with a wall, overdamped."""
    chance = np.random.default_rng(seed)
    mu, kappa, *damping = chance.uniform([0.25, 0.4, 0.0, 0.0], [4.0, 3.0, 0.3, 3.0])
    numbers = {"e": chance.uniform(0.1, 0.9), "e_slope": chance.choice([0.0, 0.3])}
    made = Structure.nondimensional(mu=mu, kappa=kappa, D1=damping[0], D2=damping[1], **numbers)
    kinds = 6 if seed % 2 else 3
    if seed % 2:
        made = made.replace(clearance=0.2, stroke=1.5)
    if seed % 3 == 0:
        made = made.replace(wall=True)
    excitation = Excitation.nondimensional(chance.uniform(0.3, 3.0), made, box_acceleration=0.1)
    form = ClosedForm.from_structure(made, excitation)
    count, periods = int(chance.integers(1, 6)), int(chance.integers(1, 3))
    nodes = chance.uniform(-1.0, 1.0, (count, 4))
    nodes[:, 0] = np.sort(chance.uniform(0.0, TURN * periods, count))
    nodes[:, 3] = np.abs(nodes[:, 3])
    sequence = ImpactSequence(periods, tuple(chance.integers(0, kinds, count).tolist()))
    return PeriodicOrbit(sequence, form, nodes)


@pytest.mark.parametrize("seed", range(6))
def test_python_and_c_have_equal_bits(seed):
    orbit, chance = random_orbit(seed), np.random.default_rng(seed)
    for name, (entry, columns, width) in ENTRIES.items():
        rows = chance.uniform(-9.0, 9.0, (5, columns))
        rows[:, 1] = chance.integers(FREE, OUTER if np.isinf(orbit.form.limit) else OUTER + 1, 5)
        if name == "find_segments":
            rows = np.column_stack(
                [orbit.nodes, orbit.modes, orbit.sequence.releases, orbit.sequence.outer]
            )
        result = orbit.form.call_kernel(name, list(rows.T), width, 12.0)
        head = [*orbit.form.kernel_numbers.tolist(), float(len(rows)), 12.0]
        memory = [*head, *rows.ravel().tolist(), *[0.0] * (width * len(rows) + orbits.SPARE)]
        entry(memory, 0.0)
        first = orbits.TABLE + rows.size
        assert result.ravel().tolist() == memory[first : first + result.size], name
    assert load_loop("orbits")


@pytest.mark.parametrize("seed", range(6))
def test_the_equations_have_exact_derivatives(seed):
    orbit, step = random_orbit(seed), 1e-6
    exact, seen = orbit.jacobian(), []
    for i in range(orbit.nodes.size):
        ends = []
        for away in (step, -step):
            nodes = orbit.nodes.copy()
            nodes.ravel()[i] += away
            ends.append(dataclasses.replace(orbit, nodes=nodes).residual())
        seen.append((ends[0] - ends[1]) / (2.0 * step))
    assert np.abs(np.transpose(seen) - exact).max() < 1e-7 * max(1.0, np.abs(exact).max())


@pytest.mark.parametrize("damping", [0.0, 0.3, 1.0 - 1e-12, 1.0, np.nextafter(1.0, 2.0), 2.0, 50.0])
def test_the_flow_of_one_oscillator_is_a_matrix_exponential(damping):
    """Critically damped too, and where one exponential has long vanished."""
    form = ClosedForm.from_structure(Structure(), Excitation.nondimensional(0.7, Structure()))
    for square, time in itertools.product((0.1, 1.0, 5.0), (0.0, 0.5, 3.0, 1e4)):
        four = np.full(4, np.sqrt(square))
        own = dataclasses.replace(form, damping=damping * four, stiffness=four**2)
        rates = np.array([[0.0, 1.0], [-square, -2.0 * damping * four[0]]])
        expected = expm(rates * time) if time < 1e3 else np.zeros((2, 2))
        found = own.flow_matrices(np.atleast_1d(time))[0, ::2, ::2]
        assert found == pytest.approx(expected, abs=1e-9) or (
            time > 1e3 and np.isfinite(found).all()
        )
