"""Match attractors along a parameter by global continuation from random starts (Datseris 2023).

Global continuation as of Datseris, Rossi and Wagemakers, Chaos 33, 073151 (2023): states on the
attractors of one value are further starts at its neighbours, so that an attractor is found as far
as it exists, however few random starts lead there. Attractors of neighbouring values are one where
each leads to the other, or where Newton's method follows the orbit from one to the other.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..fmu import EventInstance, Instance, begin, stroboscopic_samples
from ..fmu.description import describe
from ..model.outcomes import IRREGULAR, ORBIT, UNDECIDED
from ..response.questions import Point
from ..running.job import Table
from .clusters import AttractorSettings, SettlingRun, irregular_clusters
from .decision import MotionDecider
from .settled_motion import Floats, SettledMotion

BY_SIMULATION, BY_NEWTON = 1, 2  # how an attractor was continued to a neighbouring value


@contextmanager
def instance_pair(path: Path) -> Iterator[tuple[Instance, EventInstance | None]]:
    """Open the FMU as a plain instance and, if it is of FMI 3.0, as one with events."""
    with ExitStack() as stack:
        plain = stack.enter_context(Instance(path))
        eventful = describe(path).is_fmi3
        yield plain, stack.enter_context(EventInstance(path)) if eventful else None


@dataclass
class AttractorsAtValue:
    """Attractors known at one parameter value, and which of them each random start reaches."""

    decider: MotionDecider
    motions: list[SettledMotion] = field(default_factory=list)  # the attractors
    # of each random start, its attractor
    labels: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    def group_starts(self, starts: Table, settings: AttractorSettings) -> None:
        features, ends, decided = (starts[name] for name in ("features", "end", "decided"))
        self.labels = np.full(len(ends), -1, dtype=np.intp)
        seen: dict[bytes, int] = {}
        for i in np.flatnonzero(decided != IRREGULAR):
            row = features[i]
            key = row.tobytes()
            if key not in seen:
                motion = self.motion_from_features(row, ends[i], int(decided[i]))
                seen[key] = self.find_or_add(motion)
            self.labels[i] = seen[key]
        irregular = np.flatnonzero(decided == IRREGULAR)
        late = (decided != IRREGULAR) & (starts["periods"] > settings.longest // 2)
        outcome = UNDECIDED if late.any() else IRREGULAR
        groups = irregular_clusters(features[irregular], settings)
        for group in range(int(groups.max(initial=-1)) + 1):
            members = irregular[groups == group]
            median = self.median_irregular_motion(features[members], ends[members[0]], outcome)
            self.motions.append(median)
            self.labels[members] = len(self.motions) - 1

    def motion_from_features(self, row: Floats, state: Floats, decided: int) -> SettledMotion:
        decider, n = self.decider, int(row[0])
        known = decider.known_motion_at(state, n)
        if known is None and decided == ORBIT:
            known = decider.stable_orbit_at(state, n)
        if known is None:
            begin(decider.plain, *decider.point, state)
            states, _ = stroboscopic_samples(decider.plain, decider.point.excitation.period, 0, n)
            gap = float(row[2]) * decider.point.length
            known = SettledMotion(decider.point, decided, states.copy(), n, float(row[1]), gap)
            decider.known.append(known)
        return known

    def median_irregular_motion(self, rows: Floats, state: Floats, outcome: int) -> SettledMotion:
        _, impacts, gap = np.median(rows[:, :3], axis=0)
        length = self.decider.point.length
        return SettledMotion(
            self.decider.point, outcome, state[np.newaxis], 0, float(impacts), gap * length
        )

    def find_or_add(self, motion: SettledMotion) -> int:
        """Return a motion's index here, of irregular ones by the nearest gap; append a new one."""
        if motion.decided == IRREGULAR:
            alike = [k for k, known in enumerate(self.motions) if not known.multiplicity]
            if alike:
                return min(alike, key=lambda k: abs(np.log(self.motions[k].gap / motion.gap)))
        for k, known in enumerate(self.motions):
            if known is motion:
                return k
        self.motions.append(motion)
        return len(self.motions) - 1

    def continue_from_neighbour(self, motion: SettledMotion) -> tuple[int, int]:
        """Continue a neighbour's attractor here; return its index here, and how."""
        state = self.decider.point.from_faces(motion.point.faces(motion.states[0]))
        reached, _ = self.decider.decide(state)
        if motion.orbit is not None and may_be_different_branches(
            motion, reached, self.decider.settings.neighbour
        ):
            followed = self.decider.continue_orbit(motion)
            if followed is not None:
                return self.find_or_add(followed), BY_NEWTON
        return self.find_or_add(reached), BY_SIMULATION


