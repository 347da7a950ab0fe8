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
            key = features[i].tobytes()
            if key not in index_of:
                motion = self.reconstruct_motion(features[i], ends[i], int(decided[i]))
                index_of[key] = self.find_or_add(motion)
            self.labels[i] = index_of[key]
        irregular = np.flatnonzero(decided == IRREGULAR)
        late = (decided != IRREGULAR) & (starts["periods"] > settings.longest // 2)
        irregular_or_undecided = UNDECIDED if late.any() else IRREGULAR
        groups = irregular_clusters(features[irregular], settings)
        for group in range(int(groups.max(initial=-1)) + 1):
            members = irregular[groups == group]
            _, impacts, xi_rel_max = np.median(features[members, :3], axis=0)
            point, state = self.decider.point, ends[members[:1]]
            gap = xi_rel_max * point.displacement_unit
            motion = SettledMotion(point, irregular_or_undecided, state, 0, float(impacts), gap)
            self.motions.append(motion)
            self.labels[members] = len(self.motions) - 1

    def reconstruct_motion(self, features: Floats, state: Floats, decided: int) -> SettledMotion:
        """Return a start's stored periodic motion: a known one, else solved or simulated anew."""
        decider, n = self.decider, int(features[0])
        known = decider.known_motion_at(state, n)
        if known is None and decided == ORBIT:
            known = decider.find_stable_motion_near(state, n)
        if known is None:
            start_motion(decider.plain, *decider.point, state)
            point, impacts = decider.point, float(features[1])
            states, _ = sample_stroboscopically(decider.plain, point.excitation.period, 0, n)
            gap = float(features[2]) * point.displacement_unit
            known = SettledMotion(point, decided, states.copy(), n, impacts, gap)
            decider.known.append(known)
        return known

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
        decider, faces = self.decider, motion.point.faces_from_states(motion.states[0])
        reached = decider.decide(decider.point.states_from_faces(faces)).motion
        near = decider.settings.neighbour
        if motion.orbit is not None and may_be_different_branches(motion, reached, near):
            continued = decider.continue_orbit(motion)
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


def match_attractors(
    instances: tuple[Instance, EventInstance | None],
    points: Sequence[Point],
    starts: Sequence[Table],
    settings: SettlingSettings,
    seeds: Sequence[Sequence[float]] = (),
) -> tuple[list[list[SettledMotion]], list[list[int]], list[NDArray[np.intp]]]:
    """Group settled starts at all values, continue the attractors to neighbours, number them.

    ``seeds`` are further states at phase 0 of the first value whose attractors are to be found.
    Return of each value the attractors, their numbers along the parameter, and the number of that
    to which each random start leads.
    """
    values = [AttractorsAtValue(MotionDecider(*instances, point, settings)) for point in points]
    for value, starts_there in zip(values, starts, strict=True):
        value.group_starts(starts_there, settings)
    for seed in seeds:
        values[0].find_or_add(values[0].decider.decide(seed).motion)
    links = continue_to_neighbours(values)
    numbers = number_attractors(values, links, settings.neighbour)
    pairs = zip(values, numbers, strict=True)
    labels = [np.array(row, dtype=np.intp)[value.labels] for value, row in pairs]
    return [value.motions for value in values], numbers, labels


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
    ways = [(a, b, how, value.motions[a], following.motions[b]) for a, (b, how) in enumerate(forth)]
    ways += [(a, b, how, following.motions[b], value.motions[a]) for b, (a, how) in enumerate(back)]
    candidates: list[tuple[int, int, int]] = []
    for a, b, how, begun, reached in ways:
        if forth[a][0] == b and back[b][0] == a:
            candidates.append((0, a, b))
        elif how == BY_NEWTON:
            candidates.append((1, a, b))
        elif not may_be_different_branches(begun, reached, distance):
            candidates.append((2, a, b))
    pairs: list[tuple[int, int]] = []
    for _, a, b in sorted(candidates):
        if all(a != paired_a and b != paired_b for paired_a, paired_b in pairs):
            pairs.append((a, b))
    return pairs
