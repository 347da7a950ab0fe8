"""Verdicts and fits on short records of structures that are known."""

import warnings

import numpy as np
import pytest

import orchestrate
from orchestrate.diagnosis.decision_rule import Beam
from orchestrate.diagnosis.detect import DetectJob, beam_job, record_findings, sweep_direction
from orchestrate.diagnosis.fit import checked_record_data
from orchestrate.diagnosis.hypotheses import FREE
from orchestrate.diagnosis.multistart import Search, Solution
from orchestrate.diagnosis.search_job import cached_opening_measures
from orchestrate.diagnosis.settings import SETTINGS
from tests.benches.bench import Bench
from tests.benches.excitation import Swept
from tests.benches.lumped import Faces, Halves
from tests.benches.sensors import Sensor

from .records import BEAM, RATE, SWEEP, guess, record

LIMIT = {"jobs": 1, "progress": False}
SHORT = {"rounds": 1, "steps": 3, "starts": 1, "rugged_starts": 1}  # of a search: ended early


@pytest.mark.slow
def test_a_fit_is_within_its_errors_and_takes_what_is_not_free_from_the_guess():
    start = guess(e=0.5)
    measured = record(noise=0.01, both=False)
    answer = orchestrate.fit(measured, start, free=("f1", "f2", "zeta1", "zeta2"), **LIMIT)
    assert list(answer.parameter.values) == ["f1", "f2", "zeta1", "zeta2"]
    truth = np.array([30.0, 38.0, 0.02, 0.02])
    away = (answer.value.values - truth) / answer.standard_error.values
    assert abs(away).max() < 5.0
    np.testing.assert_allclose(answer.value[:2], truth[:2], rtol=0.01)
    assert answer.correlation.shape == (4, 4)
    np.testing.assert_allclose(np.diag(answer.correlation), 1.0)
    assert answer.attrs["hypothesis"] == "delaminated" and float(answer.evaluations) > 50


def test_the_direction_of_a_sweep():
    kinds = {(20, 21, 20.9, 30): "up", (30, 20): "down", (20, 30, 21): "up and down"}
    assert {one: sweep_direction(np.array(one, dtype=float)) for one in kinds} == kinds


def test_more_parameters_than_the_numbers_of_one_tone_are_not_fitted():
    """Three orders of one sensor do not determine five parameters; two are fitted."""
    time = np.arange(3000) / RATE
    orders = [np.sin(2.0 * np.pi * n * 33.0 * time + 0.4 * n) for n in (1, 2)]
    channels = {"box_acceleration": 2.0 * orders[0], "acceleration1": 9.0 * orders[0] + orders[1]}
    tone = orchestrate.record(**channels, sample_rate=RATE)
    with pytest.raises(orchestrate.InputError, match="one tone of 33 Hz has 3 numbers, 7 are fit"):
        orchestrate.fit(tone, guess(), **LIMIT)
    answer = orchestrate.fit(tone, guess(), hypothesis="bonded", **LIMIT)
    assert np.isfinite(answer.value).values.tolist() == [True, False]
    assert "zeta is not determined" in answer.attrs["reason"]
    assert answer.participation.values.tolist() == [1.0]  # one frequency does not tell it


def test_errors_end_where_a_structure_does_not_describe_the_record():
    """Standard errors were stated at any misfit: f2 29.71 +- 1.14 Hz for 32.81 at 6.02."""
    described, limited, wide = (
        orchestrate.fit(record(), guess(), hypothesis="bonded", settings=changes, **LIMIT)
        for changes in ({**SHORT, "delaminated": 100.0}, SHORT, {**SHORT, "model_error": 0.06})
    )
    assert float(wide.misfit) < 0.8 * float(limited.misfit)
    assert limited.value.equals(described.value) and 3.0 < float(limited.misfit) < 100.0
    assert np.isfinite(described.standard_error).all() and np.isfinite(described.correlation).all()
    for name in ("standard_error", "correlation", "participation_error"):
        assert limited[name].isnull().all()
    assert "errors" not in described.attrs["reason"]
    expected = f"no standard errors: the misfit {float(limited.misfit):.3g} is above 3"
    assert expected in limited.attrs["reason"]


