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

from ..fmu import EventInstance, Instance, sample_stroboscopically, start_motion
from ..fmu.description import describe
from ..model.outcomes import IRREGULAR, ORBIT, UNDECIDED
from ..response.questions import Point
from ..running.job import Table
from .clusters import irregular_clusters
from .decision import MotionDecider
from .settled_motion import Floats, SettledMotion
from .settling import AttractorSettings, SettlingSettings

BY_SIMULATION, BY_NEWTON = 1, 2  # how an attractor was continued to a neighbouring value


@contextmanager
def open_instance_pair(path: Path) -> Iterator[tuple[Instance, EventInstance | None]]:
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
    # of each random start, the index of its attractor
    labels: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    def group_starts(self, starts: Table, settings: AttractorSettings) -> None:
        """Set ``motions`` and ``labels`` by what the settled starts at this value have reached."""
        features, ends, decided = (starts[name] for name in ("features", "end", "decided"))
        self.labels = np.full(len(ends), -1, dtype=np.intp)
        index_of: dict[bytes, int] = {}
        for i in np.flatnonzero(decided != IRREGULAR):
            row = features[i]
            key = row.tobytes()
            if key not in index_of:
                motion = self.reconstruct_motion(row, ends[i], int(decided[i]))
                index_of[key] = self.find_or_add(motion)
            self.labels[i] = index_of[key]
        irregular = np.flatnonzero(decided == IRREGULAR)
        late = (decided != IRREGULAR) & (starts["periods"] > settings.longest // 2)
        irregular_or_undecided = UNDECIDED if late.any() else IRREGULAR
        groups = irregular_clusters(features[irregular], settings)
        for group in range(int(groups.max(initial=-1)) + 1):
            members = irregular[groups == group]
            self.motions.append(
                self.median_irregular_motion(
                    features[members], ends[members[0]], irregular_or_undecided
                )
            )
            self.labels[members] = len(self.motions) - 1

    def reconstruct_motion(self, features: Floats, state: Floats, decided: int) -> SettledMotion:
        """Return a start's stored periodic motion: a known one, else solved or simulated anew."""
        decider, n = self.decider, int(features[0])
        known = decider.known_motion_at(state, n)
        if known is None and decided == ORBIT:
            known = decider.find_stable_motion_near(state, n)
        if known is None:
            start_motion(decider.plain, *decider.point, state)
            states, _ = sample_stroboscopically(
                decider.plain, decider.point.excitation.period, 0, n
            )
            gap = float(features[2]) * decider.point.displacement_unit
            known = SettledMotion(decider.point, decided, states.copy(), n, float(features[1]), gap)
            decider.known.append(known)
        return known

    def median_irregular_motion(self, rows: Floats, state: Floats, decided: int) -> SettledMotion:
        """Return an irregular motion with the medians of rows of features; its state is given."""
        _, impacts, gap = np.median(rows[:, :3], axis=0)
        length = self.decider.point.displacement_unit
        return SettledMotion(
            self.decider.point, decided, state[np.newaxis], 0, float(impacts), gap * length
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
        state = self.decider.point.states_from_faces(
            motion.point.faces_from_states(motion.states[0])
        )
        reached = self.decider.decide(state).motion
        if motion.orbit is not None and may_be_different_branches(
            motion, reached, self.decider.settings.neighbour
        ):
            continued = self.decider.continue_orbit(motion)
            if continued is not None:
                return self.find_or_add(continued), BY_NEWTON
        return self.find_or_add(reached), BY_SIMULATION


def may_be_different_branches(motion: SettledMotion, other: SettledMotion, distance: float) -> bool:
    """Return whether motions at neighbouring values differ in counts, or by more than a distance.

    The distance is that of states, over the size of the motion.
    """
    counts = motion.multiplicity, motion.impacts_per_period
    if counts != (other.multiplicity, other.impacts_per_period):
        return True
    state = other.point.states_from_faces(motion.point.faces_from_states(motion.states[0]))
    return other.nearest_state(state)[1] > distance


@dataclass(frozen=True)
class MatchedAttractors:
    """Attractors at all values of a parameter; the same attractor has one number everywhere."""

    motions: Sequence[Sequence[SettledMotion]]  # of each value
    numbers: Sequence[Sequence[int]]  # of these, along the parameter
    labels: Sequence[NDArray[np.intp]]  # number of the attractor that each random start leads to

    @property
    def count(self) -> int:
        return 1 + max(max(row) for row in self.numbers)


def match_attractors(
    instances: tuple[Instance, EventInstance | None],
    points: Sequence[Point],
    starts: Sequence[Table],
    settings: SettlingSettings,
    seeds: Sequence[Sequence[float]] = (),
) -> MatchedAttractors:
    """Group settled starts at all values, continue the attractors to neighbours, number them.

    ``seeds`` are further states at phase 0 of the first value whose attractors are to be found.
    """
    values = [AttractorsAtValue(MotionDecider(*instances, point, settings)) for point in points]
    for value, starts_there in zip(values, starts, strict=True):
        value.group_starts(starts_there, settings)
    for seed in seeds:
        values[0].find_or_add(values[0].decider.decide(seed).motion)
    links = continue_to_neighbours(values)
    numbers = number_attractors(values, links, settings.neighbour)
    pairs = zip(values, numbers, strict=True)
    labels = [np.array([row[i] for i in value.labels], dtype=np.intp) for value, row in pairs]
    return MatchedAttractors([value.motions for value in values], numbers, labels)


Links = dict[tuple[int, int, int], tuple[int, int]]  # value, attractor, neighbour: where, how


def continue_to_neighbours(values: Sequence[AttractorsAtValue]) -> Links:
    """Continue each attractor to both neighbouring values, adding those that are new there."""
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
        pairs = matching_pairs(values[j - 1], value, j - 1, links, distance) if j else []
        number_of = {b: numbers[j - 1][a] for a, b in pairs}
        ordered = sorted(range(len(value.motions)), key=lambda k: value.motions[k].sort_key)
        number_of |= {b: next(free) for b in ordered if b not in number_of}
        numbers.append([number_of[b] for b in range(len(number_of))])
    return numbers


def matching_pairs(
    value: AttractorsAtValue, following: AttractorsAtValue, i: int, links: Links, distance: float
) -> list[tuple[int, int]]:
    """Return which attractors of value ``i`` and of the one after it are one, by their indices.

    First those that lead to each other, then orbits followed, then motions that are alike.
    """
    j = i + 1
    forth = [links[i, a, j] for a in range(len(value.motions))]
    back = [links[j, b, i] for b in range(len(following.motions))]
    candidates: list[tuple[int, int, int]] = []
    for a, (b, how) in enumerate(forth):
        mutual = back[b][0] == a
        alike = not may_be_different_branches(value.motions[a], following.motions[b], distance)
        if mutual or how == BY_NEWTON or alike:
            candidates.append((0 if mutual else 1 if how == BY_NEWTON else 2, a, b))
    for b, (a, how) in enumerate(back):
        alike = not may_be_different_branches(following.motions[b], value.motions[a], distance)
        if how == BY_NEWTON or alike:
            candidates.append((1 if how == BY_NEWTON else 2, a, b))
    pairs: list[tuple[int, int]] = []
    for _, a, b in sorted(candidates):
        if all(a != paired_a and b != paired_b for paired_a, paired_b in pairs):
            pairs.append((a, b))
    return pairs