def may_be_different_branches(motion: SettledMotion, other: SettledMotion, distance: float) -> bool:
    counts = motion.multiplicity, motion.impacts_per_period
    if counts != (other.multiplicity, other.impacts_per_period):
        return True
    state = other.point.from_faces(motion.point.faces(motion.states[0]))
    return other.nearest(state)[1] > distance


@dataclass(frozen=True)
class MatchedAttractors:
    """Attractors at all values of a parameter; the same attractor has one number everywhere."""

    motions: Sequence[Sequence[SettledMotion]]  # of each value
    numbers: Sequence[Sequence[int]]  # of these, along the parameter
    labels: Sequence[NDArray[np.intp]]  # number of the attractor that each random start leads to

    @property
    def count(self) -> int:
        return 1 + max(max(row) for row in self.numbers)


def continue_attractors(
    instances: tuple[Instance, EventInstance | None],
    points: Sequence[Point],
    starts: Sequence[Table],
    settings: SettlingRun,
    seeds: Sequence[Sequence[float]] = (),
) -> MatchedAttractors:
    values = [AttractorsAtValue(MotionDecider(*instances, point, settings)) for point in points]
    for value, starts_there in zip(values, starts, strict=True):
        value.group_starts(starts_there, settings)
    for seed in seeds:
        values[0].find_or_add(values[0].decider.decide(seed)[0])
    links = continue_to_neighbours(values)
    numbers = number_attractors(values, links, settings.neighbour)
    pairs = zip(values, numbers, strict=True)
    labels = [np.array([row[i] for i in value.labels], dtype=np.intp) for value, row in pairs]
    return MatchedAttractors([value.motions for value in values], numbers, labels)


Links = dict[tuple[int, int, int], tuple[int, int]]  # value, attractor, neighbour: where, how


def continue_to_neighbours(values: Sequence[AttractorsAtValue]) -> Links:
    links: Links = {}
    waiting = deque((i, k) for i, value in enumerate(values) for k in range(len(value.motions)))
    while waiting:
        i, k = waiting.popleft()
        for j in (i - 1, i + 1):
            if not 0 <= j < len(values):
                continue
            before = len(values[j].motions)
            links[i, k, j] = values[j].continue_from_neighbour(values[i].motions[k])
            waiting.extend((j, new) for new in range(before, len(values[j].motions)))
    return links


def number_attractors(
    values: Sequence[AttractorsAtValue], links: Links, distance: float
) -> list[list[int]]:
    """Return the attractors' numbers at each value: equal if matched, new ones by their rank."""
    numbers: list[list[int]] = []
    free = count()
    for j, value in enumerate(values):
        pairs = match_neighbours(values[j - 1], value, j - 1, links, distance) if j else []
        own = {b: numbers[j - 1][a] for a, b in pairs}
        ordered = sorted(range(len(value.motions)), key=lambda k: value.motions[k].rank)
        own |= {b: next(free) for b in ordered if b not in own}
        numbers.append([own[b] for b in range(len(own))])
    return numbers


def match_neighbours(
    before: AttractorsAtValue,
    value: AttractorsAtValue,
    i: int,
    links: Links,
    distance: float,
) -> list[tuple[int, int]]:
    j = i + 1
    forth = [links[i, a, j] for a in range(len(before.motions))]
    back = [links[j, b, i] for b in range(len(value.motions))]
    candidates: list[tuple[int, int, int]] = []
    for a, (b, how) in enumerate(forth):
        mutual = back[b][0] == a
        alike = not may_be_different_branches(before.motions[a], value.motions[b], distance)
        if mutual or how == BY_NEWTON or alike:
            candidates.append((0 if mutual else 1 if how == BY_NEWTON else 2, a, b))
    for b, (a, how) in enumerate(back):
        alike = not may_be_different_branches(value.motions[b], before.motions[a], distance)
        if how == BY_NEWTON or alike:
            candidates.append((1 if how == BY_NEWTON else 2, a, b))
    taken: list[tuple[int, int]] = []
    for _, a, b in sorted(candidates):
        if all(a != taken_a and b != taken_b for taken_a, taken_b in taken):
            taken.append((a, b))
    return taken
