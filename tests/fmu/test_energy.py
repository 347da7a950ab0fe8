"""The energy balance, from outputs alone: kinetic and elastic energy, work of the box, losses in
dampers and impacts.
"""

import json

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
    ],
    ids=lambda values: f"e={values['e']}",
)
def test_energy_of_free_motion_is_lost_in_impacts_alone(fmu, tmp_path, values):
    script = r"""
    f = open_fmu(PATH)
    f.start(box_amplitude=0.0, d1=0.0, d2=0.0, x1_start=-0.5, x2_start=0.25, v1_start=1.0, v2_start=-2.0, **json.loads(sys.argv[2]))
    names = ("x1", "x2", "v1", "v2", "impact_energy", "impact_count", "contact_count")
    found = [f.get(*names)]
    for k in range(1, 201):
        f.step(0.25 * k)
        found.append(f.get(*names))
    answer(found)
    """
    found = np.array(run(script, fmu, json.dumps(values), cwd=tmp_path))
    masses = [values[name] for name in ("m1", "m2", "k1", "k2")]
    total = energy(*masses, *found[:, :4].T) + found[:, 4]
    assert found[-1, 5] > 5
    assert np.all(np.diff(found[:, 4]) >= 0.0)
    assert (found[-1, 4] > 0.1 * total[0]) == (values["e"] < 1.0)
    assert total == pytest.approx(total[0], rel=1e-12)


def test_energy_balance_of_driven_motion_closes(fmu, tmp_path):
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
    }
    script = r"""
    values, nodes, end = json.loads(sys.argv[2]), json.loads(sys.argv[3]), 100.0
    f = open_fmu(PATH).start(**values)
    instants = {0.0, end}
    while f.time < end:  # where to split the quadrature
        f.step(f.time + 2.0**-8)
        count, instant = f.get("impact_count", "impact_time")
        instants.add(instant)
    impacts = count
    f = open_fmu(PATH).start(**values)
    names = ("x1", "x2", "v1", "v2", "impact_energy", "phase")
    first, samples = f.get(*names), []
    instants = sorted(instants)
    for a, b in zip(instants, instants[1:]):
        pieces = max(1, math.ceil((b - a) / 0.5))
        for k in range(pieces):
            length = (b - a) / pieces
            for node, weight in nodes:
                f.step(a + (k + node) * length)
                samples.append([weight * length, *f.get("v1", "v2", "phase")])
    f.step(end)
    answer([first, f.get(*names), samples, impacts, len(instants) - 2])
    """
    points, weights = np.polynomial.legendre.leggauss(8)
    nodes = list(zip((0.5 + 0.5 * points).tolist(), (0.5 * weights).tolist(), strict=True))
    first, last, samples, impacts, splits = run(
        script, fmu, json.dumps(values), json.dumps(nodes), cwd=tmp_path
    )
    assert impacts > 20
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
