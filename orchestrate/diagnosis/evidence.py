"""Orders of a record with their errors, and the residuals of computed motions against them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from ..errors import InputError
from ..laboratory.analysis.channels import Channels
from ..laboratory.analysis.order_tracking import decimate, integrate_in_time
from ..laboratory.pieces import Floats, Pieces
from ..laboratory.sampled import Sampled
from ..laboratory.sensors import PARTICIPATION
from .misfit import clip
from .order_windows import (
    MIN_WINDOWS,
    ORDERS,
    SAMPLES_PER_PERIOD,
    Complexes,
    OrderWindows,
    RecordOrders,
    compute_orders,
)
from .settings import SETTINGS, Settings

if TYPE_CHECKING:
    from scipy.sparse import csr_array

FITTED_ORDERS = (1.0, 2.0, 3.0)
FITTED_RANGE = (0.62, 1.55)  # of the resonance's frequency: what is fitted of a wide sweep
COARSE_RANGE = (0.8, 1.28)  # of that of both sensors' resonances: what a coarse search goes by
MAX_CUT_SHARE = 0.9  # of a record: more of it is not worth to be cut
START_UP = 1.0  # s at the beginning where the start is not forgotten; at most a tenth of the record
UNBOUNDED_RESIDUAL = 30.0  # residual of a motion that has no bounds
SENSORS = ("acceleration1", "acceleration2")
Participation = float | Mapping[str, float] | None  # as an argument: of all, of some sensors


def checked_participation(given: Participation, sensors: Sequence[str]) -> tuple[float | None, ...]:
    """Return each sensor's participation factor; None where it is to be fitted."""
    if given is None:
        return (None,) * len(sensors)
    if not isinstance(given, Mapping):
        return (PARTICIPATION.check(given),) * len(sensors)
    if unknown := set(given) - set(sensors):
        text = f"the record has {' and '.join(sensors)}"
        raise InputError(f"participation: {sorted(map(str, unknown))[0]!r} is no sensor; {text}")
    return tuple(PARTICIPATION.check(given[name]) if name in given else None for name in sensors)


def part_around(windows: OrderWindows, inside: NDArray[np.intp], before: float) -> slice | None:
    """Return the samples of some windows and from ``before`` s on; None where that is no cut."""
    begin = windows.parts[inside[0]].start - round(before * windows.sample_rate)
    part = slice(max(begin, 0), windows.parts[inside[-1]].stop)
    is_cut = part.stop - part.start <= MAX_CUT_SHARE * windows.samples
    return part if is_cut and len(inside) >= MIN_WINDOWS else None


def cut_channels(channels: Channels, part: slice) -> Channels:
    return replace(channels, time=channels.time[part], values=channels.values[:, part])


