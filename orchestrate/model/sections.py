"""Sections of a TOML file, read key by key: errors name file, section and key."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from ..constants import GRAVITY, TURN
from ..errors import InputError
from .drive import Drive
from .excitation import Excitation
from .ranges import (
    DATASHEET,
    DRIVE,
    ELECTRODYNAMIC_SHAKER,
    EXCITATION,
    LARGEST,
    MECHANICS,
    PUSHES,
    RATIO_QUANTITIES,
    SMALLEST,
    STRUCTURE,
    Quantity,
    checked_flag,
)
from .shaker import Shaker
from .spelling import expected_one_of
from .structure import Structure
from .structure_numbers import FLAGS

TO_RAD_S: dict[str, Callable[[float], float]] = {
    "hz": lambda value: TURN * value,
    "rad_s": lambda value: value,
    "rpm": lambda value: TURN * value / 60.0,
}
COMMON_NUMBERS = tuple(name for name in STRUCTURE if name not in MECHANICS)
OMEGAS = tuple(f"omega_{unit}" for unit in TO_RAD_S)
MODAL_KEYS = ("f1_hz", "f2_hz", "zeta1", "zeta2")
OF_ONE_MASS = {"m": "m1", "k": "k1", "d": "d1", "f_hz": "f1_hz", "zeta": "zeta1"}
RATIO_KEYS = ("mu", "kappa", "D", "D1", "D2", *OMEGAS)
FREQUENCIES = (*(f"frequency_{unit}" for unit in TO_RAD_S), "eta")
AMPLITUDES = ("amplitude", "acceleration_g")
SI_BOX = tuple(name for name in DRIVE if name.startswith("box_"))
SI_MOTOR = tuple(name for name in DRIVE if name not in SI_BOX)
TORQUE_LINE_KEYS = ("motor_constant", "armature_resistance")  # of which a datasheet has others:
SPEEDS = tuple(f"no_load_speed_{unit}" for unit in TO_RAD_S)
DATASHEET_KEYS = ("rated_voltage", "stall_torque", *SPEEDS, "mechanical_time_constant")
MOTOR_NUMBERS, BOX_NUMBERS = ("beta", "epsilon", "b"), ("Omega_b", "D_b")
SHAKER_COMMON = ("force_factor", "coil_resistance", "coil_inductance")
SHAKER_SI = tuple(name for name in ELECTRODYNAMIC_SHAKER if name not in SHAKER_COMMON)
QUANTITIES = {
    **{q.name: q for q in (*ELECTRODYNAMIC_SHAKER.values(), *DATASHEET.values())},
    **{q.name: q for q in (*STRUCTURE.values(), *EXCITATION.values(), *DRIVE.values())},
    **RATIO_QUANTITIES,
    "preload": replace(STRUCTURE["clearance"], name="preload", minimum=0.0),
    **{
        f"{what}_{unit}": Quantity(f"{what}_{unit}", "1", "", SMALLEST, LARGEST)
        for what in ("omega", "frequency", "no_load_speed")
        for unit in TO_RAD_S
    },
    **{
        name: Quantity(name, unit, "", SMALLEST, LARGEST)
        for name, unit in (
            *(("rated_voltage", "V"), ("stall_torque", "N.m")),
            *(("mechanical_time_constant", "s"), ("f1_hz", "Hz"), ("f2_hz", "Hz")),
        )
    },
    "acceleration_g": Quantity("acceleration_g", "1", "", 0.0, LARGEST),
}
Described = TypeVar("Described")


@dataclass(frozen=True)
class Section:
    """One section of a TOML file: its keys and values, with file and name for error messages."""

    path: Path
    name: str
    values: dict[str, Any]

    def error(self, key: str, text: str) -> InputError:
        value = f" = {self.values[key]!r}" if key in self.values else ""
        return InputError(f"{self.path}: {self.name}.{key}{value}: {text}")

    def allow_only(self, *known: str) -> None:
        """Raise ``InputError`` if the section has a key other than the known ones."""
        for key in self.values:
            if key not in known:
                raise self.error(key, f"no key of [{self.name}]; {expected_one_of(key, known)}")

    def present_keys(self, keys: Collection[str]) -> list[str]:
        return [key for key in keys if key in self.values]

    def uses_second_form(self, first: Collection[str], second: Collection[str]) -> bool:
        """Return whether the section has keys of ``second``; raise if it mixes both groups."""
        first_keys, second_keys = self.present_keys(first), self.present_keys(second)
        if first_keys and second_keys:
            text = f"given with {first_keys[0]}; expected keys of one kind: {', '.join(first)}"
            raise self.error(second_keys[0], f"{text}, or {', '.join(second)}")
        return bool(second_keys)

    def at_most_one(self, keys: Collection[str]) -> str | None:
        present = self.present_keys(keys)
        if len(present) > 1:
            expected = f"expected one of {', '.join(keys)}"
            raise self.error(present[1], f"conflicts with {present[0]}; {expected}")
        return present[0] if present else None

    def exactly_one(self, keys: Collection[str]) -> str:
        key = self.at_most_one(keys)
        if key is None:
            raise InputError(f"{self.path}: [{self.name}]: expected one of {', '.join(keys)}")
        return key

    def require_all(self, keys: Collection[str]) -> None:
        for key in keys:
            if key not in self.values:
                raise self.error(key, f"missing; expected all of {', '.join(keys)}")

    def checked_value(self, key: str) -> float:
        """Return a key's number or flag; raise ``InputError`` if it is none or out of range."""
        is_flag = key in (*FLAGS, "current_control")
        check = partial(checked_flag, key) if is_flag else QUANTITIES[key].check
        try:
            return check(self.values[key])
        except InputError as error:
            raise InputError(f"{self.path}: {self.name}.{error}") from None

    def present_values(self, keys: Collection[str]) -> dict[str, float]:
        return {key: self.checked_value(key) for key in self.present_keys(keys)}

    def rad_s(self, key: str) -> float:
        """Return a key's frequency in rad/s, converted from the unit that its name ends in."""
        unit = next(unit for unit in TO_RAD_S if key.endswith(f"_{unit}"))
        return TO_RAD_S[unit](self.checked_value(key))

    def construct(self, maker: Callable[[], Described]) -> Described:
        """Return ``maker()``; an ``InputError`` from it is raised again with file and section."""
        try:
            return maker()
        except InputError as error:
            raise InputError(f"{self.path}: [{self.name}]: {error}") from None


