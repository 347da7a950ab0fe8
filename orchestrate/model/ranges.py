"""Names, units, defaults and ranges of a user's parameters, from the FMUs' variable tables."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from decimal import Decimal, InvalidOperation
from typing import Any, TypeVar

from fmu_src.export.description_common import UNITS
from fmu_src.models.electrodynamic_shaker import variables as electrodynamic_shaker
from fmu_src.models.motor_shaker import variables as motor_shaker
from fmu_src.models.oscillator import variables as oscillator

from ..constants import GRAVITY
from ..errors import InputError

Described = TypeVar("Described")
WRITTEN_UNITS: dict[tuple[str, ...], dict[str, str]] = {  # in texts, over a quantity's own
    ("clearance", "preload", "stroke", "amplitude", "x1", "x2", "x_rel"): (
        {"mm": "1e-3", "um": "1e-6", "µm": "1e-6", "m": "1"}
    ),
    ("zeta1", "zeta2", "D", "D1", "D2"): {"%": "0.01"},
    ("f1", "f2", "f1_hz", "f2_hz", "hz", "frequency_hz"): {"Hz": "1"},
    ("rpm", "frequency_rpm"): {"rpm": "1"},
    ("g", "acceleration_g", "range"): {"g": "1"},
    ("box_acceleration",): {"m/s2": "1", "g": str(GRAVITY)},
    ("noise",): {"(m/s2)/sqrt(Hz)": "1"}  # density of an acceleration; as data sheets have it:
    | {
        f"{prefix}g{root}": str(Decimal(factor) * Decimal(str(GRAVITY)))
        for root in ("", "/sqrt(Hz)", "/sqrtHz")
        for prefix, factor in (("u", "1e-6"), ("µ", "1e-6"), ("m", "1e-3"), ("", "1"))
    },
    ("m1", "m2"): {"kg": "1", "g": "1e-3"},
    ("v1", "v2", "v_rel"): {"mm/s": "1e-3", "m/s": "1"},
}


@dataclass(frozen=True)
class Quantity:
    """A user's number as the variable table has it: name, unit, meaning, default and range."""

    # unit `"1"` is dimensionless
    name: str
    unit: str
    description: str
    # its range, both ends included
    minimum: float
    maximum: float
    default: float = 0.0  # what the FMU takes where nothing is given

    @property
    def dimension(self) -> dict[str, int]:
        """Return the exponents of kg, m and s in the quantity's unit, as a dict."""
        exponents = UNITS[self.unit]
        return {base: exponents.get(base, 0) for base in ("kg", "m", "s")}

    @property
    def expected(self) -> str:
        """Return the allowed range as text for error messages, such as ``0 <= e <= 1``."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.minimum:g} <= {self.name} <= {self.maximum:g}{unit}"

    def check(self, value: Any) -> float:
        if type(value) is float and self.minimum <= value <= self.maximum:  # usually
            return value + 0.0
        number = as_scalar(value)
        if isinstance(number, str):
            with suppress(ValueError):
                number = parse_number_with_unit(self.name, number)
        if isinstance(number, bool) or not isinstance(number, numbers.Real):
            raise InputError(f"{self.name} = {value!r}: expected a number, {self.expected}")
        try:
            number = float(number)
        except OverflowError:
            number = math.inf
        if not self.minimum <= number <= self.maximum:
            unit = "" if self.unit == "1" else f" {self.unit}"
            raise InputError(f"{self.name} = {number!r}{unit}: expected {self.expected}")
        return number + 0.0  # no negative zero


def checked_range(
    name: str,
    value: Any,
    unit: str = "",
    low: float = -math.inf,
    high: float = math.inf,
    open_low: bool = False,
    open_high: bool = False,
) -> float:
    """Return a finite number from ``low`` to ``high``, of which either end may be left out."""
    number = as_scalar(value)
    is_number = isinstance(number, numbers.Real) and not isinstance(number, bool)
    try:
        number = float(number) if is_number else math.nan
    except OverflowError:
        number = math.nan
    left_out = (open_low and number == low) or (open_high and number == high)
    if not (math.isfinite(number) and low <= number <= high) or left_out:
        begin = "" if low == -math.inf else f"{low:.4g} {'<' if open_low else '<='} "
        end = "" if high == math.inf else f" {'<' if open_high else '<='} {high:.4g}"
        expected = f"{begin}{name}{end}" if begin or end else "a finite number"
        raise InputError(f"{name} = {value!r}{unit and f' {unit}'}: expected {expected}")
    return number


def written_unit_factors(name: str) -> dict[str, str]:
    """Return the units that a text may have for a parameter, over its own; empty for most."""
    return next((units for names, units in WRITTEN_UNITS.items() if name in names), {})


def parse_number_with_unit(name: str, text: str) -> float | None:
    """Return the number of a text such as ``0.7 %``; None if it does not end in a unit."""
    known = written_unit_factors(name)
    text = text.replace("hz", "Hz")
    unit = next((unit for unit in known if text.endswith(unit)), None)  # mm before m
    if unit is None:
        return None
    number = text.removesuffix(unit).strip()
    if not number.isascii() or "_" in number:
        raise ValueError(text)
    try:
        return float(Decimal(number) * Decimal(known[unit]))  # what one would write without it
    except InvalidOperation:
        raise ValueError(text) from None


def as_scalar(value: Any) -> Any:
    """Return a zero-dimensional array's value as a Python scalar; anything else unchanged."""
    return value.item() if getattr(value, "shape", None) == () else value


