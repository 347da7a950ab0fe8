"""Samples for the energy balance."""

import itertools
import math

from driver import open_fmu


def energy_of_free_motion_is_lost_in_impacts_alone(path, values):
    f = open_fmu(path)
    f.start(
        box_amplitude=0.0,
        d1=0.0,
        d2=0.0,
        x1_start=-0.5,
        x2_start=0.25,
        v1_start=1.0,
        v2_start=-2.0,
        **values,
    )
    names = ("x1", "x2", "v1", "v2", "impact_energy", "impact_count", "contact_count")
    found = [f.get(*names)]
    for k in range(1, 201):
        f.step(0.25 * k)
        found.append(f.get(*names))
    return found


def energy_balance_of_driven_motion_closes(path, values, nodes):
    end = 100.0
    f = open_fmu(path).start(**values)
    instants = {0.0, end}
    while f.time < end:  # where to split the quadrature
        f.step(f.time + 2.0**-8)
        count, instant = f.get("impact_count", "impact_time")
        instants.add(instant)
    impacts = count
    f = open_fmu(path).start(**values)
    names = ("x1", "x2", "v1", "v2", "impact_energy", "phase")
    first, samples = f.get(*names), []
    instants = sorted(instants)
    for a, b in itertools.pairwise(instants):
        pieces = max(1, math.ceil((b - a) / 0.5))
        for k in range(pieces):
            length = (b - a) / pieces
            for node, weight in nodes:
                f.step(a + (k + node) * length)
                samples.append([weight * length, *f.get("v1", "v2", "phase")])
    f.step(end)
    return [first, f.get(*names), samples, impacts, len(instants) - 2]