def read_structure(section: Section) -> Structure:
    if section.values.get("wall") is True:  # one mass, as Structure.one_mass calls its numbers
        own = {OF_ONE_MASS.get(key, key): value for key, value in section.values.items()}
        section = replace(section, values=own)
    section.allow_only(*COMMON_NUMBERS, *FLAGS, "preload", *MECHANICS, *MODAL_KEYS, *RATIO_KEYS)
    values: dict[str, Any] = section.present_values((*COMMON_NUMBERS, *FLAGS))
    if section.at_most_one(("clearance", "preload")) == "preload":
        values["clearance"] = -section.checked_value("preload")
    if section.present_keys(MODAL_KEYS):
        section.uses_second_form(MODAL_KEYS, (*MECHANICS[2:], *RATIO_KEYS))
        if wall := values.get("wall", False):
            for key in section.present_keys(("m2", "f2_hz", "zeta2")):
                raise section.error(key, "mass 2 is a wall; expected it left out")
        section.require_all(("f1_hz", "zeta1") if wall else ("m1", "m2", *MODAL_KEYS))
        values |= section.present_values(("m1", "m2", *MODAL_KEYS))
        values = {key.removesuffix("_hz"): value for key, value in values.items()}
        construct = Structure().replace if wall else Structure.from_halves
        return section.construct(lambda: construct(**values))
    if not section.uses_second_form(MECHANICS[1:], RATIO_KEYS):
        values |= section.present_values(MECHANICS)
        return section.construct(lambda: Structure(**values))
    if section.uses_second_form(("D",), ("D1", "D2")):
        section.require_all(("D1", "D2"))
    values |= section.present_values(("m1", "mu", "kappa", "D", "D1", "D2"))
    omega = section.at_most_one(OMEGAS)
    if omega:
        values["omega"] = section.rad_s(omega)
    return section.construct(lambda: Structure.nondimensional(**values))


