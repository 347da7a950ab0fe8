"""Each threshold of the verdict and of the search has a case just inside and one just outside."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.diagnosis import search_job
from orchestrate.diagnosis.decision_rule import DELAMINATED, NOT_SEEN, UNDECIDED, Beam
from orchestrate.diagnosis.detect import mask_of_stated_hypotheses
from orchestrate.diagnosis.evidence import Evidence
from orchestrate.diagnosis.fit import Results
from orchestrate.diagnosis.hypotheses import Delaminated, DryFriction
from orchestrate.diagnosis.multistart import Solution
from orchestrate.diagnosis.opening_measures import measure_opening, order_2_thresholds
from orchestrate.diagnosis.search_job import SearchJob
from orchestrate.diagnosis.settings import SETTINGS
from orchestrate.diagnosis.standard_errors import contact_covariance

from .records import BEAM
from .test_verdicts import OPENED, QUIET

UNKNOWN = replace(OPENED, strikes=replace(OPENED.strikes, stiffness=math.nan))


@pytest.mark.parametrize(
    ("findings", "name", "inside", "outside", "verdict"),
    [
        (OPENED, "end_response", 0.69, 0.71, DELAMINATED),
        (OPENED, "clipped", *(np.array([0.99, 1.01]) * SETTINGS.clipped), DELAMINATED),
        (OPENED, "samples", 14.1, 13.9, DELAMINATED),
        (QUIET, "samples", 14.1, 13.9, NOT_SEEN),
        (OPENED, "resonance", 42.0 / 1.29, 42.0 / 1.31, DELAMINATED),
        (OPENED, "resonance", 1.29 * 52.0, 1.31 * 52.0, DELAMINATED),
        (QUIET, "excess", 0.99, 1.01, NOT_SEEN),
        (QUIET, "apart", 0.99, 1.01, NOT_SEEN),
        (QUIET, "hidden", 0.099, 0.101, NOT_SEEN),
    ],
)
def test_each_threshold_of_the_verdict(findings, name, inside, outside, verdict):
    beams = [Beam((replace(findings, **{name: float(value)}),)) for value in (inside, outside)]
    assert [beam.verdict() for beam in beams] == [verdict, UNDECIDED]


@pytest.mark.parametrize(("level", "verdict"), [(1.51, DELAMINATED), (1.49, UNDECIDED)])
def test_the_threshold_of_two_levels(level, verdict):
    """One level, but for a half, does not stand for a known frequency."""
    assert Beam((UNKNOWN, replace(UNKNOWN, high=level * UNKNOWN.high))).verdict() == verdict


@pytest.mark.parametrize(("level", "verdict"), [(0.89, DELAMINATED), (0.91, UNDECIDED)])
def test_a_record_of_the_same_level_contradicts_and_one_of_a_lower_does_not(level, verdict):
    quiet = replace(QUIET, high=level * OPENED.high)
    assert Beam((OPENED, quiet)).verdict() == verdict


def windows(one, other=None, noise=0.0, floor=0.0):
    """Evidence of one or two sensors by their orders 1 and 2 in 40 windows, over a base of none."""
    rows = [row for row in (one, other) if row is not None]
    measured = np.array([[np.broadcast_to(order, 40) for order in row] for row in rows], complex)
    return SimpleNamespace(
        measured_orders=measured,
        noise=np.full(len(rows), noise),
        floor=np.full((len(rows), 40), floor),
        order_1_size=np.abs(measured[:, 0]),
        base_orders=np.zeros((2, 40), complex),
        frequency=np.linspace(20.0, 40.0, 40),
        settings=SETTINGS,
    )


def even_orders_of(*sensors, **options):
    evidence = windows(*sensors, **options)
    return measure_opening(evidence, np.zeros_like(evidence.measured_orders))


@pytest.mark.parametrize(
    ("noise", "floor", "order2", "seen"),
    [
        *((0.0, 0.0, 0.0051, True), (0.0, 0.0, 0.0049, False)),  # over order 1,
        *((0.01, 0.0, 0.051, True), (0.01, 0.0, 0.049, False)),  # five times the noise,
        *((0.0, 0.01, 0.0225, True), (0.0, 0.01, 0.0222, False)),  # twice the floor, and it
    ],
)
def test_each_threshold_of_order_2(noise, floor, order2, seen):
    assert even_orders_of((1.0, order2), noise=noise, floor=floor).is_order_2_seen == seen


@pytest.mark.parametrize(
    ("other", "apart"),
    [
        *(((1.0, 0.395), True), ((1.0, 0.405), False)),  # a fifth of order 2
        *(((1.031, 0.5), True), ((1.029, 0.5), False)),  # 0.03 of order 1
    ],
)
def test_each_threshold_of_faces_that_move_apart(other, apart):
    """A difference in order 1 that goes to and fro is not one of gains."""
    turns = (-1.0) ** np.arange(40)
    order1 = 1.0 + (other[0] - 1.0) * turns
    assert (even_orders_of((1.0, 0.5), (order1, other[1])).largest_sensor_difference > 1.0) == apart


def test_little_moves_below_a_tenth_of_the_largest_order_1():
    size = np.where(np.arange(40) < 20, 1.0, 0.11)
    size[30:] = 0.09
    seen = order_2_thresholds(windows((size, 0.0)))[0]
    assert np.isfinite(seen[22:28]).all() and np.isnan(seen[33:]).all()


@pytest.mark.parametrize(
    ("sound", "parted", "stated"),
    [
        *((1.19, 9.0, "sound"), (1.21, 9.0, "")),  # largest misfit of a sound one,
        *((9.0, 2.99, "parted"), (9.0, 3.01, "")),  # of a delaminated one,
        *((1.5, 0.99, "parted"), (1.5, 1.01, "")),  # which is so much smaller
    ],
)
def test_each_threshold_of_stated_numbers(sound, parted, stated):
    job = SimpleNamespace(sound=[1], data=SimpleNamespace(settings=SETTINGS))
    fits = SimpleNamespace(job=job, misfit=np.array([sound, parted]))
    found = [mask_of_stated_hypotheses(fits, word).tolist() for word in (NOT_SEEN, DELAMINATED)]
    assert found == [[stated == "sound", False], [False, stated == "parted"]]
    described = Results.is_described.fget(fits)
    assert described.tolist() == [sound <= 3.0, parted <= 3.0]


def test_errors_of_orders_are_those_of_a_good_model_and_of_what_is_irregular():
    size, floor, noise = np.full((1, 3), 2.0), np.array([[0.0, 1.0, 0.1]]), np.array([0.2])
    made = SimpleNamespace(settings=SETTINGS, order_1_size=size, floor=floor, noise=noise)
    expected = np.hypot(0.03 * 2.0, [0.2, 1.5, 0.2])
    assert Evidence.standard_deviation.func(made)[0] == pytest.approx(np.tile(expected, (3, 1)))


def read_by(gain, delay, error, hertz=100.0, participation=1.0):
    """What is found of a sensor's participation, gain and delay, by an error over the size."""
    made = object.__new__(Evidence)
    computed = np.full(30, 2.0 + 0.0j)
    read = gain * computed * np.exp(-2j * np.pi * hertz * delay)
    made.__dict__.update(
        settings=SETTINGS,
        participation=(participation,),
        windows=SimpleNamespace(is_tone=False),
        base_orders=np.zeros((3, 30), complex),
        measured_orders=read[None, None],
        standard_deviation=np.full((1, 3, 30), 2.0 * error),
        frequency=np.full(30, hertz),
    )
    return made.fit_sensor_errors(0, computed)


