"""A branch of orbits followed until it ends, with the bifurcations on it; and the branches that leave there."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..access import EventInstance
from ..errors import InputError
from .bifurcations import (
    CONTACT_BEGUN,
    CONTACT_LOST,
    ENDS,
    FLIP,
    GRAZING,
    KINDS,
    TOUCHING,
    Look,
    locate,
)
from .closed_form import Floats
from .continuation import NoConvergenceError, Root, Walk, corrected, held
from .families import Family, Setting
from .guesses import Guess, from_state
from .impact_sequence import CLOSING, PHASE, POSITION, TURN, Sequence
from .orbit_search import solve, why_no_motion
from .turning_points import nearest, phase_zero, turning_points

FIRST_STEP = 1e-3
SWITCHED = 1e-3  # step away from a bifurcation onto the branch that leaves there
SHORT_OF = 1.0 - 1e-6  # of a step to the branch's end: where multipliers are looked at
LIMIT, STUCK, LONG, CLOSED = "limit", "no convergence", "most points", "no orbit of another sequence"


@dataclass
class Leg:
    """A branch in one direction.

    Attributes
    ----------
    looks : list of Look
        Its orbits, from the start on.
    events : list of (int, Look)
        Bifurcations on it, in order.
    end : str
        Why it ends.
    """

    looks: list[Look] = field(default_factory=list)
    events: list[tuple[int, Look]] = field(default_factory=list)
    end: str = ""


@dataclass(frozen=True)
class Pace:
    """How a branch is followed.

    Attributes
    ----------
    longest : float
        Longest step, of the limits' span.
    most : int
        Points in one direction.
    """

    longest: float
    most: int


def follow(instance: EventInstance, start: Look, pace: Pace) -> Leg:
    """Follow a branch from an orbit along its tangent until it ends."""
    leg = Leg([start])
    walk = Walk(start.family, start.root, min(FIRST_STEP, pace.longest), pace.longest)
    while not leg.end:
        if len(leg.looks) > pace.most:
            leg.end = LONG
            break
        advance(instance, leg, walk)
    return leg


def advance(instance: EventInstance, leg: Leg, walk: Walk) -> None:
    """One step on, or the end."""
    before = leg.looks[-1]
    try:
        root, length = walk.ahead(lambda root: orderly(walk.curve, root))
        after = Look(walk.curve, root)
        which = outside(after)
        if which is not None:
            after = Look(walk.curve, walk.land(after.family.size, which))
            length = step_to(walk, after)
            leg.end = LIMIT
        found = located(walk, before, after, length)
    except NoConvergenceError:
        leg.end = STUCK
        return
    for _, look, kind in found:
        leg.events.append((kind, look))
        if kind in ENDS:
            leg.looks.append(look)
            leg.end = KINDS[kind]
            return
    if after.wrong_contact:
        after = resequenced(instance, leg, walk, after, length)
    walk.curve, walk.root = after.family, after.root
    leg.looks.append(after)
    rescale(walk)


def rescale(walk: Walk) -> None:
    """Measure the branch in the size that the motion has now."""
    family, root = walk.curve, walk.root
    nodes = root.unknowns[: family.size].reshape(-1, 4)
    new = Family.near(family.setting, family.sequence, nodes)
    if not len(nodes) or 0.5 < new.scale[POSITION] / family.scale[POSITION] < 2.0:
        return
    tangent = root.tangent * family.scale / new.scale
    walk.curve = new
    walk.root = replace(root, tangent=tangent / np.linalg.norm(tangent))


def located(walk: Walk, before: Look, after: Look, length: float) -> list[tuple[float, Look, int]]:
    """Bifurcations in a step, in order; up to the one that ends the branch, if any."""
    kinds = after.changed(before)
    ends = [(*locate(walk, before, after, length, kind), kind) for kind in kinds if kind in ENDS]
    if ends:  # multipliers are infinite where an impact grazes
        last = min(ends, key=lambda one: one[0])
        length = last[0] * SHORT_OF
        after = Look(before.family, walk.at(length))
        kinds, ends = after.changed(before), [last]
    inside = [kind for kind in kinds if kind not in ENDS]
    found = [(*locate(walk, before, after, length, kind), kind) for kind in inside]
    return [*sorted(found, key=lambda one: one[0]), *ends]


def step_to(walk: Walk, look: Look) -> float:
    """Length of the step along the walk's tangent to an orbit."""
    way = (look.root.unknowns - walk.root.unknowns) / walk.curve.scale
    return float(way @ walk.root.tangent)


def orderly(family: Family, root: Root) -> bool:
    """Whether the flights of a root all have a length."""
    ring = family.ring(root.unknowns)
    return bool((ring.durations[~ring.contact] > 0.0).all())


def outside(look: Look) -> float | None:
    """The limit that an orbit's parameter has passed, if any."""
    (low, high), value = look.family.setting.limits[0], look.root.unknowns[look.family.size]
    rising = look.root.tangent[look.family.size] > 0.0
    if value >= high and rising:
        return high
    if value <= low and not rising:
        return low
    return None


