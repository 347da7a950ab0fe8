"""The sound structure that a record is compared with: a linear oscillator under the same box."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..constants import TURN
from ..laboratory.analysis.channels import BOX, Channels
from ..laboratory.analysis.shock_spectrum import ramp_invariant_filter
from ..laboratory.pieces import Floats
from ..model import Structure


@dataclass(frozen=True)
class SoundStructure:
    """Describe a bonded structure as a linear oscillator: both masses move as one."""

    f: float  # natural frequency, Hz
    zeta: float  # damping ratio
    # of each sensor, minus its acceleration over the force that excites it, far above the
    # resonance; none where the box moves
    gains: tuple[float, ...] = ()

    @classmethod
    def from_structure(cls, structure: Structure) -> SoundStructure:
        """Return the bonded form of a structure of two halves."""
        m, k = structure.m1 + structure.m2, structure.k1 + structure.k2
        damping = (structure.d1 + structure.d2) / (2.0 * math.sqrt(k * m))
        return cls(math.sqrt(k / m) / TURN, min(damping, 0.999))

    def with_gains_under_force(self, frequency: Floats, response: Floats) -> SoundStructure:
        """Return the oscillator under a force, with gains that are nearest to responses."""
        model = complex_transmissibility(frequency, self.f, self.zeta) - 1.0
        gains = (response @ model.conj()).real / (np.abs(model) ** 2).sum()
        return replace(self, gains=tuple(gains.tolist()))

    @classmethod
    def fit_to_record(
        cls, frequency: Floats, response: Floats, channels: Channels, is_forced: bool = False
    ) -> SoundStructure:
        """Fit the oscillator whose acceleration is nearest to a record's."""
        from scipy.optimize import least_squares

        peak = float(frequency[int(np.abs(response).max(axis=0).argmax())])
        measured = channels.responses()[1]

        def from_logarithms(logs: Floats) -> SoundStructure:
            one = cls(*np.exp(logs).tolist())
            return one.with_gains_under_force(frequency, response) if is_forced else one

        def response_residuals(logs: Floats) -> Floats:
            rest = (from_logarithms(logs).response(frequency) - response).ravel()
            return np.concatenate([rest.real, rest.imag])

        def record_residuals(logs: Floats) -> Floats:
            return np.asarray((from_logarithms(logs).acceleration(channels) - measured).ravel())

        low, high = math.log(0.2 * frequency[0]), math.log(5.0 * frequency[-1])
        bounds = ([low, math.log(1e-4)], [high, math.log(0.9)])
        starts = [(math.log(peak), math.log(ratio)) for ratio in (0.003, 0.02, 0.1)]
        fits = [least_squares(response_residuals, start, bounds=bounds) for start in starts]
        best = min(fits, key=lambda fitted: float(fitted.cost))
        best = least_squares(record_residuals, best.x, bounds=bounds, x_scale=(0.01, 1.0))
        return from_logarithms(best.x)

    def response(self, frequency: Floats) -> Floats:
        """Return the acceleration over that of the box, or over the force: a row for each gain."""
        moved = complex_transmissibility(frequency, self.f, self.zeta)
        return np.outer(self.gains, moved - 1.0) if self.gains else moved

    def acceleration(self, channels: Channels) -> Floats:
        """Compute the absolute acceleration under the box, or the force, of a record, m/s2."""
        from scipy.signal import lfilter

        filters = ramp_invariant_filter(self.f, self.zeta, channels.sample_rate)
        moved = np.asarray(lfilter(*filters, channels.box))
        return np.outer(self.gains, moved - channels.box) if self.gains else moved

    def simulate_channels(
        self, channels: Channels, noise: Floats, seeds: Sequence[int]
    ) -> Channels:
        """Simulate what sensors on this structure would read: one row for each seed and channel."""
        steady = np.broadcast_to(self.acceleration(channels), (len(noise), len(channels.time)))
        rows = [channels.box]
        for seed in seeds:
            for number, level in enumerate(noise):
                generator = np.random.default_rng([seed, number])
                rows.append(steady[number] + level * generator.standard_normal(len(steady[number])))
        names = (BOX, *(f"sound {number}" for number in range(1, len(rows))))
        return Channels(channels.time, channels.sample_rate, names, np.stack(rows), channels.title)


def complex_transmissibility(frequency: Floats, f: float, zeta: float) -> Floats:
    """Return the absolute acceleration of an oscillator over that of its base, complex."""
    r = frequency / f
    loss = 2.0j * zeta * r
    return np.asarray((1.0 + loss) / (1.0 - r**2 + loss))
