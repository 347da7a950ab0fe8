"""Write the records of the manual's tutorial: beams on one shaker, as CSV files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.signal import butter, sosfiltfilt

from orchestrate.lazy import xr

from .beam import DelaminatedBeam
from .bench import Bench
from .excitation import Swept
from .lumped import Clamp, Faces, Halves, in_rattling_clamp
from .sensors import Sensor
from .system import ModalSystem

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "records"
GRAVITY = 9.80665  # m/s2
LEVEL = 0.4  # g
SWEEP = Swept(first=20.0, last=90.0, duration=40.0, level=LEVEL * GRAVITY)
RATE = 1250.0  # Hz
BEAM = Halves(m1=1.5, m2=1.2, f1=42.0, f2=52.0, zeta1=0.008, zeta2=0.009)
FACES = Faces(law="hunt-crossley", frequency=1000.0, restitution=0.6, speed=0.05)
CLAMP = Clamp(faces=Faces(frequency=600.0), play=1e-4, mass=0.2, centring=1.0)
FACE = Sensor(noise=0.02, gain=1.02)
BENCH = Bench(excitation=SWEEP, box=Sensor(noise=0.01), face1=FACE, rate=RATE)
HEADING = """\
Virtual bench with compliant contact: computed, not measured
Test;Swept sine {first:g}-{last:g} Hz, linear, {duration:g} s, {g} g
Beam;{name}
Sampling rate [Hz];{rate:g}
Channel 1;Base, on the shaker's table
Channel 2;Acc 1, on the face of the beam, 2,0 kHz
"""
COLUMNS = "Time [s];Base [g];Acc 1 [g]\n"
LASER_BEAM = DelaminatedBeam(first=0.15, share=0.45)  # of finite elements
LASER_BENCH = Bench(
    excitation=Swept(first=15.0, last=55.0, duration=20.0, level=4.0),
    box=Sensor(noise=0.01),
    face1=Sensor(noise=0.01, gain=1.01),
    rate=1024.0,
    steps=30.0,
)


BEAMS: dict[str, tuple[str, Callable[[], ModalSystem], int]] = {  # name, system, seed of noise
    "beam_a": ("A", lambda: BEAM.delaminated(FACES), 71),
    "beam_b": ("B", BEAM.bonded, 72),
    "beam_c": ("C", lambda: in_rattling_clamp(BEAM.bonded(), BEAM.m1 + BEAM.m2, CLAMP), 73),
}


def format_record(record: xr.Dataset, name: str) -> str:
    """Return a record as CSV text: headings, semicolons, decimal commas, in g."""
    head = HEADING.format(**vars(SWEEP), g=LEVEL, name=name, rate=RATE)
    base, face = (record[c].values / GRAVITY for c in ("box_acceleration", "acceleration1"))
    table = np.stack([record.time.values, base, face], axis=1)
    rows = "".join(f"{t:.4f};{b:.4f};{a:.3f}\n" for t, b, a in table.tolist())
    return (head + COLUMNS + rows).replace(".", ",")


def format_laser_record(record: xr.Dataset) -> str:
    """Return beam D's record as it is often met: base in volts, velocity upside down, no units."""
    rate = LASER_BENCH.rate
    drifting = cumulative_trapezoid(record.acceleration1.values, dx=1.0 / rate, initial=0.0)
    velocity = sosfiltfilt(butter(2, 2.0, "highpass", fs=rate, output="sos"), drifting)
    volts = 0.1 * record.box_acceleration.values / GRAVITY
    columns = (record.time.values, volts, -1e3 * velocity)
    rows = "".join("{:.5g},{:.5g},{:.5g}\n".format(*row) for row in zip(*columns, strict=True))
    return f"Time,Table,Laser tip\n{rows}"


def write_records(folder: Path = FOLDER, bench: Bench = BENCH) -> list[Path]:
    """Shake the beams and write their records; return the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    records = {
        folder / f"{stem}.csv": format_record(bench.measure(system(), seed)[0], name)
        for stem, (name, system, seed) in BEAMS.items()
    }
    system = LASER_BEAM.system(Faces(), 0.008, modes=12, sensor=LASER_BEAM.length)
    laser = format_laser_record(LASER_BENCH.measure(system, 74)[0])
    records[folder / "beam_d.csv"] = laser
    for path, text in records.items():
        path.write_text(text, encoding="utf-8", newline="\n")
    return list(records)
