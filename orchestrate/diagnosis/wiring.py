"""Whether channels are wired as stated: checked before a beam is blamed for what they say."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..constants import GRAVITY, TURN
from ..errors import InputError
from ..laboratory.analysis.channels import BOX, Channels
from ..laboratory.analysis.order_tracking import phase_of_box
from ..laboratory.pieces import Floats
from ..laboratory.record import SHORT_NAMES
from ..laboratory.record_checks import PLATEAU, clipped_share
from .order_windows import Complexes, RecordOrders, orders_with_floors, sine_windows_and_amplitudes
from .settings import SETTINGS


@dataclass(frozen=True, kw_only=True)
class WiringSettings:
    """Thresholds of the rule of :func:`wiring_notes`."""

    low: float = 0.7  # of the resonance's frequency: up to it the response is fitted
    fewest: int = 5  # windows there, else nothing is said of gains and delays
    misfit: float = 0.15  # of the response: a fit that misses more says nothing
    swapped: float = 3.0  # times the face's peak over its larger end that the base's is
    derived: float = 1.5  # times better it describes a velocity or a displacement
    scale: float = 2.5  # factor of the base's motion beyond which a sensor's scale is wrong
    gravity: float = 0.25  # distance of a factor's logarithm from that of 9.80665 for a unit
    delay: float = 1e-3  # s
    clear: float = 7.5  # phase of a delay at the lowest frequency, over the misfit
    dead: float = 0.05  # of the base's motion: a sensor without a resonance that moves less
    peak: float = 3.0  # times the median response that a resonance reaches
    floor: float = 3.0  # times the amplitude between the orders that a line is above
    mains: tuple[float, ...] = (50.0, 60.0)  # Hz
    hum: float = 6.0  # amplitude of a mains line over that of the lines `beside` it
    beside: tuple[float, ...] = (-3.0, -2.0, 2.0, 3.0)  # Hz
    hum_time: float = 2.0  # s of a window in which they are taken
    away: float = 5.0  # Hz between that line and orders 1/2, 1, 2 and 3
    coherence: float = 0.8  # of that line from one window to the next
    jump: float = 0.35  # rad of the base's phase, without whole turns
    band: float = 2.0  # of the highest frequency of the base: what its phase is taken of
    moves: float = 0.5  # of the base's median amplitude: where it is less, no jump is looked for
    usual: float = 10.0  # times the usual change, by noise, that a jump is
    samples: float = 10.0  # in a period of the resonance
    clipped: float = SETTINGS.clipped  # share of a channel's samples at its extremes,
    plateau: int = 1  # each in a row this long, of a sweep: impacts are spikes


WIRING = WiringSettings()
QUANTITIES = {1: ("velocity", "m/s"), 2: ("displacement", "m")}  # by derivatives to acceleration


@dataclass(frozen=True)
class Note:
    """A doubt about a channel, and how to read the record where it is right."""

    kind: str  # polarity, unit, scale, delay, quantity, swapped, dead, clipped, hum, ...
    text: str


def wiring_notes(channels: Channels, settings: WiringSettings = WIRING) -> list[Note]:
    """Return what is doubtful about the channels of a swept or stepped sine.

    - Up to `low` of its resonance a sensor reads ``s exp(-i w t) (1 + G r^2/(1 - r^2))`` times the
      base's order 1, with the ratio r of the frequencies, in `fewest` windows within `misfit`, by
      the base's level: s < 0 is polarity, |s| within `gravity` of 9.8 or its inverse a unit, |s|
      beyond `scale` a scale, |t| above `delay`, `clear` of the misfit, a delay.
    - Base and face are swapped where the base's peak, over its larger end, is `swapped` times the
      face's; one is a velocity (n = 1) or displacement (2) where the formula describes that one
      times ``(i w)^n`` within `misfit`, `derived` times better; a sensor is dead that is above the
      `floor` in half of the windows at most, or below `dead` times the base and without a `peak`.
    - Samples are lost where the base `moves` and its phase (in its `band`), continued from both
      sides, jumps by `jump`, whole turns aside, and, times the level, `usual` times as far as it
      usually does.
    - A line of the `mains` is hum if it is `hum` times those `beside` it and keeps its phase
      (`coherence`), while the orders are `away`.
    - A channel is clipped by a `clipped_share` above `clipped` (of `plateau`); few are less than
      `samples` in a period of the resonance.
    """
    try:
        orders = orders_with_floors(channels, *sine_windows_and_amplitudes(channels))
    except InputError:
        return list(notes_without_sine(channels, settings))
    found = (note for row in orders.rows for note in sensor_notes(orders, row, settings))
    row = PLATEAU if orders.windows.is_tone else settings.plateau  # a tone's samples repeat
    notes = [*dict.fromkeys(found), *clipped_notes(channels, settings.clipped, row)]
    if any(note.kind in ("swapped", "quantity") for note in notes):
        return notes  # to be read again first
    notes += lost_sample_notes(orders, settings)
    for row in range(len(channels.names)):
        notes += hum_notes(orders, row, settings)
    samples, hertz = channels.sample_rate / orders.resonance, orders.resonance
    if samples < settings.samples:
        text = f"{samples:.3g} samples in a period of {hertz:.3g} Hz, the largest response"
        notes.append(Note("sampling", f"{text}; expected {settings.samples:g} or more"))
    return notes


def notes_without_sine(channels: Channels, settings: WiringSettings) -> Iterator[Note]:
    """Yield notes on a record whose base has no sine: another column's may be the base's."""
    base = channels.names.index(BOX)
    spread = channels.values.std(axis=1)
    for row, name in enumerate(channels.names):
        if row == base:
            continue
        face, values = SHORT_NAMES[name], channels.values.copy()
        values[[base, row]] = values[[row, base]]
        try:
            exchanged = replace(channels, values=values)
            orders = orders_with_floors(exchanged, *sine_windows_and_amplitudes(exchanged))
        except InputError:
            is_face = is_resonant = False
        else:
            is_face = is_above_floor(orders, row, settings)
            size = np.abs(orders.order_amplitudes(1.0, BOX))
            is_resonant = bool(size.max() > settings.peak * np.median(size))
        if spread[base] < settings.dead * spread[row]:
            yield Note("dead", f"the base has no sine and {face} moves: is the base's cable dead?")
        elif is_resonant:
            text = f"{face} has a sine with a resonance, noise or drift hides that of the base"
            mend = f"({spread[base]:.2g} m/s2 rms in all): measure at a higher level"
            yield Note("noise", f"{text} {mend}")
        elif is_face:
            text = f"the base has no sine and {face} has: swapped? exchange both in channels="
            yield Note("swapped", f"{text}; or does the base's reading drift?")
    yield from clipped_notes(channels, settings.clipped)


# -- gains and delays -----------------------------------------------------------------------------


def sensor_notes(orders: RecordOrders, row: int, settings: WiringSettings) -> Iterator[Note]:
    """Yield notes on a sensor against the base, except on its samples."""
    name = SHORT_NAMES[orders.channels.names[row]]
    response = orders.amplitude[row, 0] / orders.order_amplitudes(1.0, BOX)
    size = np.abs(response)
    usual = float(np.median(size))
    flat = size.max() < settings.peak * usual
    if not is_above_floor(orders, row, settings) or (usual < settings.dead and flat):
        yield Note("dead", f"{name} moves {usual:.2g} times the base: is its cable dead?")
        return
    sizes = np.abs(orders.order_amplitudes(1.0, BOX)), np.abs(orders.amplitude[row, 0])
    peak_of_base, peak = (float(one.max() / max(one[0], one[-1])) for one in sizes)
    if peak_of_base > settings.swapped * peak:
        text = f"{name} moves as a base and the base as {name}: swapped? exchange both in channels="
        yield Note("swapped", text)
        return
    hertz = orders.windows.frequency
    made = {order: response * (1j * TURN * hertz) ** order for order in range(-2, 3)}
    level = orders.level
    tried = {order: LowResponse.fit(hertz, one, level, settings) for order, one in made.items()}
    fits = {order: fit for order, fit in tried.items() if fit is not None}
    if (straight := fits.get(0)) is None:
        return
    order, best = min(fits.items(), key=lambda item: item[1].misfit)
    if best.misfit < min(settings.misfit, straight.misfit / settings.derived):
        read = name if order > 0 else "base"
        motion, unit = QUANTITIES[abs(order)]
        thousands = np.log10(abs(best.factor)) / 3.0 * np.sign(order)
        prefix = ("", "m", "u", "n")[int(np.clip(np.rint(thousands), 0, 3))]
        text = f"{read} moves as a {motion}, not an acceleration, at {best.frequency:.3g} Hz"
        mend = f'unit="{read.replace(" ", "")}={prefix}{unit}"'
        yield Note("quantity", f"{text}: its unit, or the other's? {mend}")
    elif straight.misfit < settings.misfit:
        yield from straight.notes(name, settings)


def is_above_floor(orders: RecordOrders, row: int, settings: WiringSettings) -> bool:
    """Return whether a channel's order 1 is above the floor in most of the windows."""
    above = np.abs(orders.amplitude[row, 0]) > settings.floor * orders.floor[row]
    return bool(above.mean() > 0.5)


