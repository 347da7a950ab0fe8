"""What responses settle to: known orbits, copies, long transients, impacts at the sampled phase."""

from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate import orbit
from orchestrate.constants import TURN
from orchestrate.dynamics import decision
from orchestrate.dynamics.attractors import attractors
from orchestrate.dynamics.decision import (
    MotionDecider,
    count_impacts_starting_in_pause,
    middle_of_longest_run,
    phase_far_from_impacts,
)
from orchestrate.dynamics.settling import ReachedMotion, run_until_settled
from orchestrate.fmu import OSCILLATOR, REST, EventInstance, Instance, find_or_export
from orchestrate.model import Excitation, Structure
from orchestrate.model.outcomes import IRREGULAR, ORBIT, REPEATED, UNDECIDED
from orchestrate.response.questions import Point
from orchestrate.response.sweep import sweep

from .single_impact import border
from .test_closed_form import random_orbit
from .test_settling import settling_run

PAPER = Structure.nondimensional()
USUAL = settling_run()
# chattering ends where the next flight lasts less than 1e-4
LAST = {"gamma": 1e-4 / (1.0 - 0.4291)}
CONTACT = Structure.nondimensional(mu=2.1943, kappa=0.4061, D=0.0116, e=0.4291, **LAST)
HEAVY = Structure.nondimensional(mu=3.0755, kappa=0.54559, D1=0.01281, D2=0.01196, e=0.30528)
HEAVY = HEAVY.replace(gamma=1e-4 / (1.0 - 0.30528))

pytestmark = pytest.mark.usefixtures("exported")


def point_of(structure, eta):
    return Point(structure, Excitation.nondimensional(eta, structure))


MIDDLES = {"0110": 1, "10011": 4, "1110011": 0, "0000": 0, "1111": 0, "0011111000": 4, "0111010": 2}


@pytest.mark.parametrize(("flags", "expected"), MIDDLES.items())
def test_the_middle_of_the_longest_run_on_a_ring(flags, expected):
    assert middle_of_longest_run(np.array([letter == "1" for letter in flags])) == expected


def test_impacts_are_counted_from_a_pause(monkeypatch):
    """One a period, that comes now a little later, now a little earlier."""
    point, now = Point(PAPER, Excitation(frequency=TURN, amplitude=1.0)), [0.0]
    times = np.arange(3) + 1.0 / 128 + 1e-9 * np.array([1, -1, 1])
    instance = SimpleNamespace(
        step=lambda begin, end: now.__setitem__(0, end),
        get=lambda name: [np.count_nonzero(times <= now[0])],
    )
    monkeypatch.setattr(decision, "start_motion", lambda *asked: None)
    assert count_impacts_starting_in_pause(instance, point, REST, 1) == 1


def test_starts_that_come_to_a_known_orbit_are_not_run_on(instances):
    """They lead where they lead alone."""
    gap, rate = np.random.default_rng(3).uniform([[0.0], [-1.3]], 1.3, (2, 12)) / 2.0
    starts = np.column_stack([-gap, gap, -rate, rate])
    alone = [decided_from(PAPER, 1.315, start)[0] for start in starts]
    decider = MotionDecider(*instances, point_of(PAPER, 1.315), USUAL)
    together = decider.decide_all(starts)
    again = run_until_settled(decider.plain, decider.point, starts, USUAL, decider.known)
    assert len({motion.multiplicity for motion in alone}) == 2
    for one, (motion, state, _) in zip(alone, together, strict=True):
        assert motion.multiplicity == one.multiplicity
        assert motion.nearest_state(one.state_of_least_x1)[1] < 1e-9
        assert (motion.states == state).all(axis=1).any()
    assert all(isinstance(each, ReachedMotion) for each in again)
    assert [each.motion for each in again] == [motion for motion, *_ in together]


class Scripted(MotionDecider):
    """Known motions at some distance, that a response comes to or does not, and runs of no FMU."""

    def __init__(self, comes=False, path=(), places=(0, 0), **settings):
        self.settings, self.known, self.comes = settling_run(**settings), [], comes
        self.path = iter(path)  # distances from a motion, now and later
        self.places = iter(places)  # and which of its states is nearest
        self.steps = []
        self.plain = SimpleNamespace(
            step=lambda begin, end: self.steps.append(end - begin), get=lambda *names: None
        )
        self.eventful, self.point = None, point_of(PAPER, 1.2)
        self.values, self.system = np.array([1.2]), None

    def motion(self, distance=0.0, decided=ORBIT, multiplicity=1, multiplier=0.5):
        return SimpleNamespace(
            nearest_state=lambda state: (0, distance),
            nearest_state_at_free_phase=lambda state: (next(self.places), next(self.path)),
            decided=decided, multiplicity=multiplicity, multiplier=multiplier, free_phase=0.0,
            states_at_free_phase=[None],
        )  # fmt: skip

    def converges_to(self, state, motion, n):
        return self.comes

    def start(self, instance, state, phase=0.0):
        pass


