"""When in the period something strikes: what no linear prediction foresees, by the stroke's phase.

In windows of some periods the samples are predicted from those before and after them: that removes
the forced motion, ringing modes and noise that is not white, and leaves what just struck. Its power
is binned over the phase of the sensor's own order 1, relative to the base: 0 is the top of the
stroke. Faces that part and meet strike where the halves' motions bring them together, which moves
with the stroke; a stop strikes where it stands.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..constants import TURN
from ..laboratory.analysis.channels import BOX, Channels
from ..laboratory.analysis.order_tracking import EDGE, NYQUIST, measured_phase
from ..laboratory.pieces import Floats

ORDERS = np.arange(1, 13)  # of what a window is projected on
HIGH = slice(5, 12)  # orders 6 to 12


@dataclass(frozen=True)
class TimingSettings:
    """Thresholds of :meth:`Strikes.word`, and the lengths with which it is measured."""

    memory: float = 0.006  # s of samples that predict one
    periods: float = 10.0  # of a window
    bins: int = 32  # of a period; half as many of slow records
    tail: float = 1e-4  # probability of a bin by noise, in a window
    loud: float = 0.3  # of the loudest window's power: windows that count
    # loudest bin over the quietest third's mean, over the limit of noise: what may be a strike,
    # and what is one
    faint: float = 3.0
    heard: float = 10.0
    base: float = 0.25  # of the sensor's ratio that the base may reach
    locked: float = 0.9  # circular concentration of the peaks' phases
    one_sided: float = 0.5  # first circular moment of a window's power
    blow: float = 0.11  # median of orders 6 to 12 over order 2: rattling clamps make 0.095
    opposite: float = -0.95  # correlation of both sensors' blows: clamps with torsion make -0.9
    order2: float = 0.05  # over order 1: parts of a percent of the mass make 0.042
    spread: float = 0.33  # of the place over the windows, over the amplitude: play makes 0.31
    softer: float = 0.9  # resonance over that of the faces shut: what is looser is the clamp
    stiffer: float = 1.06


TIMING = TimingSettings()
NOTHING, FAINT, FACES = "nothing heard", "something faint", "faces strike"
STOP, SOFTER = "stop", "stop or softer face"


@dataclass(frozen=True)
class Strikes:
    """Hold what a sensor's loud windows say of what strikes in them."""

    heard: float  # loudest bin over the mean of the quietest third, over the limit of noise
    base: float  # of the base, the median: of many windows noise makes 4 in one
    locked: float  # circular concentration of the peaks' phases
    one_sided: float  # first circular moment of the power beyond the floor
    blow: float  # median of orders 6 to 12 over order 2
    opposite: float  # correlation of what both sensors hear in the loudest bin; NaN with one
    order2: float  # over order 1, the largest
    spread: float  # range of its place over the windows, over the largest amplitude
    stiffness: float  # resonance over that of the faces shut; NaN where that is not known

    def numbers(self) -> str:
        """Format the quantities of the rule."""
        known = ((name, value) for name, value in vars(self).items() if math.isfinite(value))
        return ", ".join(f"{name} {value:.3g}" for name, value in known)

    def word(self, settings: TimingSettings = TIMING) -> str:
        """Return what strikes.

        - "nothing heard" up to `faint`, "base strikes" if the base has more than that and `base`
          of it.
        - "faces strike": the peaks' phases agree by `locked`, orders 6 to 12 are above `blow` of
          order 2, and the blows of two sensors are `opposite`.
        - "something faint" up to `heard`; "not locked" if the phases agree less, or the power is
          not on one side of the period by `one_sided`; "kinks" below `blow`; "something small
          strikes" with an order 2 below `order2`.
        - "stop" if the place moves by less than `spread`.
        - "faces strike" of one sensor with a resonance from `softer` to `stiffer`; else, and of two
          sensors, "stop or softer face".
        """
        if not self.heard > settings.faint:
            return NOTHING
        if self.base > max(settings.base * self.heard, settings.faint):
            return "base strikes"
        is_blow, is_locked = self.blow > settings.blow, self.locked >= settings.locked
        if is_locked and is_blow and self.opposite < settings.opposite:
            return FACES
        limits = {
            FAINT: self.heard > settings.heard,
            "not locked": is_locked and self.one_sided >= settings.one_sided,
            "kinks": is_blow,
            "something small strikes": self.order2 >= settings.order2,
            STOP: self.spread >= settings.spread,
            SOFTER: settings.softer <= self.stiffness <= settings.stiffer
            and math.isnan(self.opposite),
        }
        return next((word for word, holds in limits.items() if not holds), FACES)


