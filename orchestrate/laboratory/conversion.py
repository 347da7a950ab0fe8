"""Channels as they are measured, made accelerations: units, sensitivities, scales, delays."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..constants import GRAVITY, TURN
from ..errors import NOT_NUMBERS, InputError
from .pieces import Floats

INCH = 0.0254
SMALLEST, LARGEST = 1e-12, 1e12  # sizes of a channel's scale
ACCELERATIONS = {  # in m/s2
    **dict.fromkeys(("m/s2", "m/s/s", "ms-2", "m/sec2", "ms2"), 1.0),
    **dict.fromkeys(("g", "gn", "g0", "gs", "gpk", "gpeak"), GRAVITY),
    "mg": 1e-3 * GRAVITY,
    "mm/s2": 1e-3,
    "cm/s2": 1e-2,
    "gal": 1e-2,
    "in/s2": INCH,
    "ft/s2": 12.0 * INCH,
}
SPEEDS = {  # in m/s
    **{"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "in/s": INCH},
    **dict.fromkeys(("um/s", "\u00b5m/s", "\u03bcm/s"), 1e-6),
}
LENGTHS = {  # in m
    **{"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": INCH, "mil": 1e-3 * INCH, "nm": 1e-9},
    **dict.fromkeys(("um", "\u00b5m", "\u03bcm", "micron"), 1e-6),
}
VOLTAGES = {"v": 1.0, "mv": 1e-3, **dict.fromkeys(("uv", "\u00b5v", "\u03bcv"), 1e-6)}  # in V
FORCES = {"n": 1.0, "kn": 1e3, "mn": 1e-3, "lbf": 4.4482216152605}  # in N
MOTIONS = {0: "acceleration", 1: "velocity", 2: "displacement"}  # by derivatives to take
Tables = Mapping[int, Mapping[str, float]]  # of units, by derivatives to take
OF_MOTIONS: Tables = {0: ACCELERATIONS, 1: SPEEDS, 2: LENGTHS}
OF_FORCES: Tables = {0: FORCES}
SENSITIVITY = re.compile(
    r"(?P<number>[+-]?\d+(?:[.,]\d+)?)\s*(?P<volts>[mu\u00b5\u03bc]?V)/(?P<unit>.+)"
)
CALLED = {  # what options call the channels
    **dict.fromkeys(("base", "box", "box_acceleration"), "box_acceleration"),
    **dict.fromkeys(("face", "face1", "acceleration1"), "acceleration1"),
    **dict.fromkeys(("face2", "acceleration2"), "acceleration2"),
    **{"force": "force1", "force1": "force1", "force2": "force2", "time": "time"},
}
ALL_OF = {"face": ("acceleration1", "acceleration2"), "force": ("force1", "force2")}
ByChannel = str | float | Mapping[str, Any] | None  # as an argument: of all, or by channel


def normalize_unit(text: str) -> str:
    plain = text.strip().lower().replace("\u00b2", "2").replace("\u207b", "-")
    return plain.translate(str.maketrans("", "", "^*_. \u00b7[]()"))


def expand_by_channel(
    name: str, argument: ByChannel, channels: Sequence[str], only_if_named: Sequence[str] = ()
) -> dict[str, Any]:
    """Expand an argument to a value by channel: of all, a mapping, or ``base=V,face=mm/s``.

    ``face`` and ``force`` are of all such channels that are not named themselves; those in
    ``only_if_named`` have it only where they are named.
    """
    if argument is None:
        return {}
    if isinstance(argument, str) and "=" in argument:
        parts = [part.partition("=") for part in re.split(r",(?=[^,=]+=)", argument)]
        if bare := [word for word, sign, _ in parts if not sign]:
            text = f"{bare[0]!r} of which channel? expected base=..."
            raise InputError(f"{name} = {argument!r}: {text}")
        argument = {word: value for word, _, value in parts}
    if not isinstance(argument, Mapping):
        return dict.fromkeys(channels, argument)
    values: dict[str, Any] = {}
    of_several: dict[str, Any] = {}
    for key, value in argument.items():
        word = str(key).strip().lower().replace(" ", "")
        plain, value = CALLED.get(word, ""), value.strip() if isinstance(value, str) else value
        several = [one for one in ALL_OF.get(word, ()) if one in channels]
        if plain not in (known := (*channels, *only_if_named)) and not several:
            text = f"expected {', '.join(word for word, one in CALLED.items() if one in known)}"
            if plain not in ("", "time"):
                text = f'no column is read as it; channels="{word}=COLUMN,..." names it, or {text}'
            raise InputError(f"{name}: no channel {key!r}; {text}")
        values |= {} if several else {plain: value}
        of_several |= dict.fromkeys(several, value)
    return of_several | values


def text_by_channel(
    name: str, argument: ByChannel, channels: Sequence[str], only_if_named: Sequence[str] = ()
) -> dict[str, str]:
    """Return texts by channel; raise if one is no text."""
    texts = expand_by_channel(name, argument, channels, only_if_named)
    for channel, value in texts.items():
        if not isinstance(value, str):
            raise InputError(f"{name} of {channel} = {value!r}: expected a text in quotes")
    return texts


def number_by_channel(
    name: str, argument: ByChannel, channels: Sequence[str], smallest_size: float = 0.0
) -> dict[str, float]:
    """Return numbers by channel; raise unless their sizes are in a range, up to `LARGEST`."""
    numbers = {}
    for channel, value in expand_by_channel(name, argument, channels).items():
        try:
            numbers[channel] = float(value)
        except NOT_NUMBERS:
            numbers[channel] = math.nan
        if not smallest_size <= abs(numbers[channel]) <= LARGEST:
            sizes = f"of sizes from {smallest_size:g} to {LARGEST:g}, such as face1=-1"
            raise InputError(f"{name} = {argument!r}: expected numbers {sizes}")
    return numbers


def factor_and_derivatives(
    label: str, unit: str, sensitivity: str, tables: Tables
) -> tuple[float, int]:
    """Return the factor from a column's unit to SI, and how many derivatives make acceleration.

    Of a voltage they follow from its sensitivity, such as ``100 mV/g``.
    """
    plain, is_motion = normalize_unit(unit), tables is OF_MOTIONS
    derivatives = {name: n for n, factors in tables.items() for name in factors}
    if plain in derivatives:
        return tables[derivatives[plain]][plain], derivatives[plain]
    if plain not in VOLTAGES and (plain or not sensitivity):
        names = "m/s2, g, mm/s, um, V" if is_motion else "N, kN, V"
        text = f"unit = {unit!r}; expected one such as {names}: give it by unit="
        raise InputError(f"{label}: {text}")
    parts = SENSITIVITY.fullmatch(sensitivity.strip())
    below = normalize_unit(parts["unit"]) if parts else ""
    number = float(parts["number"].replace(",", ".")) if parts else 0.0
    if parts is None or below not in derivatives or not number:
        usual = "100 mV/g or 50 mV/(mm/s)" if is_motion else "22 mV/N"
        text = f"expected one such as {usual}, or base=... for one channel: give it by sensitivity="
        raise InputError(f"{label}: sensitivity {sensitivity!r}; {text}")
    volts = number * VOLTAGES[normalize_unit(parts["volts"])]
    n = derivatives[below]
    return VOLTAGES[plain or "v"] * tables[n][below] / volts, n


def differentiate_and_advance(
    values: Floats, rate: float, derivatives: int, delay: float
) -> Floats:
    """Return a channel's derivative of an order, earlier by a delay in s, by its spectrum."""
    from scipy.fft import irfft, rfft, rfftfreq

    if not derivatives and not delay:
        return values
    slope = (values[-1] - values[0]) / (len(values) - 1) * rate
    time = np.arange(len(values)) / rate
    rest = values - values[0] - slope * time
    odd = np.concatenate([rest, -rest[-2:0:-1]])
    turn = TURN * rfftfreq(len(odd), 1.0 / rate)
    made = irfft((1j * turn) ** derivatives * np.exp(1j * turn * delay) * rfft(odd), len(odd))
    line = {0: values[0] + slope * (time + delay), 1: np.full(len(values), slope)}
    return np.asarray(made[: len(values)] + line.get(derivatives, 0.0))


def si_factor(label: str, unit: str, factors: Mapping[str, float]) -> float:
    if normalize_unit(unit) not in factors:
        usual = ("ms", "rad/s", "deg")
        names = ", ".join(list(factors)[:1] + [name for name in usual if name in factors])
        text = f"unit = {unit!r}" if unit else "no unit"
        mend = 'give it by unit="time=..."' if "s" in factors else "mend it in the file"
        raise InputError(f"{label}: {text}; expected one such as {names}: {mend}")
    return factors[normalize_unit(unit)]