def test_a_record_without_a_guess_gets_its_verdict_by_halves_around_its_resonance():
    """It was a TypeError, while the guess may be left out by the contract."""
    sound = record(BEAM.as_bonded(), noise=0.02, both=False)
    answer = orchestrate.detect(sound, settings=SHORT, **LIMIT)
    assert str(answer.verdict.values) == "no opening seen"
    assert "same mass: no guess" in answer.attrs["assumed"]
    assert "Two masses were not fitted" in answer.attrs["reason"]
    assert answer.attrs["strikes"].startswith("nothing heard (heard ")
    common = float(answer.value.sel(hypothesis="bonded", parameter="f"))
    assert common == pytest.approx(33.79, rel=0.005)


def test_a_history_without_its_impacts_spikes_is_refused():
    """Its accelerations are those between impacts: a fit to them was wrong by a tenth, silently."""
    history = orchestrate.shake(BEAM, SWEEP, sample_rate=RATE, progress=False)
    assert history.sizes["impact"] > 100
    for ask in (orchestrate.detect, orchestrate.fit):
        with pytest.raises(orchestrate.InputError, match="orchestrate.measure"):
            ask(history, guess())
    with pytest.raises(orchestrate.InputError, match="leave out its"):
        orchestrate.signs(history)


def three_sensors(sweep, rate):
    sensor = Sensor(noise=0.02)
    return Bench(excitation=sweep, box=sensor, face1=sensor, face2=sensor, rate=rate)


@pytest.mark.slow
def test_of_a_structure_that_friction_locks_no_resonance_is_seen_and_nothing_is_decided():
    """Faces pressed together rub: on a bench of its own, whose contact is no model of ours."""
    faces = Faces(law="linear", frequency=900.0, clearance=-4e-3, friction=0.3)
    halves = Halves(m1=1.5, m2=1.2, f1=37.5, f2=34.7, zeta1=0.007, zeta2=0.005)
    bench = three_sensors(Swept(24.0, 56.0, 12.0, 3.0), 1000.0)
    locked, motion = bench.measure(halves.delaminated(faces), seed=3)
    assert motion.largest_gap.max() < 0.0
    answer = orchestrate.detect(locked, guess(f1=38.0, f2=34.0), **LIMIT)
    assert str(answer.verdict.values) == "undecided"
    assert "does not pass the resonance" in answer.attrs["reason"]


def test_a_sound_beam_that_twists_between_two_sensors_shows_no_opening():
    """A torsion mode 8 % above bending; halves too far apart to touch differ like no two modes."""
    halves = Halves(f1=42.0, f2=50.0)
    bench = three_sensors(Swept(36.0, 60.0, 6.0, 3.0), 1200.0)
    twisted = bench.measure(Halves(f1=46.0, f2=46.0).bonded_with_torsion(1.08, 0.5, 0.2), seed=3)[0]
    far = bench.measure(halves.delaminated(Faces(clearance=0.02)), seed=3)[0]
    data = [checked_record_data(one) for one in (twisted, far)]
    beams = [Beam((record_findings(one, guess(f1=42.0, f2=50.0), True),)) for one in data]
    assert all(cached_opening_measures(one).largest_sensor_difference > 10.0 for one in data)
    assert [beam.verdict() for beam in beams] == ["no opening seen", "undecided"]
    assert "Two modes of a sound beam do not describe" in beams[1].reason()
    second = orchestrate.fit(
        twisted, guess(f1=42.0, f2=50.0), hypothesis="two modes", settings={"rounds": 1}, **LIMIT
    )
    assert abs(float(second.value.sel(parameter="apart"))) == pytest.approx(np.log(1.08), abs=0.01)


