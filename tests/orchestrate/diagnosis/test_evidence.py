"""How far motions are from a record: the true one is at it, another is not."""

import numpy as np
import pytest

import orchestrate
from orchestrate.diagnosis.hypotheses import (
    FREE,
    Bonded,
    Delaminated,
    DelaminatedWithClearance,
    NonlinearSpring,
)
from orchestrate.diagnosis.multistart import Search, misfit
from orchestrate.diagnosis.standard_errors import contact_covariance, estimate
from orchestrate.fmu import OSCILLATOR, Player, find
from tests.benches.bench import Bench
from tests.benches.excitation import Swept
from tests.benches.lumped import Faces, Halves

from .records import BEAM, record, record_evidence


@pytest.fixture(scope="module")
def player():
    with Player(find(OSCILLATOR).path) as player:
        yield player


def missed(evidence, structure, player):
    hypothesis = Delaminated(structure)
    values = hypothesis.values_from_structure(structure, evidence)
    return misfit(evidence.residuals(hypothesis.displacements(values, evidence, player)))


def test_the_true_motion_is_at_the_record_and_others_are_not(player):
    evidence = record_evidence(record())
    assert missed(evidence, BEAM, player) < 0.08
    for changed in ({"f1": 30.6}, {"e": 0.6}, {"zeta2": 0.03}):
        assert missed(evidence, BEAM.replace(**changed), player) > 0.25


def test_gain_and_delay_of_a_sensor_are_found_in_closed_form(player):
    evidence = record_evidence(record(gain=1.04))
    hypothesis = Delaminated(BEAM)
    values = hypothesis.values_from_structure(BEAM, evidence)
    computed = evidence.orders_of_motion(hypothesis.displacements(values, evidence, player))
    found = [evidence.sensor_error(row, computed[row, 0]) for row in (0, 1)]
    factors, gains, delays = zip(*found, strict=True)
    np.testing.assert_allclose(factors, 1.0, atol=1e-2)
    np.testing.assert_allclose(gains, [1.04, 1.0], atol=1e-2)
    assert max(map(abs, delays)) < 4e-6
    late = computed * np.exp(-2j * np.pi * evidence.frequency * 1e-4)
    assert evidence.sensor_error(1, late[1, 0])[2] == pytest.approx(-1e-4, rel=0.05)


def test_impulses_do_not_come_back_from_above_the_sampling_rate(player):
    slow = record_evidence(record())
    hypothesis = Delaminated(BEAM)
    values = hypothesis.values_from_structure(BEAM, slow)
    computed = slow.orders_of_motion(hypothesis.displacements(values, slow, player))[:, 0]
    error = abs(computed - slow.measured[:, 0]) / slow.size
    assert np.median(error) < 2e-3


def test_records_of_many_samples_are_thinned_and_say_the_same(player):
    sweep = orchestrate.SweptSine(first=26.0, last=42.0, duration=10.0, acceleration=5.0)
    history = orchestrate.shake(BEAM, sweep, sample_rate=4000.0, progress=False)
    sensor = orchestrate.Sensor(bandwidth=250.0, sample_rate=4000.0)
    evidence = record_evidence(orchestrate.measure(history, sensor, excitation=sweep))
    assert 400.0 < evidence.rate < 600.0
    assert missed(evidence, BEAM, player) < 0.15


def test_what_is_computed_at_once_is_what_windows_give(player):
    evidence = record_evidence(record())
    values = Delaminated(BEAM).values_from_structure(BEAM, evidence)
    motion = Delaminated(BEAM).displacements(values, evidence, player)
    second = np.pad(np.diff(motion, 2, axis=1), ((0, 0), (1, 1)), mode="edge") * evidence.rate**2
    read = np.sinc(np.outer((1, 2, 3), evidence.frequency) / evidence.rate) ** 2
    expected = evidence.windows.amplitudes(second) / read + evidence.base
    size = abs(expected).max()
    np.testing.assert_allclose(evidence.orders_of_motion(motion), expected, atol=1e-9 * size)