def checked_flag(name: str, value: Any) -> bool:
    flag = as_scalar(value)
    if not isinstance(flag, bool):
        raise InputError(f"{name} = {value!r}: expected true or false")
    return flag


def quantities_from_variables(
    variables: Iterable[Any], names: Iterable[str]
) -> dict[str, Quantity]:
    known = {variable.name: variable for variable in variables}
    return {
        v.name: Quantity(v.name, v.unit, v.description, v.minimum, v.maximum, v.start)
        for v in map(known.__getitem__, names)
    }


STRUCTURE = quantities_from_variables(oscillator.VARIABLES, (*oscillator.STRUCTURE, "stroke"))
MECHANICS = oscillator.MECHANICS
# files made before have none of them
ADDED = (*(variable.name for variable in oscillator.ADDED), "stroke")
# with one of these a motion is not in proportion to the shaking
OF_LENGTH = tuple(name for name, quantity in STRUCTURE.items() if quantity.dimension["m"])
OF_DRIVE = (
    *("box_mass", "box_stiffness", "box_damping", "unbalance_mass", "unbalance_radius"),
    *("rotor_inertia", "motor_constant", "armature_resistance", "armature_inductance"),
)
DRIVE = quantities_from_variables(motor_shaker.VARIABLES, OF_DRIVE)
OF_SHAKER = (
    *("table_mass", "suspension_stiffness", "suspension_damping", "force_factor"),
    *("coil_resistance", "coil_inductance", "voltage_limit", "current_limit", "travel_limit"),
)
ELECTRODYNAMIC_SHAKER = quantities_from_variables(electrodynamic_shaker.VARIABLES, OF_SHAKER)

SMALLEST, LARGEST = STRUCTURE["m1"].minimum, STRUCTURE["m1"].maximum
PUSHES = {  # loads other than the box's harmonic motion, by the FMU's inputs
    "box_acceleration": "box_acceleration",
    "force1": "force1_amplitude",
    "force2": "force2_amplitude",
}
OF_BOX = ("box_amplitude", "box_frequency", "phase_start")
INPUTS = quantities_from_variables(oscillator.VARIABLES, (*OF_BOX, *PUSHES.values()))
EXCITATION = {
    quantity.name: quantity
    for quantity in (
        Quantity("frequency", "rad/s", "Angular frequency Omega of the box", SMALLEST, LARGEST),
        Quantity("amplitude", "m", "Amplitude a of the box", 0.0, INPUTS["box_amplitude"].maximum),
        replace(INPUTS["phase_start"], name="phase"),
        *(replace(INPUTS[name], name=short) for short, name in PUSHES.items()),
    )
}

