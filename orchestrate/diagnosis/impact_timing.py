"""When in the period something strikes: what no linear prediction foresees, by the stroke's phase.

In windows of some periods the samples are predicted from those before and after them: that removes
the forced motion, ringing modes and noise that is not white, and leaves what just struck. Its power
is binned over the phase of the sensor's own order 1, relative to the base: 0 is the top of the
stroke. A stop pushes back near the top: the order 1 of its force, which stiffens the beam, is at
least 3/4 of the order 2 that it makes. Faces that part and meet do not push a beam back: its
stiffness stays that of the shut faces.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from ..laboratory.analysis.channels import BOX, Channels
from ..laboratory.analysis.linear_prediction import prediction_error
from ..laboratory.analysis.order_tracking import EDGE, NYQUIST, integrate_in_time, phase_of_box
from ..laboratory.pieces import Floats

ORDERS = np.arange(1, 13)  # of what a window is projected on
HIGH = slice(5, None)  # orders 6 to 12


@dataclass(frozen=True)
class TimingSettings:
    """Thresholds of :meth:`Strikes.what_strikes`, and the lengths with which it is measured."""

    memory: float = 0.27  # of a period: samples that predict one
    periods: float = 10.0  # of a window
    bins: int = 32  # of a period; half as many of slow records
    tail: float = 1e-4  # probability of a bin by noise, in a window
    # windows that count: of the largest stroke (a sweep's ends, where noise is all that moves,
    # reach 0.002) and of the loudest window's power
    moves: float = 0.05
    loud: float = 0.3
    # loudest bin over the quietest third's mean, over the limit of noise: what may be a strike
    # once a period, what may be one of a loose part, and what is one
    faint: float = 3.0
    rattles: float = 5.0
    heard: float = 10.0
    base: float = 0.25  # of the sensor's ratio that the base may reach
    # circular concentration of the peaks' phases: faces that meet at times make 0.66
    locked: float = 0.62
    # first circular moment of a window's power: clamps that strike both ways make 0.57, faces 0.61
    one_sided: float = 0.59
    # see `Strikes`: rattling clamps, which are soft, make 0.21, faces 0.36
    blow: float = 0.28
    # of both sensors' blows: clamps with torsion that soften less make -0.88; above 0 it is one
    opposite: float = -0.95
    together: float = 0.0
    order2: float = 0.025  # parts of some percent of the mass make 0.014, a stop 0.022
    # growth of the stiffness over order 2, from rest: faces make up to 0.2, halves of which one is
    # slow up to 1.5, at the stroke's end; stops 0.45 or more. From shut faces stops make -0.2 or
    # more, such halves less. Clamps: -0.18 before `at_end` (faces -0.09), order 2 of 0.5 (0.37)
    softens: float = -0.13
    lifts: float = 0.43
    at_end: float = 0.8
    stiffens: float = 0.25
    stiffens_moving: float = 1.5
    softer: float = -0.26  # from shut faces
    middle: float = 0.6  # share of the windows for the spread: one by itself is chance
    spread: float = 0.15  # of the place, over the stroke: stops and play make 0.07, gaps 0.28
    # see `rest_frequency_and_stiffness`: windows up to this factor from the loud ones' frequency,
    # where no other mode moves the sensor; how many tell the beam at rest; weight of a
    # participation of 1
    near: float = 1.5
    quiet: int = 8
    prior: float = 1e-6
    known: float = 0.03  # error of a frequency that is known
    slower: float = 0.83  # frequency over that of shut faces: clamps make 0.81, parted faces 0.86
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
    # median of orders 6 to 12 over order 2, over the root of order 2 over order 1: the softer the
    # contact, the larger the order 2 that it makes
    blow: float
    opposite: float  # correlation of what both sensors hear in the loudest bin; NaN with one
    order2: float  # over order 1
    stiffens: float  # growth of the stiffness from that at rest, over order 2
    from_shut: float  # the same from the least stiffness of shut faces; NaN: not known
    place: float  # where it strikes, over the stroke: -1 or 1 at its ends
    spread: float  # of the place in the `middle` of the windows, over the stroke
    stiffness: float  # frequency over that of the faces shut; NaN where that is not known

    def format_quantities(self) -> str:
        """Format the quantities of the rule that are known, by their names."""
        known = ((name, value) for name, value in vars(self).items() if math.isfinite(value))
        return ", ".join(f"{name} {value:.3g}" for name, value in known)

    def what_strikes(self, settings: TimingSettings = TIMING) -> str:
        """Return what strikes.

        - "nothing heard" up to `faint`, and up to `rattles` unless the peaks' phases agree by
          `locked`; "base strikes" if the base has more than `faint` and `base` of it.
        - "faces strike": the phases agree, orders 6 to 12 make a `blow`, those of two sensors are
          `opposite`, and the beam does not soften as by a clamp.
        - "something faint" up to `heard`; "not locked" if the phases do not agree, or the power is
          not on one side of the period by `one_sided`; "kinks" below `blow`; "something small
          strikes" with an order 2 below `order2`.
        - "stop" if the stiffness grows with the stroke, over order 2, by more than `stiffens`
          (`stiffens_moving` where it strikes from `at_end` of the stroke on, at a place that moves
          by `spread`), unless it stays `softer` than shut faces; or, where it strikes before that,
          falls by more than `softens` or makes an order 2 above `lifts`: a clamp.
        - "faces strike" with a known frequency, from `slower` to `stiffer` times it, unless two
          sensors hear blows that are `together`; else "stop or softer face".
        """
        is_blow, is_locked = self.blow > settings.blow, self.locked >= settings.locked
        if not self.heard > (settings.faint if is_locked else settings.rattles):
            return NOTHING
        if self.base > max(settings.base * self.heard, settings.faint):
            return "base strikes"
        before_end = abs(self.place) < settings.at_end
        moves = self.spread >= settings.spread and not before_end
        is_softer = self.stiffens > settings.stiffens and self.from_shut < settings.softer
        growth = self.from_shut if is_softer else self.stiffens
        softens = before_end and growth < settings.softens
        lifts = before_end and self.order2 > settings.lifts
        if is_locked and is_blow and self.opposite < settings.opposite and not softens:
            return FACES
        limits = {
            FAINT: self.heard > settings.heard,
            "not locked": is_locked and self.one_sided >= settings.one_sided,
            "kinks": is_blow,
            "something small strikes": self.order2 >= settings.order2,
            STOP: growth <= (settings.stiffens_moving if moves else settings.stiffens)
            and not softens
            and not lifts,
            SOFTER: settings.slower <= self.stiffness <= settings.stiffer
            and not self.opposite > settings.together,
        }
        return next((word for word, holds in limits.items() if not holds), FACES)


def measure_strikes(
    channels: Channels, shut_resonance: float = math.nan, settings: TimingSettings = TIMING
) -> Strikes:
    """Measure what strikes at the sensor that hears most; ``shut_resonance``: Hz, NaN: unknown."""
    rows = [row for row, name in enumerate(channels.names) if name != BOX]
    orders = ([row, *(set(rows) - {row})] for row in rows)
    every = (strikes_of_sensor(channels, order, shut_resonance, settings) for order in orders)
    return max(every, key=lambda one: one.heard)


def strikes_of_sensor(
    channels: Channels, rows: Sequence[int], shut_resonance: float, settings: TimingSettings
) -> Strikes:
    """Measure what strikes at the first of these sensors, with the other one's blows."""
    columns = np.array(list(window_quantities(channels, rows, settings))).T
    heard, base, power, peak, moment, blow, second, opposite = columns[:-3].real
    motion, quiet = columns[-3:], heard <= 1.0
    size = abs(motion[2])
    power = np.where(size >= settings.moves * size.max(), power, 0.0)
    top = int(np.argmax(power * ~quiet))
    loud = (power >= settings.loud * power[top]) & ~quiet
    loud[top] = True
    turned = np.exp(1j * peak[loud])
    rest, stiffness = rest_frequency_and_stiffness(motion, loud, quiet, settings)
    from_rest, from_shut = (
        float(np.median((stiffness / one**2 - 1.0)[loud] / second[loud]))
        for one in (rest, shut_resonance * (1.0 - settings.known))
    )
    ends = 0.5 * (1.0 + settings.middle), 0.5 * (1.0 - settings.middle)
    position = (size * np.cos(peak))[loud] / size.max()
    return Strikes(
        heard=float(heard[loud].max()),
        base=float(np.median(base[loud])),
        locked=float(abs(np.average(turned, weights=np.maximum(power[loud], 1e-300)))),
        one_sided=float(np.median(moment[loud])),
        blow=float(np.median(blow[loud])),
        opposite=float(np.median(opposite[loud])),
        order2=float(np.median(second[loud])),
        stiffens=from_rest,
        from_shut=from_shut,
        place=float(np.median(turned.real)),
        spread=float(np.subtract(*np.quantile(position, ends))),
        stiffness=math.sqrt(max(np.median(stiffness[loud]), 0.0)) / shut_resonance,
    )


