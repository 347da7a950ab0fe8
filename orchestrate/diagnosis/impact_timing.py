"""When in the period something strikes: what no linear prediction foresees, by the stroke's phase.

In windows of some periods the samples are predicted from those before and after them: that removes
the forced motion, ringing modes and noise that is not white, and leaves what just struck. Its power
is binned over the phase of the sensor's own order 1, relative to the base: 0 is the top of the
stroke. Faces that part and meet strike where the halves' motions bring them together, which moves
with the stroke; a stop strikes where it stands.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..constants import TURN
from ..laboratory.analysis.channels import Channels
from ..laboratory.analysis.orders import EDGE, NYQUIST, measured_phase
from ..laboratory.pieces import Floats

ORDERS = np.arange(1, 13)  # of what a window is projected on
HIGH = slice(5, 12)  # orders 6 to 12


@dataclass(frozen=True)
class TimingSettings:
    """Thresholds of :meth:`Strikes.word`, and the lengths with which it is measured."""

    memory: float = 0.006  # s of samples that predict one
    periods: float = 10.0  # of a window
    bins: int = 32  # of a period; half as many of slow records
    tail: float = 1e-4  # probability of a bin by noise alone, in a window
    loud: float = 0.3  # of the loudest window's power: windows that count
    heard: float = 10.0  # loudest bin over the quietest third's mean, over the limit of noise
    base: float = 0.25  # of the sensor's ratio that the base may reach
    locked: float = 0.9  # circular concentration of the peaks' phases
    one_sided: float = 0.5  # first circular moment of a window's power
    blow: float = 0.05  # median of orders 6 to 12 over order 2
    stiffer: float = 1.06  # resonance over that of the faces shut
    place: float = 0.15  # distance from the nearer end, over the stroke
    spread: float = 0.24  # of the place over the windows, over the largest amplitude
    order2: float = (
        0.04  # over order 1, with what noise adds: parts of a percent of the mass make 0.03
    )


TIMING = TimingSettings()


@dataclass(frozen=True)
class Strikes:
    """Hold what a sensor's loud windows say of what strikes in them."""

    heard: float  # loudest bin over the mean of the quietest third, over the limit of noise
    base: float  # the same of the base
    locked: float  # circular concentration of the peaks' phases
    one_sided: float  # first circular moment of the power beyond the floor
    blow: float  # median of orders 6 to 12 over order 2
    stiffness: float  # resonance over that of the faces shut; NaN where that is not known
    place: float  # distance of the strike from the nearer end, over the stroke
    spread: float  # range of its place over the windows, over the largest amplitude
    order2: float  # over order 1, the largest

    def numbers(self) -> str:
        """Format the quantities of the rule."""
        return ", ".join(f"{name} {value:.3g}" for name, value in vars(self).items())

    def word(self, settings: TimingSettings = TIMING) -> str:
        """Return what strikes.

        - "nothing heard" below `heard`, "base strikes" where the base has more than `base` of it.
        - "not locked": the peaks' phases agree less than `locked`, or the power is not on one side
          of the period by `one_sided`.
        - "kinks": orders 6 to 12 are below `blow` of order 2.
        - "stop": the place is within `place` of an end and moves by less than `spread`, or the
          resonance is above `stiffer`; "stop or softer face" if only that is so or not known.
        - "faces strike" else, with order 2 above `order2`; or "something small strikes".
        """
        if not self.heard > settings.heard:
            return "nothing heard"
        if self.base > settings.base * self.heard:
            return "base strikes"
        if self.locked < settings.locked or self.one_sided < settings.one_sided:
            return "not locked"
        if not self.blow > settings.blow:
            return "kinks"
        if self.place < settings.place and self.spread < settings.spread:
            return "stop"
        if not self.stiffness <= settings.stiffer:
            return "stop or softer face"
        return "faces strike" if self.order2 > settings.order2 else "something small strikes"


