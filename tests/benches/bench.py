"""Virtual bench: shake a system by an excitation and record what its sensors read."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from orchestrate import record
from orchestrate.lazy import xr

from .excitation import Excitation
from .integrator import highest_stiffness, integrate
from .sensors import Sensor
from .system import Floats, ModalSystem, Motion

STEPS = 60.0  # in a period of the fastest oscillation, contacts closed
PIECE = 100_000  # numbers that are computed at once
BASE = 1.0 / 3000.0  # s: longest step, for what the base does


@dataclass(frozen=True, kw_only=True)
class Bench:
    """A shaker with an excitation and sensors on base and faces."""

    excitation: Excitation
    # `face2` is None where there is one accelerometer only
    box: Sensor = field(default_factory=Sensor)
    face1: Sensor = field(default_factory=Sensor)
    face2: Sensor | None = None
    rate: float = 2000.0  # samples of the record, Hz
    steps: float = STEPS  # of the integration, in a period of the fastest oscillation

    def steps_per_sample(self, system: ModalSystem) -> int:
        """Return the number of integration steps per sample for a system."""
        fastest = math.sqrt(highest_stiffness(system)) / (2.0 * math.pi)
        return math.ceil(max(self.steps * fastest, 1.0 / BASE, 8.0 * self.rate) / self.rate)

    def simulate(self, system: ModalSystem) -> tuple[Floats, Motion, int]:
        """Integrate a system's motion; return base acceleration, motion and steps per sample."""
        factor = self.steps_per_sample(system)
        step = 1.0 / (factor * self.rate)
        samples = int(self.excitation.duration * self.rate)
        base = np.empty(2 * samples * factor + 1)
        for begin in range(0, len(base), PIECE):
            part = slice(begin, min(begin + PIECE, len(base)))
            base[part] = self.excitation(
                0.5 * step * np.arange(part.start, part.stop, dtype=np.float64)
            )
        return base[::2], integrate(system, base, step), factor

    def measure(self, system: ModalSystem, seed: int) -> tuple[xr.Dataset, Motion]:
        """Shake a system; return the sensors' record as a dataset, and the true motion."""
        base, motion, factor = self.simulate(system)
        rngs = np.random.default_rng(seed).spawn(3)
        fine = factor * self.rate
        signals = (base, *motion.acceleration)
        sensors = (self.box, self.face1, self.face2)
        readings = [
            None if sensor is None else sensor.read(signal, fine, factor, rng)
            for sensor, signal, rng in zip(sensors, signals, rngs, strict=True)
        ]
        names = ("box_acceleration", "acceleration1", "acceleration2")
        channels = dict(zip(names, readings, strict=True))
        time = np.arange(len(signals[0][::factor])) / self.rate
        return record(time=time, **channels, source="virtual bench"), motion
