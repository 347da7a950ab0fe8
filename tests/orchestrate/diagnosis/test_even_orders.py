"""What order 2 tells of an opening, and what two sensors on one body tell."""

import numpy as np
import pytest

import orchestrate
from orchestrate.diagnosis.even_orders import even_orders, smallest_openings
from tests.benches.bench import Bench
from tests.benches.excitation import Swept
from tests.benches.lumped import Faces, Halves
from tests.benches.sensors import Sensor

from ...sparing import ordinary
from .records import record_evidence


def two_sensors(opposite):
    """Both read order 2 in phase, or opposite to each other; gains and delays differ."""
    rate, rng = 1000.0, np.random.default_rng(4)
    time = np.arange(10_000) / rate
    rows = {}
    for name, sign, delay, gain in (("1", 1.0, 0.0, 1.0), ("2", -1.0, 2e-4, 0.96)):
        at = time - delay
        phase = 2.0 * np.pi * (26.0 + 0.8 * at) * at
        order2 = 0.05 * (sign if opposite else 1.0) * np.sin(2.0 * phase)
        noise = 0.005 * rng.standard_normal(len(time))
        rows[f"acceleration{name}"] = gain * (np.sin(phase + 0.4) + order2) + noise
    base = 0.1 * np.sin(2.0 * np.pi * (26.0 + 0.8 * time) * time)
    return record_evidence(orchestrate.record(time=time, box_acceleration=base, **rows))


@pytest.mark.parametrize("opposite", [True, False])
def test_faces_move_apart_where_their_order_2_differs(opposite):
    evidence = two_sensors(opposite)
    even = even_orders(evidence, np.zeros_like(evidence.measured))
    assert even.is_order_2_seen
    assert (even.moved_apart > 1.5) if opposite else (even.moved_apart < 0.5)


@pytest.mark.parametrize("sensors", ordinary([1, 2]))
def test_what_would_have_been_seen_is_not_below_an_opening_that_was_not(sensors):
    """Faces that are pressed together open a little, at the resonance alone."""
    halves = Halves(m1=1.5, m2=1.2, f1=38.0, f2=34.5, zeta1=0.01, zeta2=0.01)
    faces = Faces(law="hunt-crossley", frequency=900.0, clearance=-3.7e-4)
    sensor = Sensor(noise=0.03)
    bench = Bench(
        excitation=Swept(24.0, 56.0, 12.0, 3.0),
        box=sensor,
        face1=sensor,
        face2=sensor if sensors == 2 else None,
        rate=1000.0,
    )
    record, motion = bench.measure(halves.delaminated(faces), seed=3)
    gap = float(motion.largest_gap.max())
    assert gap > 1e-5, "it opened"
    evidence = record_evidence(record)
    assert not even_orders(evidence, np.zeros_like(evidence.measured)).is_order_2_seen
    stated = smallest_openings(evidence, halves.m1, halves.m2)
    assert gap < np.nanmax(stated) < 5.0 * gap