@dataclass(frozen=True)
class LowResponse:
    """A response below the resonance: ``factor exp(-i w delay) (1 + G r^2/(1 - r^2))``."""

    frequency: float  # lowest, Hz
    factor: float
    delay: float  # s
    misfit: float  # root mean square, relative to the response

    @classmethod
    def fit(
        cls, frequency: Floats, response: Complexes, level: Floats, settings: WiringSettings
    ) -> LowResponse | None:
        """Fit a response below its peak, weighted by the base's level; None in few windows."""
        from scipy.optimize import least_squares

        peak = frequency[int(np.argmax(np.abs(response)))]
        low = frequency < settings.low * peak
        if low.sum() < settings.fewest:
            return None
        hertz, measured, weights = frequency[low], response[low], level[low]
        weights = weights / np.sqrt(np.mean(weights**2))

        def residuals(numbers: Floats) -> Floats:
            factor, late, mode, ratio = numbers
            square = (hertz / (ratio * peak)) ** 2
            model = factor * np.exp(-1e-3j * TURN * hertz * late)
            rest = model * (1.0 + mode * square / (1.0 - square)) / measured - 1.0
            rest = weights * rest
            return np.concatenate([rest.real, rest.imag])

        first = float(np.median(measured.real)) or 1.0
        # the delay is in ms, the ratio is that of the resonance to the peak
        bounds = ([-np.inf, -12.0, 0.1, 0.75], [np.inf, 12.0, 1.8, 1.25])
        best = least_squares(residuals, (first, 0.0, 1.0, 1.0), bounds=bounds, x_scale="jac")
        factor, late, *_ = best.x
        misfit = float(np.sqrt(2.0 * best.cost / len(hertz)))
        return cls(float(hertz.min()), float(factor), 1e-3 * float(late), misfit)

    def notes(self, name: str, settings: WiringSettings) -> Iterator[Note]:
        """Yield notes on polarity, unit or scale, and delay, with what mends them."""
        word, size = name.replace(" ", ""), abs(self.factor)
        moves = f"{name} moves {self.factor:.2g} times the base at {self.frequency:.3g} Hz"
        if self.factor < 0.0:
            yield Note("polarity", f'{moves}: polarity? scale="{word}=-1"')
        large = size > 1.0
        if abs(np.log(size if large else 1.0 / size) - np.log(GRAVITY)) < settings.gravity:
            one, other = ("m/s2", "g") if large else ("g", "m/s2")
            mended = f'unit="{word}={one}", or unit="base={other}"'
            yield Note("unit", f"{moves}: g in place of m/s2? {mended}")
        elif not 1.0 / settings.scale < size < settings.scale:
            yield Note("scale", f'{moves}: its scale? scale="{word}={1.0 / size:.2g}"')
        phase = TURN * self.frequency * abs(self.delay)
        if abs(self.delay) > settings.delay and phase > settings.clear * self.misfit:
            late = word if self.delay > 0.0 else "base"
            text = f"{name} comes {1e3 * self.delay:.2g} ms after the base: delay?"
            yield Note("delay", f'{text} delay="{late}={abs(self.delay):.2g}"')