@dataclass(frozen=True)
class Evidence:
    """Hold a record's orders with their errors, and the input of motions compared with them."""

    # whether the noise between the orders was measured: not in a resonance curve
    has_floor: ClassVar[bool] = True
    orders: RecordOrders
    pieces: Pieces  # the base's acceleration, from the first sample on
    participation: tuple[float | None, ...] = ()  # of each sensor; None, or (): to be fitted
    settings: Settings = SETTINGS

    @classmethod
    def from_orders(
        cls,
        orders: RecordOrders,
        samples_per_period: float = SAMPLES_PER_PERIOD,
        participation: tuple[float | None, ...] = (),
        settings: Settings = SETTINGS,
    ) -> Evidence:
        """Build the evidence from a whole record's orders: cut and decimate it where possible."""
        channels, windows = orders.channels, orders.windows
        ratio, highest = windows.frequency / orders.resonance, float(windows.frequency.max())
        inside = np.flatnonzero((ratio > FITTED_RANGE[0]) & (ratio < FITTED_RANGE[1]))
        if part := part_around(windows, inside, START_UP + 0.5):
            channels = cut_channels(channels, part)
            highest = float(windows.frequency[inside].max())
        thin = decimate(channels, highest, samples_per_period)
        if thin is not orders.channels:
            orders = compute_orders(thin)
        rate = orders.channels.sample_rate
        pieces = Sampled(acceleration=tuple(orders.channels.box), sample_rate=rate).pieces()
        return cls(orders, pieces, participation, settings)

    def near_resonance(self) -> Evidence:
        """Return the part of the evidence around both resonances, for a coarse search."""
        size = np.abs(self.measured_orders[:, 0] - self.level) / self.frequency**2
        moving = self.frequency[np.unravel_index(np.argmax(size), size.shape)[1]]
        low, high = (end([*self.peak_frequencies, moving]) for end in (min, max))
        ratio = self.orders.windows.frequency
        inside = np.flatnonzero((ratio > COARSE_RANGE[0] * low) & (ratio < COARSE_RANGE[1] * high))
        part = part_around(self.orders.windows, inside, START_UP + 0.1)
        if part is None:
            return self
        parts = self.orders.windows.parts
        kept = np.flatnonzero([part.start <= p.start and p.stop <= part.stop for p in parts])
        nodes = self.pieces.nodes[part] - self.pieces.nodes[part.start]
        cubics = self.pieces.derivatives[part.start : part.stop - 1]
        pieces = replace(self.pieces, nodes=nodes, derivatives=cubics)
        orders = RecordOrders(
            self.orders.windows.cut_to_samples(kept, part),
            cut_channels(self.orders.channels, part),
            self.orders.amplitude[:, :, kept],
            self.orders.floor[:, kept],
            self.orders.noise,
        )
        return replace(self, orders=orders, pieces=pieces)

    def select_windows(self, chosen: NDArray[np.bool_]) -> Evidence:
        """Return the evidence with only some of the fitted windows, and the same resonance."""
        made = replace(self)
        made.__dict__["used_windows"] = self.used_windows[chosen]
        made.__dict__["resonance"] = self.resonance
        return made

    @cached_property
    def velocity_sign_cubics(self) -> Floats:
        """Cubics of the sign of the measured velocity, relative to the base and smooth at zero."""
        channels = self.orders.channels
        moved = (channels.values[self.orders.rows] - channels.box).mean(axis=0)
        speed = integrate_in_time(moved, self.sample_rate, 0.5 * TURN * self.resonance)
        slow = self.settings.slow * TURN * self.resonance * self.largest_displacement
        sign = speed / np.hypot(speed, slow)
        return Sampled(acceleration=tuple(sign), sample_rate=self.sample_rate).pieces().derivatives

    @property
    def sample_rate(self) -> float:
        return self.orders.channels.sample_rate

    @property
    def sample_count(self) -> int:
        return len(self.orders.channels.time)

    @cached_property
    def sensor_masses(self) -> tuple[int, ...]:
        """Mass that each sensor is on, 0 or 1."""
        return tuple(SENSORS.index(name) for name in self.orders.sensors)

    @cached_property
    def used_windows(self) -> NDArray[np.intp]:
        """Indices of the windows that are fitted: those after the start-up."""
        time = self.orders.windows.time - self.orders.channels.time[0]
        skipped = min(START_UP, 0.1 * self.orders.channels.duration)
        return np.flatnonzero(time > skipped)

    @cached_property
    def windows(self) -> OrderWindows:
        """Windows that are fitted, reduced to the orders that are fitted."""
        return self.orders.windows.select(self.used_windows, len(FITTED_ORDERS))

    @cached_property
    def frequency(self) -> Floats:
        """Frequency of the excitation in each fitted window, Hz."""
        return self.orders.windows.frequency[self.used_windows]

    @cached_property
    def level(self) -> Floats:
        """Amplitude of the base's order 1 in each fitted window, m/s2."""
        return self.orders.level[self.used_windows]

    @cached_property
    def measured_orders(self) -> Complexes:
        """Measured orders 1, 2, 3 of the sensors, shape (sensors, 3, windows), m/s2."""
        numbers = [ORDERS.index(order) for order in FITTED_ORDERS]
        return self.orders.amplitude[self.orders.rows][:, numbers][:, :, self.used_windows]

    @cached_property
    def order_1_size(self) -> Floats:
        """Largest amplitude of order 1 around each window, shape (sensors, windows), m/s2."""
        size = np.abs(self.measured_orders[:, 0])
        padded = np.pad(size, ((0, 0), (2, 2)), mode="edge")  # two windows on each side
        return np.lib.stride_tricks.sliding_window_view(padded, 5, axis=1).max(axis=-1)

    @cached_property
    def noise(self) -> Floats:
        """Standard deviation of the orders' amplitudes by noise, shape (sensors,), m/s2."""
        return np.maximum(self.orders.noise[self.orders.rows], 1e-9 * self.order_1_size.max())

    @property
    def floor(self) -> Floats:
        """Amplitude between the orders, shape (sensors, windows), m/s2."""
        return self.orders.floor[self.orders.rows][:, self.used_windows]

    @cached_property
    def standard_deviation(self) -> Floats:
        """Standard deviations (model error and noise), shape (sensors, 3, windows), m/s2."""
        floor = np.maximum(self.settings.irregular * self.floor, self.noise[:, None])
        model = self.settings.model_error * self.order_1_size[:, None, :].repeat(3, axis=1)
        return np.sqrt(floor[:, None, :] ** 2 + model**2)

    @cached_property
    def base_orders(self) -> Complexes:
        """Orders 1, 2, 3 of the base, shape (3, windows), m/s2."""
        return self.windows.amplitudes(self.orders.channels.box[np.newaxis])[0]

    @cached_property
    def orders_of_displacement(self) -> csr_array:
        """Sparse matrix from a displacement to its orders, see :meth:`ideal_orders`."""
        from scipy.sparse import diags_array

        read = 1.0 / np.sinc(np.outer(FITTED_ORDERS, self.frequency) / self.sample_rate) ** 2
        weights = diags_array(read.repeat(2, axis=0).ravel())
        return (weights @ self.windows.displacement_operator()).tocsr()

    @cached_property
    def resonance(self) -> float:
        """Frequency at which the structure moves most for the base's amplitude, Hz."""
        response = (np.abs(self.measured_orders[:, 0]) / self.level).max(axis=0)
        return float(self.frequency[np.argmax(response)])

    @cached_property
    def peak_frequencies(self) -> tuple[float, ...]:
        """Frequency at which each sensor moves most for the base's amplitude, Hz."""
        response = np.abs(self.measured_orders[:, 0]) / self.level
        return tuple(self.frequency[np.argmax(response, axis=1)].tolist())

    @cached_property
    def largest_displacement(self) -> float:
        """Largest amplitude of order 1 relative to the base, m, at the resonance."""
        size = np.abs(self.measured_orders[:, 0] - self.level)
        return float((size / (TURN * self.frequency) ** 2).max())

    def ideal_orders(self, motion: Floats) -> Complexes:
        """Compute orders 1, 2, 3 that ideal sensors read of a motion, (sensors, 3, windows)."""
        chosen = [min(mass, len(motion) - 1) for mass in self.sensor_masses]
        parts = {row: self.orders_of_displacement @ motion[row] for row in set(chosen)}
        rows = np.stack([parts[row] for row in chosen])
        found = rows.reshape(len(chosen), len(FITTED_ORDERS), 2, -1)
        return found[:, :, 0] + 1j * found[:, :, 1] + self.base_orders

    def sensor_orders(self, motion: Floats) -> Complexes:
        """Compute the same with the errors of sensors that come nearest to what was measured."""
        return self.correct_for_sensors(self.ideal_orders(motion))

    def correct_for_sensors(self, computed: Complexes) -> Complexes:
        """Return computed orders as sensors read them: base + participation (motion - base)."""
        found = computed.copy()
        for row in range(len(found)):
            participation, gain, delay = self.fit_sensor_errors(row, computed[row, 0])
            turn = TURN * np.outer(FITTED_ORDERS, self.frequency) * delay
            moved = self.base_orders + participation * (found[row] - self.base_orders)
            found[row] = gain * np.exp(-1j * turn) * moved
        return found

    def fit_sensor_errors(self, row: int, computed: Complexes) -> tuple[float, float, float]:
        """Fit a sensor's participation factor, gain and delay (s) to order 1, with a prior."""
        if not np.isfinite(computed).all():  # a motion without bounds
            return 1.0, 1.0, 0.0
        target, participation = self.order_1_to_match(row, computed), self.fixed_participation(row)
        base, allowed = self.base_orders[0], self.settings
        if participation is None:
            gain, _, more = self.sensor_deviations(row, computed, target)
            more *= allowed.participation_deviation
            participation = 1.0 + more / (1.0 + allowed.gain_deviation * gain)
            # 1.57 at the tip of a uniform cantilever, 0.34 at 0.4 of it
            participation = float(np.clip(participation, 0.2, 1.7))
        read = base + participation * (computed - base)
        gain, delay = self.sensor_deviations(row, read, target, 2)
        most, latest = allowed.gain_error, allowed.delay
        gain = 1.0 + clip(allowed.gain_deviation * gain, (-most, most))
        return participation, gain, clip(allowed.delay_deviation * delay, (-latest, latest))

    def sensor_deviations(
        self, row: int, computed: Complexes, target: Complexes, count: int = 3
    ) -> Floats:
        """Return a sensor's gain, delay and participation in their deviations, by least squares."""
        allowed, is_given = self.settings, self.fixed_participation(row) is not None
        late = -1j * allowed.delay_deviation * TURN * self.frequency * computed
        part = 0.0 if is_given else allowed.participation_deviation
        changes = [allowed.gain_deviation * computed, late, part * (computed - self.base_orders[0])]
        columns = (np.stack(changes) / self.standard_deviation[row, 0])[:count]
        missed = (target - computed) / self.standard_deviation[row, 0]
        normal = (columns @ columns.conj().T).real
        normal += np.eye(count) * self.settings.prior_weight**2 * len(missed)  # nothing by chance
        return np.asarray(np.linalg.solve(normal, (columns.conj() @ missed).real))

    def fixed_participation(self, row: int) -> float | None:
        """Return a sensor's participation factor if it is not fitted, as stated or 1; else None."""
        given = self.participation[row] if self.participation else None
        return 1.0 if given is None and self.windows.is_tone else given

    def fit_participations(self, motion: Floats) -> Floats:
        """Return the participation factors with which a motion is nearest, shape (sensors,)."""
        first = self.ideal_orders(motion)[:, 0]
        return np.array([self.fit_sensor_errors(row, one)[0] for row, one in enumerate(first)])

    def order_1_to_match(self, row: int, computed: Complexes) -> Complexes:
        """Return a sensor's measured order 1, with which the computed one is compared."""
        return np.asarray(self.measured_orders[row, 0])

    def unbounded_residuals(self) -> Floats:
        return np.full((len(self.sensor_masses), 4, len(self.used_windows)), UNBOUNDED_RESIDUAL)

    def residuals_of_motion(self, motion: Floats) -> Floats:
        """Return the differences of a motion's orders from the measured ones, over the errors."""
        if not np.isfinite(motion).all():
            return self.unbounded_residuals()
        return self.residuals_of_orders(self.sensor_orders(motion))

    def residuals_of_orders(self, computed: Complexes) -> Floats:
        """Return computed less measured orders, over the errors; shape (sensors, 4, windows)."""
        measured = np.stack([self.order_1_to_match(row, a) for row, a in enumerate(computed[:, 0])])
        first = (computed[:, 0] - measured) / self.standard_deviation[:, 0]
        noise = self.noise[:, None, None]  # adds to both sizes alike
        size, measured_size = np.abs(computed[:, 1:]), np.abs(self.measured_orders[:, 1:])
        higher = (np.sqrt(size**2 + noise**2) - measured_size) / self.standard_deviation[:, 1:]
        raw = np.concatenate([first.real[:, None], first.imag[:, None], higher], axis=1)
        resolved = np.isfinite(measured_size[:, [0, 0, 0, 1]]) | (np.arange(4) < 2)[:, None]
        whole = np.where(np.isfinite(raw), raw, np.where(resolved, UNBOUNDED_RESIDUAL, 0.0))
        return np.clip(whole, -UNBOUNDED_RESIDUAL, UNBOUNDED_RESIDUAL)