def rest_frequency_and_stiffness(
    motion: NDArray[Any],
    loud: NDArray[np.bool_],
    quiet: NDArray[np.bool_],
    settings: TimingSettings,
) -> tuple[float, Floats]:
    """Return the frequency of the beam at rest, Hz, and each window's stiffness over mass, Hz^2.

    ``motion`` has order 1 of the sensor's acceleration relative to the base, the base's, and the
    displacement. By whatever force F the beam is held, ``a + p b + F = 0`` holds with the
    participation p, which the windows in which nothing strikes tell with the stiffness at rest.
    """
    moved, base, stroke = motion
    size, square = abs(stroke), abs(moved / stroke)
    ratio = square / np.median(square[loud])
    near = np.maximum(ratio, 1.0 / ratio) <= settings.near**2
    rest_of = near & quiet
    if rest_of.sum() < settings.quiet:  # faces that touch strike at any stroke: what moves least
        third = np.quantile(size[near], 1.0 / 3.0)
        rest_of = near & (size <= max(0.5 * size[loud].min(), third))
    toward = stroke.conj() / size
    scale = float(np.median(abs(moved) / size))
    rows = np.array([scale * size, (base * toward).real])[:, rest_of]
    products, sums = rows @ rows.T, -rows @ (moved * toward).real[rest_of]
    # where windows do not tell the participation from the stiffness it is 1
    weight = settings.prior * float(np.sum(abs(base[rest_of]) ** 2))
    rest, part = np.linalg.solve(products + np.diag([0.0, weight]), sums + [0.0, weight])
    stiffness = -((moved + part * base) / stroke).real
    return math.sqrt(max(scale * rest, 1e-9)) / TURN, stiffness / TURN**2