# -- samples --------------------------------------------------------------------------------------


def clipped_notes(channels: Channels, clipped: float, plateau: int = PLATEAU) -> Iterator[Note]:
    """Yield notes on channels that are saturated, in long enough rows of samples."""
    for name, values in zip(channels.names, channels.values, strict=True):
        if (share := clipped_share(values, plateau)) > clipped:
            text = f"{SHORT_NAMES[name]} is saturated in {100.0 * share:.2g} % of its samples"
            yield Note("clipped", f"{text}: record it again with a wider range")


def lost_sample_notes(orders: RecordOrders, settings: WiringSettings) -> Iterator[Note]:
    """Yield a note on the largest jump of the base's phase."""
    from scipy.signal import fftconvolve

    channels, windows = orders.channels, orders.windows
    count = int(2.0 * channels.sample_rate / windows.frequency.min())  # before and after
    row = np.linalg.pinv(np.vander(np.arange(count) + 0.5, 2))[1]  # a line's value at its end
    kernel = np.concatenate([row[::-1], -row])  # as a convolution: later less earlier samples
    spectrum = np.fft.rfft(channels.box)
    hertz = np.fft.rfftfreq(len(channels.time), 1.0 / channels.sample_rate)
    spectrum[hertz > settings.band * windows.frequency.max()] = 0.0  # noise makes the phase slip
    box = np.fft.irfft(spectrum, len(channels.time))
    phase = phase_of_box(Channels(channels.time, channels.sample_rate, (BOX,), box[None], ""))
    jump = np.abs(fftconvolve(phase, kernel, "same"))
    inside = np.zeros(len(phase), bool)
    for part in windows.parts:
        inside[part] = True
    inside[: 2 * count] = inside[-2 * count :] = False
    # as an acceleration: what noise does to the phase grows where the base moves little
    level = np.interp(channels.time, windows.time, orders.level)
    inside &= level > settings.moves * float(np.median(orders.level))
    moved = np.where(inside, jump * level, 0.0)
    where = int(np.argmax(moved))
    is_usual = moved[where] <= settings.usual * float(np.quantile(moved, 1.0 - 0.5 * inside.mean()))
    turned = abs(jump[where] - TURN * round(jump[where] / TURN))
    if not is_usual and turned > settings.jump:
        text = f"the base's phase jumps by {turned:.2g} rad at {channels.time[where]:.4g} s"
        yield Note("lost samples", f"{text}: are samples lost? cut the record there")