def strikes(
    channels: Channels, shut: float = math.nan, settings: TimingSettings = TIMING
) -> Strikes:
    """Measure what strikes at the sensor that hears most; ``shut``: resonance of shut faces, Hz."""
    rows = [row for row, name in enumerate(channels.names) if name != BOX]
    every = (strikes_at(channels, [row, *(set(rows) - {row})], shut, settings) for row in rows)
    return max(every, key=lambda one: one.heard)


def strikes_at(
    channels: Channels, rows: Sequence[int], shut: float, settings: TimingSettings
) -> Strikes:
    """Measure what strikes at the first of these sensors, with the other one's blows."""
    columns = np.array(list(timed_windows(channels, rows, settings))).T
    heard, base, power, peak, moment, blow, first, second, level, hertz, opposite = columns
    top = int(np.argmax(np.where(heard > 1.0, power, 0.0)))
    loud = (power >= settings.loud * power[top]) & (heard > 1.0)
    loud[top] = True
    size = first / hertz**2
    position, turned = size * np.cos(peak) / size.max(), np.exp(1j * peak[loud])
    return Strikes(
        heard=float(heard[loud].max()),
        base=float(np.median(base[loud])),
        locked=float(abs(np.average(turned, weights=np.maximum(power[loud], 1e-300)))),
        one_sided=float(np.median(moment[loud])),
        blow=float(np.median(blow[loud])),
        opposite=float(np.median(opposite[loud])),
        order2=float((second / first)[loud].max()),
        spread=float(np.ptp(position[loud])),
        stiffness=float(hertz[int(np.argmax(first / level))] / shut),
    )


def timed_windows(
    channels: Channels, rows: Sequence[int], settings: TimingSettings
) -> Iterator[tuple[float, ...]]:
    """Yield the quantities of each window, in the order in which :func:`strikes_at` reads them."""
    phase = np.maximum.accumulate(measured_phase(channels))
    marks = np.arange(phase[0] / TURN + EDGE, phase[-1] / TURN - EDGE, settings.periods)
    edges = np.searchsorted(phase, TURN * marks)
    order = max(4, round(settings.memory * channels.sample_rate))
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        if end - begin < 6 * order:
            continue
        here, base = phase[begin:end], channels.box[begin:end]
        hertz = settings.periods * channels.sample_rate / (end - begin)
        waves = np.exp(-1j * np.outer(ORDERS, here))
        moved = channels.values[rows[0], begin:end] - base
        size = 2.0 / len(here) * np.einsum("ns,s", waves, moved - moved.mean())  # without threads
        level = 2.0 / len(here) * abs(np.einsum("s,s", waves[0], base))
        # a displacement is opposite to its acceleration: the top of the stroke is at 0
        own = here + np.angle(-size[0])
        at_base, *errors = (
            prediction_error(one, order)
            for one in (base, *(channels.values[row, begin:end] for row in rows))
        )
        heard, power, peak, moment, opposite = timed_power(errors, own, settings)
        base_heard = timed_power([at_base], own, settings)[0]
        high = np.abs(size[HIGH])[ORDERS[HIGH] * hertz < NYQUIST * channels.sample_rate]
        blow = float(np.median(high)) / abs(size[1]) if len(high) else math.nan
        first, second = abs(size[0]), abs(size[1])
        own_part = heard, base_heard, power, peak, moment, blow
        yield *own_part, first, second, level, hertz, opposite


def timed_power(
    errors: Sequence[Floats], phase: Floats, settings: TimingSettings
) -> tuple[float, float, float, float, float]:
    """Return how far the loudest bin rises over noise, its power and phase, and the moment.

    Last comes the correlation of both sensors' errors in that bin, NaN of one sensor.
    """
    from scipy.special import chdtri

    bins = np.floor(phase / TURN * settings.bins).astype(int) % settings.bins
    count = np.bincount(bins, minlength=settings.bins)
    if count.min() < 3:
        bins //= 2
        count = np.bincount(bins, minlength=settings.bins // 2)
    number, usual = len(count), float(np.mean(count))
    power = np.bincount(bins, errors[0] ** 2, number) / np.maximum(count, 1)
    floor = max(float(np.sort(power)[: number // 3].mean()), 1e-300)
    limit = float(chdtri(usual, settings.tail / number)) / usual
    above, middle = np.maximum(power - floor, 0.0), (np.arange(number) + 0.5) / number * TURN
    moment = float(abs(above @ np.exp(1j * middle)) / max(above.sum(), 1e-300))
    loudest = int(np.argmax(above))
    both = np.stack([error[bins == loudest] for error in errors])
    products = both @ both.T
    sizes = np.sqrt(np.maximum(np.diag(products), 1e-300))
    opposite = float((products / np.outer(sizes, sizes))[0, 1]) if len(errors) > 1 else math.nan
    rise, loudness = power[loudest] / floor / limit, float(above[loudest])
    return rise, loudness, float(middle[loudest]), moment, opposite


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
