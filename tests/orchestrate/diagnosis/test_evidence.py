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
from orchestrate.diagnosis.standard_errors import estimate_with_errors
from orchestrate.fmu import OSCILLATOR, Player, find_or_export
from tests.benches.bench import Bench
from tests.benches.excitation import Swept
from tests.benches.lumped import Faces, Halves

from .records import BEAM, SWEEP, record, record_evidence


@pytest.fixture(scope="module")
def player():
    with Player(find_or_export(OSCILLATOR).path) as player:
        yield player


def motion_of(evidence, structure, player):
    hypothesis = Delaminated(structure)
    values = hypothesis.values_from_structure(structure, evidence)
    return hypothesis.displacements(values, evidence, player)


def missed(evidence, structure, player):
    return misfit(evidence.residuals_of_motion(motion_of(evidence, structure, player)))


def test_the_true_motion_is_at_the_record_and_others_are_not(player):
    """Also near the resonance only, and of a record of many samples, which is thinned."""
    wide = orchestrate.SweptSine(first=20.0, last=56.0, duration=20.0, acceleration=5.0)
    whole = record_evidence(record(sweep=wide))
    part = whole.near_resonance()
    assert part.sample_count < 0.9 * whole.sample_count and len(part.used_windows) >= 8
    for name in ("resonance", "largest_displacement", "peak_frequencies"):
        assert getattr(part, name) == pytest.approx(getattr(whole, name), rel=1e-12), name
    history = orchestrate.shake(BEAM, SWEEP, sample_rate=4000.0, progress=False)
    sensor = orchestrate.Sensor(bandwidth=250.0, sample_rate=4000.0)
    thinned = record_evidence(orchestrate.measure(history, sensor, excitation=SWEEP))
    assert 400.0 < thinned.sample_rate < 600.0 and missed(thinned, BEAM, player) < 0.15
    for evidence, most in ((record_evidence(record()), 0.08), (part, 0.1)):
        assert missed(evidence, BEAM, player) < most
        for changed in ({"f1": 30.6}, {"e": 0.6}, {"zeta2": 0.03}):
            assert missed(evidence, BEAM.replace(**changed), player) > 0.25


def test_what_is_computed_at_once_is_what_windows_give(player):
    """Impulses do not come back from above the sampling rate."""
    evidence = record_evidence(record())
    motion = motion_of(evidence, BEAM, player)
    second = np.diff(motion, 2, axis=1) * evidence.sample_rate**2
    second = np.pad(second, ((0, 0), (1, 1)), mode="edge")
    read = np.sinc(np.outer((1, 2, 3), evidence.frequency) / evidence.sample_rate) ** 2
    expected = evidence.windows.amplitudes(second) / read + evidence.base_orders
    computed = evidence.ideal_orders(motion)
    np.testing.assert_allclose(computed, expected, atol=1e-9 * abs(expected).max())
    missed = abs(computed[:, 0] - evidence.measured_orders[:, 0]) / evidence.order_1_size
    assert np.median(missed) < 2e-3


def test_a_bonded_structure_is_one_mass():
    evidence = record_evidence(record(BEAM.as_bonded()))
    common = Delaminated(BEAM).values_from_structure(BEAM, evidence)["common"]
    zeta = (BEAM.d1 + BEAM.d2) / (2.0 * (BEAM.m1 + BEAM.m2) * 2.0 * np.pi * common)
    motion = Bonded().displacements({"f": common, "log_zeta": np.log(zeta)}, evidence, None)
    assert misfit(evidence.residuals_of_motion(motion)) < 0.02


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
    rubbing = ({**values, "friction": f} for f in np.linspace(0.0, 0.5, 11))
    motions = (hypothesis.displacements(one, evidence, player) for one in rubbing)
    missed = [misfit(evidence.residuals_of_motion(one)) for one in motions]
    assert min(missed) < 0.5 and missed[0] > 2.0, missed


def test_motions_without_bounds_are_far_from_the_record_and_have_errors_too():
    evidence = record_evidence(record(BEAM.as_bonded()))
    nowhere = np.full((1, evidence.sample_count), np.nan)
    gone = evidence.residuals_of_motion(nowhere)
    assert np.isfinite(gone).all() and misfit(gone) > 5.0
    computed = evidence.correct_for_sensors(evidence.ideal_orders(nowhere))
    assert misfit(evidence.residuals_of_orders(computed)) > 5.0
    search = Search(NonlinearSpring(), evidence)
    values = {"f": evidence.resonance, "log_zeta": -5.0, "square": -1.0, "cube": -0.9}
    for one in (values, {**values, "f": 2.0 * evidence.resonance}):
        assert np.isfinite(estimate_with_errors(search, one)[1]).all()
    evidence.__dict__["displacement"] = 1e-12  # as of a sensor that hardly moves
    assert np.isnan(search.hypothesis.displacements(values, evidence, None)[0, -1])