@pytest.mark.parametrize(
    ("decided", "distance", "comes", "known"),
    [
        *((ORBIT, 0.99e-5, False, True), (ORBIT, 1.01e-5, False, False)),  # `same`
        *((REPEATED, 0.0199, False, True), (REPEATED, 0.0201, True, False)),  # `alike`
        *((ORBIT, 0.099, True, True), (ORBIT, 0.101, True, False), (ORBIT, 0.05, False, False)),
    ],
)
def test_each_threshold_of_a_known_motion(decided, distance, comes, known):
    decider = Scripted(comes)
    motion = decider.motion(distance, decided)
    decider.known = [motion]
    assert comes or decider.known_motion_at(REST, 2) is None
    assert (decider.known_motion_at(REST, 1) is motion) == known


@pytest.mark.parametrize(
    ("before", "after", "comes"),
    [
        *((0.99e-5, 1.0, True), (1.01e-5, 1.0, False)),  # it is there: `same`
        *((0.099, 0.0, True), (0.101, 0.0, False)),  # `near`
        # after four periods 1/16 is left: at least half as fast is less than 17/32
        *((0.05, 0.05 * 16.9 / 32.0, True), (0.05, 0.05 * 17.1 / 32.0, False)),
    ],
)
def test_each_threshold_of_a_response_that_comes_to_an_orbit(before, after, comes):
    decider = Scripted(path=(before, after))
    assert MotionDecider.converges_to(decider, REST, decider.motion(), 1) == comes
    periods = sum(decider.steps) / decider.point.excitation.period
    assert not decider.steps or periods == pytest.approx(4.0)  # a tenth is left by then


@pytest.mark.parametrize(
    ("script", "multiplier", "comes"),
    [
        # to another of its states: one of 6 periods is nearer to one of 32 at some phases
        *(({"path": (0.05, 0.01), "places": (1, at)}, 0.5, at == 1) for at in (1, 2)),
        # what rounding leaves of a deviation does not count
        ({"path": (1e-9, 0.99e-9), "same": 1e-12}, 1e-9, True),
        ({"path": (1e-9, 1.01e-9), "same": 1e-12}, 1e-9, False),
    ],
)
def test_where_a_response_is_after_it_has_been_watched(script, multiplier, comes):
    decider = Scripted(**script)
    motion = decider.motion(multiplier=multiplier)
    assert MotionDecider.converges_to(decider, REST, motion, 1) == comes


@pytest.mark.parametrize(
    ("multiplier", "n", "longest", "periods", "own"),
    [
        # of 22 a tenth is left
        *((0.999, 2, 7, 6, 1), (0.999, 8, 7, 8, 1), (0.9, 1, 99, 22, 1), (1e-9, 1, 99, 1, 1)),
        # of what repeats after 2 or 3 periods one state is nearer to another motion than the next
        *((1e-9, 1, 99, 2, 2), (0.9, 1, 99, 24, 3), (0.9, 2, 99, 44, 4), (1e-9, 6, 99, 6, 3)),
    ],
)
def test_how_long_a_response_is_watched(multiplier, n, longest, periods, own):
    turns = Scripted(path=(0.05, 0.0), longest=longest)
    motion = turns.motion(multiplier=multiplier, multiplicity=n)
    MotionDecider.converges_to(turns, REST, motion, own)
    assert turns.steps == [pytest.approx(periods * turns.point.excitation.period)]


def test_starts_are_compared_with_known_orbits_alone(monkeypatch):
    decider = Scripted()
    decider.known = [decider.motion(decided=decided) for decided in (ORBIT, REPEATED)]
    reached = ReachedMotion(decider.known[0], np.zeros(4), 3)
    settled = lambda *asked: [reached if asked[-1] == decider.known[:1] else None]  # noqa: E731
    monkeypatch.setattr(decision, "run_until_settled", settled)
    assert decider.decide_all([REST])[0] is reached


@pytest.mark.parametrize(("comes", "repeats"), [(True, True), (False, True), (True, False)])
def test_a_response_has_an_orbit_that_it_comes_to_and_the_fmu_repeats(comes, repeats):
    decider = Scripted(comes)
    motion = decider.motion()
    decider.solve_orbit_near = lambda *asked: (motion, 0.0)
    decider.motion_if_stable = lambda *orbit: motion
    decider.repeats_in_fmu, decider.find_or_add = lambda motion: repeats, lambda motion: motion
    response = SimpleNamespace(multiplicity=1, end=REST)
    assert decider.find_periodic_motion(response) == (motion if comes and repeats else None, False)


