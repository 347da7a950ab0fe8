"""What accelerometers read: impacts as their bandwidth shows them, noise, clipping, digits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, Literal

import numpy as np

from ..errors import InputError
from ..lazy import xr
from ..model import Structure
from ..model.arguments import check_and_convert_fields, whole
from ..model.ranges import ADDED, STRUCTURE, Quantity
from ..running.job import refuse_unsupported, refuse_unsupported_structure
from .analog_filter import (
    AnalogFilter,
    Floats,
    PolynomialSignal,
    anti_aliasing_zeros_and_poles,
    filters_in_series,
    low_pass_zeros_and_poles,
)
from .pieces import Pieces
from .reconstruction import (
    Motion,
    SmoothAccelerations,
    solve_smooth_accelerations,
    steady_box_acceleration,
)
from .record import ACCELERATIONS, CHANNELS, FORCES, record
from .sampled import Sampled
from .signals import HERTZ, ExcitationSignal, Hertz, Level, checked_quantity

NOISE = Quantity("noise", "(m/s2)/sqrt(Hz)", "", 0.0, 1e12)
RANGE = Quantity("range", "m/s2", "", 5e-324, math.inf)
PARTICIPATION = Quantity("participation", "1", "", -10.0, 10.0)  # of a sensor's place
MOST_SAMPLES = 20_000_000
EMPTY = np.empty(0)
NEEDED = ("x1", "x2", "v1", "v2", "in_contact", "impact_time", "impulse")


@dataclass(frozen=True, kw_only=True)
class Sensor:
    """An accelerometer with its amplifier and its converter.

    In this order: a low-pass filter, the filter against aliasing, noise, the limits of the range,
    the digits.

    Parameters
    ----------
    bandwidth : float
        Frequency at which the sensor's low-pass filter is 3 dB down, Hz.
    order : int
        Of this filter, 1 to 10.
    kind : str
        ``"butterworth"`` or ``"bessel"``.
    noise : float
        One-sided density, (m/s2)/sqrt(Hz); white, so ``noise sqrt(sample_rate/2)`` rms.
    range : float
        Readings end at plus and minus this, m/s2.
    sample_rate : float, optional
        Of the record, Hz; 2.56 times the bandwidth by default.
    resolution : float
        Step of the readings, m/s2; 0 for none.
    seed : int
        Of the noise.
    antialiasing : bool
        Whether an elliptic filter stands before the converter: flat to 0.01 dB up to
        ``sample_rate/2.56``, 80 dB down where frequencies would come back there.
    participation : float
        Of the mass at the sensor's place, which reads ``base + participation (mass - base)``: on
        a uniform cantilever 1.57 at the tip, 0.53 in the middle and 1 at 0.73 of the length. Has
        no effect on the box.

    Examples
    --------
    >>> Sensor(bandwidth=10e3, noise=0.01, range=500.0).sample_rate
    25600.0
    """

    bandwidth: Hertz
    order: Annotated[int, whole(1, 10)] = 4
    kind: Literal["butterworth", "bessel"] = "butterworth"
    noise: Annotated[float, partial(checked_quantity, NOISE)] = 0.0
    range: Annotated[float, partial(checked_quantity, RANGE)] = math.inf
    sample_rate: float | None = None
    resolution: Level = 0.0
    seed: Annotated[int, whole(0, 2**63)] = 0
    antialiasing: bool = True
    participation: Annotated[float, partial(checked_quantity, PARTICIPATION)] = 1.0

    def __post_init__(self) -> None:
        check_and_convert_fields(self)
        rate = 2.56 * self.bandwidth if self.sample_rate is None else self.sample_rate
        object.__setattr__(self, "sample_rate", checked_quantity(HERTZ, "sample_rate", rate))

    @property
    def rate(self) -> float:
        assert self.sample_rate is not None  # set when it was made
        return self.sample_rate

    @property
    def label(self) -> str:
        """Short text for titles: the filter, and all else that changes the readings."""
        parts = [f"{self.kind} of order {self.order}, {self.bandwidth:g} Hz"]
        if self.noise:
            parts.append(f"noise {self.noise:g} (m/s2)/sqrt(Hz) with seed {self.seed}")
        if self.range < math.inf:
            parts.append(f"range {self.range:g} m/s2")
        if self.resolution:
            parts.append(f"resolution {self.resolution:g} m/s2")
        if self.participation != 1.0:
            parts.append(f"participation {self.participation:g}")
        return ", ".join([*parts, *([] if self.antialiasing else ["no filter against aliasing"])])

    def analog_filter(self) -> AnalogFilter:
        """Return the filters of the sensor and against aliasing, in series."""
        parts = [low_pass_zeros_and_poles(self.kind, self.order, self.bandwidth)]
        if self.antialiasing:
            parts.append(anti_aliasing_zeros_and_poles(self.rate))
        return filters_in_series(parts)

    def add_noise_and_digitize(self, values: Floats, channel: int) -> Floats:
        """Add a channel's noise to filtered values, m/s2; clip them to the range, round them."""
        if self.noise:
            rms = self.noise * math.sqrt(0.5 * self.rate)
            generator = np.random.default_rng([self.seed, channel])
            values = values + rms * generator.standard_normal(len(values))
        values = np.clip(values, -self.range, self.range)
        if self.resolution:
            values = np.round(values / self.resolution) * self.resolution
        return values


