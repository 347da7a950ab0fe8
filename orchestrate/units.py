"""Display units: convert and format SI values for prints, pictures, tables and pages.

Datasets are in SI, whatever is asked. What shows a dataset reads here which units were asked for,
which the dataset carries as the attribute ``shown_in`` (:func:`with_units`); a stored result has
none.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from functools import reduce
from typing import TYPE_CHECKING, Any

from .constants import GRAVITY, TURN
from .errors import InputError

if TYPE_CHECKING:
    import xarray as xr

SHOWN_IN = "shown_in"
FACTORS: dict[str, dict[str, float]] = {  # SI of each word; nan where it depends on the answer
    "frequency": {"Hz": TURN, "rpm": TURN / 60.0, "rad/s": 1.0, "eta": math.nan},
    "length": {"m": 1.0, "mm": 1e-3, "um": 1e-6},
    "acceleration": {"m/s2": 1.0, "g": GRAVITY},
    "time": {"s": 1.0, "periods": math.nan},
}
OF_ACCELERATION = {"m/s2": (1, "g"), "m2/s4/Hz": (2, "g2/Hz"), "s2/m": (-1, "1/g")}
ALIKE = {"hz": "Hz", "µm": "um", "μm": "um", "rad_s": "rad/s", "m/s^2": "m/s2", "m/s²": "m/s2"}
EXPECTED = "; ".join(f"{' or '.join(words)}" for words in FACTORS.values())
OVER_OMEGA = "Omega/omega"


@dataclass(frozen=True)
class Units:
    """Display units chosen for frequency, length, acceleration and time; empty: not chosen."""

    frequency: str = ""  # Hz, rpm, rad/s or eta, the ratio to omega = sqrt(k1/m1)
    length: str = ""  # m, mm or um; beside mm and um speeds are in mm/s
    acceleration: str = ""  # m/s2 or g, 9.80665 m/s2
    time: str = ""  # s, or periods of the box

    @classmethod
    def from_text(cls, text: str, option: str = "units") -> Units:
        """Read units from a list such as ``Hz, mm, g``: at most one of each kind, in any order."""
        chosen: dict[str, str] = {}
        if not isinstance(text, str):
            raise InputError(f"{option} = {text!r}: expected a list of {EXPECTED}")
        for part in text.replace(",", " ").split():
            word = ALIKE.get(part.lower(), part)
            kind = next((kind for kind, words in FACTORS.items() if word in words), None)
            if kind is None:
                raise InputError(f"{option} {text}: {part}; expected a list of {EXPECTED}")
            if kind in chosen:
                both = f"{chosen[kind]} and {word}"
                raise InputError(f"{option} {text}: {both}; expected one unit of {kind}")
            chosen[kind] = word
        return cls(**chosen)

    @property
    def words(self) -> tuple[str, ...]:
        """Names of the chosen units, without kinds for which none was chosen."""
        return tuple(filter(None, (getattr(self, field.name) for field in fields(self))))

    def __str__(self) -> str:
        return ", ".join(self.words)

    def with_defaults(self, defaults: Units) -> Units:
        """Return a copy in which kinds without a chosen unit take that of ``defaults``."""
        names = [field.name for field in fields(self)]
        return Units(**{name: getattr(self, name) or getattr(defaults, name) for name in names})


def with_units(data: xr.Dataset, units: Units | str) -> xr.Dataset:
    """Return a dataset marked to be displayed in the given units; its numbers stay in SI."""
    chosen = units if isinstance(units, Units) else Units.from_text(units)
    text = str(chosen.with_defaults(display_units_of(data)))
    return data.assign_attrs({SHOWN_IN: text}) if text else data


def display_units_of(data: xr.Dataset) -> Units:
    return Units.from_text(str(data.attrs.get(SHOWN_IN, "")))


def is_in_si(data: xr.Dataset) -> bool:
    """Return whether a dataset's structure is in SI: sqrt(k1/m1) is known and not 1 rad/s."""
    omega = omega_of(data)
    return math.isfinite(omega) and not math.isclose(omega, 1.0, rel_tol=1e-9)


