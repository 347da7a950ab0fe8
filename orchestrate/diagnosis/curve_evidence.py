"""A resonance curve as evidence: settled motions under a stepped sine, read where they settled."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..laboratory.analysis.channels import BOX, Channels
from ..laboratory.analysis.order_tracking import dwell_windows
from ..laboratory.pieces import Floats
from ..laboratory.resonance_curve import CURVE_ORDERS, FACES, FEWEST_POINTS
from ..laboratory.sampled import Sampled
from ..laboratory.stepped_sine import SteppedSine
from ..lazy import xr
from ..model import Structure
from .evidence import COARSE_RANGE, FITTED_RANGE, Evidence, Participation, checked_participation
from .order_windows import (
    ORDERS,
    SAMPLES_PER_PERIOD,
    Complexes,
    RecordOrders,
    assemble_windows,
)
from .settings import SETTINGS, Settings

Numbers = tuple[float | None, ...]
SETTLE_CYCLES = (30, 200)  # fewest and most cycles before
COARSE_SAMPLES = 7.0  # in a period of the highest frequency, for a coarse search
COARSE_POINTS = 30  # most points of a coarse search


@dataclass(frozen=True)
class CurveData:
    """Hold a resonance curve as plain tuples, in the order in which its frequencies are played."""

    # hz, m/s2
    frequency: tuple[float, ...]
    level: tuple[float, ...]
    sensors: tuple[str, ...]  # `acceleration1`, `acceleration2` or both
    # m/s2; None where an order was not measured, as below
    amplitude: tuple[tuple[Numbers, ...], ...]
    # rad, m/s2
    phase: tuple[Numbers, ...]
    floor: tuple[Numbers, ...]
    relative: bool  # whether the amplitudes are those of the motion relative to the base
    damping: float  # damping ratio by which the motion settles
    participation: tuple[float | None, ...] = ()  # of each sensor; None, or (): to be fitted
    settings: Settings = SETTINGS

    @classmethod
    def from_curve(
        cls,
        curve: xr.Dataset,
        guess: Structure,
        participation: Participation = None,
        settings: Settings = SETTINGS,
    ) -> CurveData:
        """Check a resonance curve and take its numbers around the resonance."""
        check_curve(curve)
        falling = curve.attrs.get("direction", "up") == "down"
        played = curve.sortby("frequency", ascending=not falling)
        ratio = (played.amplitude.sel(order=1.0) / played.level).max("channel")
        near = played.frequency.values / played.frequency.values[np.argmax(ratio.values)]
        inside = played.isel(frequency=(near > FITTED_RANGE[0]) & (near < FITTED_RANGE[1]))
        if inside.sizes["frequency"] < FEWEST_POINTS:
            span = " to ".join(f"{end:g}" for end in FITTED_RANGE)
            text = f"{inside.sizes['frequency']} points from {span} times the resonance's frequency"
            raise InputError(f"resonance curve: {text}; expected {FEWEST_POINTS} or more")
        sensors = tuple(str(name) for name in inside.channel.values)
        width = half_power_damping(inside)
        amplitude = inside.amplitude.transpose("channel", "order", "frequency").values
        guessed = [zeta for zeta in (guess.zeta1, guess.zeta2) if zeta > 0.0]
        return cls(
            frequency=tuple(inside.frequency.values.tolist()),
            level=tuple(inside.level.values.tolist()),
            sensors=sensors,
            amplitude=none_for_nan(amplitude),
            phase=none_for_nan(inside.phase.values),
            floor=none_for_nan(inside.floor.values),
            relative=inside.attrs.get("relative", "false") == "true",
            damping=float(f"{min([width, *guessed]):.2g}"),
            participation=checked_participation(participation, sensors),
            settings=settings,
        )

    @property
    def settle_cycles(self) -> int:
        """Number of cycles after which the motion has settled at a new frequency."""
        cycles = -math.log(0.01) / (2.0 * math.pi * self.damping)  # 1 % of a step is left
        return round(min(max(cycles, SETTLE_CYCLES[0]), SETTLE_CYCLES[1]))

    def evidence(
        self, settle_cycles: int | None = None, samples: float = SAMPLES_PER_PERIOD
    ) -> CurveEvidence:
        """Return the curve's orders, and the stepped sine that measured it."""
        ordered = sorted(zip(self.frequency, self.level, strict=True))
        frequencies = (self.frequency[0], *self.frequency)  # twice as long at the first
        # 10 cycles separate orders 0.5, 1, 1.37
        cycles = {"settle_cycles": settle_cycles or self.settle_cycles, "measured_cycles": 10}
        sine = SteppedSine(frequencies=frequencies, acceleration=tuple(ordered), **cycles)
        rate = samples * max(self.frequency)  # so many in a period
        time = np.arange(math.ceil(sine.duration * rate) + 2) / rate
        box = np.asarray(sine(time))
        # a curve has no samples of the faces
        values = np.stack([box, *np.full((len(self.sensors), len(time)), np.nan)])
        channels = Channels(time, rate, (BOX, *self.sensors), values, "resonance curve")
        played = list(dwell_windows(channels, sine, sine.phase(time)))
        windows = assemble_windows(channels, played[1:])
        amplitude = np.array(self.amplitude, dtype=float)
        phase = np.array(self.phase, dtype=float)
        measured = amplitude.astype(complex)
        measured[:, 0] *= np.exp(1j * np.nan_to_num(phase))
        level = np.array(self.level)
        every = np.full((1 + len(measured), len(ORDERS), len(level)), np.nan, dtype=complex)
        every[1:, : len(CURVE_ORDERS)] = measured
        every[0] = 0.0
        every[0, 0] = level
        floor = np.array(self.floor, dtype=float)
        # where none is given: what a shaker makes of order 2
        floor = np.where(np.isfinite(floor), floor, 0.01 * amplitude[:, 0])
        floors = np.concatenate([np.zeros((1, len(level))), floor])
        orders = RecordOrders(windows, channels, every, floors, np.quantile(floors, 0.2, axis=1))
        pieces = Sampled(acceleration=tuple(box), sample_rate=rate).pieces()
        rest = self.participation, self.settings, np.isfinite(phase), self.relative
        return CurveEvidence(orders, pieces, *rest)

    def coarse_evidence(self) -> CurveEvidence:
        """Return the evidence of some points near the resonance, for a coarse search."""
        whole, frequency = self.evidence(), np.array(self.frequency)
        low, high = (end(whole.peak_frequencies) for end in (min, max))
        inside = (frequency > low * COARSE_RANGE[0]) & (frequency < high * COARSE_RANGE[1])
        near = np.flatnonzero(inside)
        some = self.select_points(near[:: math.ceil(len(near) / COARSE_POINTS)])
        chosen = some if len(some.frequency) >= FEWEST_POINTS else self
        settle = max(SETTLE_CYCLES[0], self.settle_cycles // 2)
        return chosen.evidence(settle, COARSE_SAMPLES)

    def select_points(self, points: NDArray[np.intp]) -> CurveData:
        """Return the curve with only the points of these indices."""
        names = ("frequency", "level", "amplitude", "phase", "floor")
        every = {name: np.array(getattr(self, name), dtype=float) for name in names}
        some: dict[str, Any] = {name: none_for_nan(one[..., points]) for name, one in every.items()}
        return replace(self, **some)


def check_curve(curve: xr.Dataset) -> None:
    """Check that a dataset has what :func:`orchestrate.resonance_curve` puts in it."""
    missing = [name for name in ("amplitude", "phase", "floor", "level") if name not in curve]
    if missing or set(curve.amplitude.dims) != {"channel", "order", "frequency"}:
        text = (
            f"no {missing[0]}" if missing else f"amplitude over {', '.join(curve.amplitude.dims)}"
        )
        raise InputError(f"resonance curve: {text}; expected one of resonance_curve or read_curve")
    names = [str(name) for name in curve.channel.values]
    if not names or not set(names) <= set(FACES):
        raise InputError(f"resonance curve: channels {names}; expected some of {', '.join(FACES)}")
    if curve.order.values.tolist() != list(CURVE_ORDERS):
        raise InputError(f"resonance curve: orders {curve.order.values.tolist()}; expected 1, 2, 3")
    first = curve.amplitude.sel(order=1.0)
    if not all(np.isfinite(one.values).all() for one in (first, curve.level, curve.frequency)):
        raise InputError("resonance curve: order 1 or its level is not finite; expected numbers")


def none_for_nan(values: Floats) -> tuple[Any, ...]:
    """Return numbers as nested tuples with None for NaN, which would not be equal to itself."""
    if values.ndim > 1:
        return tuple(none_for_nan(row) for row in values)
    return tuple(value if math.isfinite(value) else None for value in values.tolist())


def half_power_damping(curve: xr.Dataset) -> float:
    """Return the damping ratio by the width of the highest peak at 0.7 of its height."""
    ordered = curve.sortby("frequency")
    ratio = (ordered.amplitude.sel(order=1.0) / ordered.level).max("channel").values
    frequency, top = ordered.frequency.values, int(np.argmax(ratio))
    below = np.flatnonzero(ratio < 0.5**0.5 * ratio[top])
    low = frequency[max(below[below < top], default=0)]
    high = frequency[min(below[below > top], default=len(frequency) - 1)]
    return float((high - low) / (2.0 * frequency[top]))


@dataclass(frozen=True)
class CurveEvidence(Evidence):
    """Orders of a resonance curve, their errors, and the stepped sine as the input of motions."""

    has_floor: ClassVar[bool] = False
    with_phase: NDArray[np.bool_] = None  # type: ignore[assignment]
    relative_motion: bool = False  # whether the orders are those of the motion relative to the base

    @cached_property
    def used_windows(self) -> NDArray[np.intp]:
        return np.arange(len(self.orders.windows))

    @cached_property
    def order_1_size(self) -> Floats:
        """Amplitude of order 1 at each frequency, shape (sensors, windows), m/s2."""
        return np.abs(self.measured_orders[:, 0])

    @cached_property
    def standard_deviation(self) -> Floats:
        """Standard deviations (model error and floor), shape (sensors, 3, windows), m/s2."""
        floor = np.maximum(self.floor, 1e-9 * self.order_1_size.max())
        model = self.settings.model_error * self.order_1_size[:, None, :].repeat(3, axis=1)
        return np.sqrt(floor[:, None, :] ** 2 + model**2)

    @cached_property
    def base_orders(self) -> Complexes:
        """Orders 1, 2, 3 of the base, as far as they are in what was measured, m/s2."""
        return 0.0 * super().base_orders if self.relative_motion else super().base_orders

    @cached_property
    def largest_displacement(self) -> float:
        """Largest amplitude of order 1 relative to the base, m, at the resonance."""
        moved = np.abs(self.measured_orders[:, 0] - (0.0 if self.relative_motion else self.level))
        return float((moved / (2.0 * math.pi * self.frequency) ** 2).max())

    @cached_property
    def measured_rows(self) -> NDArray[np.bool_]:
        """Mask of the rows of residuals that were measured, shape (4,); the others are left out."""
        found = np.ones(4, dtype=bool)
        found[1] = self.with_phase.any()
        found[2:] = np.isfinite(self.measured_orders[:, 1:]).any(axis=(0, 2))
        return found

    def order_1_to_match(self, row: int, computed: Complexes) -> Complexes:
        """Return the measured order 1 of a sensor, with the computed phase where it has none."""
        size, known = self.measured_orders[row, 0], self.with_phase[row][self.used_windows]
        return np.where(known, size, np.abs(size) * np.exp(1j * np.angle(computed)))

    def residuals_of_orders(self, computed: Complexes) -> Floats:
        """Return computed less measured orders, over the errors, in the rows that were measured."""
        return super().residuals_of_orders(computed)[:, self.measured_rows]

    def unbounded_residuals(self) -> Floats:
        return super().unbounded_residuals()[:, self.measured_rows]