def window_quantities(
    channels: Channels, rows: Sequence[int], settings: TimingSettings
) -> Iterator[tuple[complex, ...]]:
    """Yield the quantities of each window, in the order in which the caller above reads them."""
    phase = np.maximum.accumulate(phase_of_box(channels))
    marks = np.arange(phase[0] / TURN + EDGE, phase[-1] / TURN - EDGE, settings.periods)
    edges = np.searchsorted(phase, TURN * marks)
    moved = channels.values[rows[0]] - channels.box
    turns = settings.periods * TURN * channels.sample_rate / np.diff(edges).max(initial=1)
    stroke = integrate_in_time(moved, channels.sample_rate, 0.5 * turns, 2)
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        samples = (end - begin) / settings.periods  # of a period
        order = max(4, round(settings.memory * samples))
        here, base, part = phase[begin:end], channels.box[begin:end], slice(begin, end)
        waves = np.cumprod(np.tile(np.exp(-1j * here), (len(ORDERS), 1)), axis=0)
        size = project_on_waves(moved[part], waves)
        # a displacement is opposite to its acceleration: the top of the stroke is at 0
        own = here + np.angle(-size[0])
        at_base, *errors = (
            prediction_error(one, order)
            for one in (base, *(channels.values[row, part] for row in rows))
        )
        heard, power, peak, moment, opposite = power_over_phase(errors, own, settings)
        base_heard = power_over_phase([at_base], own, settings)[0]
        high = np.abs(size[HIGH])[ORDERS[HIGH] < NYQUIST * samples]
        second = abs(size[1] / size[0])
        blow = float(np.median(high) / abs(size[1])) / math.sqrt(second) if len(high) else math.nan
        quantities = heard, base_heard, power, peak, moment, blow, second
        motion = (
            size[0],
            project_on_waves(base, waves[:1])[0],
            project_on_waves(stroke[part], waves[:1])[0],
        )
        yield *quantities, opposite, *motion


def project_on_waves(signal: Floats, waves: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return the complex amplitudes of a signal's orders, without threads."""
    return np.asarray(2.0 / len(signal) * np.einsum("ns,s", waves, signal - signal.mean()))


def power_over_phase(
    errors: Sequence[Floats], phase: Floats, settings: TimingSettings
) -> tuple[float, float, float, float, float]:
    """Return the loudest bin's rise over noise, power, phase, moment, correlation of sensors."""
    from scipy.special import chdtri

    bins = np.floor(phase / TURN * settings.bins).astype(int) % settings.bins
    count = np.bincount(bins, minlength=settings.bins)
    if count.min() < 3:
        bins //= 2
        count = np.bincount(bins, minlength=settings.bins // 2)
    number, usual = len(count), float(np.mean(count))
    power = np.bincount(bins, errors[0] ** 2, number) / np.maximum(count, 1)
    filled = np.sort(power[count > 0])  # of records too slow to judge some bins are empty
    floor = max(float(filled[: max(len(filled) // 3, 1)].mean()), 1e-300)
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
