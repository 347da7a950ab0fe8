"""Add or remove chattering impacts of an orbit, so that the sticking condition (17) holds."""

from __future__ import annotations

import numpy as np

from .bifurcations import Kind
from .closed_form import Floats
from .continuation import NoConvergenceError
from .orbit_point import OrbitPoint
from .orbit_search import solve_orbit
from .periodic_orbit import IMPACT, RELEASE, STICK, ImpactSequence, PeriodicOrbit


def add_or_remove_impacts(point: OrbitPoint) -> OrbitPoint:
    """Add or remove chattering impacts one by one until (17) holds; return the orbit."""
    for _ in range(10):  # more are no small change of an orbit
        if not point.wrong_contact:
            return point
        point = change_one_impact(point)
    raise NoConvergenceError("impacts of a chattering come and go")


def change_one_impact(point: OrbitPoint) -> OrbitPoint:
    """Return the orbit with one more chattering impact, or without those that (17) excludes."""
    orbit, margins = point.orbit, point.sticking_margins
    kinds, nodes = list(orbit.sequence.kinds), orbit.nodes
    if point.contact_margin(Kind.CONTACT_BEGUN) < point.contact_margin(Kind.CONTACT_LOST):
        impacts = ~(orbit.contact | orbit.sequence.releases)
        sticking = int(np.where(impacts, margins, np.inf).argmin())
        kinds, nodes = without_impacts_after(kinds, nodes, sticking)
    else:
        last = int(np.where(orbit.contact, margins, -np.inf).argmax())
        kinds = [*kinds[:last], IMPACT, STICK, *kinds[last + 1 :]]
        nodes = np.insert(nodes, last + 1, estimated_next_impact(orbit, last), axis=0)
    sequence = ImpactSequence(orbit.sequence.periods, tuple(kinds))
    guess, setting = (sequence, nodes), point.family.setting
    changed = OrbitPoint(
        *solve_orbit(setting, guess, point.values, max_iterations=12, max_distance=1.0)
    )
    if (changed.orbit.durations <= 0.0).any():
        raise NoConvergenceError("no time is left for contact")
    same_direction = point.root.tangent[-1] * changed.root.tangent[-1] >= 0.0
    return changed if same_direction else changed.reversed()


def without_impacts_after(
    kinds: list[int], nodes: Floats, sticking: int
) -> tuple[list[int], Floats]:
    """Remove the impacts between a sticking one and its release; return kinds and nodes."""
    releases = [i for i in range(sticking + 1, len(kinds)) if kinds[i] == RELEASE]
    if not releases:
        raise NoConvergenceError("an impact sticks that is not of a chattering")
    kept = [*range(sticking + 1), *range(releases[0], len(kinds))]
    return [STICK if i == sticking else kinds[i] for i in kept], nodes[kept]


def estimated_next_impact(orbit: PeriodicOrbit, node: int) -> Floats:
    """Return the node of the impact after a short flight, estimated as a parabola."""
    phase, position, velocity, closing = orbit.nodes[node]
    parting = orbit.form.parting(closing)
    time = 2.0 * parting / -float(orbit.form.force(position, velocity))
    if not 0.0 < time < orbit.durations[node]:
        raise NoConvergenceError("no time is left for another impact")
    return np.array([phase + orbit.form.eta * time, position + velocity * time, velocity, parting])
