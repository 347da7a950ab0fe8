"""The energy balance, from outputs: kinetic and elastic energy, work, losses."""

import itertools
import math

import numpy as np
import pytest

from .programs.driver import open_fmu

# Energy relative to the box: E' = (m1 v1 + m2 v2) a Omega^2 sin(phase) - d1 v1^2 - d2 v2^2, and
# less at impacts.


def energy(m1, m2, k1, k2, x1, x2, v1, v2):
    return 0.5 * (m1 * v1**2 + m2 * v2**2 + k1 * x1**2 + k2 * x2**2)


@pytest.mark.parametrize(
    ("clearance", "gamma", "e_slope", "more"),
    [
        *((0.0, 1e-4, 0.0, {}), (0.2, 1e-4, 0.0, {}), (-0.2, 0.3, 0.0, {}), (0.0, 1e-4, 0.2, {})),
        (0.2, 1e-4, 0.0, {"force1_amplitude": 0.3, "force2_amplitude": -0.2, "force1": 0.1}),
        (0.2, 1e-4, 0.0, {"force1_amplitude": 0.3, "force1": 0.1, "wall": True}),
        (0.2, 1e-4, 0.0, {"force1_amplitude": 0.3, "stroke": 0.5}),
    ],
)
def test_energy_balance_of_driven_motion_closes(fmu, clearance, gamma, e_slope, more):
    """By Gauss quadrature between impacts, through chaotic motion; its error is below 1e-12."""
    values = {"m1": 1.0, "m2": 1.5, "k1": 1.0, "k2": 1.4, "d1": 0.02, "d2": 0.03, "e": 0.7}
    values |= {"box_amplitude": 0.8, "box_frequency": 1.13}
    values |= {"clearance": clearance, "gamma": gamma, "e_slope": e_slope, **more}
    end, instants = 60.0, {0.0, 60.0}
    f = open_fmu(fmu).start(**values)
    while f.time < end:  # where to split the quadrature
        instants.add(f.step(f.time + 2.0**-8).one("impact_time"))
    # no two within a step: the quadrature knows them all
    assert f.one("impact_count") == len(instants) - 2 > 8
    f, samples = open_fmu(fmu).start(**values), []
    names = ("x1", "x2", "v1", "v2", "impact_energy")
    first = f.get(*names)
    points, weights = np.polynomial.legendre.leggauss(8)
    for a, b in itertools.pairwise(sorted(instants)):
        pieces = max(1, math.ceil((b - a) / 0.5))
        length = (b - a) / pieces
        for k, i in itertools.product(range(pieces), range(len(points))):
            f.step(a + (k + 0.5 + 0.5 * points[i]) * length)
            samples.append([0.5 * weights[i] * length, *f.get("v1", "v2", "phase")])
    last = f.step(end).get(*names)
    masses = [values[name] for name in ("m1", "m2", "k1", "k2")]
    weight, v1, v2, phase = np.array(samples).T
    forcing = values["box_amplitude"] * values["box_frequency"] ** 2 * np.sin(phase)
    work = np.sum(weight * (values["m1"] * v1 + values["m2"] * v2) * forcing)
    for half, v in ((1, v1), (2, v2)):
        constant, swing = (more.get(f"force{half}{end}", 0.0) for end in ("", "_amplitude"))
        work += np.sum(weight * v * (constant + swing * np.sin(phase)))
    lost_in_dampers = np.sum(weight * (values["d1"] * v1**2 + values["d2"] * v2**2))
    assert lost_in_dampers > 0.1
    assert last[4] > 0.1
    gain = energy(*masses, *last[:4]) - energy(*masses, *first[:4])
    assert gain + lost_in_dampers + last[4] == pytest.approx(work, abs=1e-10)
