"""Branch switching: first orbit and tangent of the branch that leaves another at a bifurcation."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..constants import TURN
from ..errors import InputError
from .bifurcation_kinds import KINDS, Kind
from .closed_form import Floats
from .continuation import (
    ArclengthStepper,
    Root,
    newton_correct,
    unit_vector,
    with_positive_leading_component,
)
from .families import Family
from .orbit_tracer import OrbitPoint
from .periodic_orbit import AT_OUTER_END, CLOSING, IMPACT, PHASE, ImpactSequence
from .turning_points import nearest_miss

AWAY = 1e-3  # along the new branch, in unknowns over their scale: where its gap is tested


def first_point_of_leaving_branch(kind: int, point: OrbitPoint) -> OrbitPoint:
    """Return the orbit at a bifurcation as a point of the branch that leaves there."""
    first_points: dict[int, Callable[[OrbitPoint], OrbitPoint]] = {
        Kind.FLIP: double_period,
        Kind.TOUCHING: with_touching_impact,
        Kind.GRAZING: without_grazing_impact,
    }
    if kind not in first_points:
        text = "no branch of orbits leaves there, expected period doubling or grazing"
        raise InputError(f"switch: {KINDS[kind]}; {text}")
    return first_points[kind](point)


def double_period(point: OrbitPoint) -> OrbitPoint:
    """Return the orbit repeated twice, with the tangent of the period-doubled branch."""
    family, orbit = point.family, point.orbit
    singular = orbit.jacobian(-1.0).real * family.scale[: family.node_unknowns]
    mode = with_positive_leading_component(np.linalg.svd(singular)[2][-1])
    second = orbit.nodes.copy()
    second[:, PHASE] += TURN * family.sequence.periods
    nodes = np.vstack([orbit.nodes, second])
    sizes = np.tile(family.scale[: family.node_unknowns], 2) * np.sqrt(2.0)
    scale = np.append(sizes, family.scale[family.node_unknowns :])
    doubled = ImpactSequence(2 * family.sequence.periods, family.sequence.kinds * 2)
    twice = Family(family.setting, doubled, scale)
    tangent = np.concatenate([mode, -mode, np.zeros(len(family.setting.over))])
    unknowns = np.append(nodes.ravel(), point.values)
    tangent = tangent / np.linalg.norm(tangent)
    return OrbitPoint(twice, Root(unknowns, tangent, point.root.residual, 0))


def with_touching_impact(point: OrbitPoint) -> OrbitPoint:
    """Return an orbit with its touching point added as an impact, and the branch's tangent."""
    orbit, kinds = point.orbit, point.orbit.sequence.kinds
    _, segment, phase = nearest_miss(orbit)
    state = orbit.states(np.array([segment]), np.array([phase]))[0]
    kind = IMPACT + AT_OUTER_END * int(2.0 * (state[1] - state[0]) > orbit.form.limit)
    row = [phase, state[0], float(state[2:] @ orbit.form.shares), 0.0]
    node = segment + 1 if orbit.node_count else 0
    nodes = np.insert(orbit.nodes, node, row, axis=0)
    first = solve_with_kinds(point, (*kinds[:node], kind, *kinds[node:]), nodes)
    rising = first.root.tangent[4 * node + CLOSING] > 0.0
    return first if rising else first.reversed()


def without_grazing_impact(point: OrbitPoint) -> OrbitPoint:
    """Return an orbit without its grazing impact, and the tangent of the branch there."""
    orbit, kinds = point.orbit, point.orbit.sequence.kinds
    closing = np.where(orbit.sequence.releases, np.inf, orbit.nodes[:, CLOSING])
    node = int(np.abs(closing).argmin())
    nodes = np.delete(orbit.nodes, node, axis=0)
    first = solve_with_kinds(point, (*kinds[:node], *kinds[node + 1 :]), nodes)
    ahead = ArclengthStepper(first.family, first.root, AWAY, AWAY).root_after(AWAY)
    return first if OrbitPoint(first.family, ahead).nearest_miss > 0.0 else first.reversed()


def solve_with_kinds(point: OrbitPoint, kinds: tuple[int, ...], nodes: Floats) -> OrbitPoint:
    """Solve for an orbit with another sequence of impacts at a point's parameters."""
    sequence = ImpactSequence(point.orbit.sequence.periods, kinds)
    family = Family.from_nodes(point.family.setting, sequence, nodes)
    unknowns = np.append(nodes.ravel(), point.values)
    normal = unit_vector(len(unknowns), family.node_unknowns)
    return OrbitPoint(family, newton_correct(family, unknowns, normal))