def measure(
    history: xr.Dataset,
    sensor: Sensor | Mapping[str, Sensor],
    *,
    excitation: ExcitationSignal | None = None,
) -> xr.Dataset:
    """Compute what accelerometers on the box and on both masses read, and a hammer's force cell.

    Parameters
    ----------
    history : xarray.Dataset
        Of :func:`orchestrate.shake` or :func:`orchestrate.simulate`.
    sensor : Sensor or mapping of str to Sensor
        On all three; or by channel (``box_acceleration``, ``acceleration1``, ``acceleration2``),
        with one sample rate; channels left out are not recorded. Under a hammer ``force1`` or
        ``force2`` takes the place of the box, of which a sensor has N in place of m/s2; where one
        is on all, it reads the force through the same filters, without noise, limits and digits.
    excitation : SweptSine, SteppedSine, Random, Shock, Sampled, Hammer or sum, optional
        What the history was shaken by. Without it the box's acceleration between the history's
        samples is taken from the cubic spline through them.

    Returns
    -------
    xarray.Dataset
        A record, see :func:`orchestrate.record`. The attribute ``reconstruction_error`` in m/s2 is
        the largest distance of a mass's acceleration, solved from one sample of the history to
        the next, from that sample.

    Notes
    -----
    Between the history's samples the equations of motion are solved through all impacts, so the
    history may be coarse; an impact of impulse J is a Dirac of area J/m, and the filters' response
    to both is exact. The filters are at rest at the history's beginning. They delay all channels;
    those with the same sensor by the same time. A constant acceleration of the box (gravity) is not
    read, as piezoelectric sensors do not read it. Where the box's spline is not the excitation, the
    box's channel has the spline's error, about ``(w h)^4/100`` of its amplitude for a sine of w
    rad/s sampled every h seconds, and the masses' channels less.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam")
    >>> sweep = orchestrate.SweptSine(first=10.0, last=14.0, duration=2.0, acceleration=0.2)
    >>> history = orchestrate.shake(beam, sweep)
    >>> felt = orchestrate.measure(history, orchestrate.Sensor(bandwidth=1000.0), excitation=sweep)
    >>> felt.sizes["time"], bool(abs(felt.acceleration1).max() > 5 * abs(history.a1_abs).max())
    (5121, True)
    """
    structure = structure_of_history(history)
    refuse_unsupported_structure("measure", structure)
    refuse_unsupported("measure", {name: history.attrs.get(name) for name in FORCES})
    drives = driving_channel_of_history(history)
    sensors = sensors_by_channel(sensor, (drives, *list(ACCELERATIONS)[1:]))
    rate = next(iter(sensors.values())).rate
    length = float(history.time[-1] - history.time[0])
    if not 1.0 <= length * rate <= MOST_SAMPLES:
        low, high = 1.0 / length, MOST_SAMPLES / length
        text = f"expected {low:.3g} to {high:.3g} for that history"
        raise InputError(f"sample_rate = {rate!r} Hz: {text}")
    motion = Motion.from_history(history, structure, driving_pieces(history, excitation), drives)
    parts = solve_smooth_accelerations(motion, rate)
    readings = {
        name: sensors[name].add_noise_and_digitize(
            filtered_reading(parts, motion, name, sensors[name]), number
        )
        for number, name in enumerate(CHANNELS)
        if name in sensors
    }
    made = record(
        time=parts.times + float(history.time[0]),
        sample_rate=rate,
        source="simulated",
        sensors={name: own.label for name, own in sensors.items()},
        title=f"{history.attrs.get('title', 'Motion')}, as sensors read it",
        **readings,
    )
    return made.assign_attrs(reconstruction_error=parts.error)


