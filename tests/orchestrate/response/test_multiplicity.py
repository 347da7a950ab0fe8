"""Multiplicity of sequences whose answer is known."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fmu_src.kernels import repetition
from orchestrate.dynamics.continuation import NoConvergenceError
from orchestrate.dynamics.families import Setting
from orchestrate.dynamics.orbit_search import (
    least_periods,
    simulate_guess,
    solve_orbit,
    why_no_motion,
)
from orchestrate.dynamics.turning_points import stroboscopic_states
from orchestrate.fmu import OSCILLATOR, EventInstance, Instance, find_or_export
from orchestrate.model import Excitation
from orchestrate.model.outcomes import IRREGULAR, REPEATED, UNDECIDED
from orchestrate.response.multiplicity import Decision, call_repetition_kernel, find_repetition
from orchestrate.response.questions import Point
from orchestrate.response.respond import simulate_response

from ...draws import draw_structure
from ...sparing import ordinary

TOLERANCE = 1e-2
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def memory_of(samples, frequency=1.0, gap=1.0):
    """The kernel's memory of states, as the loop fills it."""
    memory = [0.0] * repetition.memory_size(len(samples))
    memory[: repetition.MULTIPLICITY] = len(samples), frequency, gap, TOLERANCE
    memory[repetition.HEAD : repetition.HEAD + samples.size] = samples.ravel().tolist()
    return memory


def decide(samples, frequency=1.0, gap=1.0):
    """What the rule decides, compiled and in Python."""
    memory = memory_of(samples, frequency, gap)
    repetition.write_decided_multiplicity(memory, 0.0)
    compiled = call_repetition_kernel("decide_multiplicity", samples, (frequency, gap, TOLERANCE))
    found = Decision(*(int(compiled[i]) for i in (repetition.MULTIPLICITY, repetition.DECIDED)))
    assert found == (memory[repetition.MULTIPLICITY], memory[repetition.DECIDED])
    repetition.write_least_multiplicity(memory, 0.0)
    repeated = memory[repetition.MULTIPLICITY], memory[repetition.DEVIATION]
    assert find_repetition(samples, frequency, gap, TOLERANCE) == repeated
    return found


@st.composite
def orbits(draw, longest=12):
    """One period of distinct states of four co-ordinates, well apart for the tolerance."""
    n = draw(st.integers(1, longest))
    order = draw(st.permutations(range(n)))
    scale = draw(st.floats(1e-6, 1e6))
    parts = draw(st.permutations([1.0, 0.5, -0.1, 0.0]))
    return np.outer([1.0 + 0.1 * k for k in order], scale * np.array(parts))


def four(*columns):
    """States whose other co-ordinates are at rest."""
    states = np.zeros((len(columns[0]), 4))
    states[:, : len(columns)] = np.transpose(columns)
    return states