@pytest.mark.parametrize("seed", range(6))
def test_an_orbit_begins_as_far_from_its_impacts_as_may_be(seed):
    orbit = random_orbit(seed)
    span, phases = TURN * orbit.sequence.periods, orbit.nodes[:, 0]
    stretches = np.diff(np.append(phases, phases[0] + span))
    away = np.abs((phase_far_from_impacts(orbit) - phases + 0.5 * span) % span - 0.5 * span)
    assert away.min() == pytest.approx(0.5 * stretches.max())


def test_an_impact_at_the_sampled_phase_does_not_matter():
    eta = border(1, 2.09, 2.097, lambda found: np.sin(found.phase), e=0.5)
    for beside in (0.0, 1e-12, -1e-12, 1e-9):
        found = attractors(PAPER.replace(e=0.5), eta=eta + beside, starts=8)
        assert told(found) == [(1.0, 1.0)]


@pytest.mark.parametrize(("away", "stays"), [(0.99e-5, True), (1.01e-5, False)])
def test_each_threshold_of_a_run_that_stays_on_an_orbit(away, stays):
    decider = Scripted(path=(away,))
    assert decider.fmu_stays_on(decider.motion()) == stays


@pytest.mark.parametrize(
    ("away", "impacts", "period", "repeats"),
    [(0.99e-6, 1, 0, True), (1.01e-6, 1, 0, False), (0.0, 2, 0, False), (0.0, 1, 1, False)],
)
def test_an_orbit_is_one_to_which_the_fmu_returns(away, impacts, period, repeats):
    """`returns`, with the same impacts and in the same period."""
    decider = Scripted()
    found = SimpleNamespace(time=[0.0] * impacts)
    runs = {"record_impacts": lambda begin, end: found, "read": lambda *names: None}
    decider.eventful = SimpleNamespace(**runs)
    motion, ends = decider.motion(), iter([(0, 1.0), (period, away)])
    motion.orbit = SimpleNamespace(sequence=SimpleNamespace(impact_count=1))
    motion.states, motion.nearest_state_at_free_phase = [REST], lambda state: next(ends)
    assert decider.repeats_in_fmu(motion) == repeats


@pytest.mark.parametrize(
    ("changes", "continued"),
    [
        *(({}, True), ({"own": 1.01e-5}, False), ({"own": None}, False)),  # `same`
        *(({"stable": False}, False), ({"stays": False}, False)),
        *(({"orbit": None}, False), ({"eventful": None}, False)),
    ],
)
def test_an_orbit_goes_on_at_a_neighbour_if_it_is_stable_and_the_fmu_has_it(changes, continued):
    given = {"own": 0.99e-5, "stable": True, "stays": True, "eventful": ""}
    given |= {"orbit": SimpleNamespace(sequence=None, nodes=None), **changes}
    decider, own = Scripted(), given["own"] and Scripted().motion(given["own"])
    motion = decider.motion()
    motion.states, motion.orbit, decider.eventful = [REST], given["orbit"], given["eventful"]
    decider.solve_possible_orbit = lambda guess: None
    decider.motion_if_stable = lambda *orbit: motion if given["stable"] else None
    decider.fmu_stays_on = lambda motion: given["stays"]
    decider.find_stable_motion_near = lambda *asked: own
    assert decider.continue_orbit(motion) is (own if continued else None)


@pytest.mark.parametrize(
    ("times", "begun"), [([], 0.0), ([0.5, 3.5], 2.0), ([4.0, 5.0], 1.5), ([1.0, 2.5], 4.75)]
)
def test_a_guess_begins_in_the_middle_of_the_longest_pause(monkeypatch, times, begun):
    """Of a period of 6, also across its end."""
    decider, spans = Scripted(), []
    decider.point = Point(PAPER, Excitation(frequency=TURN / 6.0, amplitude=1.0))
    decider.system = SimpleNamespace(closed_form=lambda values: None)
    found = SimpleNamespace(time=np.array(times))
    decider.eventful = SimpleNamespace(record_impacts=lambda *span: spans.append(span) or found)
    monkeypatch.setattr(decision, "guess_from_impacts", lambda *given: given[0])
    guess, phase = decider.guess_and_free_phase(np.array(REST), 1)
    assert phase == pytest.approx(TURN / 6.0 * begun)
    assert times or (guess[0].periods, guess[0].kinds, guess[1].shape) == (1, (), (0, 4))
    ends = [(0.0, 6.0), (0.0, begun), (begun, 6.0 + begun)]
    assert spans == [pytest.approx(each) for each in ends[: 3 if times else 1]]