def filtered_reading(
    parts: SmoothAccelerations, motion: Motion, name: str, sensor: Sensor
) -> Floats:
    """Compute what a sensor's filter reads on the box or on a mass, m/s2, or of a force, N."""
    structure, share, box = motion.structure, sensor.participation, parts.drive
    if name == motion.drives:
        return sensor.analog_filter().apply(box, motion.impact_times[:0], EMPTY, parts.times)
    if motion.drives in FORCES:  # the box is at rest
        box = replace(box, derivatives=0.0 * box.derivatives)
    if name == "acceleration1":
        mass, jumps = parts.mass1, -motion.impulses / structure.m1
    else:
        mass, jumps = parts.mass2, motion.impulses / structure.m2
    signal, times = acceleration_at_sensor(mass, box, share), motion.impact_times
    return sensor.analog_filter().apply(signal, times, share * jumps, parts.times)


def acceleration_at_sensor(
    mass: PolynomialSignal, box: PolynomialSignal, participation: float
) -> PolynomialSignal:
    """Return ``box + participation (mass - box)``: the acceleration at a sensor's place."""
    if participation == 1.0:
        return mass
    derivatives = participation * mass.derivatives
    derivatives[:, : box.derivatives.shape[1]] += (1.0 - participation) * box.derivatives
    return PolynomialSignal(mass.starts, mass.ends, derivatives)


def driving_pieces(history: xr.Dataset, excitation: ExcitationSignal | None) -> Pieces:
    """Return what drives a history as pieces, from the history's beginning on."""
    if excitation is not None:
        label = getattr(excitation, "label", repr(excitation))
        if label != history.attrs.get("excitation"):
            text = f"expected {history.attrs.get('excitation', 'none')}, which made the history"
            raise InputError(f"excitation = {label}: {text}")
        whole = excitation.pieces(float(history.attrs["accuracy"]))
        begin = float(history.time[0])
        return Pieces(whole.nodes - begin, whole.derivatives, whole.error)
    steps = len(history.time) - 1
    rate = steps / float(history.time[-1] - history.time[0])
    drives = driving_channel_of_history(history)
    steady = 0.0 if drives in FORCES else steady_box_acceleration(history)
    driven: Any = history[drives].values - steady
    return Sampled(acceleration=driven, sample_rate=rate).pieces()


def driving_channel_of_history(history: xr.Dataset) -> str:
    """Return which channel of a history drives it; raise if there is none."""
    for name in (*FORCES, "box_acceleration"):
        if name in history and history[name].dims == ("time",):
            return name
    raise InputError("history: expected an answer of shake or simulate, with what drives it")


def sensors_by_channel(
    sensor: Sensor | Mapping[str, Sensor], known: tuple[str, ...] = tuple(ACCELERATIONS)
) -> dict[str, Sensor]:
    if isinstance(sensor, Sensor):
        plain = replace(sensor, noise=0.0, range=math.inf, resolution=0.0)
        return {name: plain if name in FORCES else sensor for name in known}
    fits = isinstance(sensor, Mapping) and all(isinstance(s, Sensor) for s in sensor.values())
    if not fits or not sensor or not set(sensor) <= set(known):
        names = ", ".join(known)
        raise InputError(f"sensor = {sensor!r}: expected a Sensor, or one for each of {names}")
    rates = sorted({own.rate for own in sensor.values()})
    if len(rates) > 1:
        text = "expected one sample rate for all channels"
        raise InputError(f"sensor: {' and '.join(f'{rate:g}' for rate in rates)} Hz; {text}")
    return dict(sensor)


def structure_of_history(history: xr.Dataset, needed: tuple[str, ...] = NEEDED) -> Structure:
    """Return the structure of a history; raise if one of the variables ``needed`` is missing."""
    attributes, variables = getattr(history, "attrs", {}), getattr(history, "variables", {})
    known = {*STRUCTURE} - {*ADDED} <= {*attributes} and {*needed} <= {*variables}
    if not known or history.sizes.get("time", 0) < 4:
        raise InputError("history: expected an answer of shake or simulate, of 4 samples or more")
    return Structure.from_attributes(attributes)
