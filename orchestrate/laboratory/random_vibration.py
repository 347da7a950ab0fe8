"""Stationary random vibration of a given power spectral density."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from ..errors import InputError
from ..model.arguments import check_and_convert_fields
from ..model.ranges import Quantity
from . import signals
from .pieces import ERROR, POINTS, Floats, Pieces, max_phase_step

RMS = Quantity("rms", "m/s2", "", 1e-120, 1e12)  # its square over that of any profile is above 0


@dataclass(frozen=True, kw_only=True)
class Random(signals.ExcitationSignal):
    """Stationary Gaussian-like vibration of a given power spectral density.

    The sum of sines at all multiples of 1/duration, each with the amplitude that its share of the
    density asks for, and a random phase (Shinozuka and Deodatis, Appl. Mech. Rev. 44, 1991): the
    periodogram over the duration is the profile exactly, and nothing lies outside its band, so the
    box's velocity and displacement stay bounded.

    Parameters
    ----------
    psd : sequence of (float, float)
        One-sided density as break points (Hz, (m/s2)^2/Hz), straight between them in log-log
        scales.
    duration : float
        s.
    seed : int
        Of the phases.
    rms : float, optional
        Root mean square of the acceleration, m/s2, to which ``psd`` is scaled; by default it is
        taken as it is.

    Examples
    --------
    >>> shaking = Random(psd=[(20.0, 0.5), (200.0, 0.5)], duration=8.0, seed=1)
    >>> round(shaking.rms, 2)  # m/s2; sqrt(0.5 (200 - 20)) is 9.49
    9.49
    >>> round(Random(psd=[(20.0, 1.0), (200.0, 1.0)], duration=8.0, rms=3.0).psd[0][1], 3)  # 9/180
    0.05
    """

    psd: signals.Profile
    duration: signals.Seconds
    seed: int = 0
    rms: float = None  # type: ignore[assignment]  # it is known once all is checked

    def __post_init__(self) -> None:
        object.__setattr__(self, "psd", signals.checked_profile("psd", self.psd, signals.DENSITY))
        check_and_convert_fields(self)
        whole = isinstance(self.seed, (int, np.integer)) and not isinstance(self.seed, bool)
        if not whole or self.seed < 0:
            raise InputError(f"seed = {self.seed!r}: expected a whole number >= 0")
        amplitudes = self._sine_amplitudes()
        if not amplitudes.any():
            band = f"{self.psd[0][0]:g} to {self.psd[-1][0]:g} Hz"
            text = f"no multiple of 1/duration lies within {band}; expected a longer one"
            raise InputError(f"duration = {self.duration!r} s: {text}")
        rms = float(np.sqrt(0.5 * (amplitudes**2).sum()))
        if self.rms is not None:
            stated = signals.checked_quantity(RMS, "rms", self.rms)
            scaled = tuple((f, value * (stated / rms) ** 2) for f, value in self.psd)
            object.__setattr__(self, "psd", scaled)
            rms = stated
        object.__setattr__(self, "rms", rms)

    @property
    def label(self) -> str:
        return f"random {self.psd[0][0]:g} to {self.psd[-1][0]:g} Hz, {self.rms:.4g} m/s2 rms"

    @property
    def usual_rate(self) -> float:
        return 10.0 * self.psd[-1][0]

    def _sine_amplitudes(self) -> Floats:
        """Return the amplitudes of the sines at 0, 1, 2 ... over the duration, m/s2."""
        count = math.floor(self.psd[-1][0] * self.duration * (1.0 + 1e-12)) + 1
        if count > signals.MOST_PIECES // 20:
            most = (signals.MOST_PIECES // 20) / self.psd[-1][0]
            raise InputError(f"duration = {self.duration!r} s: expected at most {most:.3g} s")
        density = signals.interpolate_profile(self.psd, np.arange(count) / self.duration)
        return np.sqrt(2.0 * density / self.duration)

    def pieces(self, accuracy: float = 1e-6) -> Pieces:
        """Return equal pieces: values at their Chebyshev points by inverse Fourier transforms."""
        from scipy.fft import next_fast_len

        amplitudes = self._sine_amplitudes()
        order = np.arange(len(amplitudes))
        phases = np.random.default_rng(self.seed).uniform(0.0, TURN, len(amplitudes))
        lines = 0.5 * amplitudes * np.exp(1j * phases)
        omega = TURN * order / self.duration
        # as a sine whose fourth derivative has the same ratio to it, by root mean squares
        ratio = np.linalg.norm(amplitudes * omega**4) / np.linalg.norm(amplitudes)
        longest = max_phase_step(accuracy) / ratio**0.25
        least = max(math.ceil(self.duration / longest), 4 * len(lines))
        count = int(next_fast_len(least, real=True))
        step = self.duration / count

        def signal_at(shift: float, weights: Any = 1.0) -> NDArray[np.float64]:
            return np.fft.irfft(weights * lines * np.exp(1j * omega * shift), count) * count

        values = np.stack([signal_at(point * step) for point in POINTS], axis=1)
        # between the nodes a trigonometric polynomial of degree n rises by no more than
        # 1/cos(pi n/N) above N equally spaced values (Ehlich and Zeller, Math. Z. 86, 1964)
        rise = 1.0 / math.cos(math.pi * (len(lines) - 1) / count)
        error = step**4 * np.abs(signal_at(0.0, omega**4)).max() * rise / ERROR
        nodes = self.duration * np.arange(count + 1) / count
        return Pieces.from_chebyshev_values(nodes, values, float(error))
