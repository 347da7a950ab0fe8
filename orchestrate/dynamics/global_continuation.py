"""Attractors along a parameter: gathered from random starts, carried to neighbours, and matched.

Global continuation as of Datseris, Rossi and Wagemakers, Chaos 33, 073151 (2023): states on the
attractors of one value are further starts at its neighbours, so that an attractor is found as far
as it exists, however few random starts lead there. Attractors of neighbouring values are one where
each leads to the other, or where Newton's method follows the orbit from one to the other.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..access import EventInstance, Instance, begin
from ..access.description import describe
from ..response.questions import Point
from ..response.respond import sample
from .clusters import AttractorSettings, irregular_clusters
from .decision import MotionDecider
from .settled_motion import IRREGULAR, ORBIT, Floats, SettledMotion

FAR = 0.2  # distance over the motion's size from which an attractor may be another one's neighbour
FLOWS, FOLLOWED = 1, 2  # how an attractor leads to one at a neighbour: by the FMU, or by its orbit


@dataclass
class Instances:
    """The instances that decide motions, as a context manager.

    Parameters
    ----------
    path : Path
        Of the FMU.
    """

    path: Path

    def __enter__(self) -> tuple[Instance, EventInstance | None]:
        self._plain = Instance(self.path)
        self._eventful = EventInstance(self.path) if describe(self.path).is_fmi3 else None
        return self._plain, self._eventful

    def __exit__(self, *error: object) -> None:
        self._plain.close()
        if self._eventful is not None:
            self._eventful.close()


@dataclass
class SettledStarts:
    """What random starts at one value have settled to, one row a start.

    Attributes
    ----------
    features : ndarray, shape (n, 5)
        By ``clusters.FEATURES``.
    ends : ndarray, shape (n, 4)
        States on the motions at phase 0.
    decided : ndarray of int, shape (n,)
        Of ``settled_motion.DECIDED``.
    """

    features: Floats
    ends: Floats
    decided: NDArray[np.int_]


@dataclass
class AttractorsAtValue:
    """The attractors at one value of the parameter, as far as they are known.

    Attributes
    ----------
    decider : MotionDecider
    motions : list of SettledMotion
        The attractors.
    labels : ndarray of int
        Of each random start, its attractor.
    """

    decider: MotionDecider
    motions: list[SettledMotion] = field(default_factory=list)
    labels: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    def gather(self, starts: SettledStarts, settings: AttractorSettings) -> None:
        """Collect the attractors of random starts."""
        self.labels = np.full(len(starts.ends), -1, dtype=np.intp)
        seen: dict[bytes, int] = {}
        for i in np.flatnonzero(starts.decided != IRREGULAR):
            row = starts.features[i]
            key = row.tobytes()
            if key not in seen:
                motion = self.restored(row, starts.ends[i], int(starts.decided[i]))
                seen[key] = self.index(motion)
            self.labels[i] = seen[key]
        irregular = np.flatnonzero(starts.decided == IRREGULAR)
        groups = irregular_clusters(starts.features[irregular], settings)
        for group in range(int(groups.max(initial=-1)) + 1):
            members = irregular[groups == group]
            self.motions.append(self.irregular(starts.features[members], starts.ends[members[0]]))
            self.labels[members] = len(self.motions) - 1

    def restored(self, row: Floats, state: Floats, decided: int) -> SettledMotion:
        """Return a motion that has been decided, from its features and a state on it."""
        decider, n = self.decider, int(row[0])
        known = decider.known_motion_at(state, n)
        if known is None and decided == ORBIT:
            known = decider.stable_orbit_at(state, n)
        if known is None:
            begin(decider.plain, *decider.point, state)
            states, _ = sample(decider.plain, decider.point.excitation.period, 0, n)
            gap = float(row[2]) * decider.point.length
            known = SettledMotion(decider.point, decided, states.copy(), n, float(row[1]), gap)
            decider.known.append(known)
        return known

    def irregular(self, rows: Floats, state: Floats) -> SettledMotion:
        """Return what irregular responses have in common."""
        _, impacts, gap = np.median(rows[:, :3], axis=0)
        length = self.decider.point.length
        return SettledMotion(
            self.decider.point, IRREGULAR, state[np.newaxis], 0, float(impacts), gap * length
        )

    def index(self, motion: SettledMotion) -> int:
        """Return the number of a motion, which is added where it is new.

        An irregular response belongs to the irregular attractor with the nearest gap: means over
        few periods are no reason for one more.
        """
        if motion.decided == IRREGULAR:
            alike = [k for k, one in enumerate(self.motions) if one.decided == IRREGULAR]
            if alike:
                return min(alike, key=lambda k: abs(np.log(self.motions[k].gap / motion.gap)))
        for k, one in enumerate(self.motions):
            if one is motion:
                return k
        self.motions.append(motion)
        return len(self.motions) - 1

    def lead_from(self, motion: SettledMotion) -> tuple[int, int]:
        """Return where an attractor of a neighbour leads here: the attractor's number, and how."""
        state = self.decider.point.from_faces(motion.point.faces(motion.states[0]))
        reached, _ = self.decider.decide(state)
        if motion.orbit is not None and may_differ(motion, reached):
            followed = self.decider.continue_orbit(motion)
            if followed is not None:
                return self.index(followed), FOLLOWED
        return self.index(reached), FLOWS


