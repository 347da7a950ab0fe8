"""The one dataset of a measured resonance curve: amplitudes of faces over the frequency."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..constants import TURN
from ..errors import InputError
from ..lazy import xr
from ..response.labels import variable
from .conversion import OF_MOTIONS, normalize_unit
from .headings import RATIO_UNITS
from .pieces import Floats
from .record import array_of_numbers

FACES = ("acceleration1", "acceleration2")
CURVE_ORDERS = (1.0, 2.0, 3.0)
FEWEST_POINTS = 10
MOST_POINTS = 2000
DIRECTIONS = ("up", "down")


def resonance_curve(
    *,
    frequency: ArrayLike,
    level: ArrayLike,
    amplitude1: ArrayLike | None = None,
    amplitude2: ArrayLike | None = None,
    floor: ArrayLike | None = None,
    unit: str = "m/s2",
    relative: bool = False,
    direction: str | None = None,
    title: str = "Resonance curve",
) -> xr.Dataset:
    """Make a measured resonance curve: check its columns and put them in a dataset.

    Parameters
    ----------
    frequency : array_like, shape (n,)
        Hz, ascending or descending; at least 10.
    level : float or array_like, shape (n,)
        Peak acceleration of the base, m/s2.
    amplitude1, amplitude2 : array_like, shape (n,) or (orders, n), optional
        Peak amplitudes of faces 1 and 2 at the frequency of the excitation (order 1), as a tracking
        filter or the line of a spectrum has them, then at twice and three times of it. Complex with
        phases: of the face against the base, both as accelerations or both as displacements. NaN
        where an order was not measured.
    floor : float or array_like, shape (n,), optional
        Amplitude of what is read where nothing moves, in the same unit.
    unit : str
        Of the amplitudes: of an acceleration (``"m/s2"``, ``"g"``), a velocity (``"mm/s"``), a
        displacement (``"m"``, ``"mm"``, ``"um"``), or ``"1"``, a transmissibility: over the base.
    relative : bool
        Whether the amplitudes are those of the motion relative to the base, not absolute.
    direction : {"up", "down"}, optional
        In which the frequencies were passed, since two motions may exist at one of them. By default
        their order: up if they ascend.
    title : str

    Returns
    -------
    xarray.Dataset
        Over ``channel`` (``acceleration1``, ``acceleration2``), ``order`` (1, 2, 3) and
        ``frequency`` in Hz: ``amplitude`` in m/s2; over channel and frequency ``phase`` of order 1
        in rad, negative where the face lags, and ``floor`` in m/s2, NaN where they are unknown;
        over frequency the ``level`` in m/s2. Attributes ``direction``, ``relative``, ``unit``,
        ``phase_sign`` and ``dropped``.

    Raises
    ------
    InputError
        Where frequencies neither ascend nor descend, an amplitude is negative, or the points are
        too few; it names the row, counted from 0.

    Warns
    -----
    UserWarning
        Where rows without a number are dropped.

    Notes
    -----
    A structure takes up work of its base, so that a face lags: phases that are mostly positive are
    those of the lag, and are turned; ``phase_sign`` says so.

    Examples
    --------
    >>> import numpy as np
    >>> hertz = np.linspace(40.0, 60.0, 21)
    >>> ratio = 1.0 / abs(1.0 - (hertz / 50.0) ** 2 + 0.02j)
    >>> curve = resonance_curve(frequency=hertz, level=4.0, amplitude1=ratio, unit="1")
    >>> curve.amplitude.sel(order=1.0, frequency=50.0).values.round(6).tolist()
    [200.0]
    """
    faces = {"amplitude1": amplitude1, "amplitude2": amplitude2}
    amplitudes = {
        name: array_of_numbers(name, one, complex if np.iscomplexobj(one) else float)
        for name, one in faces.items()
        if one is not None
    }
    complexes = {name: one for name, one in amplitudes.items() if np.iscomplexobj(one)}
    columns = CurveColumns(
        frequency=array_of_numbers("frequency", frequency),
        level=level,
        amplitudes={**amplitudes, **{name: np.abs(one) for name, one in complexes.items()}},
        phases={name: np.angle(np.atleast_2d(one)[0]) for name, one in complexes.items()},
        floors=dict.fromkeys(amplitudes, floor) if floor is not None else {},
        units=dict.fromkeys(amplitudes, unit),
    )
    return make_curve(columns, relative, direction, {"title": title, "source": "measured"})


@dataclass(frozen=True)
class CurveColumns:
    """Hold the columns of a resonance curve before they are checked."""

    frequency: Floats  # Hz
    level: ArrayLike  # m/s2
    amplitudes: Mapping[str, Floats]  # by `amplitude1` and `amplitude2`, shape (n,) or (orders, n)
    phases: Mapping[str, Floats] = field(default_factory=dict)  # of order 1, rad
    floors: Mapping[str, ArrayLike] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)  # of amplitudes and floors
    first_row: int = 0  # number of the first row, for messages

    def face_orders(self, name: str) -> Floats:
        """Return the orders of a face in its own unit, shape (3, n), NaN where there are none."""
        count = len(self.frequency)
        rows = np.atleast_2d(self.amplitudes[name])
        if rows.ndim != 2 or rows.shape[1] != count or len(rows) > len(CURVE_ORDERS):
            shape = "x".join(map(str, self.amplitudes[name].shape)) or "one"
            text = f"expected {count}, as the frequencies, or up to 3 orders of {count}"
            raise InputError(f"{name}: {shape} values; {text}")
        for row in rows:
            check_positive(name, row, np.arange(count) + self.first_row, allow_zero=True)
        orders = np.full((len(CURVE_ORDERS), count), np.nan)
        orders[: len(rows)] = rows
        return orders

    def broadcast_to_frequencies(self, name: str, value: ArrayLike) -> Floats:
        values = array_of_numbers(name, value)
        count = len(self.frequency)
        if values.shape not in ((), (1,), (count,)):
            text = f"expected one, or {count} as the frequencies"
            raise InputError(f"{name}: {'x'.join(map(str, values.shape))} values; {text}")
        return np.array(np.broadcast_to(values, (count,)), dtype=float)


def make_curve(
    columns: CurveColumns, relative: bool, direction: str | None, attributes: Mapping[str, Any]
) -> xr.Dataset:
    """Check the columns of a resonance curve and return it; see :func:`resonance_curve`."""
    import xarray as xr

    if not columns.amplitudes:
        raise InputError("resonance curve: no amplitude; expected amplitude1, amplitude2 or both")
    known = complete_rows(columns)
    frequency = columns.frequency[known]
    check_monotonic_frequencies(frequency, np.flatnonzero(known) + columns.first_row)
    level = columns.broadcast_to_frequencies("level", columns.level)[known]
    check_positive("level", level, np.flatnonzero(known) + columns.first_row)
    faces = sorted(columns.amplitudes)
    amplitude = np.empty((len(faces), len(CURVE_ORDERS), len(frequency)))
    floor, phase = np.full((2, len(faces), len(frequency)), np.nan)
    for number, name in enumerate(faces):
        unit = columns.units.get(name, "m/s2")
        factor = acceleration_factor(name, unit, frequency, level)
        scale = factor * np.array(CURVE_ORDERS)[:, None] ** frequency_power_of_unit(unit)
        amplitude[number] = scale * columns.face_orders(name)[:, known]
        if name in columns.floors:
            label = f"floor of {name}"
            own = columns.broadcast_to_frequencies(label, columns.floors[name])[known]
            check_positive(label, own, None, allow_zero=True)
            floor[number] = factor * own
        if name in columns.phases:
            label = f"phase of {name}"
            phase[number] = columns.broadcast_to_frequencies(label, columns.phases[name])[known]
    phase, sign = make_lags_negative(amplitude[:, 0], phase)
    text = "peak amplitude of orders, relative to the base" if relative else "peak amplitude"
    over = ("channel", "frequency")
    words = {
        **attributes,
        "unit": ", ".join(f"{name} in {columns.units.get(name, 'm/s2')}" for name in faces),
        "relative": str(bool(relative)).lower(),
        "direction": checked_direction(frequency, direction),
        "phase_sign": sign,
        "dropped": describe_dropped_rows(known, columns.first_row),
    }
    variables = {
        "amplitude": variable(("channel", "order", "frequency"), amplitude, "m/s2", text),
        "phase": variable(over, phase, "rad", "phase of order 1 against the base"),
        "floor": variable(over, floor, "m/s2", "amplitude where nothing moves"),
        "level": variable("frequency", level, "m/s2", "peak acceleration of the base"),
    }
    return xr.Dataset(variables, curve_coordinates(faces, frequency), words)


def curve_coordinates(faces: list[str], frequency: Floats) -> dict[str, Any]:
    channels = [FACES[int(name[-1]) - 1] for name in faces]
    return {
        "channel": ("channel", channels, {"long_name": "face that was measured"}),
        "order": variable("order", np.array(CURVE_ORDERS), "1", "over the excitation's"),
        "frequency": variable("frequency", frequency, "Hz", "frequency of the excitation"),
    }


# -- checks ---------------------------------------------------------------------------------------


def complete_rows(columns: CurveColumns) -> NDArray[np.bool_]:
    """Return a mask of the rows with frequency, level and order 1 of each face; warn of others."""
    if columns.frequency.ndim != 1:
        raise InputError(f"frequency: {columns.frequency.ndim} dimensions; expected a list")
    level = columns.broadcast_to_frequencies("level", columns.level)
    known = np.isfinite(columns.frequency) & np.isfinite(level)
    for name in columns.amplitudes:
        known &= np.isfinite(columns.face_orders(name)[0])
    if text := describe_dropped_rows(known, columns.first_row):
        warnings.warn(f"resonance curve: {text}", UserWarning, stacklevel=4)
    if not FEWEST_POINTS <= known.sum() <= MOST_POINTS:
        text = f"expected {FEWEST_POINTS} to {MOST_POINTS} frequencies with a level and amplitudes"
        raise InputError(f"resonance curve: {known.sum()} points; {text}")
    return np.asarray(known)


def describe_dropped_rows(known: NDArray[np.bool_], first_row: int) -> str:
    """Return a text that says which rows have no numbers; empty if all have."""
    rows = np.flatnonzero(~known) + first_row
    if not len(rows):
        return ""
    several = f"rows {', '.join(map(str, rows[:5]))}{' and others' if len(rows) > 5 else ''}"
    return f"{several if len(rows) > 1 else f'row {rows[0]}'} dropped: not a number"


def check_monotonic_frequencies(frequency: Floats, rows: NDArray[np.intp]) -> None:
    """Check that frequencies are above 0, and ascend or descend."""
    check_positive("frequency", frequency, rows)
    steps = np.diff(frequency)
    falling = np.median(steps) < 0.0
    wrong = np.flatnonzero(steps >= 0.0 if falling else steps <= 0.0)
    if len(wrong):
        after, before = frequency[wrong[0] + 1], frequency[wrong[0]]
        text = "expected ascending or descending frequencies, each once: one curve a direction"
        row = rows[wrong[0] + 1]
        raise InputError(f"frequency, row {row}: {after:.9g} Hz after {before:.9g} Hz; {text}")


def check_positive(
    name: str, values: Floats, rows: NDArray[np.intp] | None, allow_zero: bool = False
) -> None:
    wrong = np.flatnonzero(values < 0.0 if allow_zero else ~(values > 0.0))
    if len(wrong):
        row = wrong[0] if rows is None else rows[wrong[0]]
        expected = "a number >= 0" if allow_zero else "a number > 0"
        raise InputError(f"{name}, row {row}: {values[wrong[0]]:.6g}; expected {expected}")


def checked_direction(frequency: Floats, direction: str | None) -> str:
    """Return the direction in which the frequencies were passed, from their order if not given."""
    if direction is None:
        return DIRECTIONS[int(frequency[-1] < frequency[0])]
    if direction not in DIRECTIONS:
        raise InputError(f"direction = {direction!r}: expected up or down")
    return direction


# -- units and phases -----------------------------------------------------------------------------


def frequency_power_of_unit(unit: str) -> int:
    """Return the power of the frequency that makes a unit's quantity an acceleration."""
    plain = normalize_unit(unit)
    return next((n for n, units in OF_MOTIONS.items() if plain in units), 0)


def acceleration_factor(name: str, unit: str, frequency: Floats, level: Floats) -> Floats:
    """Return the factors that convert order 1 of a unit's quantity to m/s2, shape (n,)."""
    plain, power = normalize_unit(unit), frequency_power_of_unit(unit)
    if plain in RATIO_UNITS:
        return level.copy()
    if plain not in OF_MOTIONS[power]:
        text = f"unit = {unit!r}" if unit else "no unit"
        names = "m/s2, g, mm/s, m, mm, um, or 1 for a transmissibility"
        raise InputError(f"{name}: {text}; expected one such as {names}: give it by unit=")
    return np.asarray(OF_MOTIONS[power][plain] * (TURN * frequency) ** power)


def make_lags_negative(amplitude: Floats, phase: Floats) -> tuple[Floats, str]:
    """Return phases that are negative where a face lags, and what was done with their sign."""
    wrapped = np.angle(np.exp(1j * phase))
    if not np.isfinite(phase).any():
        return wrapped, ""
    if np.nansum(amplitude**2 * np.sin(phase)) > 0.0:
        return -wrapped, "positive phases taken as lags"
    return wrapped, "negative phases taken as lags"
