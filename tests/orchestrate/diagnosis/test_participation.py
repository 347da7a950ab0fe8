"""Sensors anywhere on a beam: each reads the base and a part of the mode, and is fitted so."""

import pytest

import orchestrate
from orchestrate.errors import InputError
from tests.benches.beam import DelaminatedBeam
from tests.benches.bench import Bench
from tests.benches.excitation import Swept
from tests.benches.lumped import TURN, Faces
from tests.benches.sensors import Sensor

from .records import BEAM, guess, record_evidence, seen_at

TIP, MIDDLE = 1.566, 0.532  # of a uniform cantilever: Blevins, Formulas for Natural Frequency


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


def test_a_factor_that_is_given_is_kept():
    measured, how = seen_at(0.6), {"hypothesis": "bonded", "jobs": 1, "progress": False}
    assert record_evidence(measured).fixed_participation(0) is None
    free = orchestrate.fit(measured, guess(), **how)
    kept = orchestrate.fit(measured, guess(), participation=0.9, **how)
    assert kept.participation.values.tolist() == [0.9] and kept.participation_error.item() == 0.0
    assert float(kept.misfit) > float(free.misfit)
    for given, words in (("much", "participation = 'much'"), ({"acceleration2": 0.5}, "no sensor")):
        with pytest.raises(InputError, match=words):
            orchestrate.detect(measured, guess(), participation=given)