LEVEL = Quantity("level", "m/s2", "Peak acceleration a Omega^2 of the box", SMALLEST, LARGEST)
# names of arguments that make an excitation complete
COMPLETE = ({"eta"}, {"frequency", "amplitude"}, {"frequency", "level"})


def quantities_from_rows(*rows: tuple[str, str, str, tuple[float, float]]) -> dict[str, Quantity]:
    return {name: Quantity(name, unit, text, *ends) for name, unit, text, ends in rows}


POSITIVE, NOT_NEGATIVE, RATIO = (SMALLEST, LARGEST), (0.0, LARGEST), (0.0, LARGEST / 2.0)
DATASHEET = quantities_from_rows(  # of an electrodynamic shaker
    ("rated_force", "N", "Peak of a sine", POSITIVE),
    ("moving_mass", "kg", "Of the bare table with its coil", POSITIVE),
    ("suspension_resonance", "Hz", "Of the bare table", POSITIVE),
    ("amplifier_power", "VA", "Of a sine", POSITIVE),
    ("travel", "m", "Peak to peak; 0: no stops", NOT_NEGATIVE),
    ("payload", "kg", "What is fixed to the table", NOT_NEGATIVE),
    ("damping_ratio", "1", "Of the bare table with its coil open", RATIO),
)
RATIO_QUANTITIES = quantities_from_rows(
    ("omega", "rad/s", "Frequency unit sqrt(k1/m1), (2)", POSITIVE),
    ("mu", "1", "Mass ratio m2/m1, (2)", POSITIVE),
    ("kappa", "1", "Stiffness ratio k2/k1, (2)", POSITIVE),
    ("D", "1", "Damping ratio of both masses, (8)", RATIO),
    ("D1", "1", "Damping ratio of mass 1, (8)", RATIO),
    ("D2", "1", "Damping ratio of mass 2, (8)", RATIO),
    ("f1", "Hz", "Natural frequency of mass 1 alone", POSITIVE),
    ("f2", "Hz", "Natural frequency of mass 2 alone", POSITIVE),
    ("zeta1", "1", "Damping ratio of mass 1 at its own frequency", RATIO),
    ("zeta2", "1", "Damping ratio of mass 2 at its own frequency", RATIO),
    ("eta", "1", "Frequency ratio Omega/omega, (6)", (1e-6, 1e6)),
    ("beta", "1", "Mass ratio m1/M_t", POSITIVE),
    ("epsilon", "1", "The unbalance's share in the inertia, S^2/(J M_t)", POSITIVE),
    ("b", "1", "Slope of the torque line, K^2/(R_a J omega)", POSITIVE),
    ("Omega_b", "1", "The box's own frequency over omega", RATIO),
    ("D_b", "1", "Damping ratio of the box, c_b/(2 omega M_t)", RATIO),
)


def construct_or_explain(
    arguments: Mapping[str, float], construct: Callable[[], Described]
) -> Described:
    """Call ``construct()``; an ``InputError`` is re-raised with the original arguments."""
    try:
        return construct()
    except InputError as error:
        numbers_given = ", ".join(f"{name} = {value!r}" for name, value in arguments.items())
        raise InputError(f"{numbers_given}: they make {error}") from None


def invert_exactly(guess: float, forward: Callable[[float], float], target: float) -> float:
    """Return the float near ``guess`` that ``forward`` maps to ``target``, else ``guess``."""
    # of the few numbers that do, the one with the fewest digits: the one that somebody wrote down
    near = [guess]
    for _ in range(3):
        near = [math.nextafter(near[0], -math.inf), *near, math.nextafter(near[-1], math.inf)]
    fitting = [number for number in near if number >= 0.0 and forward(number) == target]
    return min(fitting, key=lambda number: (len(repr(number)), abs(number - guess)), default=guess)