def shows_lengths_as_ratios(data: xr.Dataset) -> bool:
    """Return whether lengths are shown as the paper's ratios: of a structure that is not in SI."""
    in_si = is_in_si(data) or math.isnan(omega_of(data))
    return not (in_si or display_units_of(data).length)


def with_readable_lengths(*datasets: xr.Dataset) -> list[xr.Dataset]:
    """Return datasets with display lengths in m, mm or um, so that the largest is 1 at least.

    They stay as they are where a unit of length was asked for, or a structure is not in SI.
    """
    if not all(is_in_si(data) and not display_units_of(data).length for data in datasets):
        return list(datasets)
    largest = max(map(largest_length, datasets), default=0.0)
    sizes = {size: word for word, size in FACTORS["length"].items() if size <= largest < math.inf}
    word = sizes[max(sizes)] if sizes else ""
    return [with_units(data, word) for data in datasets]


def largest_length(data: xr.Dataset) -> float:
    """Return the largest length of a dataset's variables, axes and gaps, m; 0 if it has none."""
    shown = [*data.data_vars.values(), *(data[name] for name in data.dims if name in data.coords)]
    lengths = [array for array in shown if array.attrs.get("units") == "m"]
    if "xi_rel_max" in data and (unit := unit_of_xi(data)) is not None:
        lengths.append(data.xi_rel_max * unit)
    sizes = [float(abs(one).max()) for one in lengths if one.dtype.kind == "f" and one.size]
    return max(filter(math.isfinite, sizes), default=0.0)


def omega_of(data: xr.Dataset | Mapping[str, float]) -> float:
    """Return sqrt(k1/m1), rad/s, of a dataset's attributes or a dict; nan where it is unknown."""
    known: Mapping[Any, Any] = getattr(data, "attrs", data)
    try:
        return math.sqrt(float(known["k1"]) / float(known["m1"]))
    except (KeyError, TypeError, ValueError):
        return math.nan


def unit_of_xi(data: xr.Dataset) -> xr.DataArray | float | None:
    """Return the unit in m that the paper's displacements xi are over, as an excitation has it.

    It is a eta^2, without box motion the largest static displacement by what pushes; None where
    omega changes or the excitation is not known.
    """
    import numpy as np

    if {"eta", "frequency"} <= set(data.coords):
        omega: Any = data.frequency / data.eta
    elif {"m1", "k1", "omega"} & set(map(str, data.coords)):
        return None
    else:
        omega = omega_of(data)
    box = {name: parameter_of(data, name) for name in ("level", "amplitude", "frequency")}
    if box["level"] is None and box["amplitude"] is not None and box["frequency"] is not None:
        box["level"] = box["amplitude"] * box["frequency"] ** 2
    if box["level"] is None or np.all(box["level"] != 0.0):
        return None if box["level"] is None else box["level"] / omega**2
    pushes = [parameter_of(data, name, 0.0) for name in ("box_acceleration", "force1", "force2")]
    stiffness = [omega**2, parameter_of(data, "k1"), parameter_of(data, "k2")]
    if any(one is None for one in (*pushes, *stiffness)) or np.any(box["level"] != 0.0):
        return None
    softness = [1.0 / one for one in stiffness]
    return largest_static_displacement(pushes, softness) + box["level"]  # along it too


def largest_static_displacement(pushes: Iterable[Any], softness: Iterable[Any]) -> Any:
    """Return the largest static displacement, m, by the box's acceleration and both forces."""
    import numpy as np  # commands whose help is asked for do without

    return reduce(np.maximum, (abs(p) * s for p, s in zip(pushes, softness, strict=True)))


def parameter_of(data: xr.Dataset, name: str, default: float | None = None) -> Any:
    """Return a parameter's values along a dataset, or the number all share; None if not known."""
    if name in data.coords:
        return data[name]
    value = data.attrs.get(name, default)
    return value if is_finite_number(value) else None


def is_finite_number(value: Any) -> bool:
    try:
        return not isinstance(value, str) and math.isfinite(value)
    except TypeError:
        return False


