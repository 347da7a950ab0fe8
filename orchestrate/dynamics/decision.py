"""Decide to which motion a response settles; thresholds are those of ``AttractorSettings``.

- It is run on until its state repeats within `converged` and after fewer periods not even within
  `apart` times that, for at most `longest` periods; at their end it may repeat within the latter
  with a deviation that dies: that halves from one stretch to the next.
- It is on an *orbit* that Newton's method finds from its impacts over these periods: a possible
  motion, stable, to which the FMU `returns` with the same impacts, and to which the response, if
  nearer than `near`, comes at least half as fast as the multipliers say, watched over a multiple of
  its own periods, or lies within `same`.
  Within `apart * converged` of an earlier start's orbit, and ever nearer, it is not run on.
- Without such an orbit, states that repeat within `converged` are *repeated*; *undecided* near an
  unstable orbit, or without the impacts that such a motion must have.
- All else is *irregular*, a torus or chaos; undecided if another start repeats only after half of
  `longest`: then it may be a long transient. Irregular motions of starts are joined within
  `alike_irregular`; one that comes later joins the nearest largest gap.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..constants import TURN
from ..errors import FmuError, InputError
from ..fmu import STATE, EventInstance, Instance, sample_stroboscopically, start_motion
from ..model.outcomes import IRREGULAR, ORBIT, REPEATED, UNDECIDED
from ..response.questions import Point
from ..response.respond import Response, simulate_response
from .continuation import SOLVER_ERRORS
from .families import Setting, nonzero_pushes
from .orbit_search import Guess, guess_from_impacts, least_periods, solve_orbit, why_no_motion
from .periodic_orbit import ImpactSequence, PeriodicOrbit
from .settled_motion import Floats, SettledMotion
from .settling import ReachedMotion, SettledResponse, SettlingSettings, run_until_settled
from .turning_points import rotate_to_phase_zero

PIECES = 64  # of a period, among which a stretch without impacts is sought
OTHER_PHASE = 2.4  # rad: where a response is sampled that may repeat, but was not seen to at 0
DYING, ROUNDING = 0.1, 1e-9  # of a deviation: until when it is watched, and what is left


class MotionDecider:
    """Decides to which motions responses at one point settle; remembers the orbits found."""

    def __init__(
        self,
        plain: Instance,
        eventful: EventInstance | None,
        point: Point,
        settings: SettlingSettings,
    ) -> None:
        self.plain, self.eventful, self.point, self.settings = plain, eventful, point, settings
        excitation = vars(point.excitation)
        box = tuple((name, excitation[name]) for name in ("frequency", "amplitude"))
        self.system = Setting.fixed(point.structure, (*box, *nonzero_pushes(excitation)))
        self.values = np.array([point.excitation.frequency])
        self.known: list[SettledMotion] = []

    # -- responses --------------------------------------------------------------------------------

    def decide(self, state: ArrayLike) -> ReachedMotion:
        """Run from a state at phase 0 until its motion is known; return what it has reached."""
        return self.decide_all(np.asarray(state)[np.newaxis])[0]

    def decide_all(self, states: ArrayLike) -> list[ReachedMotion]:
        """Run from states at phase 0, as :meth:`decide` from one."""
        starts, reached = np.asarray(states), list[ReachedMotion]()
        while len(reached) < len(starts):  # each time as many as before: these know the orbits
            batch = starts[len(reached) : 2 * len(reached) + 1]
            orbits = [motion for motion in self.known if motion.decided == ORBIT]
            settled = run_until_settled(self.plain, self.point, batch, self.settings, orbits)
            reached += [
                each if isinstance(each, ReachedMotion) else self.decide_response(each)
                for each in settled
            ]
        return reached

    def decide_response(self, settled: SettledResponse) -> ReachedMotion:
        """Decide the motion of a settled response; run it on where no stable orbit is found."""
        response, done = settled
        settings, near_unstable = self.settings, False
        while True:
            motion, unstable = self.find_periodic_motion(response)
            if motion is not None:
                state = motion.states[motion.nearest_state(response.end)[0]]
                return ReachedMotion(motion, state, settled.periods)
            near_unstable |= unstable
            dropped = min(done, settings.longest - done)
            if dropped <= 0:
                motion = self.motion_without_orbit(response, near_unstable)
                return ReachedMotion(motion, np.array(response.end), settled.periods)
            lengths = dropped, settings.samples
            response = simulate_response(
                self.plain, *self.point, response.end, *lengths, settings.converged
            )
            done += sum(lengths)

    def find_periodic_motion(self, response: Response) -> tuple[SettledMotion | None, bool]:
        """Return a response's known motion or stable orbit, or None and whether one is unstable."""
        n = response.multiplicity
        known = self.known_motion_at(response.end, n) if n else None
        if known is not None:
            return known, False
        unstable = False
        for periods in [n] if n else self.find_periods_at_other_phase(response):
            orbit, free_phase = self.solve_orbit_near(response.end, periods)
            motion = self.motion_if_stable(orbit, free_phase)
            unstable |= orbit is not None and motion is None
            comes = motion is not None and self.converges_to(response.end, motion, periods)
            if motion and comes and self.repeats_in_fmu(motion):
                return self.find_or_add(motion), False
        return None, unstable

    def find_periods_at_other_phase(self, response: Response) -> list[int]:
        """Simulate on, sampled at another phase; return periods after which it may repeat there."""
        settings, excitation = self.settings, self.point.excitation
        self.start(self.plain, response.end)
        self.plain.step(0.0, OTHER_PHASE / excitation.frequency)
        self.start(self.plain, self.plain.get(*STATE), OTHER_PHASE)
        samples = settings.irregular_samples
        states, gap = sample_stroboscopically(self.plain, excitation.period, 0, samples)
        sampled = replace(response, samples=states, x_rel_max=gap)
        close, nearly = settings.converged, settings.apart * settings.converged
        counts = [sampled.find_repetition(tolerance).multiplicity for tolerance in (close, nearly)]
        return [n for n in dict.fromkeys(counts) if n]

    def motion_without_orbit(self, response: Response, near_unstable: bool) -> SettledMotion:
        """Return a new motion for a response without stable orbit; a periodic one is known now."""
        n = response.multiplicity  # by `apart` too: a response that nearly repeats is irregular
        if not n or response.find_repetition(self.settings.converged).multiplicity != n:
            states, impacts = response.samples, response.impacts_per_period
            return SettledMotion(self.point, IRREGULAR, states, 0, impacts, response.x_rel_max)
        states = response.samples[-n:].copy()
        impacts = count_impacts_starting_in_pause(self.plain, self.point, response.end, n) / n
        decided = UNDECIDED if near_unstable or response.lacks_impacts(impacts, n) else REPEATED
        motion = SettledMotion(self.point, decided, states, n, impacts, response.x_rel_max)
        self.known.append(motion)
        return motion

    def start(self, instance: Instance, state: ArrayLike, phase: float = 0.0) -> None:
        """Start a run in a state at a phase of the box, rad."""
        excitation = self.point.excitation.replace(phase=phase % TURN)
        start_motion(instance, self.point.structure, excitation, state)

    # -- known motions ----------------------------------------------------------------------------

    def known_motion_at(self, state: ArrayLike, n: int) -> SettledMotion | None:
        """Return the known motion of ``n`` periods that a state lies on, or converges to."""
        for motion in self.known:
            distance = motion.nearest_state(state)[1]
            within = self.settings.same if motion.decided == ORBIT else self.settings.alike
            if distance < within and motion.multiplicity == n:
                return motion
            near = motion.decided == ORBIT and distance < self.settings.near
            if near and self.converges_to(state, motion, n):
                return motion
        return None

    def find_or_add(self, motion: SettledMotion) -> SettledMotion:
        """Return the known motion with the same orbit, or this one, known from now on."""
        for known in self.known:
            if known.is_same_orbit_as(motion, self.settings.same):
                return known
        self.known.append(motion)
        return motion

    def motion_if_stable(
        self, orbit: PeriodicOrbit | None, free_phase: float
    ) -> SettledMotion | None:
        if orbit is None or not orbit.stable:
            return None
        return SettledMotion.from_orbit(self.point, orbit, free_phase)

    def find_stable_motion_near(self, state: ArrayLike, periods: int) -> SettledMotion | None:
        """Solve for a stable orbit from a state; if the FMU has it, its motion is known now."""
        motion = self.motion_if_stable(*self.solve_orbit_near(state, periods))
        return self.find_or_add(motion) if motion and self.repeats_in_fmu(motion) else None

    def converges_to(self, state: ArrayLike, motion: SettledMotion, n: int) -> bool:
        """Return whether the response from a state, of ``n`` periods so far, comes to an orbit."""
        excitation, periods = self.point.excitation, motion.multiplicity
        self.start(self.plain, state)
        if motion.free_phase > 0.0:
            self.plain.step(0.0, motion.free_phase / excitation.frequency)
        state = self.plain.get(*STATE)
        first, before = motion.nearest_state_at_free_phase(state)
        if before < self.settings.same or not before < self.settings.near:
            return before < self.settings.same
        rate = max(motion.multiplier, 1e-3)
        turns = math.ceil(math.log(DYING) / math.log(rate))
        turns = max(1, min(turns, self.settings.longest // periods))
        whole = n // math.gcd(n, periods)  # what repeats after n periods is as near again after it
        turns = math.ceil(turns / whole) * whole
        self.start(self.plain, state, motion.free_phase)
        self.plain.step(0.0, turns * periods * excitation.period)
        last, after = motion.nearest_state_at_free_phase(self.plain.get(*STATE))
        return last == first and after <= max(0.5 * (1.0 + rate**turns) * before, ROUNDING)

    # -- orbits -----------------------------------------------------------------------------------

    def solve_orbit_near(
        self, state: ArrayLike, periods: int
    ) -> tuple[PeriodicOrbit | None, float]:
        """Solve for an orbit from a state's impacts; return it, or None, and its free phase."""
        if self.eventful is None:
            return None, 0.0
        guess, free_phase = self.guess_and_free_phase(np.array(state), periods)
        return self.solve_possible_orbit(guess), free_phase

    def solve_possible_orbit(self, guess: Guess) -> PeriodicOrbit | None:
        """Return the orbit, of least period, that Newton's method finds, if a motion can be it."""
        if len(guess[0].kinds) > self.settings.max_nodes:
            return None
        try:
            family, root = solve_orbit(self.system, guess, self.values)
        except SOLVER_ERRORS:
            return None
        orbit = family.orbit(root.unknowns)
        if root.residual > self.settings.residual or why_no_motion(orbit):
            return None
        return reduce_to_least_period(orbit)

    def guess_and_free_phase(self, state: Floats, periods: int) -> tuple[Guess, float]:
        """Run the FMU from a state; return its impacts as a guess, from an impact-free phase on."""
        instance, frequency = self.eventful, self.point.excitation.frequency
        assert instance is not None
        form, span = self.system.closed_form(self.values), periods * self.point.excitation.period
        self.start(instance, state)
        times = instance.record_impacts(0.0, span).time
        if not len(times):
            return (ImpactSequence(periods, ()), np.zeros((0, 4))), 0.0
        stretches = np.diff(np.append(times, times[0] + span))
        longest = int(stretches.argmax())
        free_time = float(times[longest] + 0.5 * stretches[longest]) % span
        self.start(instance, state)
        if free_time > 0.0:
            instance.record_impacts(0.0, free_time)
        impacts = instance.record_impacts(free_time, free_time + span)
        return guess_from_impacts(impacts, self.point, form, periods), frequency * free_time

    def continue_orbit(self, motion: SettledMotion) -> SettledMotion | None:
        """Continue an orbit of a neighbouring value to this one; None if not stable here."""
        if motion.orbit is None or self.eventful is None:
            return None
        orbit = self.solve_possible_orbit((motion.orbit.sequence, motion.orbit.nodes))
        continued = self.motion_if_stable(orbit, phase_far_from_impacts(orbit) if orbit else 0.0)
        if continued is None or not self.fmu_stays_on(continued):
            return None
        state = continued.states[0]
        # with the impacts of the FMU
        own = self.find_stable_motion_near(state, continued.multiplicity)
        return own if own is not None and own.nearest_state(state)[1] < self.settings.same else None

    def fmu_stays_on(self, motion: SettledMotion) -> bool:
        """Return whether the FMU, started at the orbit's free phase, is there again a round on."""
        try:
            self.start(self.plain, motion.states_at_free_phase[0], motion.free_phase)
        except (FmuError, InputError):  # in contact the masses overlap within rounding
            return False
        self.plain.step(0.0, motion.multiplicity * self.point.excitation.period)
        return motion.nearest_state_at_free_phase(self.plain.get(*STATE))[1] < self.settings.same

    def repeats_in_fmu(self, motion: SettledMotion) -> bool:
        """Return whether the FMU, started on an orbit, has its impacts and comes back to it."""
        # by `gamma` chattering may have an impact more or less: a root that is no motion of the FMU
        instance, orbit, nearest = self.eventful, motion.orbit, motion.nearest_state_at_free_phase
        assert instance is not None and orbit is not None, "no orbit"
        free_time = motion.free_phase / self.point.excitation.frequency
        end = free_time + motion.multiplicity * self.point.excitation.period
        try:
            self.start(instance, motion.states[0])
        except (FmuError, InputError):  # in contact the masses overlap within rounding
            return False
        if free_time > 0.0:
            instance.record_impacts(0.0, free_time)
        first = nearest(instance.read(*STATE))[0]
        impacts = len(instance.record_impacts(free_time, end).time)
        last, away = nearest(instance.read(*STATE))
        has_impacts = impacts == orbit.sequence.impact_count
        return has_impacts and last == first and away < self.settings.returns


def reduce_to_least_period(orbit: PeriodicOrbit) -> PeriodicOrbit:
    """Return an orbit reduced to its least period, if it repeats within its period."""
    periods, least = orbit.sequence.periods, least_periods(orbit)
    if least == periods:
        return orbit
    sequence, nodes = rotate_to_phase_zero(orbit.sequence, orbit.nodes)
    count = len(nodes) * least // periods
    return PeriodicOrbit(ImpactSequence(least, sequence.kinds[:count]), orbit.form, nodes[:count])


def phase_far_from_impacts(orbit: PeriodicOrbit) -> float:
    """Return the phase, rad, in the middle of the orbit's longest time without impact."""
    if not orbit.node_count:
        return 0.0
    longest = int(orbit.durations.argmax())
    middle = 0.5 * (orbit.begin_phases[longest] + orbit.end_phases[longest])
    return float(middle % (TURN * orbit.sequence.periods))


def count_impacts_starting_in_pause(
    instance: Instance, point: Point, state: ArrayLike, periods: int
) -> int:
    """Count a response's impacts over some periods, from its longest time without impacts on."""
    start_motion(instance, *point, state)
    width = point.excitation.period / PIECES
    counts = [0]
    for piece in range(periods * PIECES):
        instance.step(piece * width, (piece + 1) * width)
        counts += instance.get("impact_count")
    middle = middle_of_longest_run(np.diff(counts) == 0)
    start_motion(instance, *point, state)
    first = (middle + 0.5) * width
    instance.step(0.0, first)
    (before,) = instance.get("impact_count")
    instance.step(first, first + periods * PIECES * width)
    (after,) = instance.get("impact_count")
    return int(after - before)


def middle_of_longest_run(flags: NDArray[np.bool_]) -> int:
    """Return the index in the middle of the longest cyclic run of True; 0 without any."""
    if flags.all() or not flags.any():
        return 0
    first = int(np.flatnonzero(~flags)[0])
    rolled = np.roll(flags, -first)  # begins with a false one
    edges = np.diff(np.concatenate([rolled, [False]]).astype(int))
    begins, ends = np.flatnonzero(edges == 1) + 1, np.flatnonzero(edges == -1) + 1
    longest = int((ends - begins).argmax())
    return int((begins[longest] + ends[longest] - 1) // 2 + first) % len(flags)