PRESSED = -2.5e-4  # m: a fifth of what opens at the resonance


def test_the_search_for_pressed_faces_starts_at_the_preload_that_opens_where_order_2_begins():
    pressed = record(BEAM.replace(clearance=PRESSED), noise=0.01)
    job = DetectJob(name="x", data=checked_record_data(pressed), guess=guess(), free=FREE)
    hypothesis = job.hypotheses[-1]
    assert hypothesis.onset.common == pytest.approx(33.79, rel=0.01)
    starts = [one for one in hypothesis.starts(job.evidence) if one["split"] == 0.3]
    gaps = [s["clearance"] * job.evidence.largest_displacement for s in starts]
    assert min(abs(gap / PRESSED - 1.0) for gap in gaps) < 0.25
    data = checked_record_data(record(BEAM.as_bonded()))
    silent = DetectJob(name="x", data=data, guess=guess(), free=FREE)
    assert silent.hypotheses[-1].onset is None and not silent.is_worth_a_search
    assert job.is_worth_a_search


def test_two_masses_are_searched_only_where_timing_says_that_faces_strike():
    """Order 2 is seen in both; of a beam that is not called their numbers are not stated."""
    called = beam_job(record(noise=0.02), guess(), FREE, None, SETTINGS)
    unknown = beam_job(record(noise=0.02, both=False), None, FREE, None, SETTINGS)
    assert called.is_worth_a_search and not unknown.is_worth_a_search
    assert unknown.beam().verdict() == "undecided" and unknown.beam().records[0].excess > 1.0


@pytest.mark.slow
def test_pressed_faces_are_seen_when_they_open():
    felt = record(BEAM.replace(clearance=PRESSED), noise=0.01)
    answer = orchestrate.detect(felt, guess(), **LIMIT)
    assert str(answer.verdict.values) == "delaminated", answer.attrs["reason"]
    pressed = answer.sel(hypothesis="delaminated, with clearance")
    assert float(pressed.value.sel(parameter="clearance")) == pytest.approx(PRESSED, rel=0.15)
    assert float(pressed.value.sel(parameter="f1")) == pytest.approx(30.0, rel=0.03)


@pytest.mark.parametrize(
    ("share", "end", "factor", "reason"),  # clip, end of the sweep in s, factor of the times
    [
        (0.8, 10.0, 1.0, "saturated"),
        (np.inf, 3.5, 1.0, "does not pass the resonance"),
        (np.inf, 10.0, 1e3, "a factor of"),
    ],
)
def test_no_opening_is_seen_only_in_a_record_that_can_show_one(share, end, factor, reason):
    whole = record(BEAM.as_bonded(), noise=0.02, both=False)
    part = whole.sel(time=slice(0.0, end))
    peak = float(abs(part.acceleration1).max())
    cut = orchestrate.record(
        box_acceleration=part.box_acceleration,
        acceleration1=np.clip(part.acceleration1, -share * peak, share * peak),
        sample_rate=RATE / factor,
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        beam = beam_job(cut, guess(), FREE, None, SETTINGS).beam()
    assert beam.verdict() == "undecided" and reason in beam.reason()
    assert any("are the times in s" in str(one.message) for one in caught) == (factor > 1.0)


def test_of_halves_that_may_change_places_the_guess_decides():
    """One sensor, masses alike: both solutions miss about as much."""
    job = DetectJob(
        name="x", data=checked_record_data(record(both=False)), guess=guess(), free=FREE
    )
    search = Search(job.hypotheses[-2], job.evidence)
    there = search.hypothesis.values_from_structure(guess(), job.evidence)
    mirrored = {**there, "split": -there["split"]}
    like, unlike = Solution(there, 1.05), Solution(mirrored, 1.0)
    assert job.sort_by_misfit_and_guess(search, [unlike, like])[0] is like
    much_better = Solution(mirrored, 0.5)
    assert job.sort_by_misfit_and_guess(search, [like, much_better])[0] is much_better