def read_excitation(section: Section, structure: Structure | None) -> Excitation:
    section.allow_only(*FREQUENCIES, *AMPLITUDES, "phase", *PUSHES)
    key = section.exactly_one(FREQUENCIES)
    amplitude_key = section.at_most_one(AMPLITUDES)
    more = section.present_values(("phase", *PUSHES))
    if key == "eta":
        eta = section.checked_value("eta")
        if structure is None:
            raise section.error("eta", "it refers to a structure; expected a section [structure]")
        if amplitude_key is None:
            return section.construct(lambda: Excitation.nondimensional(eta, structure, **more))
        frequency = eta * structure.omega
    else:
        frequency = section.rad_s(key)
    amplitude = section.checked_value(section.exactly_one(AMPLITUDES))
    if amplitude_key == "acceleration_g":
        amplitude = amplitude * GRAVITY / (frequency * frequency)
    return section.construct(lambda: Excitation(frequency=frequency, amplitude=amplitude, **more))


def read_drive(motor: Section, box: Section, structure: Structure | None) -> Drive:
    motor.allow_only(*SI_MOTOR, *DATASHEET_KEYS, *MOTOR_NUMBERS)
    box.allow_only(*SI_BOX, *BOX_NUMBERS)
    by_numbers = motor.uses_second_form((*SI_MOTOR, *DATASHEET_KEYS), MOTOR_NUMBERS)
    if box.uses_second_form(SI_BOX, BOX_NUMBERS) != by_numbers:
        kind = ", ".join(BOX_NUMBERS if by_numbers else SI_BOX)
        form = "non-dimensional" if by_numbers else "SI"
        raise InputError(f"{box.path}: [box] with a {form} [motor]: expected {kind}")
    if not by_numbers:
        box.require_all(SI_BOX)
        return read_si_drive(motor, box.present_values(SI_BOX))
    motor.require_all(MOTOR_NUMBERS)
    box.require_all(BOX_NUMBERS)
    if structure is None:
        raise motor.error("beta", "it refers to a structure; expected a section [structure]")
    numbers = {**motor.present_values(MOTOR_NUMBERS), **box.present_values(BOX_NUMBERS)}
    return motor.construct(lambda: Drive.nondimensional(**numbers, structure=structure))


def read_shaker(section: Section) -> Shaker:
    keys = (*SHAKER_SI, *SHAKER_COMMON, "current_control", *DATASHEET)
    section.allow_only(*keys)
    values: dict[str, Any] = section.present_values(keys)
    section.require_all(("force_factor", "coil_resistance"))
    if section.uses_second_form(SHAKER_SI, DATASHEET):
        needed = "rated_force", "moving_mass", "suspension_resonance", "amplifier_power"
        section.require_all(needed)
        return section.construct(lambda: Shaker.from_datasheet(**values))
    section.require_all(("table_mass", "suspension_stiffness", "suspension_damping"))
    return section.construct(lambda: Shaker(**values))


def check_m1_given(structure: Section, motor: Section) -> None:
    """Raise if a motor is in SI but the structure's mass m1 is left to its default of 1 kg."""
    if (omegas := structure.present_keys(OMEGAS)) and "m1" not in structure.values:
        text = f"missing with {omegas[0]}; expected it, as the motor feels the masses"
        if "beta" not in motor.values:
            raise structure.error("m1", text)


def read_si_drive(motor: Section, box: dict[str, float]) -> Drive:
    values = {**motor.present_values(SI_MOTOR), **box}
    if not motor.uses_second_form(TORQUE_LINE_KEYS, DATASHEET_KEYS):
        motor.require_all([name for name in SI_MOTOR if name != "armature_inductance"])
        return motor.construct(lambda: Drive(**values))
    motor.require_all(("rated_voltage", "stall_torque", "unbalance_mass", "unbalance_radius"))
    speed = motor.rad_s(motor.exactly_one(SPEEDS))
    motor.exactly_one(("rotor_inertia", "mechanical_time_constant"))
    values |= motor.present_values(("rated_voltage", "stall_torque", "mechanical_time_constant"))
    return motor.construct(lambda: Drive.from_datasheet(**values, no_load_speed=speed))
