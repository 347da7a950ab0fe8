"""Multiplicity of sequences whose answer is known."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fmu_src.kernels import repetition
from orchestrate.dynamics.continuation import NoConvergenceError
from orchestrate.dynamics.families import Setting
from orchestrate.dynamics.orbit_search import (
    guess_from_state,
    least_periods,
    solve_orbit,
    why_no_motion,
)
from orchestrate.dynamics.turning_points import stroboscopic_states
from orchestrate.fmu import OSCILLATOR, EventInstance, Instance, find
from orchestrate.model import Excitation
from orchestrate.model.outcomes import IRREGULAR, REPEATED, UNDECIDED
from orchestrate.response.multiplicity import (
    MIN_RELATIVE_GAP,
    decide_multiplicity,
    find_repetition,
)
from orchestrate.response.questions import Point
from orchestrate.response.respond import respond

from ...draws import draw_structure
from ...sparing import ordinary

TOLERANCE = 1e-2
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def multiplicity(samples, tolerance, frequency=1.0, gap=None):
    gap = 2.0 * np.abs(samples).max() if gap is None else gap  # no smaller than any difference
    return find_repetition(samples, frequency, gap, tolerance).multiplicity


def decide(samples):
    return decide_multiplicity(samples, 1.0, 1.0, TOLERANCE)


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
    """Take the first ``length`` states of a periodic sequence."""
    return np.tile(orbit, (length // len(orbit) + 1, 1))[:length]


@given(orbits(), st.integers(0, 60))
def test_period_of_a_periodic_sequence(orbit, more):
    assert multiplicity(repeat(orbit, 4 * len(orbit) + more), TOLERANCE) == len(orbit)


@given(st.floats(0.0, 1.0), st.integers(100, 200))
def test_quasi_periodic_motion_never_repeats(phase, length):
    angle = 2.0 * np.pi * (GOLDEN * np.arange(length) + phase)
    assert multiplicity(four(np.cos(angle), np.sin(angle)), TOLERANCE) == 0


@given(orbits(longest=6), st.integers(0, 1000))
def test_the_earlier_half_does_not_count(orbit, seed):
    samples = repeat(orbit, 60)
    samples[:30] = 100.0 * np.random.default_rng(seed).normal(size=(30, 4)) * np.abs(orbit).max()
    assert multiplicity(samples, TOLERANCE) == len(orbit)


@given(st.integers(2, 10))
def test_nothing_beyond_a_quarter_of_the_samples(n):
    orbit = four(np.arange(1.0, n + 1.0))
    assert multiplicity(repeat(orbit, 4 * n), TOLERANCE) == n
    assert multiplicity(repeat(orbit, 4 * n - 1), TOLERANCE) == 0


@pytest.mark.parametrize(("deviation", "expected"), [(0.9, 1), (1.1, 2)])
@pytest.mark.parametrize("coordinate", range(4))
def test_the_tolerance_is_relative_to_the_size_of_the_motion(coordinate, deviation, expected):
    frequency = 8.0
    samples = np.tile([0.0, -1000.0, 0.0, 0.0], (40, 1))
    samples[::2, coordinate] += (
        deviation * TOLERANCE * 1000.0 * (frequency if coordinate > 1 else 1)
    )
    assert multiplicity(samples, TOLERANCE, frequency) == expected


def test_a_co_ordinate_that_passes_zero_at_the_sampled_phase_hides_nothing():
    # a stable T response is left of its way to itself: each co-ordinate in turn is nearly 0
    n = np.arange(200)
    rest = 1e-4 * 0.98**n * np.cos(2.0 * np.pi * GOLDEN * n)
    for coordinate in range(4):
        samples = np.ones((200, 4))
        samples[:, coordinate] = rest
        assert multiplicity(samples, TOLERANCE, 1.0, 1.0) == 1


@pytest.mark.parametrize(("deviation", "expected"), [(0.9, 1), (1.1, 2)])
@pytest.mark.parametrize("coordinate", range(4))
def test_a_gap_much_smaller_than_the_motion_has_a_size_of_its_own(coordinate, deviation, expected):
    frequency, gap = 3.0, 1.0
    samples = np.tile([100.0, 100.5, 50.0, 50.0], (40, 1))
    samples[::2, coordinate] += deviation * TOLERANCE * gap * (frequency if coordinate > 1 else 1.0)
    assert multiplicity(samples, TOLERANCE, frequency) == 1
    assert multiplicity(samples, TOLERANCE, frequency, gap) == expected


@given(st.integers(0, 1000))
def test_a_gap_of_rounding_errors_is_none(seed):
    noise = np.random.default_rng(seed).uniform(0.0, 1e-12, (40, 4))
    assert multiplicity(np.ones((40, 4)) + noise, TOLERANCE, 1.0, 1e-12) == 1
    assert MIN_RELATIVE_GAP * TOLERANCE > 1e-12


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


def doubling(multiplier, count=200, width=0.0):
    """Next to a period doubling: a deviation that changes sides dies, beside one that stays."""
    return states_of(lambda n: (-1.0) ** n * (0.05 * multiplier**n + width), count)


@given(orbits(), st.integers(0, 60), st.floats(0.5, 0.9))
def test_what_has_died_or_dies_fast_has_repeated(orbit, more, multiplier):
    samples = repeat(orbit, 8 * len(orbit) + more + 40)
    rest = 1e-3 * np.abs(orbit).max() * multiplier ** np.arange(len(samples))
    n, decided = decide_multiplicity(
        samples + rest[:, None], 1.0, 2.0 * np.abs(samples).max(), TOLERANCE
    )
    assert n == len(orbit)
    assert decided == REPEATED


@pytest.mark.parametrize("multiplier", [0.5, 0.9, 0.97])
def test_a_stable_response_next_to_a_period_doubling_is_none_of_two_periods(multiplier):
    assert decide(doubling(multiplier)) == (1, REPEATED)


@pytest.mark.parametrize("width", [1e-7, 1e-5, 1e-3, 0.1])
def test_the_tolerance_does_not_hide_a_narrow_period_doubling(width):
    states = doubling(0.8, width=width)
    assert find_repetition(states, 1.0, 1.0, TOLERANCE).multiplicity == (1 if width < 0.01 else 2)
    assert decide(states) == (2, REPEATED)


@pytest.mark.parametrize("angle", [0.117, 0.291, GOLDEN])
def test_a_deviation_that_dies_while_it_turns_round_repeats_after_one_period(angle):
    def spiral(n, multiplier):
        return 0.1 * multiplier**n * np.cos(2.0 * np.pi * angle * n)

    assert decide(states_of(lambda n: spiral(n, 0.9))) == (1, REPEATED)
    n, decided = decide(states_of(lambda n: spiral(n, 0.99)))
    assert (n, decided) in [(1, REPEATED), (1, UNDECIDED)]


@given(st.integers(1, 60), st.integers(0, 60), st.integers(0, 2**32 - 1))
def test_the_spread_is_that_of_states_a_multiple_of_n_periods_apart(n, more, seed):
    runs = np.random.default_rng(seed).uniform(-1.0, 1.0, (2, 6, n + more))
    expected = [max(np.ptp(run[:, k::n], axis=1).max() for k in range(n)) for run in runs]
    for run, spread in zip(runs, expected, strict=True):
        head = [0.0] * repetition.HEAD
        head[repetition.LATER] = count = run.shape[1]
        assert repetition.spread_over_returns([*head, *run.ravel()], 0, count, n) == spread


@given(st.floats(0.0, 1.0), st.floats(0.05, 0.45))
@example(0.125, 0.41665656283994273)  # in one co-ordinate alone its drift looks like dying
def test_a_torus_has_repeated_after_no_number_of_periods(phase, angle):
    # its state comes back as closely as one likes, and drifts away again
    def turn(n):
        return 2.0 * np.pi * (angle * n + phase)

    states = states_of(lambda n: 0.3 * np.cos(turn(n)), of_velocity=lambda n: np.sin(turn(n)))
    exact = min(abs(angle * n - round(angle * n)) for n in range(1, 51)) < 1e-4
    assert exact or decide(states).decided != REPEATED


def test_what_leaves_an_unstable_orbit_is_undecided():
    assert decide(states_of(lambda n: 1e-9 * 1.08**n)) == (1, UNDECIDED)


def test_noise_narrower_than_the_tolerance_is_undecided_and_wider_irregular():
    noise = np.random.default_rng(3).uniform(-1.0, 1.0, (30, 200))
    narrow = [decide(states_of(lambda n, row=row: 1e-3 * row)) for row in noise]
    assert {found.multiplicity for found in narrow} == {1}
    assert sum(found.decided == UNDECIDED for found in narrow) >= 28  # chance may look like dying
    wide = {decide(states_of(lambda n, row=row: 0.2 * row)) for row in noise}
    assert wide == {(0, IRREGULAR)}


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


@given(st.integers(0, 2**32 - 1))
def test_compiled_and_in_python_the_rule_is_the_same(seed):
    random = np.random.default_rng(seed)
    n, count, decay = random.integers(1, 30), random.choice([1, 7, 40, 60, 200]), random.uniform()
    samples = random.normal(size=(n, 4))[np.arange(count) % n]
    samples += (
        10.0 ** random.uniform(-9, 0)
        * random.normal(size=4)
        * decay ** np.arange(count).reshape(-1, 1)
    )
    memory = [0.0] * repetition.memory_size(count)
    memory[: repetition.MULTIPLICITY] = count, 1.3, 2.0, TOLERANCE
    memory[repetition.HEAD : repetition.HEAD + samples.size] = samples.ravel()
    repetition.decide(memory, 0.0)
    decided = memory[repetition.MULTIPLICITY], memory[repetition.DECIDED]
    assert decide_multiplicity(samples, 1.3, 2.0, TOLERANCE) == decided
    repetition.repeat(memory, 0.0)
    repeated = memory[repetition.MULTIPLICITY], memory[repetition.DEVIATION]
    assert find_repetition(samples, 1.3, 2.0, TOLERANCE) == repeated


def newton(instance, point, state, periods):
    """Least period of the orbit that Newton's method finds from a state, and whether it attracts.

    Returns None where there is none, or none near.
    """
    excitation = point.excitation
    numbers = (("frequency", excitation.frequency), ("amplitude", excitation.amplitude))
    limits = ((0.999 * excitation.frequency, 1.001 * excitation.frequency),)
    setting = Setting(point.structure, numbers, ("frequency",), limits)
    values = np.array([excitation.frequency])
    try:
        guess = guess_from_state(instance, point, setting.form(values), np.array(state), periods)
        family, root = solve_orbit(setting, guess, values)
    except NoConvergenceError:
        return None
    orbit = family.orbit(root.unknowns)
    begin = stroboscopic_states(orbit)[0]
    away = np.abs(begin - point.faces(np.array(state))).max()
    size = max(np.abs(begin).max(), np.abs(orbit.nodes).max(initial=0.0))
    if why_no_motion(orbit) or away > 1e-3 * size:
        return None
    return least_periods(orbit), bool(np.abs(orbit.multipliers()).max() < 1.0)


def checked_by_newton(points, transient, samples):
    """How many responses from rest have repeated, and which of these Newton's method denies."""
    count, wrong = 0, []
    path = find(OSCILLATOR).path
    with Instance(path) as plain, EventInstance(path) as eventful:
        for point in points:
            response = respond(plain, *point, (0.0,) * 4, transient, samples, TOLERANCE)
            size = response.frequency, response.x_rel_max
            n, decided = decide_multiplicity(response.samples, *size, TOLERANCE)
            if decided != REPEATED:
                continue
            end = respond(plain, *point, response.end, 3000, 4, TOLERANCE).end
            orbit = newton(eventful, point, end, n)
            count += 1
            if orbit != (n, True):
                wrong.append((point, n, orbit))
    return count, wrong


