"""What order 2 tells of an opening, and what two sensors on one body tell."""

import numpy as np
import pytest

import orchestrate
from orchestrate.diagnosis.opening_measures import (
    measure_opening,
    order_2_thresholds,
    scaled_sensor_difference,
    smallest_visible_opening_by_window,
)
from tests.benches.bench import Bench
from tests.benches.excitation import Swept
from tests.benches.lumped import Faces, Halves
from tests.benches.sensors import Sensor

from ...sparing import ordinary
from .records import BEAM, record_evidence, seen_at


@pytest.mark.parametrize("opposite", [True, False])
def test_faces_move_apart_where_their_order_2_differs(opposite):
    """Both read order 2 in phase, or opposite to each other; gains and delays differ."""
    rng, time, rows = np.random.default_rng(4), np.arange(10_000) / 1000.0, {}
    for name, sign, delay, gain in (("1", 1.0, 0.0, 1.0), ("2", -1.0, 2e-4, 0.96)):
        phase = 2.0 * np.pi * (26.0 + 0.8 * (time - delay)) * (time - delay)
        order2 = 0.05 * (sign if opposite else 1.0) * np.sin(2.0 * phase)
        noise = 0.005 * rng.standard_normal(len(time))
        rows[f"acceleration{name}"] = gain * (np.sin(phase + 0.4) + order2) + noise
    base = 0.1 * np.sin(2.0 * np.pi * (26.0 + 0.8 * time) * time)
    evidence = record_evidence(orchestrate.record(time=time, box_acceleration=base, **rows))
    even = measure_opening(evidence, np.zeros_like(evidence.measured_orders))
    assert even.is_order_2_seen and even.is_opening_seen
    assert (
        (even.largest_sensor_difference > 1.5)
        if opposite
        else (even.largest_sensor_difference < 0.5)
    )


def test_sensors_at_two_places_of_a_sound_beam_do_not_differ():
    apart = []
    for structure in (BEAM.as_bonded(), BEAM):
        evidence = record_evidence(seen_at(0.8, 0.65, structure))
        apart.append(np.nanmax(scaled_sensor_difference(evidence, order_2_thresholds(evidence))))
    assert apart[0] < 0.1 and apart[1] > 2.0


@pytest.mark.parametrize("sensors", ordinary([1, 2]))
def test_what_would_have_been_seen_is_not_below_an_opening_that_was_not(sensors):
    """Faces that are pressed together open a little, at the resonance alone."""
    halves = Halves(m1=1.5, m2=1.2, f1=38.0, f2=34.5, zeta1=0.01, zeta2=0.01)
    faces = Faces(law="hunt-crossley", frequency=900.0, clearance=-3.7e-4)
    one, sweep = Sensor(noise=0.03), Swept(24.0, 56.0, 12.0, 3.0)
    other = one if sensors == 2 else None
    bench = Bench(excitation=sweep, box=one, face1=one, face2=other, rate=1000.0)
    record, motion = bench.measure(halves.delaminated(faces), seed=3)
    gap, evidence = float(motion.largest_gap.max()), record_evidence(record)
    assert gap > 1e-5, "it opened"
    assert not measure_opening(evidence, np.zeros_like(evidence.measured_orders)).is_order_2_seen
    stated = smallest_visible_opening_by_window(evidence, halves.m1, halves.m2)
    assert gap < np.nanmax(stated) < 5.0 * gap
