"""Sensors anywhere on a beam: each reads the base and a part of the mode, and is fitted so."""

import numpy as np
import pytest

import orchestrate
from orchestrate.diagnosis.even_orders import sensor_difference, thresholds
from orchestrate.errors import InputError
from tests.benches.beam import DelaminatedBeam
from tests.benches.bench import Bench
from tests.benches.excitation import Swept
from tests.benches.lumped import TURN, Faces
from tests.benches.sensors import Sensor

from .records import BEAM, RATE, SWEEP, guess, record_evidence, seen_at

TIP, MIDDLE = 1.566, 0.532  # of a uniform cantilever: Blevins, Formulas for Natural Frequency


@pytest.mark.parametrize("factor", [0.5, 1.5])
def test_a_sensor_reads_a_part_of_the_mass(factor):
    history = orchestrate.shake(BEAM, SWEEP, sample_rate=RATE, progress=False)
    usual, part = (
        orchestrate.measure(
            history,
            orchestrate.Sensor(bandwidth=250.0, sample_rate=RATE, participation=share),
            excitation=SWEEP,
        )
        for share in (1.0, factor)
    )
    np.testing.assert_array_equal(part.box_acceleration, usual.box_acceleration)
    for name in ("acceleration1", "acceleration2"):
        expected = usual.box_acceleration + factor * (usual[name] - usual.box_acceleration)
        scale = float(abs(usual[name]).max())
        np.testing.assert_allclose(part[name], expected, atol=1e-11 * scale)


def test_a_factor_that_is_no_number_is_one_line():
    with pytest.raises(InputError, match="participation = nan"):
        orchestrate.Sensor(bandwidth=250.0, participation=np.nan)


def cantilever(place):
    """A record of a sound beam of finite elements, and a structure near it; ``place`` of 1: tip."""
    beam = DelaminatedBeam(first=0.0, last=0.0)
    system = beam.system(Faces(), 0.01, modes=4, sensor=place * beam.length)
    f = float(system.frequency[0]) / TURN
    sweep = Swept(0.75 * f, 1.3 * f, 12.0, 4.0)
    measured, _ = Bench(excitation=sweep, box=Sensor(), face1=Sensor()).measure(system, 1)
    return measured, BEAM.replace(f1=0.93 * f, f2=1.08 * f)


def test_a_sound_cantilever_is_described_wherever_its_sensor_is():
    """The factor is that of the literature."""
    fitted = orchestrate.fit(*cantilever(0.5), hypothesis="bonded", jobs=1, progress=False)
    assert float(fitted.misfit) < 0.4
    found = fitted.sel(channel="acceleration1")
    error = abs(float(found.participation) - MIDDLE)
    assert error < min(0.03 * MIDDLE, 4.0 * float(found.participation_error))


@pytest.mark.slow
def test_of_a_sound_cantilever_no_opening_is_seen():
    answer = orchestrate.detect(*cantilever(1.0), jobs=1, progress=False)
    assert answer.verdict == "no opening seen" and float(answer.misfit.min()) < 0.4
    bonded = answer.sel(hypothesis="bonded", channel="acceleration1")
    assert float(bonded.participation) == pytest.approx(TIP, rel=0.03)


def test_sensors_at_two_places_of_a_sound_beam_do_not_differ():
    apart = []
    for structure in (BEAM.as_bonded(), BEAM):
        evidence = record_evidence(seen_at(0.8, 0.65, structure))
        apart.append(np.nanmax(sensor_difference(evidence, thresholds(evidence))))
    assert apart[0] < 0.1 and apart[1] > 2.0


def test_a_factor_that_is_given_is_kept():
    measured = seen_at(0.6)
    known = record_evidence(measured)
    assert known.given_participation(0) is None
    free = orchestrate.fit(measured, guess(), hypothesis="bonded", jobs=1, progress=False)
    kept = orchestrate.fit(
        measured, guess(), hypothesis="bonded", participation=0.9, jobs=1, progress=False
    )
    assert kept.participation.values.tolist() == [0.9] and kept.participation_error.item() == 0.0
    assert float(kept.misfit) > float(free.misfit)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("much", "participation = 'much'"),
        ({"acceleration2": 0.5}, "'acceleration2' is no sensor; the record has acceleration1"),
    ],
)
def test_mistaken_factors_are_one_line(given, words):
    with pytest.raises(InputError, match=words):
        orchestrate.detect(seen_at(1.0), guess(), participation=given)
