"""The energy balance, from outputs alone: kinetic and elastic energy, work of the box, losses in
dampers and impacts.
"""

import numpy as np
import pytest

from .driver import run

# Energy relative to the box: E' = (m1 v1 + m2 v2) a Omega^2 sin(phase) - d1 v1^2 - d2 v2^2, and
# less at impacts.


def energy(m1, m2, k1, k2, x1, x2, v1, v2):
    return 0.5 * (m1 * v1**2 + m2 * v2**2 + k1 * x1**2 + k2 * x2**2)


@pytest.mark.parametrize(
    "values",
    [
        {"m1": 1.0, "m2": 1.0, "k1": 1.0, "k2": 1.2, "e": 0.7},
        {"m1": 0.3, "m2": 2.5, "k1": 1.7, "k2": 4.0, "e": 0.95},
        {"m1": 4.0, "m2": 1.5, "k1": 1.0, "k2": 2.0, "e": 0.0},  # every impact begins a contact
        {"m1": 1.0, "m2": 3.0, "k1": 2.0, "k2": 1.0, "e": 1.0},  # nothing is lost
        {"m1": 0.3, "m2": 2.5, "k1": 1.7, "k2": 4.0, "e": 0.95, "clearance": 0.3},
        {"m1": 4.0, "m2": 1.5, "k1": 1.0, "k2": 2.0, "e": 0.0, "clearance": -0.3},
        {"m1": 1.0, "m2": 3.0, "k1": 2.0, "k2": 1.0, "e": 1.0, "clearance": -0.3},
        {"m1": 0.3, "m2": 2.5, "k1": 1.7, "k2": 4.0, "e": 0.98, "e_slope": 0.5},
    ],
    ids=lambda values: ",".join(f"{n}={v}" for n, v in values.items() if n[0] in "ec"),
)
def test_energy_of_free_motion_is_lost_in_impacts_alone(fmu, tmp_path, values):
    found = np.array(
        run("energy.energy_of_free_motion_is_lost_in_impacts_alone", fmu, values, cwd=tmp_path)
    )
    masses = [values[name] for name in ("m1", "m2", "k1", "k2")]
    total = energy(*masses, *found[:, :4].T) + found[:, 4]
    assert found[-1, 5] > 5
    assert np.all(np.diff(found[:, 4]) >= 0.0)
    assert (found[-1, 4] > 0.1 * total[0]) == (values["e"] < 1.0)
    assert total == pytest.approx(total[0], rel=1e-12)


@pytest.mark.parametrize(
    ("clearance", "gamma", "e_slope"),
    [(0.0, 1e-4, 0.0), (0.2, 1e-4, 0.0), (-0.2, 0.3, 0.0), (0.0, 1e-4, 0.2)],
)
def test_energy_balance_of_driven_motion_closes(fmu, tmp_path, clearance, gamma, e_slope):
    """Work and damping losses by Gauss quadrature between impacts, through chaotic motion; its
    error is below 1e-12.
    """
    values = {
        "m1": 1.0,
        "m2": 1.5,
        "k1": 1.0,
        "k2": 1.4,
        "d1": 0.02,
        "d2": 0.03,
        "e": 0.7,
        "box_amplitude": 0.8,
        "box_frequency": 1.13,
        "clearance": clearance,
        "gamma": gamma,
        "e_slope": e_slope,
    }
    points, weights = np.polynomial.legendre.leggauss(8)
    nodes = list(zip((0.5 + 0.5 * points).tolist(), (0.5 * weights).tolist(), strict=True))
    first, last, samples, impacts, splits = run(
        "energy.energy_balance_of_driven_motion_closes", fmu, values, nodes, cwd=tmp_path
    )
    assert impacts > 15
    assert splits == impacts  # no two within a step: the quadrature knows them all
    masses = [values[name] for name in ("m1", "m2", "k1", "k2")]
    weight, v1, v2, phase = np.array(samples).T
    forcing = values["box_amplitude"] * values["box_frequency"] ** 2 * np.sin(phase)
    work = np.sum(weight * (values["m1"] * v1 + values["m2"] * v2) * forcing)
    lost_in_dampers = np.sum(weight * (values["d1"] * v1**2 + values["d2"] * v2**2))
    assert lost_in_dampers > 0.1
    assert last[4] > 0.1
    gain = energy(*masses, *last[:4]) - energy(*masses, *first[:4])
    assert gain + lost_in_dampers + last[4] == pytest.approx(work, abs=1e-10)
