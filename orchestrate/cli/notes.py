"""Notes on questions that are trivial, and warnings of numbers that are probably not intended."""

from __future__ import annotations

import logging
import math
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import orchestrate

from ..constants import GRAVITY, TURN
from ..lazy import np, xr
from ..model import Structure
from ..model.ranges import COMPLETE, OF_LENGTH
from ..units import format_quantity
from .command import Keywords

OTHER_UNIT = {  # of an option: its unit over the other one's, names of both
    "frequency": (1.0 / TURN, "rad/s", "--hz"),
    "hz": (TURN, "Hz", "--frequency"),
}
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class NoteSettings:
    """State from which numbers on a user is asked whether they are intended."""

    far: float = 25.0  # frequency ratio, or its inverse, at which there is little to be seen
    near: float = 0.1  # relative distance within which a frequency is one of the structure's own
    heavy: float = 20.0  # kg, of a half of a beam
    unfelt: float = 200.0  # threshold of contact over the level: a clearance is hardly meant
    unlike: float = 3.0  # ratio of the halves' frequencies, where one is set and the other is not
    travel: float = 0.05  # m, amplitude of the box: no shaker has it
    violent: float = 100.0  # g, its acceleration
    slow: float = 0.5  # no-load speed of a motor over omega, of all voltages: it stays below
    fast: float = 5.0  # or above the resonance


SETTINGS = NoteSettings()


def warn(text: str) -> None:
    warnings.warn(text, stacklevel=3)


def heavy_mass_note(structure: Structure) -> str:
    """Return a line that gives heavy masses their unit; empty for lighter ones and in ratios."""
    masses = {f"m{half}": getattr(structure, f"m{half}") for half in structure.halves}
    if max(masses.values()) < SETTINGS.heavy or math.isclose(structure.omega, 1.0):
        return ""
    text = ", ".join(f"{name} = {mass:g} kg" for name, mass in masses.items())
    return f"{text}: masses are in kg (150 g is 0.15, or 150g)"


def trivial_question_notes(
    structure: Structure, question: Keywords, shown: xr.Dataset
) -> Iterator[str]:
    varied = isinstance(question.get("level"), tuple) or question.get("over") == "level"
    if varied and not structure.has_scale:
        nothing = ", ".join(f"{name} = 0" for name in OF_LENGTH)
        yield f"{nothing}: the response is proportional to the level; one level is enough"
    elif structure.bonded:
        yield "bonded: both masses move as one, there are no impacts"
    elif not structure.wall and structure.alike:
        yield "both oscillators are alike: masses that start together never part"
    else:
        yield from clearance_notes(structure, question, shown)


def box_frequencies_and_amplitudes(structure: Structure, question: Keywords) -> tuple[Any, Any]:
    """Return frequencies, rad/s, and amplitudes, m, of all points asked, as arrays."""
    box = {name: np.ravel(question[name]) for name in set().union(*COMPLETE) & question.keys()}
    if "eta" in box:
        return box["eta"] * structure.omega, box["eta"] ** -2.0
    if "level" in box:
        frequency = box["frequency"][:, None]
        return frequency, box["level"] / frequency**2
    return box["frequency"], box["amplitude"]


def warn_of_unusual_voltage(text: str, voltages: tuple[float, ...], volts: float) -> None:
    """Warn if voltages are far from the one that turns the motor at omega, ``volts``."""
    ratios = [abs(voltage) / volts for voltage in voltages]
    if max(ratios) < SETTINGS.slow or min(ratios) > SETTINGS.fast:
        eta0 = " to ".join(f"{ratio:.3g}" for ratio in ratios)
        warn(
            f"{text}: eta0 = {eta0}, far from the resonance: without a load the motor turns at "
            f"omega with {volts:.4g} V (eta0 = 1)"
        )


def print_and_warn_of_frequencies(arguments: Any, structure: Structure, question: Keywords) -> None:
    if question.get("frequency") is None:
        return
    values = np.ravel(question["frequency"])
    own_frequency = f"{structure.omega / TURN:.4g} Hz"
    if getattr(arguments, "structure", "") == "paper" and not arguments.set:
        omega = f"omega = {structure.omega:.6g} rad/s, {own_frequency}"
        print(f"structure: the paper's, {omega} (--structure names another)")
    if not math.isclose(structure.omega, 1.0):
        warn_of_other_unit(arguments, structure, values.min(), values.max())
        if {"amplitude", "level"} & question.keys():
            frequency, amplitude = box_frequencies_and_amplitudes(structure, question)
            travel, level = amplitude.max(), (amplitude * frequency**2).max() / GRAVITY
            if travel > SETTINGS.travel or level > SETTINGS.violent:
                warn(
                    f"the box moves by up to {travel:.3g} m and {level:.3g} g: beyond what shakers "
                    "do; is the amplitude in m (1 mm is 1e-3, or 1mm), the level in g?"
                )
    low, high = values.min() / structure.omega, values.max() / structure.omega
    if high > SETTINGS.far or low < 1.0 / SETTINGS.far:
        ends = " to ".join(f"{ratio:.3g}" for ratio in dict.fromkeys((low, high)))
        log.warning(
            "frequencies of %s times the structure's %s are far from it: is it the structure that "
            "is meant (--structure)?",
            *(ends, own_frequency),
        )


def warn_of_other_unit(arguments: Any, structure: Structure, first: float, last: float) -> None:
    """Warn if frequencies would fit the structure in the other unit: Hz for rad/s or reverse."""
    low, high = (1.0 - SETTINGS.near) * first, (1.0 + SETTINGS.near) * last
    hertz = [getattr(structure, f"f{half}") for half in structure.halves]

    def fits_structure(factor: float) -> bool:
        return any(low <= factor * TURN * each <= high for each in hertz)

    for name, (factor, unit, other) in OTHER_UNIT.items() if not fits_structure(1.0) else ():
        text = getattr(arguments, name, None)
        if text and fits_structure(factor):
            own = f"own frequencies are {' and '.join(f'{each:.4g}' for each in hertz)} Hz"
            warn(f"--{name} {text}: these are {unit}, and the structure's {own}; is {other} meant?")


def clearance_notes(structure: Structure, question: Keywords, shown: xr.Dataset) -> Iterator[str]:
    if question.get("over") == "level":
        question = {**question, "level": question["values"]}
    elif question.get("over") is not None or "clearance" in question:
        return
    linear = structure.bonded or structure.wall or structure.stroke or not structure.clearance
    if linear or set().union(*COMPLETE) & question.keys() not in COMPLETE:
        return
    ratio = smallest_threshold_over_level(structure, question)
    if ratio <= 1.0:
        return
    if ratio > SETTINGS.unfelt:
        times = f"{ratio:.3g} times what this level moves"
        warn(f"clearance = {structure.clearance:g} m: {times}; is it in m (20 um is 2e-5)?")
    pressed = structure.clearance < 0.0
    kind, event = ("pressed together", "opens") if pressed else ("open", "touches")
    length = format_quantity(shown, abs(structure.clearance), "m")
    first = f"{kind} by {length}, it first {event} at {ratio:.4g} times this level"
    yield f"{first}: from rest the response is linear"


def smallest_threshold_over_level(structure: Structure, question: Keywords) -> float:
    """Return the smallest ratio of contact threshold to excitation level, of all points asked."""
    frequency, amplitude = box_frequencies_and_amplitudes(structure, question)
    level = orchestrate.contact_threshold(structure, frequency=np.unique(frequency))
    threshold = np.interp(frequency, level.frequency, level.threshold_amplitude)
    return float((threshold / amplitude).min())