def test_the_part_near_the_resonance_says_the_same_of_a_structure(player):
    wide = orchestrate.SweptSine(first=20.0, last=56.0, duration=20.0, acceleration=5.0)
    whole = record_evidence(record(sweep=wide))
    part = whole.near_resonance()
    assert part.samples < 0.9 * whole.samples and len(part.used_windows) >= 8
    for name in ("resonance", "displacement", "peaks"):
        assert getattr(part, name) == pytest.approx(getattr(whole, name), rel=1e-12), name
    assert missed(part, BEAM, player) < 0.1
    assert missed(part, BEAM.replace(f1=30.6), player) > 0.25


def test_damping_split_and_restitution_are_in_doubt_where_the_contact_is_another():
    values = {"common": 34.0, "log_zeta1": np.log(0.03), "log_zeta2": np.log(0.01), "e": 0.5}
    values["split"] = 0.1
    assert not contact_covariance(values, 0.0).any()
    deviation = np.sqrt(np.diag(contact_covariance(values, 1.0)))
    np.testing.assert_allclose(deviation[1:3] * [0.03, 0.01], 0.02)  # of both, their mean
    assert deviation[0] == 0.0
    assert not contact_covariance({"f": 34.0, "log_zeta": -4.0}, 1.0).any()


def test_a_bonded_structure_is_one_mass(player):
    evidence = record_evidence(record(BEAM.as_bonded()))
    common = Delaminated(BEAM).values_from_structure(BEAM, evidence)["common"]
    total = BEAM.d1 + BEAM.d2
    zeta = total / (2.0 * (BEAM.m1 + BEAM.m2) * 2.0 * np.pi * common)
    motion = Bonded().displacements({"f": common, "log_zeta": np.log(zeta)}, evidence, None)
    assert misfit(evidence.residuals(motion)) < 0.02


def test_pressed_faces_that_slide_are_described_with_friction(player):
    """Shut faces of a virtual bench, whose force brakes the bending of both halves."""
    own = Halves(f1=42.0, f2=52.0)
    faces = Faces(law="linear", frequency=900.0, clearance=-4e-3, friction=0.01)
    bench = Bench(excitation=Swept(34.0, 60.0, 12.0, 4.0), face2=None)
    measured, motion = bench.measure(own.delaminated(faces), 1)
    assert motion.largest_gap.max() < 0.0
    evidence = record_evidence(measured)
    beam = orchestrate.Structure.from_halves(**vars(own), e=0.5, clearance=faces.clearance)
    hypothesis = DelaminatedWithClearance(beam, (*FREE, "clearance"))
    values = hypothesis.values_from_structure(beam, evidence)
    missed = [
        misfit(
            evidence.residuals(
                hypothesis.displacements({**values, "friction": f}, evidence, player)
            )
        )
        for f in np.linspace(0.0, 0.5, 11)
    ]
    assert min(missed) < 0.5 and missed[0] > 2.0, missed


def test_motions_without_bounds_are_far_from_the_record():
    evidence = record_evidence(record())
    gone = evidence.residuals(np.full((1, evidence.samples), np.nan))
    assert np.isfinite(gone).all() and misfit(gone) > 5.0
    computed = evidence.corrected_for_sensors(
        evidence.orders_of_motion(np.full((1, evidence.samples), np.nan))
    )
    assert misfit(evidence.order_residuals(computed)) > 5.0


def test_a_hypothesis_whose_motion_has_no_bounds_has_errors_too():
    evidence = record_evidence(record(BEAM.as_bonded()))
    search = Search(NonlinearSpring(), evidence)
    values = {"f": evidence.resonance, "log_zeta": -5.0, "square": 0.0, "cube": -0.9}
    values["square"] = -1.0
    gone = {**values, "f": 2.0 * evidence.resonance}
    for one in (values, gone):
        known = estimate(search, one)
        assert np.isfinite(known.covariance).all()
    evidence.__dict__["displacement"] = 1e-12  # as of a sensor that hardly moves
    assert np.isnan(search.hypothesis.displacements(values, evidence, None)[0, -1])