def resequenced(
    instance: EventInstance, leg: Leg, walk: Walk, look: Look, length: float
) -> Look:
    """The orbit with the impacts that the FMU has there, where chattering ends earlier or later than before.

    Where permanent contact is lost or begins, the branch ends: infinitely many impacts would graze
    one after the other.
    """
    had = bool(look.ring.contact.any())
    values = look.root.unknowns[look.family.size :]
    try:
        family, root = solve(look.family.setting, sequence_at(instance, look, values), values)
    except NoConvergenceError:
        leg.end = CLOSED
        family, root = look.family, look.root
    if had != bool(family.sequence.sticks.any()) or leg.end:
        return contact_changes(leg, walk, look, length, had)
    if family.sequence == look.family.sequence or why_no_motion(family.ring(root.unknowns)):
        leg.end = CLOSED
    turned = look.root.tangent[-1] * root.tangent[-1] < 0.0
    return Look(family, replace(root, tangent=-root.tangent) if turned else root)


def sequence_at(instance: EventInstance, look: Look, values: Floats) -> Guess:
    """What the FMU runs through from an orbit's state at phase 0."""
    point = look.family.setting.point(values)
    state = phase_zero(look.ring)[0] * point.scale
    state[1] = max(state[0], state[1])
    return from_state(instance, point, look.ring.form, state, look.ring.sequence.periods)


def contact_changes(leg: Leg, walk: Walk, look: Look, length: float, had: bool) -> Look:
    """The end of a branch where permanent contact is lost, or begins."""
    kind = CONTACT_LOST if had else CONTACT_BEGUN
    _, found = locate(walk, leg.looks[-1], look, length, kind)
    leg.events.append((kind, found))
    leg.end = KINDS[kind]
    return found


def backwards(look: Look) -> Look:
    """The same orbit with the branch's other direction."""
    return Look(look.family, replace(look.root, tangent=-look.root.tangent))


# -- branches that leave at a bifurcation ----------------------------------------------------------


def leaving(kind: int, look: Look) -> Look:
    """The begin of the branch that leaves at a bifurcation.

    Raises
    ------
    InputError
        Where none does, or it is no branch of orbits.
    """
    if kind == FLIP:
        return doubled(look)
    if kind == TOUCHING:
        return with_touching(look)
    if kind == GRAZING:
        return without_grazing(look)
    expected = "period doubling or grazing"
    raise InputError(f"switch: {KINDS[kind]}; no branch of orbits leaves there, expected {expected}")


def doubled(look: Look) -> Look:
    """Twice the orbit, with the direction in which its second half differs from the first."""
    family, unknowns = look.family, look.root.unknowns
    mode = np.linalg.svd(look.ring.jacobian(-1.0).real * family.scale[: family.size])[2][-1]
    second = look.ring.nodes.copy()
    second[:, PHASE] += TURN * family.sequence.periods
    nodes = np.vstack([look.ring.nodes, second])
    sizes = np.tile(family.scale[: family.size], 2) * np.sqrt(2.0)
    scale = np.append(sizes, family.scale[family.size :])
    twice = Family(family.setting, family.sequence.doubled(), scale)
    tangent = np.concatenate([mode, -mode, np.zeros(len(family.setting.over))])
    start = np.append(nodes.ravel(), unknowns[family.size :])
    tangent = tangent / np.linalg.norm(tangent)
    return Look(twice, Root(start, tangent, look.root.residual, 0))


def with_touching(look: Look) -> Look:
    """The orbit with the touching as an impact, going where it gets a closing speed."""
    ring = look.ring
    _, segment, phase = nearest(ring, turning_points(ring))
    state = ring.states(np.array([segment]), np.array([phase]))[0]
    share = ring.form.mu / (1.0 + ring.form.mu)
    row = [phase, state[0], state[2] * (1.0 - share) + state[3] * share, 0.0]
    if not ring.count:
        sequence, nodes, place = Sequence(ring.sequence.periods, (0,)), np.array([row]), 0
    else:
        place = segment + 1
        sequence = ring.sequence.with_impact(place)
        nodes = np.insert(ring.nodes, place, row, axis=0)
    found = polished(look, sequence, nodes)
    rising = found.root.tangent[4 * place + CLOSING] > 0.0
    return found if rising else backwards(found)


def without_grazing(look: Look) -> Look:
    """The orbit without the impact that has no closing speed, going where the gap stays open."""
    ring = look.ring
    closing = np.where(ring.sequence.releases, np.inf, ring.nodes[:, CLOSING])
    node = int(np.abs(closing).argmin())
    nodes = np.delete(ring.nodes, node, axis=0)
    found = polished(look, ring.sequence.without(node), nodes)
    ahead = Walk(found.family, found.root, SWITCHED, SWITCHED).at(SWITCHED)
    return found if Look(found.family, ahead).clearance > 0.0 else backwards(found)


def polished(look: Look, sequence: Sequence, nodes: Floats) -> Look:
    """An orbit of another sequence that is the same motion, at the same parameters."""
    family = Family.near(look.family.setting, sequence, nodes)
    start = np.append(nodes.ravel(), look.root.unknowns[look.family.size :])
    root = corrected(family, start, held(family, family.size))
    return Look(family, root)