@pytest.mark.parametrize(
    ("nodes", "residual", "found"),
    [(400, 0.99e-9, True), (401, 0.99e-9, False), (400, 1.01e-9, False)],
)
def test_each_threshold_of_newtons_method(monkeypatch, nodes, residual, found):
    family = SimpleNamespace(orbit=lambda unknowns: "orbit")
    root = SimpleNamespace(unknowns=None, residual=residual)
    monkeypatch.setattr(decision, "solve_orbit", lambda *asked: (family, root))
    monkeypatch.setattr(decision, "why_no_motion", lambda orbit: "")
    monkeypatch.setattr(decision, "reduce_to_least_period", lambda orbit: orbit)
    guess = SimpleNamespace(kinds=range(nodes)), None
    assert (Scripted().solve_possible_orbit(guess) is not None) == found


def decided_from(structure, eta, start=REST, settings=USUAL, form="fmi3"):
    path = find_or_export(OSCILLATOR, form=form).path
    with Instance(path) as plain, EventInstance(find_or_export(OSCILLATOR).path) as eventful:
        events = eventful if form == "fmi3" else None
        decider = MotionDecider(plain, events, point_of(structure, eta), settings)
        return decider.decide(start)[:2]


def told(data):
    """Multiplicity and impacts of all attractors at the only value."""
    here = data.isel({next(iter(data.number.dims)): 0})
    n = here.multiplicity.values
    return sorted(zip(n.tolist(), (n * here.impacts_per_period.values).tolist(), strict=True))


FOUND = {
    "11T once": (CONTACT, 3.0952, {"starts": 60, "seed": 3}, [(2, 1), (11, 32)]),
    "no 5T with 8 impacts": (HEAVY, 2.67054, {"starts": 60}, [(2, 1), (5, 9)]),
}


@pytest.mark.parametrize("name", FOUND)
def test_attractors_are_those_that_newtons_method_confirms(name):
    structure, eta, asked, expected = FOUND[name]
    found = attractors(structure, eta=eta, **asked)
    assert told(found) == [tuple(map(float, pair)) for pair in expected]
    for k in range(found.sizes["attractor"]):
        one = found.isel(eta=0, attractor=k)
        n = int(one.multiplicity)
        confirmed = orbit(structure, eta=eta, period=n, guess=one.state.values)
        assert bool(confirmed.stable)
        assert np.isfinite(confirmed.impact_time).sum() == n * float(one.impacts_per_period)
        sizes = np.hypot(*confirmed.multipliers.transpose("part", "multiplier").values)
        assert float(one.multiplier) == pytest.approx(sizes.max(), rel=1e-6)
        assert int(one.decided_by) == ORBIT


@pytest.mark.parametrize(("eta", "e"), [(0.4, 0.7), (0.6, 0.2), (0.6, 0.0)])
def test_chattering_that_ends_in_contact_is_decided_by_its_orbit(eta, e):
    structure = PAPER.replace(e=e)
    motion, state = decided_from(structure, eta)
    confirmed = orbit(structure, eta=eta, guess=state)
    assert (motion.decided, motion.multiplicity) == (ORBIT, 1)
    assert motion.impacts_per_period == np.isfinite(confirmed.impact_time).sum()


def test_impacts_are_whole_numbers_from_whatever_period_one_counts(instances):
    motion, _ = decided_from(CONTACT, 3.0952, settings=settling_run(transient=2000))
    assert motion.multiplicity in (2, 11)
    counts = {
        count_impacts_starting_in_pause(instances[0], motion.point, state, motion.multiplicity)
        for state in motion.states
    }
    assert counts == {round(motion.impacts_per_period * motion.multiplicity)}


def test_an_fmu_without_events_decides_by_repeated_states():
    motion, _ = decided_from(PAPER, 1.315, form="fmi2", settings=settling_run(longest=1500))
    other, _ = decided_from(PAPER, 1.315)
    assert (motion.decided, other.decided) == (REPEATED, ORBIT)
    assert motion.features == pytest.approx(other.features, rel=1e-4)


def test_what_stays_near_an_unstable_orbit_is_undecided_and_settles_when_run_on():
    """At D = 0.05 T/1 is unstable at 1.116: deviations take thousands of periods to grow."""
    damped = PAPER.replace(D=0.05)
    near = sweep(damped, eta=1.115, transient=3000, samples=10).end_state.values[0]
    start = orbit(damped, eta=1.116, guess=near).state.values[0]
    short = settling_run(transient=100, settle=1.0, longest=300)
    early, _ = decided_from(damped, 1.116, start, short)
    late, _ = decided_from(damped, 1.116, near)
    assert (early.decided, early.impacts_per_period) == (UNDECIDED, 1.0)
    assert (late.decided, late.multiplicity, late.impacts_per_period) == (ORBIT, 2, 1.5)


def test_a_torus_and_chaos_are_irregular():
    for eta in (2.655, 0.8):
        motion, _ = decided_from(PAPER, eta)
        assert (motion.decided, motion.multiplicity) == (IRREGULAR, 0)
        assert np.isnan(motion.multiplier)