def repeat(orbit, length):
    return np.tile(orbit, (length // len(orbit) + 1, 1))[:length]


@given(st.integers(0, 1000), st.integers(-200, 200))
def test_nothing_depends_on_the_amplitude(seed, power):
    samples = np.random.default_rng(seed).normal(size=(40, 4))
    scale = 2.0**power
    once = find_repetition(samples, 1.7, 0.3, 1e3)
    assert find_repetition(scale * samples, 1.7, scale * 0.3, 1e3) == once
    later = samples[20:] / (1.0, 1.0, 1.7, 1.7)
    gap, rate = (later[:, 2 * i + 1] - later[:, 2 * i] for i in (0, 1))
    parts = [*(later.T / np.abs(later).max()), gap / 0.3, rate / max(0.3, np.abs(rate).max())]
    assert once == (1, np.abs(np.diff(parts)).max())


def states_of(deviation, count=200, of_velocity=np.zeros_like):
    """A response with some deviations of mass 1, of a motion of size 1 to 2."""
    n = np.arange(count)
    samples = np.tile([0.2, 0.8, 2.0, -1.0], (count, 1))
    samples[:, 0] += deviation(n)
    samples[:, 2] += of_velocity(n)
    return samples


@given(orbits(), st.integers(0, 60), st.floats(0.5, 0.9))
def test_what_has_died_or_dies_fast_has_repeated(orbit, more, multiplier):
    samples = repeat(orbit, 8 * len(orbit) + more + 40)
    rest = 1e-3 * np.abs(orbit).max() * multiplier ** np.arange(len(samples))
    n, decided = decide(samples + rest[:, None], gap=2.0 * np.abs(samples).max())
    assert n == len(orbit)
    assert decided == REPEATED


def scaled(run):
    """The kernel's memory of scaled states, a row for each of six co-ordinates."""
    head, count = [0.0] * repetition.HEAD, run.shape[1]
    head[repetition.LATER], head[repetition.AWAY] = count, repetition.HEAD + run.size
    return [*head, *run.ravel().tolist(), *[0.0] * count]


def spread(run, n):
    """How far states a multiple of n periods apart lie apart."""
    return max(np.ptp(run[:, k::n], axis=1).max() for k in range(min(n, run.shape[1])))


@given(st.integers(1, 60), st.integers(0, 60), st.integers(0, 2**32 - 1))
@example(5, 40, 1)  # seen often enough, by little
@example(5, 30, 1)
def test_deviations_and_spreads_are_numpys(n, more, seed):
    count = n + 2 + more
    run = np.random.default_rng(seed).uniform(-1.0, 1.0, (6, count))
    m, half = scaled(run), count // 2
    away = np.abs(run[:, n:] - run[:, :-n]).max(axis=0)
    assert repetition.measure_deviations(m, n) == away.max()
    assert m[int(m[repetition.AWAY]) :][: count - n] == away.tolist()
    some = max(1, (count - n) // 2)
    assert repetition.deviation_growth(m, count - n) == away[-some:].max() / away[:some].max()
    assert repetition.spread_over_returns(m, 0, count, n) == spread(run, n)
    if 4 * n <= half:
        late, early = spread(run[:, count - half :], n), spread(run[:, :half], n)
        assert repetition.contraction_ratio(m, n) == late / early
    parts = [part.max() for part in np.array_split(away, 5) if len(part)]
    if 4 * n > half:
        dies = len(away) >= 5 and (np.diff(parts) < 0.0).all()
        expected = repetition.deviation_growth(m, count - n) if dies else 1.0
        assert repetition.contraction_ratio(m, n) == expected


@pytest.mark.parametrize("late", range(20))
def test_a_deviation_that_is_seen_a_few_times_dies_from_part_to_part(late):
    """22 of them in fifths of five, five, four, four and four; one is as high as 0.9."""
    steps = np.repeat([1.0, 0.8, 0.6, 0.4, 0.2], [5, 5, 4, 4, 4])
    steps[late] = 0.9 if late else 1.0
    run = np.zeros((6, 40))
    for k in range(22):
        run[0, k + 18] = run[0, k] + steps[k]
    ratio = repetition.contraction_ratio(scaled(run), 18)
    dies = late < 10  # up to 1 before
    first, last = steps[:11].max(), steps[11:].max()
    assert ratio == pytest.approx(last / first if dies else 1.0)


@pytest.mark.parametrize(("early", "late"), [(0.0, 1.0), (1.0, 0.0), (0.0, 0.0)])
def test_a_ratio_to_nothing_is_none(early, late):
    run = np.zeros((6, 9))
    run[0, 1:5], run[0, 5:] = early * np.arange(1.0, 5.0), 4.0 * early + late * np.arange(1.0, 5.0)
    m = scaled(run)
    repetition.measure_deviations(m, 1)
    assert repetition.deviation_growth(m, 8) == 1.0
    assert early or repetition.contraction_ratio(scaled(run[:, :1].repeat(20, axis=1)), 1) == 1.0


@pytest.mark.parametrize(
    ("growth", "more"), [(1.051, False), (1.0515, True), (1 / 1.051, False), (1 / 1.0515, True)]
)
def test_what_is_more_than_chance(growth, more):
    assert repetition.is_beyond_chance(growth) == more


@pytest.mark.parametrize("ratio", [0.5, 0.79, 0.81])
def test_what_is_left_of_a_deviation_that_dies_is_a_geometric_series(ratio):
    """From the earlier half of 80 samples to the later one it shrinks by a ratio."""
    steps = ratio ** (np.arange(81) / 40.0)
    run = np.zeros((6, 80))
    run[2] = steps[:80]
    moved = 1.0 - steps[80]  # what is left after as long again and again is that part of it
    left = moved * sum(steps[80] ** k for k in range(1, 400)) if ratio < 0.8 else np.inf
    assert repetition.estimate_remaining_drift(scaled(run), 1, moved) == pytest.approx(left)


@pytest.mark.parametrize(
    ("period", "n", "minimum", "decay", "differ"),
    [
        *((1, 2, 0.1, 1.0, False), (2, 2, 0.99, 1.0, True), (2, 2, 1.01, 1.0, False)),
        *((2, 4, 0.1, 1.0, False), (4, 4, 0.1, 1.0, True), (3, 3, 0.1, 1.0, True)),
        *((1, 3, 0.1, 1.0, False), (1, 1, 0.1, 1.0, True), (2, 2, 0.1, 0.99, False)),
        *((6, 6, 0.1, 1.0, True), (3, 6, 0.1, 1.0, False), (2, 6, 0.1, 1.0, False)),
    ],
)
def test_a_difference_of_parts_of_a_period_stays(period, n, minimum, decay, differ):
    """At least 1 apart, for all divisors of n."""
    run = np.zeros((6, 48))
    run[1] = (np.arange(48) % period) ** 1.5 * decay ** np.arange(48)
    assert repetition.has_persistent_difference(scaled(run), n, minimum) == differ


@pytest.mark.parametrize(
    ("apart", "drift", "expected"),
    [
        *((0.99e-9, 0.0, (1, REPEATED)), (1.01e-9, 0.0, (1, UNDECIDED))),  # `ROUNDING`
        *((3.99e-9, 0.0, (1, UNDECIDED)), (4.01e-9, 0.0, (2, REPEATED))),  # four times as much
        *((8.9e-6, 0.9e-9, (1, UNDECIDED)), (9.1e-6, 0.9e-9, (2, REPEATED))),  # `MAX_DRIFT`
    ],
)
def test_each_threshold_of_a_narrow_period_doubling(apart, drift, expected):
    side = lambda n: 0.5 * apart * (-1.0) ** n + drift * n / 98.0  # noqa: E731
    assert decide(states_of(side)) == expected


def test_the_best_guess_is_no_longer_than_what_nearly_repeats():
    """To and fro by 0.6 of the tolerance; after two periods a deviation is seen to die."""
    side = lambda n: TOLERANCE * (0.3 * (-1.0) ** n + 0.75 * 0.7 ** (n / 50.0 - 2.0))  # noqa: E731
    assert decide(states_of(side)) == (1, UNDECIDED)


@pytest.mark.parametrize(("growth", "expected"), [(1.06, (10, UNDECIDED)), (1.045, (0, IRREGULAR))])
def test_what_drifts_steadily_is_irregular(growth, expected):
    """Of ten periods, by half the tolerance; from the 45 earlier deviations to the later ones."""
    n, rate = np.arange(200), growth ** (1.0 / 45.0)
    drift = 4.5 * TOLERANCE / (rate**10 - 1.0) * rate ** (n - 100.0)
    assert decide(four(n % 10, drift), gap=9.0) == expected


@pytest.mark.parametrize(("part", "expected"), [(0.99, REPEATED), (1.01, UNDECIDED)])
def test_a_period_that_is_seen_a_few_times_repeats_to_a_thousandth_of_the_tolerance(part, expected):
    samples = repeat(np.random.default_rng(4).uniform(-1.0, 1.0, (14, 4)), 60)
    samples[55, 0] += part * 1e-3 * TOLERANCE * np.abs(samples[30:]).max()
    assert decide(samples, gap=9.0) == (14, expected)


@given(st.integers(0, 2**32 - 1))
def test_the_nearest_state_is_numpys(seed):
    rng = np.random.default_rng(seed)
    states, given, frequency, gap = rng.normal(size=(9, 4)), rng.normal(size=4), 1.7, 0.9
    m = memory_of(states, frequency, gap)
    m[repetition.GIVEN : repetition.HEAD] = given.tolist()
    repetition.write_nearest_state(m, 0.0)
    unit = np.array([1.0, 1.0, frequency, frequency])
    sized, other = states / unit, given / unit
    size, rates = np.abs(sized).max(), sized[:, 3] - sized[:, 2]
    off = np.abs(sized - other) / size
    apart = np.abs((sized[:, 1] - sized[:, 0]) - (other[1] - other[0])) / gap
    faster = np.abs(rates - (other[3] - other[2])) / max(gap, np.abs(rates).max())
    distance = np.column_stack([off, apart, faster]).max(axis=1)
    assert m[repetition.NEAREST] == distance.argmin()
    assert m[repetition.DISTANCE] == pytest.approx(distance.min())


@pytest.mark.parametrize(("gap", "counts"), [(1.01 / 2**20, True), (0.99 / 2**20, False)])
def test_a_gap_below_a_millionth_of_the_motion_is_as_large(gap, counts):
    m = memory_of(np.array([[1.0, 1.0, 0.0, 0.0], [0.0] * 4]), gap=gap)
    repetition.write_scaled_states(m, 0)
    assert m[repetition.SIZE_OF_GAP] == (gap if counts else 2.0**-20)
    assert m[repetition.AWAY] == len(m) - 2  # deviations are the last row


@given(st.floats(0.0, 1.0), st.floats(0.05, 0.45))
@example(0.125, 0.41665656283994273)  # in one co-ordinate alone its drift looks like dying
def test_a_torus_has_repeated_after_no_number_of_periods(phase, angle):
    # its state comes back as closely as one likes, and drifts away again
    def turn(n):
        return 2.0 * np.pi * (angle * n + phase)

    states = states_of(lambda n: 0.3 * np.cos(turn(n)), of_velocity=lambda n: np.sin(turn(n)))
    exact = min(abs(angle * n - round(angle * n)) for n in range(1, 51)) < 1e-4
    assert exact or decide(states).decided != REPEATED


@pytest.mark.parametrize(
    ("n", "expected"),
    [(16, UNDECIDED), (18, UNDECIDED), (45, UNDECIDED), (46, IRREGULAR)],  # of 60 samples
)
def test_a_period_longer_than_the_samples_can_show_is_undecided(n, expected):
    states = np.random.default_rng(4).normal(size=(n, 4))
    found = decide(repeat(states, 60))
    assert found == (n if expected == UNDECIDED else 0, expected)
    chaotic = np.random.default_rng(5).normal(size=(60, 4))
    assert decide(chaotic) == (0, IRREGULAR)
    assert decide(np.ones((3, 4))) == (1, REPEATED)  # one period is looked at always
    assert decide(np.eye(4)[[0, 1, 0]]) == (2, UNDECIDED)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=100)
def test_compiled_and_in_python_the_rule_is_the_same(seed):
    random = np.random.default_rng(seed)
    n, count = random.integers(1, 30), random.choice([1, 7, 8, 16, 40, 60, 200])
    decay = random.choice([random.uniform(), 1.0])
    samples = random.normal(size=(n, 4))[np.arange(count) % n]
    size = 10.0 ** random.uniform(-12, 0) * random.normal(size=4)
    samples += size * decay ** np.arange(count).reshape(-1, 1)
    decide(samples, 1.3, 2.0)


def denied_by_newton(instance, point, state, periods):
    """Whether Newton's method finds no stable orbit of as many periods near a state."""
    frequency, state = point.excitation.frequency, np.array(state)
    numbers = (("frequency", frequency), ("amplitude", point.excitation.amplitude))
    limits = ((0.999 * frequency, 1.001 * frequency),)
    setting = Setting(point.structure, numbers, ("frequency",), limits)
    values = np.array([frequency])
    try:
        guess = simulate_guess(instance, point, setting.closed_form(values), state, periods)
        family, root = solve_orbit(setting, guess, values)
    except NoConvergenceError:
        return True
    orbit = family.orbit(root.unknowns)
    begin = stroboscopic_states(orbit)[0]
    away = np.abs(begin - point.faces_from_states(state)).max()
    size = max(np.abs(begin).max(), np.abs(orbit.nodes).max(initial=0.0))
    stable = np.abs(orbit.multipliers()).max() < 1.0
    other = why_no_motion(orbit) or least_periods(orbit) != periods
    return other or away > 1e-3 * size or not stable


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize("number", ordinary([20, 1000]))
@pytest.mark.parametrize("samples", [60, 200])
def test_where_a_response_has_repeated_it_lies_on_a_stable_orbit_of_as_many_periods(
    samples, number
):
    rng, count, path = np.random.default_rng(samples), 0, find_or_export(OSCILLATOR).path
    with Instance(path) as plain, EventInstance(path) as eventful:
        for _ in range(number):
            structure, eta = draw_structure(rng)
            point = Point(structure, Excitation.nondimensional(eta, structure))
            response = simulate_response(plain, *point, (0.0,) * 4, 500, samples, TOLERANCE)
            size = response.frequency, response.x_rel_max
            n, decided = decide(response.samples, *size)
            if decided == REPEATED:
                end = simulate_response(plain, *point, response.end, 3000, 4, TOLERANCE).end
                assert not denied_by_newton(eventful, point, end, n), (point, n)
                count += 1
    assert count > 0.65 * number


@pytest.mark.parametrize(
    ("found", "impacts", "n", "same"),
    [
        *((200, 1, 1, True), (201, 1, 1, True), (202, 1, 1, False)),  # one may be at phase 0
        *((198, 1, 1, False), (0, 0, 1, True), (4, 0, 1, False)),
        *((134, 2, 3, True), (131, 2, 3, True)),  # 66 whole responses, and two thirds of one
        *((130, 2, 3, False), (136, 2, 3, False)),
    ],
)
def test_impacts_of_all_samples_are_those_of_the_response(found, impacts, n, same):
    memory = memory_of(np.zeros((200, 4)))
    memory[repetition.MULTIPLICITY] = n
    memory[repetition.IMPACTS], memory[repetition.OWN_IMPACTS] = found, impacts
    memory[repetition.DECIDED] = REPEATED
    repetition.confirm_by_impacts(memory, 0.0)
    assert memory[repetition.DECIDED] == (REPEATED if same else UNDECIDED)


def test_none_where_there_must_be_some_are_too_few():
    for impacts, n, must in ((0, 1, True), (0, 2, False)):
        assert repetition.lacks_impacts(impacts, n, must)
    assert not repetition.lacks_impacts(0, 1, False) and not repetition.lacks_impacts(1, 2, True)


@pytest.mark.parametrize(
    ("halving", "turn", "expected"),
    [
        *((55.0, 1, UNDECIDED), (132.0, 1, UNDECIDED), (140.0, 1, IRREGULAR)),
        *((90.0, 5, UNDECIDED), (90.0, 6, IRREGULAR)),  # of 100 samples seen five times a quarter
    ],
)
def test_a_spiral_that_shrinks_is_not_irregular(halving, turn, expected):
    n = np.arange(200)
    size, turns = 0.5 ** (n / halving), 2.0 * np.pi * GOLDEN * n
    states = four(size * np.cos(turns) + n % turn, size * np.sin(turns))
    assert decide(states) == (turn if expected == UNDECIDED else 0, expected)


@pytest.mark.parametrize(("found", "expected"), [(0, (1, UNDECIDED)), (1, (0, IRREGULAR))])
def test_irregular_motions_have_impacts(found, expected):
    memory = memory_of(np.zeros((200, 4)))
    memory[repetition.IMPACTS], memory[repetition.DECIDED] = found, IRREGULAR
    repetition.confirm_by_impacts(memory, 0.0)
    assert (memory[repetition.MULTIPLICITY], memory[repetition.DECIDED]) == expected