def test_a_gain_and_a_delay_are_held_by_their_deviations_where_records_say_little():
    """An estimate between the record's and none, by the weights of both: a tenth of an error."""
    _, gain, _ = read_by(1.05, 0.0, 1.0)
    assert gain - 1.0 == pytest.approx(0.05 / (1.0 + (0.1 / 0.03) ** 2))
    *_, delay = read_by(1.0, 1e-6, 1.0)
    assert delay == pytest.approx(
        1e-6 / (1.0 + (0.1 / (2e-4 * 2.0 * math.pi * 100.0)) ** 2), rel=1e-4
    )
    assert read_by(1.119, 0.0, 1e-6)[1] == pytest.approx(1.119)
    assert read_by(1.13, 0.0, 1e-6)[1] == pytest.approx(1.12)  # the largest
    assert read_by(1.0, 0.99e-3, 1e-6, 1.0)[2] == pytest.approx(0.99e-3, rel=1e-4)
    assert read_by(1.0, -1.1e-3, 1e-6, 1.0)[2] == pytest.approx(-1e-3)


def test_a_participation_takes_its_part_of_what_a_gain_could_explain_too():
    """By the squares of both deviations, where the base is at rest."""
    share = 0.5**2 / (0.5**2 + 0.03**2)
    expected = 1.0 + 0.2 * share / (1.0 + 0.2 * (1.0 - share))
    found, *_ = read_by(1.2, 0.0, 1e-6, participation=None)
    assert found == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("error", "found"), [(0.0049, []), (0.0051, ["zeta1", "zeta2"])])