def random_points(seed, count):
    """Structures and excitations of all kinds."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        structure, eta = draw_structure(rng)
        yield Point(structure, Excitation.nondimensional(eta, structure))


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize("number", ordinary([40, 1000]))
@pytest.mark.parametrize("samples", [60, 200])
def test_where_a_response_has_repeated_it_lies_on_a_stable_orbit_of_as_many_periods(
    samples, number
):
    count, wrong = checked_by_newton(random_points(samples, number), 500, samples)
    assert not wrong
    assert count > 0.65 * number


@pytest.mark.parametrize(
    ("found", "impacts", "n", "same"),
    [
        (200, 1, 1, True),
        (201, 1, 1, True),  # one at phase 0 may be counted on either side
        (202, 1, 1, False),
        (198, 1, 1, False),
        (134, 2, 3, True),  # 66 whole responses, and two thirds of one
        (131, 2, 3, True),
        (130, 2, 3, False),
        (136, 2, 3, False),
        (0, 0, 1, True),
        (4, 0, 1, False),
    ],
)
def test_impacts_of_all_samples_are_those_of_the_response(found, impacts, n, same):
    memory = [0.0] * repetition.memory_size(200)
    memory[repetition.COUNT], memory[repetition.MULTIPLICITY] = 200, n
    memory[repetition.IMPACTS], memory[repetition.OWN_IMPACTS] = found, impacts
    memory[repetition.DECIDED] = REPEATED
    repetition.confirm(memory, 0.0)
    assert memory[repetition.DECIDED] == (REPEATED if same else UNDECIDED)


def test_none_where_there_must_be_some_are_too_few():
    for impacts, n, must in ((0, 1, True), (0, 2, False)):
        assert repetition.lacks_impacts(impacts, n, must)
    assert not repetition.lacks_impacts(0, 1, False) and not repetition.lacks_impacts(1, 2, True)


@pytest.mark.parametrize(
    ("halving", "expected"), [(55.0, UNDECIDED), (120.0, UNDECIDED), (500.0, IRREGULAR)]
)
def test_a_spiral_that_shrinks_is_not_irregular(halving, expected):
    n = np.arange(200)
    size, turns = 0.5 ** (n / halving), 2.0 * np.pi * GOLDEN * n
    assert decide(four(size * np.cos(turns), size * np.sin(turns))).decided == expected


@pytest.mark.parametrize(("found", "expected"), [(0, (1, UNDECIDED)), (1, (0, IRREGULAR))])
def test_irregular_motions_have_impacts(found, expected):
    memory = [0.0] * repetition.memory_size(200)
    memory[repetition.IMPACTS], memory[repetition.DECIDED] = found, IRREGULAR
    repetition.confirm(memory, 0.0)
    assert (memory[repetition.MULTIPLICITY], memory[repetition.DECIDED]) == expected