def strikes(
    channels: Channels, row: int, shut: float = math.nan, settings: TimingSettings = TIMING
) -> Strikes:
    """Measure when a sensor hears something strike; ``shut``: resonance of shut faces, Hz."""
    columns = np.array(list(timed_windows(channels, row, settings))).T
    heard, base, power, peak, moment, blow, first, second, level, hertz = columns
    top = int(np.argmax(np.where(heard > 1.0, power, 0.0)))
    loud = (power >= settings.loud * power[top]) & (heard > 1.0)
    loud[top] = True
    size = first / hertz**2
    position, turned = size * np.cos(peak) / size.max(), np.exp(1j * peak[loud])
    return Strikes(
        heard=float(heard[loud].max()),
        base=float(base[loud].max()),
        locked=float(abs(np.average(turned, weights=np.maximum(power[loud], 1e-300)))),
        one_sided=float(np.median(moment[loud])),
        blow=float(np.median(blow[loud])),
        stiffness=float(hertz[int(np.argmax(first / level))] / shut),
        place=float(np.median(0.5 - 0.5 * np.abs(np.cos(peak[loud])))),
        spread=float(np.ptp(position[loud])),
        order2=float((second / first)[loud].max()),
    )


def timed_windows(
    channels: Channels, row: int, settings: TimingSettings
) -> Iterator[tuple[float, ...]]:
    """Yield the quantities of each window, in the order in which :func:`strikes` reads them."""
    phase = np.maximum.accumulate(measured_phase(channels))
    marks = np.arange(phase[0] / TURN + EDGE, phase[-1] / TURN - EDGE, settings.periods)
    edges = np.searchsorted(phase, TURN * marks)
    order = max(4, round(settings.memory * channels.sample_rate))
    face, box = channels.values[row], channels.box
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        if end - begin < 6 * order:
            continue
        here, base = phase[begin:end], box[begin:end]
        hertz = settings.periods * channels.sample_rate / (end - begin)
        waves = np.exp(-1j * np.outer(ORDERS, here))
        moved = face[begin:end] - base
        size = 2.0 / len(here) * (waves @ (moved - moved.mean()))
        level = 2.0 / len(here) * abs(waves[0] @ base)
        # a displacement is opposite to its acceleration: the top of the stroke is at 0
        own = here + np.angle(-size[0])
        heard, power, peak, moment = timed_power(face[begin:end], own, order, settings)
        base_heard = timed_power(base, own, order, settings)[0]
        high = np.abs(size[HIGH])[ORDERS[HIGH] * hertz < NYQUIST * channels.sample_rate]
        blow = float(np.median(high)) / abs(size[1]) if len(high) else math.nan
        first, second = abs(size[0]), abs(size[1])
        yield heard, base_heard, power, peak, moment, blow, first, second, level, hertz


def timed_power(
    signal: Floats, phase: Floats, order: int, settings: TimingSettings
) -> tuple[float, float, float, float]:
    """Return how far the loudest bin rises over noise, its power, its phase, and the moment."""
    from scipy.special import chdtri

    bins = np.floor(phase / TURN * settings.bins).astype(int) % settings.bins
    count = np.bincount(bins, minlength=settings.bins)
    if count.min() < 3:
        bins //= 2
        count = np.bincount(bins, minlength=settings.bins // 2)
    number, usual = len(count), float(np.mean(count))
    power = np.bincount(bins, prediction_error(signal, order) ** 2, number) / np.maximum(count, 1)
    floor = max(float(np.sort(power)[: number // 3].mean()), 1e-300)
    limit = float(chdtri(usual, settings.tail / number)) / usual
    above, middle = np.maximum(power - floor, 0.0), (np.arange(number) + 0.5) / number * TURN
    moment = float(abs(above @ np.exp(1j * middle)) / max(above.sum(), 1e-300))
    loudest = int(np.argmax(above))
    return power[loudest] / floor / limit, float(above[loudest]), float(middle[loudest]), moment


def prediction_error(signal: Floats, order: int) -> Floats:
    """Return what the samples before do not foresee, by weights that serve both directions."""
    after = np.lib.stride_tricks.sliding_window_view(signal, order + 1)
    before = after[:, ::-1]
    products = before.T @ before + after.T @ after
    products[np.diag_indices(order + 1)] *= 1.0 + 1e-9  # of a signal without noise
    weights = np.linalg.solve(products[1:, 1:], products[1:, 0])
    error = np.zeros(len(signal))
    error[order:] = before[:, 0] - before[:, 1:] @ weights
    return error