def excitation_period_of(data: xr.Dataset) -> float:
    """Return the box's excitation period, s, of a dataset at one frequency; nan for others."""
    for holder in (data.attrs, data.coords):
        for name, factor in (("frequency", 1.0), ("eta", omega_of(data))):
            value = holder.get(name)
            in_hertz = getattr(value, "attrs", {}).get("units") == "Hz"  # of a record's line
            if value is not None and not getattr(value, "shape", ()) and not in_hertz:
                return TURN / (factor * float(value))
    return math.nan


def display_scale_of(data: xr.Dataset, unit: str) -> tuple[float, str]:
    """Return the divisor from an SI unit to the display unit of a dataset, and that unit's name."""
    units = display_units_of(data)
    word, factor = unit, 1.0
    if unit in ("rad/s", "Hz") and units.frequency:
        word = units.frequency
        factor = omega_of(data) if word == "eta" else FACTORS["frequency"][word]
        factor /= FACTORS["frequency"][unit]
    elif unit in ("m", "m/s") and units.length:
        length = "mm" if unit == "m/s" and units.length == "um" else units.length
        word, factor = unit.replace("m", length, 1), FACTORS["length"][length]
    elif unit in OF_ACCELERATION and units.acceleration:
        power, in_g = OF_ACCELERATION[unit]
        word = in_g if units.acceleration == "g" else unit
        factor = FACTORS["acceleration"][units.acceleration] ** power
    elif unit == "s" and units.time:
        word = units.time
        factor = excitation_period_of(data) if word == "periods" else 1.0
    return (factor, word) if math.isfinite(factor) else (1.0, unit)


def format_quantity(
    data: xr.Dataset, value: float | xr.DataArray, unit: str, form: str = ".6g"
) -> str:
    """Format an SI value with unit, in a dataset's display units: ``12.5 Hz``, ``eta = 0.8``."""
    number, word = format_number_and_unit(data, value, unit, form)
    return f"eta = {number}" if word == "eta" else f"{number} {word}".rstrip()


def format_quantity_range(
    data: xr.Dataset, low: float, high: float, unit: str, form: str = ".4g"
) -> str:
    """Format two SI values as a range in a dataset's display units: ``41 to 45 Hz``."""
    first, word = format_number_and_unit(data, low, unit, form)
    last, _ = format_number_and_unit(data, high, unit, form)
    return f"eta = {first} to {last}" if word == "eta" else f"{first} to {last} {word}".rstrip()


def format_number_and_unit(
    data: xr.Dataset, value: float | xr.DataArray, unit: str, form: str = ".6g"
) -> tuple[str, str]:
    """Convert an SI value to a dataset's display unit; return its text and the unit's name."""
    factor, word = display_scale_and_label(data, unit)
    return format(float(value) / factor, form), word


def display_scale_and_label(data: xr.Dataset, unit: str) -> tuple[float, str]:
    """Return divisor and unit as :func:`display_scale_of` does, of ratios no unit.

    Where lengths are the paper's ratios, they have none, nor have speeds and accelerations.
    """
    factor, word = display_scale_of(data, unit)
    is_ratio = word == unit in ("m", "m/s", "m/s2") and shows_lengths_as_ratios(data)
    return factor, "" if word == "1" or is_ratio else word


def in_display_units(data: xr.Dataset) -> xr.Dataset:
    """Convert a dataset's values and ``units`` attributes from SI to its display units.

    Beside a frequency ratio a frequency stays in rad/s; what is named for its unit keeps it.
    """
    if SHOWN_IN not in data.attrs:
        return data
    changed: dict[str, Any] = {}
    for name, array in data.variables.items():
        factor, word = display_scale_of(data, str(array.attrs.get("units", "")))
        if str(name).endswith("hertz") or (word == "eta" and "eta" in data.variables):
            continue
        if array.dtype.kind == "f" and word != array.attrs.get("units", ""):
            about = {**array.attrs, "units": OVER_OMEGA if word == "eta" else word}
            changed[str(name)] = (array.dims, array.values / factor, about)
    shown = data.assign_coords({n: v for n, v in changed.items() if n in data.coords})
    return shown.assign({n: v for n, v in changed.items() if n not in data.coords})
