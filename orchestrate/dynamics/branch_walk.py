"""A branch of orbits followed until it ends, its bifurcations, and branches that leave there."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..errors import InputError
from .bifurcations import (
    CONTACT_BEGUN,
    CONTACT_LOST,
    ENDS,
    FLIP,
    GRAZING,
    KINDS,
    SIGNS,
    TOUCHING,
    UNDECIDED,
    Look,
    Step,
)
from .closed_form import Floats
from .continuation import NoConvergenceError, Root, Walk, corrected, held, oriented
from .families import Family
from .impact_sequence import CLOSING, IMPACT, PHASE, POSITION, RELEASE, STICK, TURN, Ring, Sequence
from .orbit_search import solve
from .turning_points import nearest, turning_points

FIRST_STEP = 1e-3
SWITCHED = 1e-3  # step away from a bifurcation onto the branch that leaves there
SHORT_OF = 1.0 - 1e-6  # of a step to the branch's end: where multipliers are looked at
AT_BEGIN = 1e-7  # of a step: what is found before was there when the step began
SHORTER = 0.3  # a step in which a bifurcation was not found, over the one before
NOTHING = 1e-6  # of a permanent contact is left
CHANGES = 10  # impacts of a chattering that come or go in one step
LIMIT, STUCK, LONG, CLOSED = (
    "limit",
    "no convergence",
    "most points",
    "no orbit of another sequence",
)


@dataclass(frozen=True)
class Event:
    """A bifurcation on a branch.

    Attributes
    ----------
    kind : int
    look : Look
        The orbit there.
    place : float
        Among the branch's orbits: between two numbers where it lies between two orbits.
    """

    kind: int
    look: Look
    place: float


@dataclass
class Leg:
    """A branch in one direction.

    Attributes
    ----------
    looks : list of Look
        Its orbits, from the start on.
    events : list of Event
        Bifurcations on it, in order.
    end : str
        Why it ends.
    rates : dict
        How fast what tells bifurcations changed in the last step.
    """

    looks: list[Look] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    end: str = ""
    rates: dict[int, float] = field(default_factory=dict)


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


def follow(start: Look, pace: Pace) -> Leg:
    """Follow a branch from an orbit along its tangent until it ends."""
    leg = Leg([start])
    walk = Walk(start.family, start.root, min(FIRST_STEP, pace.longest), pace.longest)
    while not leg.end:
        if len(leg.looks) > pace.most:
            leg.end = LONG
            break
        advance(leg, walk)
    return leg


def advance(leg: Leg, walk: Walk[Family]) -> None:
    """One step on, or the end."""
    try:
        step, found, arrived = stepped(leg, walk)
    except NoConvergenceError:
        stuck(leg)
        return
    after, leg.end = step.after, LIMIT if arrived else ""
    leg.rates = {kind: step.rate(kind) for kind in SIGNS}
    last = len(leg.looks) - 1
    for place, look, kind in found:
        ends = kind in ENDS
        leg.events.append(Event(kind, look, last + (1.0 if ends else place / step.length)))
        if ends:
            leg.looks.append(look)
            leg.end = KINDS[kind]
            return
    if after.wrong_contact:
        after = resequenced(leg, walk, after, step.length)
    walk.curve, walk.root = after.family, after.root
    leg.looks.append(after)
    rescale(walk)


def stuck(leg: Leg) -> None:
    """End a branch where no step is short enough: with its contact, if none of that is left."""
    look = leg.looks[-1]
    if look.ring.contact.any() and look.contact_test(CONTACT_LOST) < NOTHING:
        leg.events.append(Event(CONTACT_LOST, look, len(leg.looks) - 1.0))
        leg.end = KINDS[CONTACT_LOST]
    else:
        leg.end = STUCK


def stepped(leg: Leg, walk: Walk[Family]) -> tuple[Step, list[tuple[float, Look, int]], bool]:
    """The next step with its bifurcations, and whether it ends at a limit; shorter where they hide.

    Raises
    ------
    NoConvergenceError
        Where no step is short enough.
    """
    family = walk.curve
    while True:
        root, length, arrived = walk.inside(
            family.size, family.setting.limits, lambda root: orderly(family, root)
        )
        step = Step(walk, leg.looks[-1], Look(family, root), length, leg.rates)
        try:
            return step, located(step), arrived
        except NoConvergenceError:
            walk.step = SHORTER * length
            if walk.step < walk.shortest:
                raise


def rescale(walk: Walk[Family]) -> None:
    """Measure the branch in the size that the motion has now."""
    family, root = walk.curve, walk.root
    nodes = root.unknowns[: family.size].reshape(-1, 4)
    new = Family.near(family.setting, family.sequence, nodes)
    if not len(nodes) or 0.5 < new.scale[POSITION] / family.scale[POSITION] < 2.0:
        return
    tangent = root.tangent * family.scale / new.scale
    walk.curve = new
    walk.root = replace(root, tangent=tangent / np.linalg.norm(tangent))


def located(step: Step) -> list[tuple[float, Look, int]]:
    """Bifurcations in a step, in order; up to the one that ends the branch, if any.

    Not the one that the step begins at.
    """
    ends = places(step, [one for one in step.crossings() if one[0] in ENDS])[:1]
    if ends:  # multipliers are infinite where an impact grazes
        short = ends[0][0] * SHORT_OF
        step = replace(step, after=step.look(short), length=short)
    return [*places(step, [one for one in step.crossings() if one[0] not in ENDS]), *ends]


def places(step: Step, crossings: list[tuple[int, float, float]]) -> list[tuple[float, Look, int]]:
    """Where bifurcations lie in a step, in order."""
    found = [(*step.locate(*crossing), crossing[0]) for crossing in crossings]
    there = [one for one in found if one[0] > AT_BEGIN * step.length and one[1].happens(one[2])]
    return sorted(there, key=lambda one: one[0])


def orderly(family: Family, root: Root) -> bool:
    """Whether the flights of a root all have a length."""
    ring = family.ring(root.unknowns)
    return bool((ring.durations[~ring.contact] > 0.0).all())


def resequenced(leg: Leg, walk: Walk[Family], look: Look, length: float) -> Look:
    """The orbit with the impacts that it has, where chattering ends earlier or later than before.

    Where permanent contact is lost or begins, the branch ends: infinitely many impacts would graze
    one after the other.
    """
    try:
        return chattering(look)
    except NoConvergenceError:  # too far on: look where the first impact comes or goes
        lost = look.contact_test(CONTACT_LOST) <= -UNDECIDED
        kind = CONTACT_LOST if lost else CONTACT_BEGUN
        step = Step(walk, leg.looks[-1], look, length)
        place, first = step.locate(kind, 0.0, length, -UNDECIDED)
    try:
        found = chattering(rechattered(first))
    except NoConvergenceError:
        leg.events.append(Event(kind, first, float(len(leg.looks))))
        leg.end = KINDS[kind]
        return first
    walk.step, leg.end = max(place, 2.0 * walk.shortest), ""
    return found


def chattering(look: Look) -> Look:
    """The orbit with impacts added or left out until it has those that (17) says.

    Raises
    ------
    NoConvergenceError
        Where there is no such orbit.
    """
    found = look
    for _ in range(CHANGES):
        if not found.wrong_contact:
            return found
        found = rechattered(found)
    raise NoConvergenceError("impacts of a chattering come and go")


def rechattered(look: Look) -> Look:
    """The orbit with one impact more before its contact, or without those after one that sticks."""
    ring, kinds = look.ring, list(look.ring.sequence.kinds)
    nodes, missing = look.ring.nodes, look.sticking
    if look.contact_test(CONTACT_BEGUN) < look.contact_test(CONTACT_LOST):
        impacts = ~(ring.contact | ring.sequence.releases)
        kinds, nodes = cut(kinds, nodes, int(np.where(impacts, missing, np.inf).argmin()))
    else:
        last = int(np.where(ring.contact, missing, -np.inf).argmax())
        kinds = [*kinds[:last], IMPACT, STICK, *kinds[last + 1 :]]
        nodes = np.insert(nodes, last + 1, next_impact(ring, last), axis=0)
    values = look.root.unknowns[look.family.size :]
    sequence = Sequence(ring.sequence.periods, tuple(kinds))
    found = Look(*solve(look.family.setting, (sequence, nodes), values, most=12, furthest=1.0))
    if (found.ring.durations <= 0.0).any():
        raise NoConvergenceError("no time is left for contact")
    turned = look.root.tangent[-1] * found.root.tangent[-1] < 0.0
    return backwards(found) if turned else found


def cut(kinds: list[int], nodes: Floats, stick: int) -> tuple[list[int], Floats]:
    """Nodes without the impacts between one that sticks and the release after it."""
    after = [i for i in range(stick + 1, len(kinds)) if kinds[i] == RELEASE]
    if not after:
        raise NoConvergenceError("an impact sticks that is not of a chattering")
    kept = [*range(stick + 1), *range(after[0], len(kinds))]
    return [STICK if i == stick else kinds[i] for i in kept], nodes[kept]


def next_impact(ring: Ring, node: int) -> Floats:
    """The impact after one with a short flight: a parabola (17)."""
    phase, position, velocity, closing = ring.nodes[node]
    parting = ring.form.e * closing
    time = 2.0 * parting / -float(ring.form.force(position, velocity))
    if not 0.0 < time < ring.durations[node]:
        raise NoConvergenceError("no time is left for another impact")
    return np.array([phase + ring.form.eta * time, position + velocity * time, velocity, parting])


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
    raise InputError(
        f"switch: {KINDS[kind]}; no branch of orbits leaves there, expected {expected}"
    )


def doubled(look: Look) -> Look:
    """Twice the orbit, with the direction in which its second half differs from the first."""
    family, unknowns = look.family, look.root.unknowns
    singular = look.ring.jacobian(-1.0).real * family.scale[: family.size]
    mode = oriented(np.linalg.svd(singular)[2][-1])
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
