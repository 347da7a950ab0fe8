"""What is missing to read the columns of a file, with the arguments that give it, to complete."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from ..errors import InputError
from .conversion import VOLTAGES, normalize_unit
from .record import FORCES, SHORT_NAMES

USUAL_UNITS = "m/s2, g, mm/s, um", "100 mV/g"  # and the sensitivity of a sensor in volts


class DescribedColumn(Protocol):
    """A column of a file by its name, unit and sensitivity."""

    @property
    def name(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def sensitivity(self) -> str: ...


Used = Mapping[str, DescribedColumn]  # by channel


def check_units(
    path: str, used: Used, units: Mapping[str, str], stated: Mapping[str, str], setup_file: str
) -> None:
    """Raise where columns have no unit, with the argument that states it for each."""
    known = {n: units.get(n, one.unit) or stated.get(n, one.sensitivity) for n, one in used.items()}
    if unknown := [name for name, text in known.items() if not text]:
        words = {n: SHORT_NAMES.get(n, n).replace(" ", "") for n in (*units, *unknown)}
        order = [n for n in ("time", *used) if n in words]
        usual, volts = ("N, kN", "22 mV/N") if {*unknown} <= {*FORCES} else USUAL_UNITS
        volts = f', or V or mV with sensitivity="{volts}"'
        text = f"no unit; expected one such as {usual}{volts}: give it by unit="
        sections = ", ".join(f"[{words[n]}]" for n in unknown)
        there = f', or in {setup_file} write unit = "..." below {sections}' if setup_file else ""
        argument = format_by_channel(order, units)
        columns = format_file_and_columns(path, used, unknown)
        raise InputError(f"{columns}: {text}{argument}{there}")


def check_sensitivities(
    path: str, used: Used, units: Mapping[str, str], stated: Mapping[str, str]
) -> None:
    """Raise where columns in volts have no sensitivity, with the argument that states it."""
    volts = {n: units.get(n, one.unit) for n, one in used.items()}
    volts = {n: unit for n, unit in volts.items() if normalize_unit(unit) in VOLTAGES}
    if bare := [name for name in volts if not stated.get(name, used[name].sensitivity)]:
        usual = [] if {*bare} <= {*FORCES} else ["100 mV/g or 50 mV/(mm/s)"]
        usual += ["22 mV/N"] if {*bare} & {*FORCES} else []
        text = f"in {volts[bare[0]]}, without a sensitivity; expected one such as "
        option = format_by_channel([n for n in used if n in (*stated, *bare)], stated)
        text = f"{text}{', of forces '.join(usual)}: give it by sensitivity={option}"
        raise InputError(f"{format_file_and_columns(path, used, bare)}: {text}")


def format_file_and_columns(path: str, used: Used, names: Sequence[str]) -> str:
    columns = (f'column "{used[name].name}" ({SHORT_NAMES[name]})' for name in names)
    return f"{path}, {', '.join(columns)}"


def format_by_channel(names: Sequence[str], values: Mapping[str, str]) -> str:
    """Format an argument by channel, to be completed: ``"base=V,face1=..."``."""
    words = (SHORT_NAMES.get(name, name).replace(" ", "") for name in names)
    pairs = zip(words, (values.get(name) or "..." for name in names), strict=True)
    return f'"{",".join(map("=".join, pairs))}"'