def may_differ(one: SettledMotion, other: SettledMotion) -> bool:
    """Return whether two motions at neighbouring values may be of different branches."""
    if (one.multiplicity, one.impacts_per_period) != (
        other.multiplicity,
        other.impacts_per_period,
    ):
        return True
    state = other.point.from_faces(one.point.faces(one.states[0]))
    return other.nearest(state)[1] > FAR


@dataclass(frozen=True)
class MatchedAttractors:
    """Attractors along a parameter.

    Attributes
    ----------
    motions : sequence of sequence of SettledMotion
        Of each value.
    numbers : sequence of sequence of int
        Numbers of these along the parameter, the most frequent attractor first.
    labels : sequence of ndarray
        Number of the attractor that each random start leads to.
    """

    motions: Sequence[Sequence[SettledMotion]]
    numbers: Sequence[Sequence[int]]
    labels: Sequence[NDArray[np.intp]]

    @property
    def count(self) -> int:
        """Return the number of attractors over all values, each counted once."""
        return 1 + max(max(row) for row in self.numbers)


def continue_attractors(
    instances: tuple[Instance, EventInstance | None],
    points: Sequence[Point],
    starts: Sequence[SettledStarts],
    settings: AttractorSettings,
    seeds: Sequence[Sequence[float]] = (),
) -> MatchedAttractors:
    """Find the attractors that random starts lead to; carry them along a parameter and match them.

    Parameters
    ----------
    instances : (Instance, EventInstance or None)
    points : sequence of Point
        In the order of the parameter: neighbours are next to each other.
    starts : sequence of SettledStarts
    settings : AttractorSettings
    seeds : sequence of 4 floats
        States on attractors that are known at the first value, at phase 0.
    """
    values = [AttractorsAtValue(MotionDecider(*instances, point, settings)) for point in points]
    for value, some in zip(values, starts, strict=True):
        value.gather(some, settings)
    for seed in seeds:
        values[0].index(values[0].decider.decide(seed)[0])
    links = carry_to_neighbours(values)
    numbers = number_attractors(values, links)
    labels = [
        np.array([row[label] for label in value.labels], dtype=np.intp)
        for value, row in zip(values, numbers, strict=True)
    ]
    return MatchedAttractors([value.motions for value in values], numbers, labels)


Links = dict[tuple[int, int, int], tuple[int, int]]  # value, attractor, neighbour: where, how


def carry_to_neighbours(values: Sequence[AttractorsAtValue]) -> Links:
    """Carry every attractor to both neighbours, those that are added on the way too."""
    links: Links = {}
    waiting = deque((i, k) for i, value in enumerate(values) for k in range(len(value.motions)))
    while waiting:
        i, k = waiting.popleft()
        for j in (i - 1, i + 1):
            if not 0 <= j < len(values):
                continue
            before = len(values[j].motions)
            links[i, k, j] = values[j].lead_from(values[i].motions[k])
            waiting.extend((j, new) for new in range(before, len(values[j].motions)))
    return links


def number_attractors(values: Sequence[AttractorsAtValue], links: Links) -> list[list[int]]:
    """Return numbers of attractors along the parameter, the most frequent one first."""
    chains: list[list[int]] = []
    count = 0
    for j, value in enumerate(values):
        own = [-1] * len(value.motions)
        if j:
            for a, b in match_neighbours(values[j - 1], value, j - 1, links):
                own[b] = chains[j - 1][a]
        for b, number in enumerate(own):
            if number < 0:
                own[b], count = count, count + 1
        chains.append(own)
    shares = np.zeros(count)
    for value, own in zip(values, chains, strict=True):
        counts = np.bincount(value.labels, minlength=len(own))
        shares[own] += counts / max(1, len(value.labels))
    rank = np.empty(count, dtype=int)
    rank[np.argsort(-shares.round(12), kind="stable")] = np.arange(count)
    return [[int(rank[number]) for number in own] for own in chains]


def match_neighbours(
    before: AttractorsAtValue, value: AttractorsAtValue, i: int, links: Links
) -> list[tuple[int, int]]:
    """Return pairs of attractors of two neighbouring values that are one.

    Each leads to the other; else the orbit of one is followed to the other; else one leads to the
    other and looks the same.
    """
    j = i + 1
    forth = [links[i, a, j] for a in range(len(before.motions))]
    back = [links[j, b, i] for b in range(len(value.motions))]
    candidates: list[tuple[int, int, int]] = []
    for a, (b, how) in enumerate(forth):
        mutual = back[b][0] == a
        alike = not may_differ(before.motions[a], value.motions[b])
        if mutual or how == FOLLOWED or alike:
            candidates.append((0 if mutual else 1 if how == FOLLOWED else 2, a, b))
    for b, (a, how) in enumerate(back):
        alike = not may_differ(value.motions[b], before.motions[a])
        if how == FOLLOWED or alike:
            candidates.append((1 if how == FOLLOWED else 2, a, b))
    taken: list[tuple[int, int]] = []
    for _, a, b in sorted(candidates):
        if all(a != one and b != other for one, other in taken):
            taken.append((a, b))
    return taken