def hum_notes(orders: RecordOrders, row: int, settings: WiringSettings) -> Iterator[Note]:
    """Yield a note on a line of the mains in a channel."""
    channels, values = orders.channels, orders.channels.values[row]
    count = int(settings.hum_time * channels.sample_rate)
    weights = np.hanning(count) * 2.0 / np.hanning(count).sum()
    starts = np.arange(0, len(channels.time) - count, count, dtype=np.intp)
    middle = channels.time[starts] + 0.5 * settings.hum_time
    swept = np.interp(middle, orders.windows.time, orders.windows.frequency)
    for mains in settings.mains:
        distance = np.abs(np.outer((0.5, 1.0, 2.0, 3.0), swept) - mains).min(axis=0)
        away = distance > settings.away
        if away.sum() < settings.fewest:
            continue
        beside = (mains + off for off in (0.0, *settings.beside))  # Hz, itself the first
        shifted = (values * np.exp(-1j * TURN * hertz * channels.time) for hertz in beside)
        lines = np.array([[weights @ one[k : k + count] for k in starts] for one in shifted])
        size = np.median(np.abs(lines[:, away]), axis=1)
        pairs = away[1:] & away[:-1]
        turned = (lines[0, 1:] * lines[0, :-1].conj())[pairs]
        kept = abs(turned.sum()) / max(np.abs(turned).sum(), 1e-300)
        if size[0] > settings.hum * size[1:].max() and kept > settings.coherence:
            name = SHORT_NAMES[channels.names[row]]
            text = f"{name} has a line of {size[0]:.2g} m/s2 at {mains:g} Hz, of the mains"
            yield Note("hum", f"{text}: look for a loop of earth")