def test_a_damping_ratio_of_which_half_is_error_is_not_determined(error, found):
    """They are named in the order of the halves: it was that of a set, another one in each run."""
    job = SimpleNamespace(data=SimpleNamespace(settings=SETTINGS))
    reported = {"f": 42.0, "zeta2": 0.01, "zeta1": 0.01}, np.diag([1e-4, error**2, error**2])
    fits = SimpleNamespace(job=job, is_described=[True])
    fits.reported_values_and_covariance = lambda position: reported
    assert list(Results.why_undetermined(fits, 0)) == found


def test_doubt_about_real_contacts_grows_with_what_the_contact_misses():
    values = {"e": 0.5, "split": 0.1}
    for beyond, part in ((0.0225, 0.5), (0.09, 1.0), (1.0, 1.0)):  # of 0.3, squared
        found = np.sqrt(np.diag(contact_covariance(values, beyond, SETTINGS)))
        assert found == pytest.approx([part * 0.12, part * 0.02])


def test_dry_friction_is_viscous_below_a_hundredth_of_the_largest_speed():
    made = SimpleNamespace(settings=SETTINGS, resonance=34.0, level=[3.0, 5.0])
    made.largest_displacement = 2e-3
    mass = DryFriction().single_mass({"f": 34.0, "log_zeta": -4.0, "friction": 0.2}, made)
    assert (mass.slow, mass.friction) == pytest.approx((0.01 * 2.0 * math.pi * 34.0 * 2e-3, 0.8))


@pytest.mark.parametrize(("misfit", "tried"), [(1.29, [0.0, 0.2]), (1.31, [0.0])])
def test_the_second_best_minimum_goes_on_too_if_it_is_close(monkeypatch, misfit, tried):
    """Up to 1.3 times the best one's misfit; a third one never does."""
    found = [Solution({"split": 0.0}, 1.0), Solution({"split": 0.2}, misfit)]
    found.append(Solution({"split": 0.4}, misfit))
    coarse = SimpleNamespace(evaluations=0, rank_starts=lambda starts: found)
    monkeypatch.setattr(search_job, "Search", lambda *given: coarse)
    monkeypatch.setattr(search_job, "cached_coarse_evidence", lambda data: None)
    hypothesis = SimpleNamespace(is_rugged=True, bounds=lambda evidence: {})
    search, went_on = SimpleNamespace(hypothesis=hypothesis, player=None, evaluations=0), []
    search.rank_starts = lambda starts: went_on.extend(starts) or found[:1]
    search.polish = lambda one: one
    job = SimpleNamespace(data=SimpleNamespace(settings=SETTINGS), evidence=None)
    job.sort_by_misfit_and_guess = lambda search, ends: ends
    SearchJob.refine_minima(job, search, [], [], True)
    assert [start["split"] for start in went_on] == tried


@pytest.mark.parametrize(
    ("off", "better", "is_guessed"),
    [
        *((0.06, 0.981, True), (0.06, 0.979, False)),  # one deviation counts 2 %
        *((0.12, 0.927, True), (0.12, 0.925, False)),  # two of them four times as much
        *((0.6, 0.715, True), (0.6, 0.713, False)),  # but no more than 40 %
    ],
)
def test_a_minimum_is_the_better_the_nearer_to_the_guess(monkeypatch, off, better, is_guessed):
    """Its frequencies ``off``, as logarithm, its misfit ``better`` times the other's."""

    def frequencies(self, values, evidence=None):
        return {"f1": BEAM.f1 * math.exp(values["off"]), "f2": BEAM.f2}

    monkeypatch.setattr(Delaminated, "structure_from_values", frequencies)
    job = SimpleNamespace(data=SimpleNamespace(settings=SETTINGS), evidence=None)
    job.guess = frequencies(None, {"off": 0.0})
    near, far = Solution({"off": 0.0}, 1.0), Solution({"off": off}, better)
    search = SimpleNamespace(hypothesis=Delaminated(BEAM))
    first, _ = SearchJob.sort_by_misfit_and_guess(job, search, [far, near])
    assert (first is near) == is_guessed
